/* Hinges that bend a flat sheet otherwise than its material are told, with a factor that Newton's method shows. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "run/warned.h"

/* 5 mm of foam that xpbd is the default for */
#define FOAM(more)                                                                                                     \
    "version: 1\nbodies:\n  - name: foam\n    mesh: { shape: grid, nx: 12, ny: 12, size_x: 0.2, size_y: 0.2 }\n"       \
    "    membrane: { young: 1.0e5, poisson: 0.2, thickness: 0.005 }\n" more

static const char shelf[] = FOAM("    pinned: { box: { min: [-1, -1, -1], max: [-0.08, 1, 1] } }\n"
                                 "    mass: { density: 30 }\ngravity: [0, 0, -0.1]\nsolver: { drag: 20 }\n"
                                 "duration: 1\n");

/* the stiffness of hinges over that of the material that a run tells; 0 = it tells nothing */
static double factor_of(const char *text, const char *const *overrides, int32_t count, double *way)
{
    pel_run_summary summary;
    run_scene(text, overrides, count, NULL, 0, &summary);
    const pel_run_warning *warning = find_warning(&summary, "hinge-bending");
    *way = summary.max_displacement;
    double factor = 0;
    if (warning != NULL)
        assert_int_equal(sscanf(warning->text, "the hinges of body 'foam' are about %lf times", &factor), 1);
    return factor;
}

/* value: what the run tells */
static void check_factor(const char *text, double value)
{
    const char *fall[] = {"solver={ method: xpbd, drag: 20 }"}, *rest[] = {"solver={ method: static }"};
    double hinges, plate, told = factor_of(text, fall, 1, &hinges);
    assert_near(told, value, 0.03);
    assert_true(factor_of(text, rest, 1, &plate) == 0);
    /* the shape gives it within 20 % */
    if (fabs(told * hinges / plate - 1) > 0.2 || fabs(told - 1) < 0.15)
        fail_msg("told %g, %g", told, plate / hinges);
}

/* a plate on its rim, and a shelf */
static void test_told(void **unused)
{
    (void)unused;
    double way;
    const char *const plate = FOAM("    pinned: boundary\n    pressure: { outside: 0.2 }\nsolver: { drag: 20 }\n"
                                   "duration: 1\n");
    /* the default has hinges */
    assert_true(factor_of(plate, NULL, 0, &way) > 1.4);
    check_factor(plate, 1.6);
    check_factor(shelf, 0.75);
}

/* what is named, stretches, is curved, folds more sharply than its edges show, or keeps its folds */
static void test_not_told(void **unused)
{
    (void)unused;
    double way;
    const char *heavy[] = {"gravity=[0, 0, -30]", "solver={ method: xpbd, drag: 20 }",
                           "bodies.0.mesh={ shape: grid, nx: 6, ny: 6, size_x: 0.2, size_y: 0.2 }",
                           "bodies.0.pinned={ box: { min: [-1, -1, -1], max: [-0.06, 1, 1] } }"};
    const char *hinge[] = {"bodies.0.bending={ model: hinge }"};
    const char *curved[] = {"bodies.0.mesh={ shape: geodesic-sphere, frequency: 4, radius: 0.1 }",
                            "bodies.0.pinned={ box: { min: [-2, -2, -2], max: [2, 2, 0] } }"};
    const char *const pulled =
        FOAM("    pinned: boundary\n    pressure: { outside: 20 }\nsolver: { drag: 20 }\nduration: 1\n");
    const char *const load = FOAM("    pinned: boundary\nloads: [ { force: [0, 0, -1.0e-3] } ]\n"
                                  "solver: { method: xpbd, drag: 20 }\nduration: 1\n");
    const char *const cloth = "version: 1\nbodies:\n  - name: foam\n    mesh: { shape: grid, nx: 12, ny: 12 }\n"
                              "    membrane: { preset: denim }\n    pinned: { vertices: [0, 12] }\n"
                              "gravity: [0, 0, -9.81]\nsolver: { drag: 2 }\nduration: 1\n";
    const char *const foil =
        "version: 1\nbodies:\n  - name: foam\n    mesh: { shape: grid, nx: 12, ny: 12, size_x: 0.1, size_y: 0.1 }\n"
        "    membrane: { young: 7.0e10, thickness: 5.0e-5 }\n    bending: { yield: 50 }\n    mass: { density: 2700 }\n"
        "    pinned: { box: { min: [-1, -1, -1], max: [-0.04, 1, 1] } }\n"
        "loads: [ { at: { box: { min: [0.045, -1, -1], max: [1, 1, 1] } }, force: [0, 0, 0.05], until: 0.5 } ]\n"
        "duration: 1\n";
    assert_true(factor_of(foil, NULL, 0, &way) == 0 && way > 0.1);
    assert_true(factor_of(pulled, NULL, 0, &way) == 0 && way > 0.005);
    assert_true(factor_of(load, NULL, 0, &way) > 0);
    assert_true(factor_of(load, hinge, 1, &way) == 0 && way > 0);
    assert_true(factor_of(load, curved, 2, &way) == 0 && way > 0);
    assert_true(factor_of(cloth, NULL, 0, &way) == 0 && way > 0.3);
    assert_true(factor_of(shelf, heavy, 2, &way) > 0 && way > 0.2);
    assert_true(factor_of(shelf, heavy, 4, &way) == 0 && way > 0.2);
}

/* a limit: hinges that take another shape than the plate, and store there what a plate would */
static void test_other_shape(void **unused)
{
    (void)unused;
    double hinges, plate;
    const char *rest[] = {"solver={ method: static }"};
    /* three corners held, the fourth pulled */
    const char *const twisted = FOAM("    pinned: { vertices: [0, 12, 156] }\n    mass: { density: 10 }\n"
                                     "loads: [ { force: [0, 0, 1.0e-4], at: { nearest: [0.1, 0.1, 0] } } ]\n"
                                     "solver: { method: xpbd, drag: 20 }\nduration: 2\n");
    assert_true(factor_of(twisted, NULL, 0, &hinges) == 0 && factor_of(twisted, rest, 1, &plate) == 0);
    assert_near(plate / hinges, 2.4, 0.1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_told), cmocka_unit_test(test_not_told),
                                       cmocka_unit_test(test_other_shape)};
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
