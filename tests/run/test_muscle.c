/* Muscles against closed forms: a free strip shortens until its muscle and its membrane balance, a held one pulls with
   activation times tension times its width. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "run/warned.h"

#include <math.h>

/* N/m: Young's modulus times thickness, and tension */
#define SHEET 60
#define TENSION 40
/* of sweeps, whose membrane gives way under the muscle by some percent; the other methods balance forces */
#define SWEEP_TOLERANCE 0.05
#define TOLERANCE (sizeof(pel_real) == sizeof(float) ? 5e-3 : 1e-3)

static const char *const strip =
    "version: 1\nbodies:\n"
    "  - name: strip\n    mesh: { shape: grid, nx: 10, ny: 2, size_x: 0.1, size_y: 0.02, diagonals: union-jack }\n"
    "    membrane: { material: neo-hookean, young: 3.0e4, poisson: 0.5, thickness: 0.002 }\n"
    "    mass: { density: 1000 }\n"
    "    anisotropy: { mode: muscle, tension: 40, activation: 0.5, direction: [1, 0, 0] }\n"
    "solver: { method: static }\nduration: 1\n";

/* the stretch at which an incompressible strip balances its muscle */
static double stretch_of(double activation, double optimum, double width)
{
    double low = 0.3, high = 1;
    for (int n = 0; n < 100; n++) {
        const double s = 0.5 * (low + high), at = (s - optimum) / width;
        const double pull = activation * TENSION * fmax(0, 1 - at * at) + SHEET / 3.0 * (s - 1 / (s * s));
        *(pull > 0 ? &high : &low) = s;
    }
    return low;
}

/* m, of the corners */
static double way_of(double stretch)
{
    return hypot(0.05 * (1 - stretch), 0.01 * (1 / sqrt(stretch) - 1));
}

static double run_way(const char *const *overrides, int32_t count)
{
    pel_run_summary summary;
    run_scene(strip, overrides, count, NULL, 0, &summary);
    assert_int_equal(summary.warning_count, 0);
    assert_true(summary.ledger.energy_error <= summary.ledger.tolerance);
    return summary.residual_displacement;
}

static void test_free_strip(void **unused)
{
    (void)unused;
    const char *const cases[][3] = {
        {"bodies.0.anisotropy.activation=0.1"},
        {"bodies.0.anisotropy.activation=1"},
        {"bodies.0.anisotropy.optimum=1.1", "bodies.0.anisotropy.width=0.6"},
        {"solver={ method: implicit, dt: 0.01, drag: 20 }"},
        {"solver={ method: xpbd, dt: 0.01, drag: 20 }"},
    };
    const double stretches[] = {stretch_of(0.1, 1, 0.5), stretch_of(1, 1, 0.5), stretch_of(0.5, 1.1, 0.6),
                                stretch_of(0.5, 1, 0.5), stretch_of(0.5, 1, 0.5)};
    for (int i = 0; i < 5; i++) {
        const double expected = way_of(stretches[i]);
        const double way = run_way(cases[i], cases[i][1] != NULL ? 2 : 1);
        print_message("%s: %.6g m, expected %.6g\n", cases[i][0], way, expected);
        assert_near(way, expected, (i == 4 ? SWEEP_TOLERANCE : TOLERANCE) * expected);
    }
}

/* the state at the end is that of the last activation, whatever was before; the muscle did the work */
static void test_keys(void **unused)
{
    (void)unused;
    const char *overrides[] = {"bodies.0.anisotropy.activation={ keys: [[0, 0], [0.5, 1], [1, 0.5]] }",
                               "solver.steps=4"};
    pel_run_summary summary;
    run_scene(strip, overrides, 2, NULL, 0, &summary);
    const double expected = way_of(stretch_of(0.5, 1, 0.5));
    assert_near(summary.residual_displacement, expected, TOLERANCE * expected);
    assert_near(summary.max_displacement, way_of(stretch_of(1, 1, 0.5)), TOLERANCE);
    assert_true(summary.ledger.work_material > 0);
}

/* N, largest of a column */
static double largest_force(const char *name)
{
    char *bytes;
    int column = 0;
    read_text("warned", "series.csv", &bytes, NULL);
    const char *found = strstr(bytes, name);
    assert_non_null(found);
    for (const char *c = bytes; c < found; c++)
        column += *c == ',';
    pel_free(bytes);
    return largest_in_series("warned", column);
}

static void test_held_strip(void **unused)
{
    (void)unused;
    const char *held = "bodies.0.supports=[{ name: a, at: { plane: { point: [-0.0499, 0, 0], normal: [-1, 0, 0] } } }, "
                       "{ name: b, at: { plane: { point: [0.0499, 0, 0], normal: [1, 0, 0] } } }]";
    const char *const cases[][2] = {
        {held, "bodies.0.anisotropy.activation=0.5"},
        {held, "bodies.0.anisotropy.activation=1"},
        {held, "solver={ method: implicit, dt: 0.01, drag: 20 }"},
    };
    const double activations[] = {0.5, 1, 0.5};
    for (int i = 0; i < 3; i++) {
        pel_run_summary summary;
        run_scene(strip, cases[i], 2, NULL, 0, &summary);
        const double expected = activations[i] * TENSION * 0.02;
        const double force = largest_force("strip_a_force,");
        print_message("%s: %.6g N, expected %.6g\n", cases[i][1], force, expected);
        assert_near(force, expected, TOLERANCE * expected);
    }
}

static void test_refused(void **unused)
{
    (void)unused;
    const char *const cases[][2] = {
        {"bodies.0.anisotropy.activation=1.5", "activation is out of range"},
        {"bodies.0.anisotropy.stiffness=100", "a muscle has a tension, and no stiffness"},
        {"bodies.0.anisotropy.width=0", "width is out of range"},
    };
    for (int i = 0; i < 3; i++) {
        pel_error error = {0};
        pel_scene *scene = NULL;
        assert_int_not_equal(pel_scene_parse("strip.yaml", strip, strlen(strip), cases[i], 1, NULL, &scene, &error),
                             PEL_OK);
        print_message("%s\n", error.what);
        assert_non_null(strstr(error.what, cases[i][1]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_free_strip),
        cmocka_unit_test(test_keys),
        cmocka_unit_test(test_held_strip),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
