/* The step of scenes that leave it to the program. */
#include "scene/scene_run.h"

#include "choice/time_step.h"

#include <stdlib.h>

#define RULER                                                                                                          \
    "version: 1\nbodies:\n  - name: ruler\n"                                                                           \
    "    mesh: { shape: grid, nx: 16, ny: 3, size_x: 0.2, size_y: 0.02 }\n    membrane: { preset: steel-sheet }\n"     \
    "    supports: [ { at: { box: { min: [-0.1001, -1, -1], max: [-0.0999, 1, 1] } }, rotation: fixed } ]\n"
#define THICK(thickness)                                                                                               \
    "version: 1\nduration: 0.5\nbodies:\n  - name: ruler\n"                                                            \
    "    mesh: { shape: grid, nx: 16, ny: 3, size_x: 0.2, size_y: 0.02 }\n"                                            \
    "    membrane: { preset: steel-sheet, thickness: " thickness " }\n"                                                \
    "    supports: [ { at: { box: { min: [-0.1001, -1, -1], max: [-0.0999, 1, 1] } }, rotation: fixed } ]\n"
#define SHAKEN                                                                                                         \
    "version: 1\nbodies:\n  - name: ruler\n"                                                                           \
    "    mesh: { shape: grid, nx: 16, ny: 3, size_x: 0.2, size_y: 0.02 }\n    membrane: { preset: steel-sheet }\n"     \
    "    pinned: { box: { min: [-1, -1, -1], max: [-0.08, 1, 1] } }\n"
#define PINCH(until)                                                                                                   \
    "tools: [ { shape: sphere, radius: 0.01, press: false, grasp: { reach: 0.001, until: " until                       \
    " }, motion: [ { position: [0.1, 0, 0] } ] } ]\n"
#define THUMB(end)                                                                                                     \
    "tools: [ { shape: sphere, radius: 0.005, motion: [ { position: [0.095, 0, 0.006] }, { time: 0.2, position: "      \
    "[0.095, 0, -0.004] }, { time: 0.21, position: " end " } ] } ]\n"
#define BAND                                                                                                           \
    "version: 1\nbodies:\n  - name: band\n"                                                                            \
    "    mesh: { shape: grid, nx: 20, ny: 2, size_x: 0.2, size_y: 0.02 }\n    mass: { density: 1000 }\n"               \
    "    membrane: { young: 1.0e6, poisson: 0, thickness: 0.001, material: linear }\n"                                 \
    "    pinned: { box: { min: [-0.11, -1, -1], max: [-0.085, 1, 1] } }\n"
#define AT_END "at: { box: { min: [0.0999, -1, -1], max: [0.1001, 1, 1] } }"
#define WHILE "duration: 0.5\n"
#define SLOW "keys: [[0, 0], [0.4, 1]]"
#define PULL(when) "loads: [ { name: pull, force: [0.2, 0, 0], " when ", " AT_END " } ]\n" WHILE
#define WEAK_PULL(force) "loads: [ { name: pull, force: [" force ", 0, 0], " AT_END " } ]\n" WHILE
#define LIFT(when)                                                                                                     \
    "    supports: [ { name: lift, fix: [x], displacement: [0.01, 0, 0], " when ", " AT_END " } ]\n" WHILE
#define FLAT(inside)                                                                                                   \
    "version: 1\nbodies:\n  - name: ball\n    mesh: { shape: geodesic-sphere, frequency: 3, radius: 0.1 }\n"           \
    "    membrane: { young: 1.0e6, poisson: 0.5, thickness: 0.001 }\n    mass: { density: 1000 }\n"                    \
    "    pressure: { inside: { " inside " } }\n"
#define BALL                                                                                                           \
    "version: 1\nbodies:\n  - name: ball\n    mesh: { shape: geodesic-sphere, frequency: 3, radius: 0.05 }\n"          \
    "    membrane: { preset: steel-sheet }\n    bending: {}\n    pressure: { inside: 1000 }\n"
#define GAS                                                                                                            \
    "version: 1\nbodies:\n  - name: ball\n    mesh: { shape: geodesic-sphere, frequency: 3, radius: 0.1 }\n"           \
    "    membrane: { young: 1.0e6, poisson: 0.5, thickness: 0.001 }\n    mass: { density: 1000 }\n"                    \
    "    pressure: { gas: { outside: -500 } }\n"
#define SHEET                                                                                                          \
    "version: 1\nbodies:\n  - name: card\n    mesh: { shape: grid, nx: 3, ny: 3, size_x: 9, size_y: 9 }\n"             \
    "    membrane: { preset: rubber }\n"

/* what moves and goes on moving gets a step that resolves it, if that is affordable; all else the default */
static void test_choice(void **unused)
{
    (void)unused;
    static const struct {
        const char *text;
        double dt;
        const char *says; /* null = nothing of dt */
    } cases[] = {
        {RULER "duration: 1\n", 0.002, "vibration of body 'ruler', 10."},
        {THICK("0.0015"), 0.000625, "vibration of body 'ruler', 3"},
        {THICK("0.00325"), 0.0003125, "vibration of body 'ruler', 6"},
        {RULER "duration: 1\nsolver: { dt: 0.01 }\n", 0.01, NULL},
        {RULER "duration: 1\nsolver: { drag: 5 }\n", 0.01, NULL},
        {RULER "duration: 1\nsolver: { drag: 1 }\n", 0.002, "vibration of body 'ruler', 10."},
        {RULER "duration: 1\nsolver: { method: static }\n", 0.01, NULL},
        {RULER "duration: 1\noutput: { every_frame: 1 }\n", 0.01, NULL},
        {RULER "stop: { frames: 3 }\n", 0.01, NULL},
        {RULER "duration: 1\ntools: [ { shape: sphere, radius: 0.01, motion: [ { position: [0, 0, 1] } ] } ]\n", 0.01,
         NULL},
        /* what holds the ruler lets go, or pins of it move */
        {RULER "duration: 1\n" PINCH("0.5"), 0.002, "vibration of body 'ruler', 10."},
        {RULER "duration: 1\n" PINCH("1"), 0.01, NULL},
        {SHAKEN "    support: { motion: [ { time: 0 }, { time: 1, position: [0, 0, 1] } ] }\nduration: 2\n", 0.002,
         "vibration of body 'ruler', 11."},
        {SHAKEN "    support: { motion: [ { time: 0 }, { time: 0.002, position: [0, 0, 0.01] } ] }\nduration: 2\n",
         0.0005, "4 steps in what ruler_support does in 0.002 s"},
        /* a thumb that bends the ruler and goes away, or stays */
        {RULER "duration: 1\n" THUMB("[0.2, 0, -0.004]"), 0.002, "vibration of body 'ruler', 10."},
        {RULER "duration: 1\n" THUMB("[0.095, 0, -0.004]"), 0.01, NULL},
        /* what a load starts along a band is faster than its slowest vibration, 0.6 Hz, if the load is sudden */
        {BAND "duration: 0.5\nloads: [ { name: pull, force: [0.2, 0, 0], " AT_END " } ]\n", 0.0005,
         "vibration that load 'pull' starts, 45."},
        {BAND "duration: 0.5\nloads: [ { force: [0.2, 0, 0], keys: [[0, 0], [0.4, 1]], " AT_END " } ]\n", 0.01, NULL},
        {BAND "duration: 0.5\nloads: [ { force: [0, 0, 0.0001], " AT_END " } ]\n", 0.01, NULL},
        {BAND "    velocity: [0.1, 0, 0]\nduration: 0.5\n", 0.0005,
         "vibration that the motion at the start starts, 41."},
        /* motion at the start, contact with nothing, and ties that open change nothing */
        {RULER "    velocity: [0, 0, 1]\n    angular_velocity: [0, 1, 0]\nduration: 1\n", 0.0003125,
         "vibration that the motion at the start starts, 6"},
        /* a gas is as stiff for it as the skin */
        {GAS "duration: 0.05\n", 6.25e-5, "vibration that the pressure starts, 33"},
        {RULER "duration: 1\ncontact: {}\n", 0.002, "vibration of body 'ruler', 10."},
        {RULER "duration: 1\nattachments: [ { at: { nearest: [0.1, 0, 0] }, until: 0.1 } ]\n", 0.002,
         "vibration of body 'ruler', 10."},
        {RULER "duration: 1\nwind: { velocity: [0, 0, 1] }\n", 0.002, "vibration of body 'ruler', 10."},
        {RULER "duration: 1000\n", 0.01, NULL},
        {RULER "  - name: far\n    mesh: { shape: grid, nx: 2, ny: 2, translate: [0, 0, 9] }\n    membrane: { preset: "
               "steel-sheet }\n    pinned: all\nduration: 1\n",
         0.002, "vibration of body 'ruler', 10."},
        {RULER "duration: 150\n", 0.01, "it is damped"},
        {RULER "duration: 1\nloads: [ { name: flick, force: [0, 0, 1], from: 0.1, until: 0.104 } ]\n", 0.0004,
         "load 'flick' does in 0.004 s"},
        {RULER "duration: 0.5\nloads: [ { name: tick, force: [0, 0, 1], until: 0.0004 } ]\n", 5e-5,
         "load 'tick' does in 0.0004 s"},
        /* what would cost too much is told, and the rest resolved */
        {RULER "duration: 2\nloads: [ { name: tick, force: [0, 0, 1], until: 0.0001 } ]\n", 0.002,
         "load 'tick' does in 0.0001 s would take 1.25e-05 s"},
        /* no step is longer than the time between frames */
        {RULER "duration: 0.1\nsolver: { drag: 50 }\noutput: { every: 0.004 }\n", 0.004, "output.every"},
        {RULER "duration: 0.1\nsolver: { dt: 0.01 }\noutput: { every: 0.004 }\n", 0.01, "each step is a frame"},
        {RULER "duration: 1\nloads: [ { force: [0, 0, 1], keys: [[0, 0], [0.1, 1], [0.108, 1], [0.15, 0]] } ]\n", 0.002,
         "vibration of body 'ruler', 10."},
        {BALL "duration: 1\n", 0.01, NULL},
        {SHEET "duration: 1\n", 0.01, NULL},
        {SHEET "solver: { method: implicit }\nduration: 1\nloads: [ { name: flick, force: [0, 0, 1], until: 0.04 } ]\n",
         0.005, "load 'flick' does in 0.04 s"},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        heard told = {""};
        pel_log log = {.write = hear, .user = &told};
        pel_scene *scene = NULL;
        pel_error error = {0};
        char message[1000];
        if (pel_scene_parse("a.yaml", cases[c].text, strlen(cases[c].text), NULL, 0, &log, &scene, &error) != PEL_OK)
            print_error("%s\n", pel_error_text(&error, message, sizeof message));
        assert_non_null(scene);
        const char *line = strstr(told.text, "dt ");
        bool says = cases[c].says != NULL ? line != NULL && strstr(line, cases[c].says) != NULL : line == NULL;
        char number[40];
        snprintf(number, sizeof number, "dt: %g\n", cases[c].dt);
        if (!says || fabs(scene->sim.solver.dt - cases[c].dt) > 1e-12)
            fail_msg("case %d: dt %g, %s", (int)c, scene->sim.solver.dt, told.text);
        assert_non_null(strstr(pel_scene_text(scene), number));
        pel_scene_destroy(scene);
    }
}

/* What starts vibrations: loads that begin or end at once within the run, weight that moves the body, pressures that
   change, and supports that move, fast as measured by the vibration itself. */
static void test_excited(void **unused)
{
    (void)unused;
    static const struct {
        const char *text, *by; /* null = nothing */
        double frequency;      /* Hz */
    } cases[] = {
        {BAND PULL("from: 0.499"), "load 'pull'", 45.8},
        {BAND PULL("from: 0.5"), NULL, 0},
        {BAND PULL(SLOW ", until: 0.499"), "load 'pull'", 45.8},
        {BAND PULL(SLOW ", until: 0.5"), NULL, 0},
        {BAND PULL(SLOW ", until: 0.501"), NULL, 0},
        {BAND PULL("keys: [[0, 1], [0.4, 1]]"), "load 'pull'", 45.8},
        {BAND PULL("keys: [[0, 0], [0.1, 0], [0.4, 1]]"), NULL, 0},
        /* ten periods */
        {BAND PULL("keys: [[0, 0], [0.217, 1]]"), "load 'pull'", 45.8},
        {BAND PULL("keys: [[0, 0], [0.22, 1]]"), NULL, 0},
        {BAND LIFT("keys: [[0, 0], [0.2, 1], [0.3, 0]]"), "support 'band_lift'", 83.6},
        {BAND LIFT("keys: [[0, 0], [0.1, 1]]"), "support 'band_lift'", 82.8},
        {BAND LIFT("keys: [[0, 0], [0.13, 1]]"), NULL, 0},
        {BAND LIFT("keys: [[0, 1], [0.4, 1]]"), "support 'band_lift'", 82.8},
        {BAND LIFT("rotation: free"), NULL, 0},
        /* rho g L^2 / (2 E) of a thousandth of the diagonal: 11 m/s^2 */
        {BAND "gravity: [10.7, 0, 0]\n" WHILE, NULL, 0},
        {BAND "gravity: [11.2, 0, 0]\n" WHILE, "gravity", 41.7},
        /* a hundredth of the energy of the motion: F^2 L / (2 E A) of m v^2 / 2 */
        {BAND "    velocity: [0.1, 0, 0]\n" WEAK_PULL("0.0062"), "load 'pull'", 45.8},
        {BAND "    velocity: [0.1, 0, 0]\n" WEAK_PULL("0.0052"), "the motion at the start", 41.7},
        {FLAT("keys: [[0, 0], [0.1, 10]]") WHILE, "the pressure", 99.5},
        {FLAT("keys: [[0, 0], [0.101, 10]]") WHILE, NULL, 0},
        {FLAT("keys: [[0, 10], [0.5, 10]]") WHILE, "the pressure", 99.5},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        pel_scene *scene = NULL;
        pel_vibration found;
        pel_error error = {0};
        char message[1000];
        if (pel_scene_parse("a.yaml", cases[c].text, strlen(cases[c].text), NULL, 0, NULL, &scene, &error) != PEL_OK)
            print_error("%s\n", pel_error_text(&error, message, sizeof message));
        assert_non_null(scene);
        assert_int_equal(pel_scene_find_vibration(scene, 0, &found), PEL_OK);
        const char *by = cases[c].by != NULL ? cases[c].by : "";
        if (strcmp(found.excited.by, by) != 0 || fabs(found.excited.frequency - cases[c].frequency) > 0.1)
            fail_msg("case %d: '%s', %g Hz", (int)c, found.excited.by, found.excited.frequency);
        pel_scene_destroy(scene);
    }
}

/* a dt that is half of what a simulation refuses */
static void check_half(const pel_sim_def *scene, double *stable)
{
    pel_sim_def def = *scene;
    pel_sim *sim;
    assert_int_equal(pel_sim_stable_dt(&def, stable, NULL), PEL_OK);
    def.solver.dt = 1.98 * *stable;
    assert_int_equal(pel_sim_create(&def, &sim, NULL), PEL_OK);
    pel_sim_destroy(sim);
    def.solver.dt = 2.02 * *stable;
    assert_int_equal(pel_sim_create(&def, &sim, NULL), PEL_UNSTABLE);
}

/* The step of explicit is told and stable, and follows what it depends on; it is refused where it would take
   long, and not chosen where it is written. */
static void test_explicit(void **unused)
{
    (void)unused;
    const char *const text = "version: 1\nbodies:\n  - name: card\n    mesh: { shape: grid, nx: 8, ny: 8, size_x: 0.2, "
                             "size_y: 0.2 }\n    membrane: { young: %s, thickness: 0.001 }\n%s    pinned: boundary\n"
                             "gravity: [0, 0, -9.81]\nduration: 0.2\nsolver: { method: explicit%s }\n";
    static const struct {
        const char *young, *more, *dt;
        double least, most; /* s */
        const char *says;
    } cases[] = {
        {"1e6", "", "", 1.7e-4, 3e-4, "half of what explicit is stable with at rest"},
        {"4e6", "", "", 0.8e-4, 1.5e-4, "half of what explicit is stable with at rest"},
        {"1e6", "    refine: { levels: 1, near_tools: 0.01 }\n", "", 1e-4, 1.6e-4, "half of what explicit"},
        {"1e6", "", ", dt: 1e-5", 1e-5, 1e-5, ""},
        {"1e-2", "", "", 0.01, 0.01, ""},
        {"1e17", "", "", 0, 0, "use the method xpbd or implicit, or write solver.dt"},
    };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        char scene_text[600], message[1000] = "";
        run r;
        pel_error error = {0};
        snprintf(scene_text, sizeof scene_text, text, cases[c].young, cases[c].more, cases[c].dt);
        pel_status status = begin(&r, scene_text, &error);
        assert_int_equal(status, cases[c].most > 0 ? PEL_OK : PEL_BAD_SCENE);
        const char *said = status == PEL_OK ? r.told.text : pel_error_text(&error, message, sizeof message);
        if (strstr(said, cases[c].says) == NULL || (cases[c].says[0] == '\0' && strstr(said, "explicit") != NULL))
            fail_msg("case %d: %s", (int)c, said);
        if (status == PEL_OK) {
            double dt = r.scene->sim.solver.dt, stable;
            if (!(dt >= cases[c].least && dt <= cases[c].most))
                fail_msg("case %d: dt %g", (int)c, dt);
            check_half(&r.scene->sim, &stable);
            assert_true(dt <= stable);
        }
        end(&r);
    }
}

/* a solid whose systems take long is told before the first step, with an edge that would do; xpbd solves none */
static void test_solid_cost(void **unused)
{
    (void)unused;
    const char *const text = "version: 1\nbodies:\n  - name: organ\n    mesh: { shape: box, nx: 8, ny: 8, nz: 8 }\n"
                             "    volume: { young: 10000, edge: %s }\n    pinned: { nearest: [0, 0, 0] }\n"
                             "solver: { method: %s }\nduration: 1\n";
    static const struct {
        const char *edge, *method;
        bool tells;
    } cases[] = {{"0.03", "static", true}, {"0.06", "static", false}, {"0.03", "xpbd", false}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        char scene_text[500];
        heard told = {""};
        pel_log log = {.write = hear, .user = &told};
        pel_scene *scene = NULL;
        snprintf(scene_text, sizeof scene_text, text, cases[c].edge, cases[c].method);
        assert_int_equal(pel_scene_parse("a.yaml", scene_text, strlen(scene_text), NULL, 0, &log, &scene, NULL),
                         PEL_OK);
        assert_true((strstr(told.text, "'organ' has ") != NULL) == cases[c].tells);
        /* 12 tetrahedra a cell of the lattice: 431,000, three systems of a minute */
        assert_true(!cases[c].tells || strstr(told.text, "volume.edge at least 1.7 times as long") != NULL);
        pel_scene_destroy(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_choice), cmocka_unit_test(test_excited),
                                       cmocka_unit_test(test_explicit), cmocka_unit_test(test_solid_cost)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
