/* The method of scenes that leave it to the program, and runs of xpbd that are too soft. */
#define _XOPEN_SOURCE 700
#include "check.h"
#include "def/row.h"
#include "failing_malloc.h"

#include <ftw.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/memory.h"
#include "io/file.h"
#include "pellicle/run.h"
#include "pellicle/sim_reading.h"
#include "scene/build.h"
#include "stage/stepper.h"

#define HEAD "version: 1\nduration: 0.05\nbodies:\n  - mesh: {shape: geodesic-sphere, frequency: 4, radius: 0.05}\n"
#define BALL "version: 1\nduration: 0.05\nbodies:\n  - mesh: {shape: geodesic-sphere, frequency: 10, radius: 0.05}\n"
#define LONG_HEAD                                                                                                      \
    "version: 1\nduration: 5000\nbodies:\n  - mesh: {shape: geodesic-sphere, frequency: 4, radius: 0.05}\n"
#define SHEET "version: 1\nduration: 0.05\nbodies:\n  - mesh: {shape: grid, nx: 8, ny: 8, size_x: 0.1, size_y: 0.1}\n"
#define HANGS                                                                                                          \
    "version: 1\nduration: 0.05\ngravity: [0, 0, -9.81]\nbodies:\n  - mesh: {shape: grid, nx: 30, ny: 10, size_x: "    \
    "0.6, "                                                                                                            \
    "size_y: 0.2}\n    pinned: {vertices: [0]}\n"
#define STEEL "    membrane: {preset: steel-sheet}\n    bending: {}\n"
#define RUBBER "    membrane: {preset: rubber}\n    bending: {}\n"
#define SOFT "    membrane: {young: 3.0e5, thickness: 0.001}\n    bending: {}\n"
#define PINNED "    pinned: {vertices: [0]}\n"
#define GAS "    pressure: {gas: {pressure: 2000}}\n"
#define BESIDE                                                                                                         \
    "  - mesh: {shape: geodesic-sphere, frequency: 2, radius: 0.01, translate: [0, 0, 0.05]}\n    rigid: {mass: "      \
    "0.01}\n"                                                                                                          \
    "gravity: [0, 0, -9.81]\n"
#define MARBLE                                                                                                         \
    "  - mesh: {shape: geodesic-sphere, frequency: 2, radius: 0.01, translate: [0, 0, 0.08]}\n    rigid: {sphere: "    \
    "true}\ngravity: [0, 0, -9.81]\n"
#define SLAB                                                                                                           \
    "version: 1\nduration: 0.05\nbodies:\n  - mesh: {shape: box, size_x: 0.2, size_y: 0.2, size_z: 0.06, nx: 8, ny: "  \
    "8, nz: 3}\n    volume: {young: 2.0e4}\n    pinned: all\n"
#define PRESSED "    pressure: {inside: 1000}\n"

typedef struct heard {
    char text[1024];
    int count;
} heard;

static void hear(void *user, const char *text)
{
    heard *told = user;
    size_t length = told->count > 0 ? strlen(told->text) : 0;
    snprintf(told->text + length, sizeof told->text - length, "%s\n", text);
    told->count++;
}

static pel_scene *load(const char *text, heard *told)
{
    pel_log log = {.write = hear, .user = told};
    pel_scene *scene;
    pel_error error = {0};
    char message[1000];
    if (pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, &log, &scene, &error) != PEL_OK)
        print_error("%s\n", pel_error_text(&error, message, sizeof message));
    assert_non_null(scene);
    return scene;
}

/* where xpbd would need too much, or more time than implicit: implicit; xpbd, silently, in all other scenes */
static void test_choice(void **unused)
{
    (void)unused;
    static const struct {
        const char *text;
        const char *takes; /* null = keeps the method of the scene */
    } cases[] = {
        {HEAD STEEL PRESSED, "implicit"},
        {HEAD STEEL, "implicit"},
        {HEAD SOFT PRESSED, NULL},
        {HEAD RUBBER PRESSED "solver: {max_substeps: 5}\n", "implicit"},
        {HEAD STEEL PRESSED "solver: {max_substeps: 1000000}\n", NULL},
        /* within max_substeps, but dearer than implicit; a limit that is written asks for xpbd */
        {HEAD RUBBER, "implicit"},
        {HEAD RUBBER "solver: {max_substeps: 200}\n", NULL},
        {HEAD RUBBER "contact: {}\n", NULL},
        /* features without xpbd */
        {SHEET SOFT "    supports: [{at: {vertices: [0]}}]\n", "implicit"},
        {SHEET SOFT "loads: [{force: [0, 0, 1], per: moment}]\n", "implicit"},
        {SHEET "    membrane: {young: 3.0e5, thickness: 0.001}\n    bending: {model: midedge}\n", "implicit"},
        /* written */
        {HEAD STEEL PRESSED "solver: {method: xpbd}\n", NULL},
        {HEAD STEEL PRESSED "solver: {substeps: 16}\n", NULL},
        {HEAD STEEL PRESSED "solver: {iterations: 3}\n", NULL},
        {HEAD STEEL PRESSED "solver: {method: explicit, dt: 1.0e-7}\n", NULL},
        /* free to move */
        {HEAD STEEL "gravity: [0, 0, -9.81]\n", "implicit"},
        {HEAD STEEL PINNED "gravity: [0, 0, -9.81]\n", "implicit"},
        {HEAD STEEL "loads: [{force: [0, 0, 1]}]\n", "implicit"},
        {SHEET STEEL PRESSED, "implicit"},
        {SHEET STEEL PINNED PRESSED, "implicit"},
        {HEAD STEEL "    pressure: {inside: 1, form: vertex-normal}\n", "implicit"},
        /* only position-based methods cave in */
        {HEAD STEEL "    anisotropy: {strength: 0.1, stiffness: 1}\n", NULL},
        /* a surface that may change */
        {HEAD RUBBER "solver: {max_substeps: 80}\n", NULL},
        {HEAD RUBBER "    refine: {levels: 2, everywhere: true}\nsolver: {max_substeps: 80}\n", "implicit"},
        /* sheets that are limp under their weight crumple: there xpbd is cheaper with more substeps, and as right */
        {HANGS RUBBER, NULL},
        {HANGS "    membrane: {preset: paper}\n", "implicit"},
        {HANGS STEEL, "implicit"},
        /* contact */
        {SHEET STEEL PINNED "contact: {}\n", "implicit"},
        {SHEET STEEL "contact: {}\ngravity: [0, 0, -9.81]\n", "implicit"},
        /* what implicit lacks: a rigid sphere */
        {HEAD RUBBER MARBLE, NULL},
        {HEAD STEEL MARBLE, NULL},
        /* there xpbd is cheaper with more substeps than by default, but not with any number of them */
        {BALL RUBBER "contact: {}\n", "xpbd"},
        {BALL RUBBER "contact: {}\nsolver: {max_substeps: 200}\n", "implicit"},
        {BALL RUBBER, "implicit"},
        {BALL STEEL "contact: {}\n", "implicit"},
        /* beside a rigid body too */
        {SHEET STEEL PINNED BESIDE, "implicit"},
        {SHEET SOFT PINNED BESIDE, NULL},
        /* a gas that swings, unless something damps or touches the body, or it takes long */
        {HEAD SOFT GAS, "implicit"},
        {HEAD SOFT GAS "solver: {drag: 1}\n", "implicit"},
        {HEAD SOFT GAS "solver: {drag: 90}\n", NULL},
        {HEAD SOFT GAS "contact: {}\n", NULL},
        {LONG_HEAD SOFT GAS, NULL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        heard told = {.count = 0};
        pel_scene *scene = load(cases[i].text, &told);
        const char *takes = cases[i].takes;
        char line[100];
        told.count -= strstr(told.text, "\ndt ") != NULL;
        /* how long a run takes is told of any method */
        told.count -= told.count > 0 && strstr(told.text, "steps of xpbd take") != NULL;
        if (told.count != (takes != NULL))
            print_error("case %d: %s\n", (int)i, told.text);
        assert_int_equal(told.count, takes != NULL);
        if (takes != NULL) {
            pel_method method = scene->sim.solver.method;
            assert_string_equal(pel_method_words[method], takes);
            snprintf(line, sizeof line, "method %s: ", takes);
            assert_non_null(strstr(told.text, line));
            if (method == PEL_METHOD_XPBD)
                assert_in_range(scene->sim.solver.max_substeps, 201, 2000);
            else
                assert_true(strstr(told.text, "xpbd would need ") != NULL ||
                            strstr(told.text, "xpbd does not support") || strstr(told.text, "xpbd damps"));
            snprintf(line, sizeof line, "method: %s\n", takes);
            assert_non_null(strstr(pel_scene_text(scene), line));
            /* the resolved scene has it as written */
            heard again = {.count = 0};
            pel_scene *resolved = load(pel_scene_text(scene), &again);
            assert_true(resolved->sim.solver.method == method && again.count == 0);
            pel_scene_destroy(resolved);
        }
        pel_scene_destroy(scene);
    }
}

static int remove_entry(const char *path, const struct stat *information, int kind, struct FTW *place)
{
    (void)information;
    (void)kind;
    (void)place;
    return remove(path);
}

static void remove_folder(const char *path)
{
    nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

static pel_status run(const char *text, heard *told, pel_run_summary *summary, pel_error *error)
{
    heard unheard;
    remove_folder("method_run");
    pel_scene *scene = load(text, &unheard);
    pel_log log = {.write = hear, .user = told};
    pel_run_def def = pel_run_def_default();
    def.folder = "method_run";
    def.thread_count = 1;
    def.warnings = &log;
    pel_status status = pel_run(scene, &def, summary, error);
    pel_scene_destroy(scene);
    return status;
}

static bool summary_has(const char *entry)
{
    char *text;
    size_t size;
    assert_int_equal(pel_file_read("method_run/summary.json", &text, &size, NULL), PEL_OK);
    bool has = strstr(text, entry) != NULL;
    if (!has)
        print_error("no %s in %s\n", entry, text);
    pel_free(text);
    return has;
}

/* a run that is too soft says so before its first step; one that fails in it is refused, and writes nothing */
static void test_soft_runs(void **unused)
{
    (void)unused;
    heard told = {.count = 0};
    pel_run_summary summary;
    pel_error error = {0};
    assert_int_equal(run(HEAD RUBBER PRESSED "solver: {method: xpbd, substeps: 8}\n", &told, &summary, &error), PEL_OK);
    assert_non_null(strstr(told.text, "xpbd with 8 substeps stretches up to "));
    assert_non_null(strstr(told.text, "times as far as the material. use substeps >= "));
    assert_true(summary_has("\"substeps_min\": 8,") && summary_has("\"substeps_max\": 8,"));
    assert_true(summary_has("\"method\": \"xpbd\"") && summary_has("\"softness_max\": "));
    told.count = 0;
    assert_int_equal(run(HEAD RUBBER PRESSED "solver: {method: xpbd, max_substeps: 8}\n", &told, &summary, &error),
                     PEL_OK);
    assert_non_null(strstr(told.text, "use max_substeps >= "));
    told.count = 0;
    told.text[0] = '\0';
    assert_int_equal(run(HEAD SOFT PRESSED, &told, &summary, &error), PEL_OK);
    assert_null(strstr(told.text, "xpbd"));
    assert_true(summary_has("\"second_order\": true"));
    assert_int_equal(
        run(HEAD STEEL "    pressure: {inside: 3.0e7}\nsolver: {method: xpbd, substeps: 4}\n", &told, &summary, &error),
        PEL_BAD_SCENE);
    assert_non_null(strstr(error.what, "xpbd diverges in the first step: it stretches about "));
    assert_non_null(strstr(error.remedy, "use substeps >= "));
    assert_true(access("method_run", F_OK) != 0);
}

/* and a ball that a gas fills swings on after a blow from all sides, as xpbd would not */
static void test_gas(void **unused)
{
    (void)unused;
    heard told = {.count = 0};
    pel_run_summary kept, lost;
    const char *const blown =
        "version: 1\nduration: 0.3\nbodies:\n  - mesh: {shape: geodesic-sphere, frequency: 4, "
        "radius: 0.1}\n    membrane: {young: 1.0e5, thickness: 0.001}\n    pressure: {gas: "
        "{pressure: 2000, outside: {keys: [[0, 0], [0.01, 20], [0.02, 0]]}}}\noutput: {every: 0.002}\n%s";
    char text[600];
    snprintf(text, sizeof text, blown, "");
    assert_int_equal(run(text, &told, &kept, NULL), PEL_OK);
    assert_true(kept.ledger.dissipated_solver < 0.01 * kept.ledger.supplied);
    snprintf(text, sizeof text, blown, "solver: {method: xpbd}\n");
    assert_int_equal(run(text, &told, &lost, NULL), PEL_OK);
    assert_true(lost.ledger.dissipated_solver > 0.3 * lost.ledger.supplied);
}

/* a slab bends on smooth tetrahedra, which implicit has; beside a rigid sphere on linear ones under xpbd */
static void test_marble(void **unused)
{
    (void)unused;
    const char *const texts[] = {SLAB, SLAB MARBLE};
    for (int i = 0; i < 2; i++) {
        heard told = {.count = 0};
        pel_scene *scene = load(texts[i], &told);
        assert_int_equal(scene->sim.solver.method, i == 0 ? PEL_METHOD_IMPLICIT : PEL_METHOD_XPBD);
        assert_int_equal(scene->model.bodies[0].volume.element, i == 0 ? PEL_VOLUME_SMOOTH : PEL_VOLUME_LINEAR);
        pel_scene_destroy(scene);
    }
}

/* the step that is tried leaves no trace */
static void test_tried_step(void **unused)
{
    (void)unused;
    heard told = {.count = 0};
    pel_run_summary soft;
    assert_int_equal(run(HEAD RUBBER PRESSED "solver: {method: xpbd, substeps: 8}\n", &told, &soft, NULL), PEL_OK);
    remove_folder("method_run");
    pel_scene *scene = load(HEAD RUBBER PRESSED "solver: {method: xpbd, substeps: 8}\n", &told);
    pel_model *model;
    pel_sim *sim;
    assert_int_equal(pel_model_create(&scene->model, &model, NULL), PEL_OK);
    scene->sim.model = model;
    assert_int_equal(pel_sim_create(&scene->sim, &sim, NULL), PEL_OK);
    assert_true(pel_sim_softness(sim) > 1);
    for (int i = 0; i < 5; i++)
        assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
    assert_true(pel_sim_hash(sim) == soft.state_hash);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
}

static pel_status create(const void *text, pel_error *error)
{
    pel_scene *scene;
    pel_status status = pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, error);
    pel_scene_destroy(scene);
    return status;
}

static void test_allocation(void **unused)
{
    (void)unused;
    for_every_allocation_failure(create, SHEET STEEL);
}

/* static without a duration: steps for keys, for modes, along a path */
static void test_static_times(void **unused)
{
    (void)unused;
    static const struct {
        const char *solver;
        double duration, dt;
    } cases[] = {
        {"solver: {method: static}\n", 1, 1},
        {"solver: {method: static}\nloads: [{force: [0, 0, 1], keys: [[0, 0], [0.5, 1], [1.5, 0]]}]\n", 1.5, 0.5},
        {"solver: {method: static, steps: 6}\nloads: [{force: [0, 0, 1], keys: [[0, 0], [3, 1]]}]\n", 3, 0.5},
        {"solver: {method: static, analysis: modal, modes: 4}\n", 4, 1},
        {"solver: {method: static, analysis: modal, modes: 4, dt: 0.5}\n", 2, 0.5},
        {"solver: {method: static, path: arc-length, steps: 20}\n", 20, 1},
        {"solver: {method: static, path: arc-length}\n", 100, 1},
        {"solver: {method: static, path: arc-length, steps: 20, dt: 0.5}\n", 10, 0.5},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1000];
        snprintf(text, sizeof text, "version: 1\nbodies: [{mesh: {shape: grid}, pinned: {nearest: [0, 0, 0]}}]\n%s",
                 cases[i].solver);
        pel_scene *scene;
        assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, NULL), PEL_OK);
        assert_near(scene->sim.solver.dt, cases[i].dt, 1e-12);
        assert_near(scene->duration, cases[i].duration, 1e-12);
        assert_int_equal(scene->output.every_frame, 1);
        pel_scene_destroy(scene);
    }
}

/* bending that names no model: mid-edge where the method knows the edges */
static void test_bending(void **unused)
{
    (void)unused;
    static const struct {
        const char *text;
        pel_bending_model model;
        const char *printed;
    } cases[] = {
        {HEAD SOFT PRESSED, PEL_BENDING_HINGE, "model: hinge"},
        {HEAD STEEL PRESSED, PEL_BENDING_MIDEDGE, "model: midedge"},
        {HEAD RUBBER PRESSED "solver: {method: implicit}\n", PEL_BENDING_MIDEDGE, "model: midedge"},
        {SHEET RUBBER PINNED "solver: {method: static}\n", PEL_BENDING_MIDEDGE, "model: midedge"},
        {SHEET RUBBER PINNED "solver: {method: descent}\n", PEL_BENDING_HINGE, "model: hinge"},
        {HEAD "    membrane: {preset: steel-sheet}\n    bending: {model: hinge}\nsolver: {method: implicit}\n",
         PEL_BENDING_HINGE, "model: hinge"},
        {HEAD RUBBER "    anisotropy: {mode: curl}\nsolver: {method: implicit}\n", PEL_BENDING_HINGE, "model: hinge"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        heard told = {0};
        pel_scene *scene = load(cases[i].text, &told);
        assert_int_equal(scene->model.bodies[0].shell.bending.model, cases[i].model);
        assert_non_null(strstr(pel_scene_text(scene), cases[i].printed));
        pel_scene_destroy(scene);
    }
}

/* s that a scene is told to take, 0 = nothing is told; those of one contact say that a jam takes more */
static double told_seconds(const char *text, const char *method, bool may_jam)
{
    heard told = {0};
    char words[64];
    double seconds;
    pel_scene_destroy(load(text, &told));
    snprintf(words, sizeof words, "steps of %s take about ", method);
    const char *at = told.count > 0 ? strstr(told.text, words) : NULL;
    if (at == NULL)
        return 0;
    assert_int_equal(sscanf(at + strlen(words), "%lf", &seconds), 1);
    assert_int_equal(strstr(at, "more where bodies jam") != NULL, may_jam);
    return seconds;
}

/* What takes long is told: 320 triangles cost 5e-3 n (n / 1000)^1/4 ms a step, under contact 30e-3, under static three
   systems; smooth tetrahedra four times the others; substeps of xpbd, and steps of the others, 50e-6 n each. */
static void test_long_runs(void **unused)
{
    (void)unused;
    const double step = 1e-3 * 320 * pow(0.32, 0.25), steps = 5000 / 0.01;
    static const char implicit[] = LONG_HEAD RUBBER PINNED "solver: {method: implicit, dt: 0.01}\n";
    static const char contact[] =
        LONG_HEAD RUBBER PINNED "solver: {method: implicit, dt: 0.01}\ncontact: {self: true}\n";
    static const char fixed[] = LONG_HEAD RUBBER PINNED "solver: {method: static, dt: 0.01}\n";
    static const char soft[] = LONG_HEAD SOFT PRESSED "solver: {dt: 0.01}\n";
    static const char brief[] = HEAD RUBBER PINNED "solver: {method: implicit, dt: 0.01}\n";
    static const char solid[] = LONG_HEAD "    volume: {element: %s, young: 1.0e4, edge: 0.01}\n"
                                          "    pinned: {nearest: [0, 0, -0.05]}\n"
                                          "solver: {method: implicit, dt: 0.01}\n";
    assert_near(told_seconds(implicit, "implicit", false), 5e-3 * step * steps, 0.02 * 5e-3 * step * steps);
    assert_near(told_seconds(contact, "implicit", true), 30e-3 * step * steps, 0.02 * 30e-3 * step * steps);
    assert_near(told_seconds(fixed, "static", false), 15e-3 * step * steps, 0.02 * 15e-3 * step * steps);
    assert_true(told_seconds(soft, "xpbd", false) > 50e-9 * 320 * steps);
    assert_true(told_seconds(brief, "implicit", false) == 0);
    static const char *const short_steps[] = {"explicit", "pbd", "quasi-static"};
    for (size_t i = 0; i < sizeof short_steps / sizeof *short_steps; i++) {
        char tiny[1000];
        snprintf(tiny, sizeof tiny, LONG_HEAD SOFT PRESSED "solver: {method: %s, dt: 1e-12}\n", short_steps[i]);
        assert_true(told_seconds(tiny, short_steps[i], false) > 50e-9 * 320 * 5000e12 * 0.9);
    }
    char text[2][1000];
    double seconds[2];
    for (int i = 0; i < 2; i++) {
        snprintf(text[i], sizeof text[i], solid, i == 0 ? "linear" : "smooth");
        seconds[i] = told_seconds(text[i], "implicit", false);
    }
    assert_true(seconds[0] > 0 && seconds[1] > 1.2 * seconds[0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_choice),     cmocka_unit_test(test_bending),      cmocka_unit_test(test_soft_runs),
        cmocka_unit_test(test_gas),        cmocka_unit_test(test_marble),       cmocka_unit_test(test_tried_step),
        cmocka_unit_test(test_allocation), cmocka_unit_test(test_static_times), cmocka_unit_test(test_long_runs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
