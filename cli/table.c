/* The table of commands: parsing, help and completion all come from here. */
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
        .doc = "write this format: obj, ply (binary), ply-ascii, ply-big (big endian), stl (binary), stl-ascii or "    \
               "off; left out, the file's ending decides"                                                              \
    }

const cli_option cli_help_option = {.name = "help", .letter = 'h', .kind = CLI_FLAG, .doc = "print this page"};

static const cli_command commands[] = {
    {
        .name = "run",
        .summary = "simulate a scene and write its results",
        .text = "Reads the scene file SCENE (YAML or JSON), simulates it and leaves a folder of results: frames.pvd "
                "with frames/*.vtp for ParaView, series.csv with the measures over time, summary.json, final.ply and "
                "scene.yaml, the scene with every default filled in.\n\n"
                "Ctrl-C stops after the current step with everything written so far whole, and leaves a checkpoint "
                "from which --resume continues with the same bits; a second Ctrl-C ends at once. A run that diverges "
                "says where, keeps its last good checkpoint and exits with status 1.",
        .slots = {{.name = "SCENE", .kind = CLI_SCENE}},
        .options = {{.name = "output",
                     .letter = 'o',
                     .kind = CLI_FOLDER,
                     .value = "DIR",
                     .doc = "folder of the results; left out: results/ and the scene's name, or with --resume the "
                            "folder of the checkpoint"},
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
                     .doc = "stop with frame N; frame 0 is the initial state"},
                    {.name = "threads",
                     .kind = CLI_COUNT,
                     .value = "N",
                     .doc = "use N threads; left out: all of the machine. The results do not depend on it"},
                    {.name = "resume",
                     .kind = CLI_FILE,
                     .value = "FILE",
                     .doc = "continue from this checkpoint of an earlier run of the same scene"},
                    {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"},
                    JSON_OPTION},
        .examples = "pellicle run scenes/sphere-press.yaml\n"
                    "pellicle run scenes/sphere-press.yaml -o /tmp/soft --set bodies.0.springs.stiffness=1\n"
                    "pellicle run scenes/sphere-press.yaml --frames 20 --json | jq .volume_ratio_final",
        .run = cli_run,
    },
    {
        .name = "check",
        .summary = "find what is wrong with a mesh or a scene; repair a mesh",
        .text =
            "Says every problem of FILE with its place and remedy. A file that ends in .yaml, .yml or .json is "
            "checked as a scene, with the meshes it names; anything else as a mesh. Elements are numbered from 0.\n\n"
            "Exit status 0: fine (notes may be printed), or repaired and written; 2: there are errors (cannot be "
            "simulated) or warnings (can be, but is probably not what was meant).",
        .slots = {{.name = "FILE", .kind = CLI_FILE}},
        .options = {{.name = "fix",
                     .kind = CLI_FILE,
                     .value = "OUT",
                     .doc = "write the repaired mesh: vertices welded, degenerate, duplicate and isolated elements "
                            "dropped, triangles turned the same way and outward. Nothing is written when the result "
                            "still could not be simulated"},
                    {.name = "tolerance",
                     .kind = CLI_LENGTH,
                     .value = "LENGTH",
                     .doc = "with --fix: weld vertices up to this far apart [units of the file]; left out: 0, only "
                            "those at exactly the same place"},
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
        .text = "Prints what a mesh is: counts, whether it is closed, manifold and oriented, genus, components, "
                "volume, area, edge lengths, triangle quality, bounding box and vertex fields.",
        .slots = {{.name = "MESH", .kind = CLI_FILE}},
        .options = {JSON_OPTION},
        .examples = "pellicle info liver.obj\npellicle info liver.obj --json | jq .volume",
        .run = cli_info,
    },
    {
        .name = "measure",
        .summary = "measure area, volume, mean and Gaussian curvature of a mesh",
        .text = "Prints the area, the volume, and of both curvatures the least, the mean by area and the greatest. The "
                "mean curvature is that of the cotangent Laplacian over mixed areas, positive on a sphere; the "
                "Gaussian curvature is the angle defect over the same areas, and its total is compared with 2 pi times "
                "the Euler number, which it has to be. Numbers are in the units of the file.\n\n"
                "Vertices on a boundary are left out, but for the total, where their turning counts.",
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
              .doc = "with -o: add what this outside pressure does, as in paper B's figure 2: the fields "
                     "pressure_force, pressure_magnitude and pressure_direction, the cosine of its angle to +y"},
             JSON_OPTION},
        .examples = "pellicle measure liver.obj\n"
                    "pellicle measure liver.obj --json | jq .mean_curvature_max\n"
                    "pellicle measure head.ply --pressure 100 -o head.vtp",
        .run = cli_measure,
    },
    {
        .name = "shape",
        .summary = "make a mesh: sphere, grid, cylinder, torus, capsule, lens capsule",
        .text = "Writes a generated mesh. Lengths are metres.",
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
        .summary = "make a mesh finer and smooth (modified butterfly)",
        .text = "Cuts each triangle into four, LEVELS times. Vertices stay where they are; those new on the edges are "
                "placed by the modified butterfly scheme (Zorin, Schroeder, Sweldens 1996), so that the surface "
                "becomes smooth. Vertex fields are interpolated alike.",
        .slots = {{.name = "MESH", .kind = CLI_FILE}},
        .options = {{.name = "levels",
                     .letter = 'n',
                     .kind = CLI_COUNT,
                     .value = "LEVELS",
                     .doc = "how often; each level has four times as many triangles"},
                    {.name = "output",
                     .letter = 'o',
                     .kind = CLI_FILE,
                     .value = "OUT",
                     .doc = "the file to write: .obj, .ply, .stl or .off"},
                    {.name = "no-clamp",
                     .kind = CLI_FLAG,
                     .doc =
                         "let fields go beyond their least and greatest values; left out: a thickness stays positive"},
                    FORMAT_OPTION,
                    {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"}},
        .examples = "pellicle subdivide liver.obj -n 1 -o liver-fine.ply",
        .run = cli_subdivide,
    },
    {
        .name = "convert",
        .summary = "turn one mesh format into another",
        .text = "Reads any mesh (OBJ, PLY, STL and OFF with own readers that keep the order of vertices and custom "
                "fields; glTF, FBX, 3MF, COLLADA and others through assimp) and writes OBJ, PLY, STL or OFF. What was "
                "changed on the way (polygons cut, vertices welded, fields dropped) is said on standard error.",
        .slots = {{.name = "IN", .kind = CLI_FILE}, {.name = "OUT", .kind = CLI_FILE}},
        .options = {FORMAT_OPTION, {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"}},
        .examples = "pellicle convert organ.glb organ.ply\npellicle convert ball.ply ball.txt --format off",
        .run = cli_convert,
    },
    {
        .name = "bench",
        .summary = "measure the speed of this machine on known jobs",
        .text = "Runs one benchmark, or all of them, and prints the least and the median time of its repeats beside "
                "the time it is compared with.",
        .slots = {{.name = "NAME", .kind = CLI_WORD, .optional = true, .noun = "benchmark", .words = cli_bench_names}},
        .options = {{.name = "list", .kind = CLI_FLAG, .doc = "print the benchmarks"},
                    {.name = "repeats",
                     .kind = CLI_COUNT,
                     .value = "N",
                     .doc = "time each N times; left out: what suits the benchmark"},
                    JSON_OPTION},
        .more_help = cli_bench_help,
        .examples = "pellicle bench\npellicle bench read-ply --repeats 20\npellicle bench --json > bench.json",
        .run = cli_bench,
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
        .examples = "source <(pellicle completion bash)",
        .run = cli_completion,
    },
    {
        .name = "help",
        .summary = "explain a command",
        .text = "Prints the page of a command, or the list of commands.",
        .slots =
            {{.name = "COMMAND", .kind = CLI_WORD, .optional = true, .noun = "command", .words = cli_command_names}},
        .examples = "pellicle help run",
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
    if (call->arguments[0] == NULL)
        cli_print_overview(stdout);
    else
        cli_print_help(stdout, cli_command_find(call->arguments[0]));
    return CLI_DONE;
}

const char *cli_shell_names(int index)
{
    return index == 0 ? "bash" : NULL;
}

int cli_completion(const cli_call *call)
{
    (void)call;
    cli_print_completion(stdout);
    return CLI_DONE;
}
