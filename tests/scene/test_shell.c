/* Shells in scenes: every key reaches its def, implied keys are in the resolved scene, bad values are refused. */
#define _XOPEN_SOURCE 700
#include "check.h"

#include "base/memory.h"
#include "io/file.h"
#include "pellicle/material.h"
#include "pellicle/run.h"
#include "pellicle/scene.h"

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>

#define BALL "version: 1\nduration: 1\nbodies:\n  - mesh: {shape: geodesic-sphere, frequency: 3}\n"

#define CAPSULE "version: 1\nduration: 1\nbodies:\n  - mesh: {shape: lens-capsule, frequency: 4}\n"

#define WEAVE "    membrane: {material: weave, warp_curve: [[0.5, 2], [1, 8]], shear: 3, thickness: 0.25, "

static pel_scene *load(const char *text)
{
    pel_scene *scene;
    pel_error error;
    char message[1000];
    if (pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, &error) != PEL_OK) {
        print_error("%s\n", pel_error_text(&error, message, sizeof message));
        fail();
    }
    return scene;
}

/* the example of paper B as the design has it */
static void test_head(void **unused)
{
    (void)unused;
    pel_scene *scene = load("version: 1\n"
                            "bodies:\n"
                            "  - name: head\n"
                            "    mesh: { shape: geodesic-sphere, frequency: 6 }\n"
                            "    mass: { density: 1000, thickness: 0.01 }\n"
                            "    membrane: { material: stvk, young: 1.0e5, poisson: 0.3 }\n"
                            "    bending: { model: isometric, weight: 0.01 }\n"
                            "    anisotropy:\n"
                            "      energy: arap\n"
                            "      strength: 0.02\n"
                            "      region: { sphere: { center: [0, 1, 0.2], radius: 0.4 } }\n"
                            "    pressure: { outside: 100 }\n"
                            "solver: { method: pbd, dt: 0.0166667, iterations: 5 }\n"
                            "stop: { volume_ratio_below: 0.35, frames: 200 }\n"
                            "output: { every_frame: 1, fields: [pressure, energy, mean_curvature] }\n");
    const pel_body_def *body = &scene->model.bodies[0];
    const pel_shell_def *shell = &body->shell;
    assert_true(shell->membrane.on && shell->membrane.kind == PEL_MEMBRANE_STVK);
    assert_true(shell->membrane.young.value == 1e5 && shell->membrane.thickness.value == 0.01);
    assert_true(shell->bending.model == PEL_BENDING_ISOMETRIC && shell->bending.weight == 0.01);
    assert_true(shell->bending.stiffness.value < 0 && shell->bending.stiffness.field == NULL);
    assert_int_equal(shell->anisotropy_count, 1);
    const pel_anisotropy_def *cave = &shell->anisotropies[0];
    assert_true(cave->mode == PEL_FIBRE_CAVE && cave->kind == PEL_FIBRE_ARAP && cave->strength == 0.02);
    assert_true(cave->stiffness == 1000 && cave->center[1] == 1 && cave->center[2] == 0.2 && cave->max_step == 0.05);
    assert_non_null(cave->weights);
    assert_true(shell->pressure.kind == PEL_PRESSURE_GIVEN && shell->pressure.outside.value == 100);
    assert_true(body->spring_stiffness.value == 0 && body->volumetric_stiffness.value == 0);
    assert_true(scene->sim.solver.method == PEL_METHOD_PBD && scene->sim.solver.iterations == 5);
    assert_true(scene->least_volume_ratio == 0.35 && scene->frame_limit == 200);
    assert_near(scene->duration, 200 * 0.0166667, 1e-12);
    pel_scene_destroy(scene);
}

static void test_materials(void **unused)
{
    (void)unused;
    static const char *const words[] = {"stvk", "corotated", "linear", "mooney-rivlin", "neo-hookean", "gent", "fung"};
    const int count = (int)(sizeof words / sizeof *words);
    assert_true(count <= PEL_MEMBRANE_COUNT);
    for (int kind = 0; kind < PEL_MEMBRANE_COUNT; kind++) {
        const char *word = kind < count ? words[kind] : pel_membrane_kind_name((pel_membrane_kind)kind);
        char text[400];
        snprintf(text, sizeof text, BALL "    membrane: {material: %s, %spoisson: 0.1, thickness: 0.5%s}\n", word,
                 kind == PEL_MEMBRANE_WEAVE ? "" : "young: 2, ",
                 kind == PEL_MEMBRANE_WEAVE           ? ", shear: 3, warp_curve: [[0.5, 1], [1, 4]]"
                 : kind == PEL_MEMBRANE_MOONEY_RIVLIN ? ", mooney_ratio: 0.3"
                 : kind == PEL_MEMBRANE_GENT          ? ", extension_limit: 7"
                 : kind == PEL_MEMBRANE_FUNG          ? ", stiffening: 8"
                 : kind == PEL_MEMBRANE_ELASTOPLASTIC ? ", yield: 4"
                                                      : "");
        pel_scene *scene = load(text);
        const pel_membrane_def *membrane = &scene->model.bodies[0].shell.membrane;
        assert_true(membrane->kind == (pel_membrane_kind)kind && membrane->poisson == 0.1);
        assert_string_equal(pel_membrane_kind_name(membrane->kind), word);
        assert_true(membrane->extension_limit == (kind == PEL_MEMBRANE_GENT ? 7 : 50));
        assert_true(membrane->stiffening == (kind == PEL_MEMBRANE_FUNG ? 8 : 10));
        assert_true(membrane->mooney_ratio == (kind == PEL_MEMBRANE_MOONEY_RIVLIN ? 0.3 : 0.2));
        assert_true(membrane->young.value == 2 && membrane->thickness.value == 0.5);
        if (kind == PEL_MEMBRANE_WEAVE)
            assert_true(membrane->shear == 3 && membrane->warp_curve[1][0] == 1 && membrane->weft_curve[1][1] == 4 &&
                        membrane->warp_curve[2][0] == 0);
        if (kind == PEL_MEMBRANE_ELASTOPLASTIC)
            assert_true(membrane->yield == 4 && membrane->hardening == 0);
        pel_scene_destroy(scene);
    }
}

static void test_regions_and_pressures(void **unused)
{
    (void)unused;
    pel_scene *scene = load(BALL "    bending: {model: isometric-rest, weight: auto, stiffness: 0.25}\n"
                                 "    anisotropy:\n"
                                 "      - {mode: strain, energy: stvk, stiffness: 5, direction: principal}\n"
                                 "      - {mode: active, stiffness: 6, rest_length: {keys: [[0, 1], [2, 0.5]]},\n"
                                 "         direction: [0, 0, 2], region: {nearest: [0, 0, 1], falloff: 0.5}}\n"
                                 "    pressure: {inside: {keys: [[0, 0], [1, 7]]}, form: vertex-normal,\n"
                                 "      region: {box: {min: [-2, -2, 0], max: [2, 2, 2]}}}\n"
                                 "solver: {descent: gradient, method: descent, drag: 2, second_order: true,\n"
                                 "  substeps: 7}\n");
    const pel_shell_def *shell = &scene->model.bodies[0].shell;
    assert_false(shell->membrane.on);
    assert_true(shell->bending.model == PEL_BENDING_ISOMETRIC_REST && shell->bending.weight < 0);
    assert_true(shell->bending.stiffness.value == 0.25);
    assert_int_equal(shell->anisotropy_count, 2);
    const pel_anisotropy_def *strain = &shell->anisotropies[0], *active = &shell->anisotropies[1];
    assert_true(strain->mode == PEL_FIBRE_STRAIN && strain->kind == PEL_FIBRE_STVK && strain->stiffness == 5);
    assert_true(strain->direction == PEL_FIBRE_PRINCIPAL && strain->weights == NULL);
    assert_true(active->mode == PEL_FIBRE_ACTIVE && active->rest_length.key_count == 2);
    assert_true(active->direction == PEL_FIBRE_ALONG && active->axis[2] == 2);
    double largest = 0, parts = 0;
    for (int32_t v = 0; v < scene->model.bodies[0].mesh->vertex_count; v++) {
        largest = fmax(largest, active->weights[v]);
        parts += active->weights[v] > 0 && active->weights[v] < 1;
    }
    assert_true(largest == 1 && parts > 0);
    assert_true(shell->pressure.outside.key_count == 2 && shell->pressure.outside.keys[1].value == -7);
    assert_true(shell->pressure.form == PEL_PRESSURE_VERTEX_NORMAL && shell->pressure.weights != NULL);
    const pel_solver_def *solver = &scene->sim.solver;
    assert_true(solver->method == PEL_METHOD_DESCENT && solver->gradient_only && solver->drag == 2);
    assert_true(solver->substeps == 7 && solver->second_order && solver->iterations == 0);
    pel_scene_destroy(scene);

    /* an inside pressure pushes outward, also where it varies over the body */
    scene = load(CAPSULE "    pressure: {inside: {field: thickness}}\n");
    const pel_body_def *capsule = &scene->model.bodies[0];
    const double *thickness = pel_mesh_field(capsule->mesh, "thickness")->values;
    for (int32_t v = 0; v < capsule->mesh->vertex_count; v++)
        assert_true(capsule->shell.pressure.outside.field[v] == -thickness[v] && thickness[v] > 0);
    pel_scene_destroy(scene);
    scene = load(BALL "    pressure: {inside: 3}\n");
    assert_true(scene->model.bodies[0].shell.pressure.outside.value == -3);
    pel_scene_destroy(scene);

    scene = load(BALL "    pressure: {gas: {pressure: 9, gamma: 1}}\n");
    assert_true(scene->model.bodies[0].shell.pressure.kind == PEL_PRESSURE_GAS);
    assert_true(scene->model.bodies[0].shell.pressure.value == 9);
    /* pressure alone leaves the springs as they are */
    assert_true(scene->model.bodies[0].spring_stiffness.value == 5000);
    assert_true(scene->model.bodies[0].spring_thickness > 0);
    pel_scene_destroy(scene);
    scene = load(BALL "    pressure: {volume: {target: 0.5, bulk: 3}}\n    bending: {}\n"
                      "    anisotropy: {mode: curl, curvature: -2}\n");
    assert_true(scene->model.bodies[0].shell.pressure.kind == PEL_PRESSURE_VOLUME);
    assert_true(scene->model.bodies[0].shell.pressure.target.value == 0.5);
    assert_true(scene->model.bodies[0].shell.anisotropies[0].curvature == -2);
    assert_true(scene->model.bodies[0].shell.bending.model == PEL_BENDING_HINGE);
    pel_scene_destroy(scene);
}

/* the resolved scene says all that is implied, and gives the same scene again */
static void check_implied(const char *text, const char *const *expected)
{
    pel_scene *scene = load(text);
    const char *resolved = pel_scene_text(scene);
    for (; *expected != NULL; expected++)
        if (strstr(resolved, *expected) == NULL) {
            print_error("'%s' is not in\n%s", *expected, resolved);
            fail();
        }
    pel_scene *again = load(resolved);
    assert_string_equal(pel_scene_text(again), resolved);
    pel_scene_destroy(again);
    pel_scene_destroy(scene);
}

static void test_implied(void **unused)
{
    (void)unused;
    check_implied(BALL "    membrane: {preset: rubber}\n",
                  (const char *const[]){"material: mooney-rivlin\n", "young: 1170000\n", "mooney_ratio: 0.1\n",
                                        "density: 930\n", "thickness: 0.001\n", "method: xpbd\n", "stiffness: 0\n",
                                        NULL});
    /* an entry without value counts as left out */
    check_implied(BALL "    membrane: {preset: rubber, young: ~}\n    mass:\n    springs: ~\n",
                  (const char *const[]){"young: 1170000\n", "density: 930\n", "stiffness: 0\n", NULL});
    check_implied(BALL "    mass: {density: 5, thickness: 0.5}\n    membrane: {preset: rubber, material: stvk}\n",
                  (const char *const[]){"density: 5\n", "      thickness: 0.5\n    springs", "material: stvk\n",
                                        "mooney_ratio: 0.2\n", "poisson: 0.5\n      thickness: 0.5\n", NULL});
    check_implied(BALL "    membrane: {young: 1, thickness: 0.25}\n    springs: {stiffness: 2}\n",
                  (const char *const[]){"density: 1000\n      thickness: 0.25\n", "stiffness: 2\n",
                                        "material: neo-hookean\n", NULL});
    /* the modulus of curves is their first slope, and both threads are alike */
    check_implied(BALL "    membrane: {material: weave, warp_curve: [[0.5, 2], [1, 8]], shear: 3, thickness: 0.25}\n",
                  (const char *const[]){"young: 4\n", "weft_curve: [[0.5, 2], [1, 8]]\n", NULL});
    /* the capsule of a filled body has no mass */
    check_implied(BALL "    membrane: {young: 1, thickness: 0.25}\n    volume: {young: 1}\n",
                  (const char *const[]){"density: 1000\n", NULL});
    const pel_body_def fresh = pel_body_def_default();
    assert_true(fresh.shell.membrane.kind == PEL_MEMBRANE_NEO_HOOKEAN);
    check_implied(BALL "    membrane: {young: 1, thickness: 0.25}\n    mass: {total: 2}\nsolver: {method: explicit}\n",
                  (const char *const[]){"total: 2\n", "method: explicit\n", NULL});
    check_implied("version: 1\nbodies: [{mesh: {shape: grid}}]\nstop: {time: 2, frames: 1000}\n",
                  (const char *const[]){"duration: 2\n", NULL});
    check_implied("version: 1\nbodies: [{mesh: {shape: grid}}]\nstop: {time: 20, frames: 50}\nsolver: {dt: 0.5}\n",
                  (const char *const[]){"duration: 20\n", NULL});
}

/* a sheet bends as its material does, unless it says something else or is stepped by pbd */
static void test_implied_bending(void **unused)
{
    (void)unused;
    static const struct {
        const char *text;
        pel_bending_model model;
    } scenes[] = {
        {"", PEL_BENDING_HINGE},
        {"    bending: {model: none}\n", PEL_BENDING_NONE},
        {"    bending: {model: isometric}\n", PEL_BENDING_ISOMETRIC},
        {"solver: {method: implicit}\n", PEL_BENDING_MIDEDGE},
        {"    bending: {model: none}\nsolver: {method: implicit}\n", PEL_BENDING_NONE},
        {"solver: {method: explicit}\n", PEL_BENDING_HINGE},
        {"solver: {method: pbd}\n", PEL_BENDING_NONE},
        {"    bending: {}\nsolver: {method: pbd}\n", PEL_BENDING_HINGE},
    };
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        char text[512];
        snprintf(text, sizeof text, BALL "    membrane: {preset: skin}\n%s", scenes[i].text);
        pel_scene *scene = load(text);
        const pel_bending_def *bending = &scene->model.bodies[0].shell.bending;
        assert_int_equal(bending->model, scenes[i].model);
        if (bending->model != PEL_BENDING_NONE)
            assert_true(bending->stiffness.value < 0); /* that of the material */
        pel_scene_destroy(scene);
    }
}

static const char *const bad_scenes[][2] = {
    {BALL "    membrane: {thickness: 1}\n", "a.yaml:5:15: error: bodies.0.membrane lacks 'young'"},
    {BALL "    membrane: {young: 1}\n", "a.yaml:5:15: error: bodies.0.membrane lacks 'thickness'"},
    {BALL "    membrane: {young: -1, thickness: 1}\n", "membrane.young is out of range: -1 Pa"},
    {BALL "    membrane: {young: 1, thickness: 0}\n", "membrane.thickness is out of range: 0 m"},
    {BALL "    membrane: {young: 1, thickness: 1, poisson: 1.5}\n", "membrane.poisson is out of range: 1.5"},
    {BALL "    membrane: {young: 1, thickness: 1, material: stkv}\n", "unknown material 'stkv'. did you mean 'stvk'?"},
    {BALL WEAVE "young: 5}\n", "a.yaml:5:92: error: 'young' has no effect on the material weave, whose modulus is the "
                               "first slope of warp_curve, 4 Pa. remove young, or use material orthotropic"},
    {BALL WEAVE "young: [4, 2]}\n", "'young' has no effect on the material weave"},
    {BALL WEAVE "weft: 2}\n",
     "a.yaml:5:92: error: 'weft' has no effect on the material weave, which has curves. give the pull across the warp "
     "as weft_curve"},
    {BALL "    membrane: {young: 1, thickness: 1, mooney_ratio: 0.3}\n",
     "a.yaml:5:40: error: 'mooney_ratio' has no effect on the material neo-hookean. remove mooney_ratio, or use "
     "material mooney-rivlin"},
    {BALL "    membrane: {preset: rubber, stiffening: 4}\n",
     "'stiffening' has no effect on the material mooney-rivlin"},
    {BALL "    membrane: {preset: rubbr}\n", "a.yaml:5:24: error: unknown preset 'rubbr'. did you mean 'rubber'?"},
    {BALL "    membrane: {preset: tissue}\n",
     "a.yaml:5:24: error: unknown preset 'tissue'. 'tissue' is a word of bodies[].preset"},
    {BALL "    membrane: rubber\n",
     "a.yaml:5:15: error: bodies.0.membrane is 'rubber', it must be: map. write { preset: rubber }"},
    {BALL "    preset: latex\n",
     "a.yaml:5:13: error: unknown preset 'latex'. 'latex-balloon' is a word of bodies[].membrane.preset"},
    {BALL "    preset: paper\n",
     "a.yaml:5:13: error: unknown preset 'paper'. 'paper' is a word of bodies[].membrane.preset"},
    {BALL "    membrane: {young: {field: stiff}, thickness: 1}\n", "unknown scalar field of the mesh 'stiff'"},
    {BALL "    bending: {weight: 2}\n", "bending.weight is out of range: 2"},
    {BALL "    bending: {model: cubic}\n", "unknown model 'cubic'"},
    {BALL "    anisotropy: []\n", "anisotropy has 0 elements"},
    {BALL "    anisotropy: {energy: arap}\n    membrane: {preset: skin}\n", "bodies.0.anisotropy lacks 'strength'"},
    {BALL "    anisotropy: {strength: 1}\n", "a.yaml:5:17: error: the stiffness of the fibres is not known"},
    {BALL "    anisotropy: {mode: active, stiffness: 1}\n", "lacks 'rest_length'"},
    {BALL "    anisotropy: {mode: strain, strength: 1}\n", "unknown key of mode strain: 'strength'"},
    {BALL "    anisotropy: {mode: normal, stiffness: 1}\n", "bodies.0.anisotropy lacks 'gradient'"},
    {BALL "    anisotropy: {mode: normal, stiffness: 1, gradient: 0}\n", "gradient is out of range: 0 N"},
    {BALL "    anisotropy: {mode: normal, stiffness: 1, gradient: 1, max_step: 2}\n", "max_step"},
    {BALL "    anisotropy: {mode: strain, stiffness: 1, region: {sphere: {center: [9, 9, 9], radius: 0.1}}}\n",
     "a.yaml:5:54: error: "},
    {BALL "    pressure: {outside: 1, inside: 2}\n", "'outside' and 'inside' exclude each other"},
    {BALL "    pressure: {}\n", "a.yaml:5:15: error: bodies.0.pressure lacks one of its main keys"},
    {BALL "    pressure: {gas: {gamma: 0.5}}\n", "gamma is out of range: 0.5"},
    {BALL "    pressure: {volume: {target: 1}}\n", "lacks 'bulk'"},
    {CAPSULE "    pressure: {gas: {pressure: 1, gamma: 1, outside: {field: thickness}}}\n",
     "with a gas or a target volume the outside pressure cannot vary over the body. give a number or keys"},
    {CAPSULE "    pressure: {volume: {target: 1, bulk: 1, outside: {field: thickness}}}\n",
     "with a gas or a target volume the outside pressure cannot vary over the body"},
    {CAPSULE "    pressure: {volume: {target: {field: thickness}, bulk: 1}}\n",
     "the target volume is one number; it cannot vary over the body. give a number or keys"},
    {CAPSULE "    anisotropy: {mode: active, stiffness: 1, rest_length: {field: thickness}}\n",
     "rest_length cannot vary over the body. use a number or keys"},
    {CAPSULE "    membrane: {young: {field: thicknes}, thickness: 1}\n",
     "unknown scalar field of the mesh 'thicknes'. did you mean 'thickness'?"},
    {BALL "    pressure: {outside: 1, region: {field: paint}}\n", "unknown scalar field of the mesh 'paint'"},
    {BALL "solver: {method: pbd, iterations: 0}\n", "solver.iterations is out of range: 0"},
    {BALL "solver: {method: pbd, substeps: -1}\n", "solver.substeps is out of range: -1"},
    {BALL "stop: {frames: 0}\n", "stop.frames is out of range: 0"},
    {BALL "stop: {volume_ratio_below: 0}\n", "stop.volume_ratio_below is out of range: 0"},
};

static void test_bad_scenes(void **unused)
{
    (void)unused;
    for (size_t i = 0; i < sizeof bad_scenes / sizeof bad_scenes[0]; i++) {
        const char *text = bad_scenes[i][0];
        pel_scene *scene;
        pel_error error = {0};
        char message[1000];
        pel_status status = pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, &error);
        pel_error_text(&error, message, sizeof message);
        if (status == PEL_OK || strstr(message, bad_scenes[i][1]) == NULL)
            print_error("%s\nexpected %s\nactual   %s\n", text, bad_scenes[i][1], status == PEL_OK ? "none" : message);
        assert_true(status != PEL_OK && strstr(message, bad_scenes[i][1]) != NULL);
        assert_null(scene);
    }
}

/* ---- runs ---- */

static int remove_entry(const char *path, const struct stat *information, int kind, struct FTW *place)
{
    (void)information;
    (void)kind;
    (void)place;
    return remove(path);
}

static void remove_run_folder(const char *path)
{
    nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

static pel_status run(const char *text, pel_run_summary *summary, pel_error *error)
{
    pel_scene *scene = load(text);
    pel_run_def def = pel_run_def_default();
    def.folder = "shell_run";
    def.thread_count = 1;
    pel_status status = pel_run(scene, &def, summary, error);
    pel_scene_destroy(scene);
    return status;
}

#define SHELL                                                                                                          \
    "version: 1\nduration: 1\nbodies:\n  - mesh: {shape: geodesic-sphere, frequency: 3}\n"                             \
    "    membrane: {young: 1.0e4, thickness: 0.01}\n    bending: {}\n"
#define STEPS "solver: {method: explicit, dt: 0.002}\noutput: {every_frame: 10}\n"

static void check_stop(const char *text, const char *reason, int64_t frames, int64_t steps)
{
    pel_run_summary summary;
    assert_int_equal(run(text, &summary, NULL), PEL_OK);
    assert_string_equal(summary.stop_reason, reason);
    assert_int_equal(summary.frames, frames);
    assert_int_equal(summary.steps, steps);
}

static void test_stops(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    check_stop(SHELL STEPS "stop: {frames: 25}\n", "frames", 4, 25);
    check_stop(SHELL STEPS "stop: {time: 0.04}\n", "time", 3, 20);
    check_stop(SHELL "solver: {method: explicit, dt: 0.002}\noutput: {every: 0.5}\n", "duration", 3, 500);
    check_stop(SHELL "solver: {method: descent}\nstop: {at_rest: 1.0e-9}\n", "at_rest", 2, 10);
    /* between two frames: the last row is that of the stop */
    assert_int_equal(run(SHELL "    pressure: {outside: 20}\nsolver: {method: explicit, dt: 0.002}\n"
                               "output: {every_frame: 1000}\nstop: {volume_ratio_below: 0.9}\n",
                         &summary, NULL),
                     PEL_OK);
    assert_string_equal(summary.stop_reason, "volume_ratio_below");
    assert_true(summary.frames == 2 && summary.steps < 500 && summary.volume_ratio_final < 0.9);
    assert_true(summary.volume_ratio_final > 0.85 && summary.volume_rises == 0);
    /* and the list of frames has its time */
    char *list, *end;
    size_t size;
    assert_int_equal(pel_file_read("shell_run/frames.pvd", &list, &size, NULL), PEL_OK);
    const char *last = strstr(strstr(list, "timestep=\"") + 1, "timestep=\"");
    assert_non_null(last);
    assert_near(strtod(last + 10, &end), summary.time_simulated, 0);
    assert_null(strstr(end, "timestep"));
    pel_free(list);
    /* a ball that swings gains volume again */
    assert_int_equal(run(SHELL "    pressure: {outside: {keys: [[0, 5], [0.01, 0]]}}\n" STEPS, &summary, NULL), PEL_OK);
    assert_true(summary.volume_rises > 3 && summary.volume_rise_max > 1e-5);
    assert_true(summary.volume_rise_sum >= summary.volume_rise_max);
    remove_run_folder("shell_run");
}

/* the last line of a log, and how many there were */
typedef struct heard {
    char text[512];
    int count;
} heard;

static void hear(void *user, const char *text)
{
    heard *told = user;
    snprintf(told->text, sizeof told->text, "%s", text);
    told->count++;
}

/* keys that pbd-distance ignores are reported with their place */
static void test_ignored(void **unused)
{
    (void)unused;
    static const struct {
        const char *text, *told;
    } cases[] = {
        {BALL "    membrane: {preset: skin}\n    bending: {}\nsolver: {method: pbd-distance}\n",
         "a.yaml:5:5: pbd-distance constrains edge lengths only and ignores membrane, bending. use pbd"},
        {BALL "    mass: {total: 1}\n    anisotropy: {strength: 1, stiffness: 1}\nsolver: {method: pbd-distance}\n",
         "a.yaml:6:5: pbd-distance constrains edge lengths only and ignores anisotropy. use pbd"},
        {BALL "    pressure: {outside: 1}\nsolver: {method: pbd-distance}\n", NULL},
        {BALL "    membrane: {preset: skin}\n    bending: {}\nsolver: {method: pbd}\n", NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        heard told = {.count = 0};
        pel_log log = {.write = hear, .user = &told};
        pel_scene *scene;
        assert_int_equal(pel_scene_parse("a.yaml", cases[i].text, strlen(cases[i].text), NULL, 0, &log, &scene, NULL),
                         PEL_OK);
        assert_int_equal(told.count, cases[i].told != NULL);
        if (cases[i].told != NULL && strstr(told.text, cases[i].told) == NULL)
            print_error("%s\n", told.text);
        assert_true(cases[i].told == NULL || strstr(told.text, cases[i].told) != NULL);
        pel_scene_destroy(scene);
    }
}

static void test_bad_runs(void **unused)
{
    (void)unused;
    static const char *const bad[][2] = {
        {SHELL "solver: {method: explicit, dt: 0.5}\n", "a.yaml:7:32: error: dt 0.5 is unstable on this mesh: the "
                                                        "limit is "},
        {"version: 1\nduration: 1\nbodies: [{mesh: {shape: grid}}]\nstop: {volume_ratio_below: 0.5}\n",
         "stop.volume_ratio_below needs a volume, but each body is open, or flat at rest"},
        {"version: 1\nduration: 1\nbodies: [{mesh: {shape: grid}, pressure: {gas: {}}}]\n",
         "a.yaml:3:10: error: body 'body1': its mesh has a boundary and encloses no volume. close its holes with "
         "`pellicle "
         "check MESH --fix OUT --fill-holes 40`, or give the pressure as a number"},
        {"version: 1\nduration: 1\nbodies: [{mesh: {shape: grid}, membrane: {preset: skin, poisson: 1}}]\n",
         "poisson is 1. give a number with -1 < poisson < 1"},
        {SHELL "    anisotropy: {strength: 1}\nsolver: {method: explicit, dt: 0.001}\n", "caves in"},
        {SHELL "    pressure: {outside: 5000}\n" STEPS, "inside out in frame "},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        pel_run_summary summary;
        pel_error error = {0};
        char message[1000];
        pel_status status = run(bad[i][0], &summary, &error);
        pel_error_text(&error, message, sizeof message);
        if (strstr(message, bad[i][1]) == NULL)
            print_error("expected %s\nactual   %s\n", bad[i][1], message);
        assert_true(status != PEL_OK && strstr(message, bad[i][1]) != NULL);
    }
    remove_run_folder("shell_run");
}

/* columns of the energies follow the others, only if there is a shell */
static void test_series(void **unused)
{
    (void)unused;
    char header[400];
    assert_int_equal(run(SHELL STEPS "stop: {frames: 10}\n", &(pel_run_summary){0}, NULL), PEL_OK);
    FILE *file = fopen("shell_run/series.csv", "r");
    assert_non_null(file);
    assert_non_null(fgets(header, sizeof header, file));
    assert_non_null(strstr(header, ",step_ms,membrane_energy,bending_energy,fibre_energy,work_tools,"));
    fclose(file);
    assert_int_equal(run(BALL "output: {every_frame: 10}\nstop: {frames: 10}\n", &(pel_run_summary){0}, NULL), PEL_OK);
    file = fopen("shell_run/series.csv", "r");
    assert_non_null(fgets(header, sizeof header, file));
    assert_null(strstr(header, "membrane_energy"));
    fclose(file);
    remove_run_folder("shell_run");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_head),
        cmocka_unit_test(test_materials),
        cmocka_unit_test(test_regions_and_pressures),
        cmocka_unit_test(test_implied),
        cmocka_unit_test(test_implied_bending),
        cmocka_unit_test(test_bad_scenes),
        cmocka_unit_test(test_stops),
        cmocka_unit_test(test_ignored),
        cmocka_unit_test(test_bad_runs),
        cmocka_unit_test(test_series),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
