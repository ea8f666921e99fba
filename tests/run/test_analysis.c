/* Statics without a duration, frequencies and buckling factors, from the scene to the summary, against closed forms. */
#define _XOPEN_SOURCE 700
#include "run_fixture.h"

#include <math.h>

#define PI 3.14159265358979323846

static pel_run_summary run_text(const char *text, const char *name)
{
    pel_scene *scene = load_scene(text, NULL, 0);
    run_case test = {.run = name};
    check_run(scene, &test, PEL_OK);
    pel_scene_destroy(scene);
    return test.summary;
}

static void check_refused(const char *text, const char *words)
{
    char message[900];
    pel_scene *scene = load_scene(text, NULL, 0);
    run_case test = {.run = "refused"};
    assert_int_equal(do_run(scene, &test), PEL_BAD_ARGUMENT);
    pel_error_text(&test.error, message, sizeof message);
    if (strstr(message, words) == NULL)
        print_error("%s\n", message);
    assert_non_null(strstr(message, words));
    pel_scene_destroy(scene);
}

/* aluminium, 1 m x 1 m x 1 cm */
#define PLATE                                                                                                          \
    "version: 1\nbodies:\n"                                                                                            \
    "  - mesh: { shape: grid, nx: 20, ny: 20, diagonals: union-jack }\n"                                               \
    "    membrane: { material: stvk, young: 7.0e10, poisson: 0.3, thickness: 0.01 }\n"                                 \
    "    mass: { density: 2700, thickness: 0.01 }\n"                                                                   \
    "    bending: { model: midedge }\n"

/* omega a^2 sqrt(rho h / D) of a free square plate of poisson 0.3, by Ritz (papers/own/ritz.c); Leissa 1969, table C1,
   is up to 1 % above: an upper bound with few terms */
static void test_free_plate(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* positions in float strain a stiff sheet by 1e-7 */
    static const double ritz[6] = {13.468, 19.596, 24.270, 34.801, 34.801, 61.093};
    double unit = sqrt(7e10 * 1e-6 / (12 * 0.91) / 27) / (2 * PI);
    pel_run_summary summary = run_text(PLATE "solver: { analysis: modal, modes: 12 }\n", "free");
    assert_int_equal(summary.mode_count, 12);
    assert_int_equal(summary.frames, 13);
    for (int m = 0; m < 6; m++) {
        assert_true(summary.modes[m] == 0);
        /* 20 cells a side: 0.4 to 3.2 % below */
        assert_near(summary.modes[6 + m] / (unit * ritz[m]), 0.982, 0.016);
    }
    /* drawn with 5 % of the diagonal */
    assert_near(summary.residual_displacement, 0.05 * sqrt(2), 1e-6);
    check_contains("free", "summary.json", "\"frequencies\": [0, 0, 0, 0, 0, 0, 32.");
    check_contains("free", "series.csv", ",frequency\n");
}

/* frequencies are those under the loads: a strip on a hinge that is pulled at its end */
static void test_loaded(void **unused)
{
    (void)unused;
    const char *strip = "version: 1\nbodies:\n"
                        "  - mesh: { shape: grid, nx: 40, ny: 4, size_y: 0.1, diagonals: union-jack }\n"
                        "    membrane: { material: stvk, young: 2.1e11, poisson: 0, thickness: 0.002 }\n"
                        "    mass: { density: 7800, thickness: 0.002 }\n"
                        "    bending: { model: midedge }\n"
                        "    pinned: { box: { min: [-1, -1, -1], max: [-0.499, 1, 1] } }\n"
                        "loads: [{ force: [1000, 0, 0], at: { box: { min: [0.499, -1, -1], max: [1, 1, 1] } } }]\n"
                        "solver: { analysis: modal, modes: 1 }\n";
    /* between a string, pi/2 sqrt(F / (m l)), and a rigid rod */
    pel_run_summary summary = run_text(strip, "loaded");
    double mass = 7800 * 0.1 * 0.002, rod = sqrt(3 * 1000 / mass) / (2 * PI);
    assert_true(summary.modes[0] < rod && summary.modes[0] > rod * PI / 2 / sqrt(3));
}

/* a drum whose rim holds a stretch of 5 % from the shape at rest: 2.405 / (2 pi R) sqrt(tension / mass) */
static void test_stretched_at_the_start(void **unused)
{
    (void)unused;
    const char *drum = "version: 1\nbodies:\n"
                       "  - mesh: { shape: disk, radius: 0.15, rings: 12 }\n"
                       "    rest: { shape: disk, radius: 0.14285714285714286, rings: 12 }\n"
                       "    membrane: { material: neo-hookean, young: 1.0e6, poisson: 0.5, thickness: 0.001 }\n"
                       "    mass: { density: 1100 }\n"
                       "    pinned: boundary\n"
                       "solver: { analysis: modal, modes: 1 }\n";
    const double tension = 1e6 / 3 * 1e-3 * (1 - pow(1.05, -6)), mass = 1100 * 1e-3 / (1.05 * 1.05);
    const double frequency = 2.404826 / (2 * PI * 0.15) * sqrt(tension / mass);
    pel_run_summary summary = run_text(drum, "stretched");
    assert_near(summary.modes[0] / frequency, 1, 5e-3);
}

/* a free strip that is pressed at both ends: Euler's column between hinges */
static void test_column(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* positions in float strain a stiff sheet by 1e-7 */
    pel_run_summary summary =
        run_text("version: 1\nbodies:\n"
                 "  - mesh: { shape: grid, nx: 40, ny: 4, size_y: 0.1, diagonals: union-jack }\n"
                 "    membrane: { material: stvk, young: 2.1e11, poisson: 0, thickness: 0.002 }\n"
                 "    bending: { model: midedge }\n"
                 "loads:\n"
                 "  - { force: [-1, 0, 0], at: { box: { min: [0.499, -1, -1], max: [1, 1, 1] } } }\n"
                 "  - { force: [1, 0, 0], at: { box: { min: [-1, -1, -1], max: [-0.499, 1, 1] } } }\n"
                 "solver: { analysis: buckling, modes: 2 }\n",
                 "column");
    double euler = PI * PI * 2.1e11 * 0.1 * 8e-9 / 12;
    assert_near(summary.modes[0] / euler, 1, 0.005);
    assert_near(summary.modes[1] / (4 * euler), 1, 0.01);
    check_contains("column", "series.csv", ",load_factor\n");
    check_contains("column", "summary.json", "\"load_factors\": [13");
}

#define BALL                                                                                                           \
    "version: 1\nbodies:\n"                                                                                            \
    "  - mesh: { shape: geodesic-sphere, frequency: 12 }\n"                                                            \
    "    membrane: { material: stvk, young: 1.0e9, poisson: 0.3, thickness: 0.05 }\n"                                  \
    "    bending: { model: midedge }\n"

/* Zoelly 1915, with the term of second order in h/R (Timoshenko and Gere, section 11.13) */
static void test_sphere(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* positions in float strain a stiff sheet by 1e-7 */
    double h = 0.05, zoelly = 2 * h * 1e9 / 0.91 * (sqrt(0.91 / 3) * h - 0.3 * h * h / 2);
    pel_run_summary summary =
        run_text(BALL "    pressure: { outside: 1000 }\nsolver: { analysis: buckling, modes: 1 }\n", "sphere");
    /* 6 % below with 8 edges in a wave; 1.6 % on fine meshes */
    assert_near(1000 * summary.modes[0] / zoelly, 0.94, 0.02);
}

#define STRIP                                                                                                          \
    "version: 1\nbodies:\n"                                                                                            \
    "  - mesh: { shape: grid, nx: 20, ny: 2, size_y: 0.1 }\n"                                                          \
    "    membrane: { material: stvk, young: 2.1e11, poisson: 0.3, thickness: 0.002 }\n"                                \
    "    bending: { model: midedge }\n"                                                                                \
    "    pinned: { box: { min: [-1, -1, -1], max: [-0.44, 1, 1] } }\n"                                                 \
    "loads: [{ force: [0, 0, 1], at: { box: { min: [0.499, -1, -1], max: [1, 1, 1] } }"

/* one step; with keys one for each time that all are multiples of; with `steps` so many to the last */
static void test_durations(void **unused)
{
    (void)unused;
    pel_run_summary plain = run_text(STRIP " }]\nsolver: { method: static }\n", "plain");
    assert_int_equal(plain.steps, 1);
    assert_int_equal(plain.frames, 2);
    assert_true(plain.solver.converged && plain.max_displacement > 1e-3);
    pel_run_summary keyed =
        run_text(STRIP ", keys: [[0, 0], [1, 1], [2.5, 0.5]] }]\nsolver: { method: static }\n", "keyed");
    assert_int_equal(keyed.steps, 5);
    assert_int_equal(keyed.frames, 6);
    assert_near(keyed.time_simulated, 2.5, 1e-12);
    assert_near(keyed.max_displacement, plain.max_displacement, 1e-6 * plain.max_displacement);
    pel_run_summary cut =
        run_text(STRIP ", keys: [[0, 0], [1, 1], [2.5, 0.5]] }]\nsolver: { method: static, steps: 2 }\n", "cut");
    assert_int_equal(cut.steps, 2);
    assert_near(cut.residual_displacement, keyed.residual_displacement, 1e-6 * keyed.residual_displacement);
}

static void test_refusals(void **unused)
{
    (void)unused;
    if (sizeof(pel_real) == sizeof(float))
        skip(); /* positions in float strain a stiff sheet by 1e-7 */
    check_refused(BALL "solver: { analysis: buckling }\n", "no load acts");
    check_refused(BALL "    pressure: { inside: 1000 }\nsolver: { analysis: buckling, modes: 1 }\n", "reverse them");
    check_refused(BALL "solver: { method: xpbd, analysis: modal }\nduration: 1\n", "use method static");
    check_refused(BALL "contact: {}\nsolver: { analysis: modal }\n", "does not support contact");
}

/* stopped in the middle, taken up again: the same files */
static void test_resume(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(STRIP " }]\nsolver: { analysis: modal, modes: 4 }\n", NULL, 0);
    run_case whole = {.run = "whole"}, first = {.run = "parts", .stop_at = 2};
    run_case second = {.run = "parts", .resume = "checkpoint"};
    check_run(scene, &whole, PEL_OK);
    check_run(scene, &first, PEL_STOPPED);
    check_run(scene, &second, PEL_OK);
    check_same_results("whole", "parts", 5);
    pel_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_free_plate), cmocka_unit_test(test_loaded), cmocka_unit_test(test_stretched_at_the_start),
        cmocka_unit_test(test_column),     cmocka_unit_test(test_sphere), cmocka_unit_test(test_durations),
        cmocka_unit_test(test_refusals),   cmocka_unit_test(test_resume),
    };
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
