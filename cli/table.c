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

#define EXPORT_OPTION                                                                                                  \
    {                                                                                                                  \
        .name = "format", .kind = CLI_WORD, .value = "FORMAT", .words = cli_export_names,                              \
        .doc = "write this format: obj, ply (binary), ply-ascii, ply-big (big endian), stl (binary), stl-ascii, off, " \
               "glb or, of a run, pc2; left out, the file's ending decides"                                            \
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
        .name = "convert",
        .summary = "turn one mesh format into another; export a run",
        .text = "Reads any mesh (OBJ, PLY, STL and OFF with own readers that keep the order of vertices and custom "
                "fields; glTF, FBX, 3MF, COLLADA and others through assimp) and writes OBJ, PLY, STL, OFF or GLB. What "
                "was changed on the way (polygons cut, vertices welded, fields dropped) is said on standard error.\n\n"
                "When IN is the folder of a run, all its frames are written: to a .pc2 point cache (Blender, Maya), to "
                "a .glb with one morph target for each frame and an animation, or to numbered mesh files: out.obj "
                "gives out_00000.obj, out_00001.obj, ...",
        .slots = {{.name = "IN", .kind = CLI_FILE}, {.name = "OUT", .kind = CLI_FILE}},
        .options = {EXPORT_OPTION, {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"}},
        .examples = "pellicle convert organ.glb organ.ply\npellicle convert ball.ply ball.txt --format off\n"
                    "pellicle convert results/sphere-press press.glb\n"
                    "pellicle convert results/sphere-press frames/press.obj",
        .run = cli_convert,
    },
    {
        .name = "report",
        .summary = "make one HTML page of one or several runs",
        .text =
            "Writes one file that any browser opens, without a network: the body to turn in the hand, play, scrub and "
            "colour by any field, a vertex to pick and read, plots linked to the frame, and the scene. Several runs "
            "stand side by side under the same camera. Numbers are rounded to 1/65535 of their range; a run "
            "that is too long is thinned, and the page says how.",
        .slots = {{.name = "DIR", .kind = CLI_FOLDER, .repeated = true}},
        .options =
            {{.name = "output",
              .letter = 'o',
              .kind = CLI_FILE,
              .value = "FILE",
              .doc = "the page to write; left out: report.html in the first folder"},
             {.name = "field",
              .kind = CLI_NAME,
              .repeated = true,
              .value = "NAME",
              .doc = "take only this field along, the first is shown first; left out: all of the run"},
             {.name = "limit", .kind = CLI_COUNT, .value = "MB", .doc = "thin what is larger than this; left out: 25"},
             {.name = "page",
              .kind = CLI_FILE,
              .value = "FILE",
              .doc = "the empty page that is filled; left out: the one that 'make web' built"},
             {.name = "quiet", .letter = 'q', .kind = CLI_FLAG, .doc = "print errors only"}},
        .examples = "pellicle report results/sphere-press\n"
                    "pellicle report results/sphere-press results/sphere-press-hollow -o compare.html\n"
                    "pellicle report results/sphere-press --field force --limit 5",
        .run = cli_report_page,
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
