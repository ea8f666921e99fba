/* The table of commands, from which parsing, help and completion are derived. */
#include "commands.h"
#include "help.h"

#include <string.h>

/* options that mean the same in several commands; short names are for the commonest only */
#define JSON_OPTION                                                                                                    \
    {                                                                                                                  \
        .name = "json", .kind = CLI_FLAG, .doc = "print one JSON object on standard output"                            \
    }
#define FORMAT_OPTION                                                                                                  \
    {                                                                                                                  \
        .name = "format", .kind = CLI_WORD, .value = "FORMAT", .words = cli_format_names,                              \
        .doc = "write this format: obj, ply (binary), ply-ascii, ply-big (big endian), stl (binary), stl-ascii, "      \
               "off or vtp (VTK PolyData); default: by the file's ending"                                              \
    }

#define EXPORT_OPTION                                                                                                  \
    {                                                                                                                  \
        .name = "format", .kind = CLI_WORD, .value = "FORMAT", .words = cli_export_names,                              \
        .doc = "write this format: obj, ply (binary), ply-ascii, ply-big (big endian), stl (binary), stl-ascii, off, " \
               "vtp (VTK PolyData), glb or, of a run, pc2 or usda; default: by the file's ending"                      \
    }

const cli_option cli_help_option = {.name = "help", .letter = 'h', .kind = CLI_FLAG, .doc = "print this page"};

static const cli_command commands[] = {
    {
        .name = "run",
        .summary = "simulate a scene and write its results",
        .text = "Reads the scene file SCENE (YAML or JSON; a name such as balloon is an installed scene), simulates it "
                "and writes a folder of results: frames.pvd with frames/*.vtp for ParaView, series.csv with the "
                "measures over time, summary.json, final.ply, and scene.yaml, which is the scene with all defaults "
                "written out.\n\nCtrl-C (SIGINT), SIGTERM and SIGHUP stop the run within 0.5 s, complete all files and "
                "write a checkpoint from which --resume continues with the same bits. A second signal ends the run at "
                "once; the files in the folder are then complete too, including `checkpoint`, the state that is saved "
                "every 10 s. If a run diverges, the error names the vertex, the last good checkpoint is kept, and the "
                "exit status is 1.\n\nIf the numbers may be wrong, 'warning: ...' on standard error says why, and "
                "summary.json has the code of the warning: a method that is softer than the material, steps that did "
                "not converge, energy that appears, contact that jams, a mesh that is too coarse, a run that ends "
                "before it settles. docs/results.md lists the codes.",
        .slots = {{.name = "SCENE", .kind = CLI_SCENE}},
        .options = {{.name = "output",
                     .letter = 'o',
                     .kind = CLI_FOLDER,
                     .value = "DIR",
                     .doc =
                         "folder of the results; default: results/ and the scene's name, or with --resume the "
                         "folder of the checkpoint. It is new or empty, or that of an older run, which moves aside to "
                         "DIR.1"},
                    {.name = "overwrite", .kind = CLI_FLAG, .doc = "remove the older run in the folder instead"},
                    {.name = "set",
                     .kind = CLI_SETTING,
                     .repeated = true,
                     .value = "KEY=VALUE",
                     .print_keys = cli_print_scene_keys,
                     .doc =
                         "change one value of the scene, such as bodies.ball.springs.stiffness=5 or solver.dt=0.005; "
                         "'pellicle reference' lists the keys"},
                    {.name = "frames",
                     .kind = CLI_COUNT,
                     .value = "N",
                     .doc = "stop after frame N; frame 0 is the initial state"},
                    {.name = "threads",
                     .kind = CLI_COUNT,
                     .value = "N",
                     .doc = "use N threads; default: as many as the machine has. The results do not depend on it"},
                    {.name = "resume",
                     .kind = CLI_FILE,
                     .value = "FILE",
                     .doc = "continue from this checkpoint of an earlier run of the same scene"},
                    {.name = "progress",
                     .kind = CLI_WORD,
                     .value = "FORM",
                     .words = cli_progress_names,
                     .doc = "show progress on standard error: bar (one line that is updated), plain (one line per "
                            "second, for logs and pipes) or none; default: bar on a terminal, else none"},
                    {.name = "strict",
                     .kind = CLI_FLAG,
                     .doc = "exit with status 1 if the run ends with any warning; the results are kept"},
                    {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors and warnings only"},
                    JSON_OPTION},
        .examples = "pellicle run scenes/sphere-press.yaml\n"
                    "pellicle run scenes/sphere-press.yaml -o /tmp/soft --set bodies.0.springs.stiffness=1\n"
                    "pellicle run scenes/sphere-press.yaml --frames 20 --json | jq .volume_ratio_final",
        .run = cli_run,
    },
    {
        .name = "live",
        .summary = "interact with a simulation in a browser",
        .text =
            "Simulates SCENE and serves a page that shows it: pull the surface by a spring, press it with a tool, pin, "
            "inflate, change parameters, undo, and save all interactions as a scene that 'pellicle run' repeats bit "
            "for bit. A MESH becomes a body filled with tissue or, with --shell, a shell of rubber. Default: the scene "
            "balloon.\n\nPrints 'live at http://127.0.0.1:PORT/?token=TOKEN', opens this address in a browser and "
            "serves it until interrupted. Only this machine can reach it, unless --host names another address, and "
            "only with the token. The next start continues the session.\n\n--html writes one HTML file instead, which "
            "simulates in any browser without this "
            "program: it contains the scene, the meshes and the library as WebAssembly.",
        .slots = {{.name = "SCENE|MESH", .kind = CLI_SCENE, .optional = true}},
        .options =
            {{.name = "shell", .kind = CLI_FLAG, .doc = "simulate a mesh as a shell of rubber, not as tissue"},
             {.name = "no-open", .kind = CLI_FLAG, .doc = "do not open a browser"},
             {.name = "port", .kind = CLI_COUNT, .value = "N", .doc = "port of the server; default: a free port"},
             {.name = "host",
              .kind = CLI_TEXT,
              .value = "ADDRESS",
              .doc = "serve on this address of the machine; default: 127.0.0.1"},
             {.name = "html",
              .kind = CLI_FILE,
              .value = "OUT",
              .doc = "write the page with the simulation to this file; start no server"},
             {.name = "paused", .kind = CLI_FLAG, .doc = "start paused"},
             {.name = "fresh", .kind = CLI_FLAG, .doc = "start anew, not from the last session of this scene"},
             {.name = "set",
              .kind = CLI_SETTING,
              .repeated = true,
              .value = "KEY=VALUE",
              .print_keys = cli_print_scene_keys,
              .doc = "change one value of the scene, such as solver.drag=2"},
             {.name = "threads",
              .kind = CLI_COUNT,
              .value = "N",
              .doc = "threads of a step; default: solver.threads of the scene"},
             {.name = "page",
              .kind = CLI_FILE,
              .value = "FILE",
              .doc = "the page template; default: the page that 'make web' built, or with --html 'make wasm'"},
             {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print the address and errors only"}},
        .examples = "pellicle live balloon\n"
                    "pellicle live balloon --html balloon.html\n"
                    "pellicle live liver.obj\n"
                    "pellicle live bust.ply --shell --no-open --port 8080",
        .run = cli_live,
    },
    {
        .name = "check",
        .summary = "find problems of a mesh or a scene; repair a mesh",
        .text =
            "Lists every problem of FILE with its place and remedy. A file that ends in .yaml, .yml or .json is "
            "checked as a scene, with the meshes it names; any other file as a mesh. Elements are numbered from "
            "0. Of a scene without errors it prints magnitudes: mass, the pressure or tension of 1 % strain, the "
            "pressure that "
            "buckles a closed shell, the time to fall, the lowest frequency (up to 3,000 vertices), and the cost of a "
            "run.\n\nExit status 0: no problem (notes may be printed), or the repaired mesh was written; 2: there are "
            "errors (the file cannot be simulated) or warnings (it can be simulated, but the result is probably not "
            "the intended one).\n\n--fix welds vertices at the same position; removes invalid, duplicate and flat "
            "triangles and unused vertices; divides the neighbour of a flat triangle if a slit would remain; splits "
            "non-manifold edges and vertices by duplicating vertices (a later check warns of the duplicates; write "
            ".obj, .ply or .off, because reading .stl welds them again); and orients triangles consistently and "
            "outward. Only welded vertices move. Holes remain unless --fill-holes closes them, and stray parts unless "
            "--drop-parts drops them.",
        .slots = {{.name = "FILE", .kind = CLI_FILE}},
        .options = {{.name = "fix",
                     .kind = CLI_FILE,
                     .value = "OUT",
                     .doc = "write the repaired mesh. Nothing is written if the result still cannot be simulated"},
                    {.name = "tolerance",
                     .kind = CLI_LENGTH,
                     .value = "LENGTH",
                     .doc = "with --fix: weld vertices up to this distance apart [units of the file]; default: 0, only "
                            "vertices at exactly the same position"},
                    {.name = "drop-parts",
                     .kind = CLI_COUNT,
                     .value = "N",
                     .doc =
                         "with --fix: drop parts of at most N triangles that no edge connects with the largest part"},
                    {.name = "fill-holes",
                     .kind = CLI_COUNT,
                     .value = "N",
                     .doc = "with --fix: close holes of at most N edges with as little bending as possible, and print "
                            "the quality of the worst new triangle. 'pellicle info' lists the holes"},
                    {.name = "no-intersections",
                     .doc = "do not search for intersecting triangles; saves time on large meshes"},
                    FORMAT_OPTION,
                    JSON_OPTION},
        .examples = "pellicle check liver.obj\n"
                    "pellicle check scan.stl --fix scan-fixed.ply\n"
                    "pellicle check scenes/sphere-press.yaml",
        .run = cli_check,
    },
    {
        .name = "info",
        .summary = "print counts, topology, sizes and quality of a mesh",
        .text = "Prints the properties of a mesh: counts, whether it is closed, manifold and oriented, genus, "
                "components, volume, area, edge lengths, triangle quality, bounding box and vertex fields. Lengths are "
                "in the units of the file.",
        .slots = {{.name = "MESH", .kind = CLI_FILE}},
        .options = {JSON_OPTION},
        .examples = "pellicle info liver.obj\npellicle info liver.obj --json | jq .volume",
        .run = cli_info,
    },
    {
        .name = "measure",
        .summary = "measure area, volume, mean and Gaussian curvature of a mesh",
        .text = "Prints the area, the volume, and for both curvatures the minimum, the mean weighted by area and the "
                "maximum. The mean curvature is that of the cotangent Laplacian over mixed areas, positive on a "
                "sphere; the Gaussian curvature is the angle defect over the same areas. Its total must equal 2 pi "
                "times the Euler number; both are printed. Numbers are in the units of the file.\n\nBoundary vertices "
                "are excluded, except in the total, which includes their geodesic curvature.",
        .slots = {{.name = "MESH", .kind = CLI_FILE}},
        .options =
            {{.name = "output",
              .letter = 'o',
              .kind = CLI_FILE,
              .value = "OUT",
              .doc = "write the mesh with the vertex fields area, normal, mean_curvature and gaussian_curvature: .vtp "
                     "or .ply"},
             {.name = "pressure",
              .kind = CLI_LENGTH,
              .value = "PASCAL",
              .doc = "with -o: also write the forces of this outside pressure, as in paper B's figure 2: the fields "
                     "pressure_force, pressure_magnitude and pressure_direction (the cosine of the angle to +y)"},
             JSON_OPTION},
        .examples = "pellicle measure liver.obj\n"
                    "pellicle measure liver.obj --json | jq .mean_curvature_max\n"
                    "pellicle measure head.ply --pressure 100 -o head.vtp",
        .run = cli_measure,
    },
    {
        .name = "shape",
        .summary = "generate a mesh: sphere, box, disk, grid, cylinder, torus, capsule, lens capsule, blend",
        .text = "Writes a generated mesh. Lengths are in metres.",
        .slots = {{.name = "NAME", .kind = CLI_WORD, .optional = true, .noun = "shape", .words = cli_shape_names}},
        .options = {{.name = "output",
                     .letter = 'o',
                     .kind = CLI_FILE,
                     .value = "OUT",
                     .doc = "the file to write: .obj, .ply, .stl or .off"},
                    {.name = "set",
                     .kind = CLI_SETTING,
                     .repeated = true,
                     .value = "KEY=VALUE",
                     .print_keys = cli_print_shape_keys,
                     .doc = "set one parameter of the shape"},
                    FORMAT_OPTION,
                    {.name = "list", .kind = CLI_FLAG, .doc = "print the shapes and their parameters"}},
        .more_help = cli_shape_help,
        .examples = "pellicle shape geodesic-sphere --set frequency=5 -o ball.ply\n"
                    "pellicle shape lens-capsule --set age=29 -o lens.ply\n"
                    "pellicle shape --list",
        .run = cli_shape,
    },
    {
        .name = "subdivide",
        .summary = "subdivide a mesh smoothly (modified butterfly)",
        .text = "Splits each triangle into four, LEVELS times. Existing vertices do not move; new vertices on the "
                "edges are placed by the modified butterfly scheme (Zorin, Schroeder, Sweldens 1996), so that the "
                "surface becomes smooth. Vertex fields are interpolated in the same way.",
        .slots = {{.name = "MESH", .kind = CLI_FILE}},
        .options = {{.name = "levels",
                     .letter = 'n',
                     .kind = CLI_COUNT,
                     .value = "LEVELS",
                     .doc = "number of subdivisions; each one multiplies the number of triangles by four"},
                    {.name = "output",
                     .letter = 'o',
                     .kind = CLI_FILE,
                     .value = "OUT",
                     .doc = "the file to write: .obj, .ply, .stl or .off"},
                    {.name = "no-clamp",
                     .kind = CLI_FLAG,
                     .doc = "allow values of fields beyond the minimum and maximum of the input; default: fields are "
                            "clamped, so that a thickness stays positive"},
                    FORMAT_OPTION,
                    {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"}},
        .examples = "pellicle subdivide liver.obj -n 1 -o liver-fine.ply",
        .run = cli_subdivide,
    },
    {
        .name = "convert",
        .summary = "convert a mesh to another format; export a run",
        .text =
            "Reads a mesh and writes it as OBJ, PLY, STL, OFF, VTP, GLB or USD. OBJ, PLY, STL and OFF keep the order "
            "of "
            "vertices and custom fields; glTF 2.0 and USD are read too, and FBX, 3MF, COLLADA and others through "
            "assimp. "
            "Changes "
            "(polygons split, vertices welded, fields dropped) are reported on standard error.\n\nIf IN is the "
            "folder of a run, all its frames are written: as a .pc2 point cache (Blender, Maya) with its mesh "
            "OUT-bodies.obj, and a cache and a mesh for each tool; as a .glb with a node for each body and tool, "
            "one morph target for each frame and an animation; as a .usda (USD as text) with a mesh for each body and "
            "tool and time samples of points and normals; or as numbered mesh files with bodies and tools: "
            "out.obj gives out_00000.obj, out_00001.obj, ... If a body refines, its frames are converted to their "
            "finest common mesh, so that all files have the same triangles.",
        .slots = {{.name = "IN", .kind = CLI_FILE}, {.name = "OUT", .kind = CLI_FILE}},
        .options = {EXPORT_OPTION, {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"}},
        .examples =
            "pellicle convert organ.glb organ.ply\npellicle convert ball.ply ball.txt --format off\n"
            "pellicle convert results/sphere-press press.glb\npellicle convert results/sphere-press press.usda\n"
            "pellicle convert results/sphere-press frames/press.obj",
        .run = cli_convert,
    },
    {
        .name = "render",
        .summary = "draw pictures and films of runs and meshes",
        .text =
            "Draws the frames of one or more runs (folders that 'pellicle run' wrote), .vtp files or meshes, without a "
            "display. Colors show a vertex field. The camera shows all bodies in all frames, and colors have one range "
            "for all frames. Tools are drawn in their actual poses. Several runs are drawn side by side with the same "
            "camera and colors.\n\nOUT determines the kind of output: FILE.png is one picture (the frame with the "
            "largest displacement, or a contact sheet of several frames, fields or runs), FILE.mp4 or FILE.gif is a "
            "film (needs ffmpeg), and any other name is a folder with a picture of each frame.",
        .slots = {{.name = "RUN", .kind = CLI_FILE, .repeated = true}},
        .options =
            {{.name = "output",
              .letter = 'o',
              .kind = CLI_FILE,
              .value = "OUT",
              .doc = "a folder, FILE.png, FILE.mp4 or FILE.gif; default: the folder `pictures` in the run, or a .png "
                     "named after the mesh"},
             {.name = "field",
              .kind = CLI_TEXT,
              .value = "NAME",
              .doc = "color by this vertex field, or none for a plain surface; several fields, separated by commas, "
                     "are drawn side by side; default: displacement, if the frames have it"},
             {.name = "component",
              .kind = CLI_TEXT,
              .value = "C",
              .doc = "show x, y, z or a number from 0 of a vector field; default: its magnitude"},
             {.name = "colors",
              .kind = CLI_WORD,
              .value = "MAP",
              .words = cli_color_map_names,
              .doc = "viridis, cividis, cool-warm or warm; default: warm (grey is zero) for values that begin at 0, "
                     "cool-warm for values of both signs, viridis for others"},
             {.name = "range",
              .kind = CLI_TEXT,
              .value = "LOW:HIGH",
              .doc = "range of the colors; default: that of all frames drawn"},
             {.name = "unit",
              .kind = CLI_TEXT,
              .value = "TEXT",
              .doc = "unit of the field; default: the SI unit of known quantities"},
             {.name = "frames",
              .kind = CLI_TEXT,
              .value = "A:B:STEP",
              .doc = "draw these frames: 50, 0:100, 0:100:10, or a list such as 0,50,-1, where -1 is the last frame; "
                     "default: all; for a .png the frame with the largest displacement"},
             {.name = "view",
              .kind = CLI_TEXT,
              .value = "VIEW",
              .doc = "iso, front, back, left, right, top or bottom, or AZIMUTH,ELEVATION[,ZOOM]: the angles [degrees] "
                     "around the body from the front and above the horizontal plane, and the magnification"},
             {.name = "up",
              .kind = CLI_WORD,
              .value = "AXIS",
              .words = cli_axis_names,
              .doc = "axis that points up: x, y or z; default: that of the scene"},
             {.name = "size",
              .kind = CLI_TEXT,
              .value = "WxH",
              .doc = "width and height of the whole picture in pixels"},
             {.name = "sheet",
              .kind = CLI_TEXT,
              .value = "COLSxROWS",
              .doc = "arrange pictures in columns and rows; without --frames, as many frames of each run as fit; "
                     "default: a row for each run and field"},
             {.name = "arrows",
              .kind = CLI_TEXT,
              .value = "FIELD",
              .doc = "draw this vector field as arrows, such as force; arrows that point into the surface end on it"},
             {.name = "body-colors",
              .kind = CLI_TEXT,
              .value = "LIST",
              .doc = "colors of the bodies where no field colors them, as RRGGBB, such as d9b4a0,4a7cb2; default: the "
                     "color of tissue, and others for further bodies"},
             {.name = "edges", .kind = CLI_FLAG, .doc = "draw the edges of the triangles"},
             {.name = "outline", .kind = CLI_FLAG, .doc = "draw a dark line along the silhouette"},
             {.name = "flat", .kind = CLI_FLAG, .doc = "shade each triangle flat, not smoothly"},
             {.name = "background",
              .kind = CLI_WORD,
              .value = "COLOR",
              .words = cli_background_names,
              .doc = "white, dark or transparent; default: white"},
             {.name = "title", .kind = CLI_TEXT, .value = "TEXT", .doc = "write this text above the picture"},
             {.name = "label",
              .kind = CLI_TEXT,
              .repeated = true,
              .value = "TEXT",
              .doc = "label of a run (repeatable), in the order of the runs; default: names of the folders"},
             {.name = "no-labels", .kind = CLI_FLAG, .doc = "omit times and names"},
             {.name = "frame-numbers",
              .kind = CLI_FLAG,
              .doc = "label pictures with the number of the frame, not with its time"},
             {.name = "no-bar", .kind = CLI_FLAG, .doc = "omit color bars"},
             {.name = "no-tools", .kind = CLI_FLAG, .doc = "omit tools"},
             {.name = "no-ground", .kind = CLI_FLAG, .doc = "omit the shadow on the ground"},
             {.name = "fps",
              .kind = CLI_LENGTH,
              .value = "N",
              .doc = "pictures per second of a film; default: real time, between 10 and 60"},
             {.name = "turn",
              .kind = CLI_LENGTH,
              .value = "DEGREES",
              .doc = "rotate the camera around the body by this angle during a film; a mesh or a single frame becomes "
                     "a turntable of 72 pictures"},
             {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"},
             JSON_OPTION},
        .examples = "pellicle render results/sphere-press -o press.png --edges --frames 50\n"
                    "pellicle render liver.ply -o turntable.gif --turn 360\n"
                    "pellicle render results/sphere-press -o press.mp4\n"
                    "pellicle render results/soft results/stiff -o both.png --frames 0,25,50 --field force\n"
                    "pellicle render liver.obj -o liver.png --view 20,10 --up y",
        .run = cli_render,
    },
    {
        .name = "plot",
        .summary = "plot columns of a run's series.csv",
        .text = "Draws columns of series.csv against the first of them, or over time if there is one; without a column "
                "it lists them. Cells that are empty or no number are left out.",
        .slots = {{.name = "DIR", .kind = CLI_FOLDER},
                  {.name = "COLUMN", .kind = CLI_TEXT, .optional = true, .repeated = true}},
        .options =
            {{.name = "output",
              .letter = 'o',
              .kind = CLI_FILE,
              .value = "FILE",
              .doc = "the file to write: .svg or .png (a picture) or .csv (a table); default: plot.svg in the folder"},
             {.name = "log-x", .kind = CLI_FLAG, .doc = "logarithmic x axis"},
             {.name = "log-y", .kind = CLI_FLAG, .doc = "logarithmic y axis"},
             {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"}},
        .examples = "pellicle plot results/organ-press\n"
                    "pellicle plot results/organ-press ball_force_z -o force.png\n"
                    "pellicle plot results/organ-press ball_z ball_force_z -o force-depth.csv",
        .run = cli_plot,
    },
    {
        .name = "fields",
        .summary = "add fields to the frames of a run, such as stresses",
        .text = "Computes fields from the positions in the frames and the scene of the run, and writes them into the "
                "frames: displacement, elastic energies, curvatures, strains and stresses of shells. Fields that "
                "depend on velocities, contacts, loads or the past have to be in output.fields before the run; so do "
                "all fields of bodies that refine, are cut or have fibres. Positions of frames are rounded to seven "
                "digits (output.precision: double keeps all), so strains have an error of about 1e-6.",
        .slots = {{.name = "DIR", .kind = CLI_FOLDER}},
        .options = {{.name = "add",
                     .kind = CLI_TEXT,
                     .value = "NAMES",
                     .doc = "the fields to add, with commas between them; 'pellicle reference' lists all fields"},
                    {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"}},
        .examples = "pellicle fields results/balloon --add von_mises_top,principal_stress",
        .run = cli_fields,
    },
    {
        .name = "report",
        .summary = "make one HTML page of one or several runs",
        .text =
            "Writes one HTML file that any browser opens without a network. The page plays the frames; you can rotate "
            "the body, color it by any field and click a vertex to read its values. It also has plots of the measures "
            "over time, and the scene. Several runs are shown side by side with the same camera. Numbers are rounded "
            "to 1/65535 of their range. If a page is larger than --limit, its data are reduced, and the page says how.",
        .slots = {{.name = "DIR", .kind = CLI_FOLDER, .repeated = true}},
        .options = {{.name = "output",
                     .letter = 'o',
                     .kind = CLI_FILE,
                     .value = "FILE",
                     .doc = "the page to write; default: report.html in the first folder"},
                    {.name = "field",
                     .kind = CLI_TEXT,
                     .repeated = true,
                     .value = "NAME",
                     .doc = "include only this field (repeatable); the page opens with the first one; default: all "
                            "fields of the run"},
                    {.name = "limit",
                     .kind = CLI_COUNT,
                     .value = "MB",
                     .doc = "maximum size of the page; larger data are reduced; default: 25"},
                    {.name = "page",
                     .kind = CLI_FILE,
                     .value = "FILE",
                     .doc = "the page template; default: the one that 'make web' built"},
                    {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"}},
        .examples = "pellicle report results/sphere-press\n"
                    "pellicle report results/sphere-press results/sphere-press-hollow -o compare.html\n"
                    "pellicle report results/sphere-press --field force --limit 5",
        .run = cli_report_page,
    },
    {
        .name = "reproduce",
        .summary = "repeat the experiments of both papers",
        .text =
            "Runs the experiments NAME, or all of them. Each writes a folder with its runs and their scenes, plots, "
            "pictures (if the program was built with them) and numbers.csv. Several experiments also write index.html "
            "and index.md with a table of verdicts and all pictures.\n\nAn experiment checks claims of a paper, of the "
            "theory or of a reference, and compares with earlier results of this program (regression). Each claim has "
            "numbers, and each number has an expected value, a tolerance and a source. The verdict is 'holds'; "
            "'differs' with a reason if a paper's claim does not hold here; or 'fails'.\n\nThe experiments of paper B "
            "shrink bodies that the program generates, or with --data the scans in a folder (goat-head.obj, koala.obj, "
            "spot.obj, cat.obj, nefertiti-head.obj, gallbladder.obj, liver-coarse.obj), or with --mesh your own mesh, "
            "for which the papers' claims need not "
            "hold.\n\nExit status 0: no claim fails; 1: a claim fails.",
        .slots = {{.name = "NAME",
                   .kind = CLI_WORD,
                   .optional = true,
                   .repeated = true,
                   .noun = "experiment",
                   .words = cli_experiment_names}},
        .options = {{.name = "list", .kind = CLI_FLAG, .doc = "list the experiments"},
                    {.name = "all",
                     .kind = CLI_FLAG,
                     .doc = "run all experiments, as without NAME (7 minutes of processor time)"},
                    {.name = "output",
                     .letter = 'o',
                     .kind = CLI_FOLDER,
                     .value = "DIR",
                     .doc = "folder of the results; default: results/reproduce"},
                    {.name = "data",
                     .kind = CLI_FOLDER,
                     .value = "DIR",
                     .doc = "folder with scans; default: the folder in the environment variable PELLICLE_DATA"},
                    {.name = "mesh",
                     .kind = CLI_FILE,
                     .value = "FILE",
                     .doc = "use this closed mesh in the experiments of paper B"},
                    {.name = "up",
                     .kind = CLI_WORD,
                     .value = "AXIS",
                     .words = cli_axis_names,
                     .doc = "with --mesh: axis that points up: x, y or z; default: z"},
                    {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"},
                    JSON_OPTION},
        .more_help = cli_reproduce_help,
        .examples = "pellicle reproduce figure8\npellicle reproduce --all -o results/papers\n"
                    "pellicle reproduce b-figure10 b-figure16-18 --mesh bust.ply",
        .run = cli_reproduce,
    },
    {
        .name = "sweep",
        .summary = "run a study: one scene with many parameters, one table",
        .text =
            "Reads the study STUDY (YAML or JSON): a scene, 'vary' with the values of its keys, and 'measure' with the "
            "numbers to record. Executes all runs on all cores and writes runs.csv, with one row per run, and "
            "report.html. docs/sweeps.md explains the keys.\n\nEach row is saved when its run ends: after Ctrl-C or a "
            "kill the same command continues without repeating completed runs. The row of a run that fails, crashes or "
            "is killed has its status and error. The table has the same bits with any --jobs, in chunks and on other "
            "machines.\n\nExit status 0: all rows of the chunk exist; 1: stopped; 2: the study is refused.",
        .slots = {{.name = "STUDY", .kind = CLI_SCENE}},
        .options =
            {{.name = "output",
              .letter = 'o',
              .kind = CLI_FOLDER,
              .value = "DIR",
              .doc = "folder of the results; default: results/ and the study's name"},
             {.name = "jobs",
              .letter = 'j',
              .kind = CLI_COUNT,
              .value = "N",
              .doc = "execute N runs at a time; default: one for each core"},
             {.name = "chunk",
              .kind = CLI_TEXT,
              .value = "K/N",
              .doc = "execute the K-th of N equal chunks; the chunk that ends last writes the table"},
             {.name = "slurm",
              .kind = CLI_FLAG,
              .doc = "write DIR/job.sh, a Slurm job array of chunks, and submit it with sbatch"},
             {.name = "chunks", .kind = CLI_COUNT, .value = "N", .doc = "with --slurm: number of chunks; default: 16"},
             {.name = "timeout",
              .kind = CLI_LENGTH,
              .value = "SECONDS",
              .doc = "end runs that take more wall time; default: no limit"},
             {.name = "retry", .kind = CLI_FLAG, .doc = "repeat the runs that failed"},
             {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"},
             JSON_OPTION},
        .examples = "pellicle sweep examples/studies/indent.yaml\n"
                    "pellicle sweep study.yaml -o results/study --jobs 4\n"
                    "pellicle sweep study.yaml -o /shared/study --slurm --chunks 64",
        .run = cli_sweep,
    },
    {
        .name = "calibrate",
        .summary = "fit parameters of a scene to measured curves",
        .text = "Reads the fit FIT (YAML or JSON): a scene, the parameters with start values and bounds, and measured "
                "curves (CSV). Finds the parameters with which the results fit the curves best (bounded least squares) "
                "and writes fit.json with the values and their confidence intervals, curves.csv, and fit.svg. It runs "
                "the Python package, which needs scipy. docs/sweeps.md explains the keys.",
        .slots = {{.name = "FIT", .kind = CLI_SCENE}},
        .options = {{.name = "output",
                     .letter = 'o',
                     .kind = CLI_FOLDER,
                     .value = "DIR",
                     .doc = "folder of the results; default: results/ and the fit's name"},
                    {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"},
                    JSON_OPTION},
        .examples = "pellicle calibrate examples/fits/balloon.yaml -o results/balloon-fit",
        .run = cli_calibrate,
    },
    {
        .name = "bench",
        .summary = "measure the speed of this machine",
        .text = "Runs one benchmark or all of them, and prints the minimum and the median of the measured times, and a "
                "reference time.",
        .slots = {{.name = "NAME", .kind = CLI_WORD, .optional = true, .noun = "benchmark", .words = cli_bench_names}},
        .options = {{.name = "list", .kind = CLI_FLAG, .doc = "print the benchmarks"},
                    {.name = "repeats",
                     .kind = CLI_COUNT,
                     .value = "N",
                     .doc = "measure each benchmark N times; default: chosen by the benchmark"},
                    JSON_OPTION},
        .more_help = cli_bench_help,
        .examples = "pellicle bench\npellicle bench read-ply --repeats 20\npellicle bench --json > bench.json",
        .run = cli_bench,
    },
    {
        .name = "presets",
        .summary = "print the materials for scenes, with their sources",
        .text = "Prints the name, law, numbers and source of each material. A scene uses one by 'membrane: { preset: "
                "NAME }'; further keys of 'membrane' override its numbers.",
        .options = {JSON_OPTION},
        .examples = "pellicle presets\npellicle presets --json | jq '.presets[].name'",
        .run = cli_presets,
    },
    {
        .name = "reference",
        .summary = "print the reference of scene files (Markdown)",
        .text = "Prints every key of a scene file with its type, unit, range, default and meaning, as Markdown.",
        .examples = "pellicle reference | less",
        .run = cli_reference,
    },
    {
        .name = "schema",
        .summary = "print the JSON Schema of scene files, for editors",
        .text = "Prints a JSON Schema of scene files. Editors that know YAML schemas complete and check scenes with "
                "it, for example with '# yaml-language-server: $schema=scene.schema.json' in a scene's first line.",
        .examples = "pellicle schema > scene.schema.json",
        .run = cli_schema,
    },
    {
        .name = "completion",
        .summary = "print the completion script of a shell",
        .text = "Prints a script that makes the shell complete commands, options, shapes and scene keys.",
        .slots = {{.name = "SHELL", .kind = CLI_WORD, .noun = "shell", .words = cli_shell_names}},
        .examples = "source <(pellicle completion bash)\n"
                    "source <(pellicle completion zsh)\n"
                    "pellicle completion fish | source",
        .run = cli_completion,
    },
    {
        .name = "help",
        .summary = "print the help of a command",
        .text = "Prints the help of a command, or the list of commands.",
        .slots =
            {{.name = "COMMAND", .kind = CLI_WORD, .optional = true, .noun = "command", .words = cli_command_names}},
        .options = {{.name = "man", .kind = CLI_FLAG, .doc = "print the manual page pellicle(1) of all commands"}},
        .examples = "pellicle help run\n"
                    "pellicle help --man | man -l -",
        .run = cli_help,
    },
};

enum { COMMAND_COUNT = sizeof commands / sizeof *commands };

const cli_command *cli_command_at(int index)
{
    return index >= 0 && index < COMMAND_COUNT ? &commands[index] : NULL;
}

const cli_command *cli_command_find(const char *name)
{
    for (int i = 0; i < COMMAND_COUNT; ++i) {
        if (strcmp(commands[i].name, name) == 0)
            return &commands[i];
    }
    return NULL;
}

const char *cli_command_names(int index)
{
    return index < COMMAND_COUNT ? commands[index].name : NULL;
}

int cli_help(const cli_call *call)
{
    if (cli_has(call, "man"))
        cli_print_manual(stdout);
    else if (call->arguments[0] == NULL)
        cli_print_overview(stdout);
    else
        cli_print_help(stdout, cli_command_find(call->arguments[0]));
    return CLI_DONE;
}
