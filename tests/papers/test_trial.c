#include "check.h"

#include "papers/lab/trial.h"
#include "pellicle/sim_surface.h"

static const char ball[] = "version: 1\n"
                           "bodies:\n"
                           "  - { mesh: { shape: geodesic-sphere, frequency: 2 }, preset: paper-a }\n"
                           "solver: { method: quasi-static, dt: 0.01 }\n"
                           "duration: 1\n";

static void test_steps(void **unused)
{
    (void)unused;
    static const char *const overrides[] = {"bodies.0.mesh.frequency=3", "solver.dt=0.02", NULL};
    pel_error error;
    lab_trial trial;
    assert_int_equal(lab_open_trial("ball", ball, overrides, &trial, &error), PEL_OK);
    assert_int_equal(pel_sim_triangle_count(trial.sim, 0), 20 * 9);
    assert_int_equal(lab_step_trial(&trial, 5, &error), PEL_OK);
    assert_near(pel_sim_time(trial.sim), 0.1, 1e-12);
    lab_close_trial(&trial);
    assert_int_equal(lab_open_trial("ball", ball, NULL, &trial, &error), PEL_OK);
    assert_int_equal(pel_sim_triangle_count(trial.sim, 0), 20 * 4);
    lab_close_trial(&trial);
}

static void test_bad_scene(void **unused)
{
    (void)unused;
    static const char *const overrides[] = {"solver.dt=-1", NULL};
    pel_error error;
    lab_trial trial;
    assert_int_not_equal(lab_open_trial("ball", ball, overrides, &trial, &error), PEL_OK);
    assert_true(trial.model == NULL && trial.sim == NULL);
    lab_close_trial(&trial);
}

static void test_count(void **unused)
{
    (void)unused;
    static const char *const two[] = {"a", "b", NULL, "c"};
    assert_int_equal(lab_count_overrides(NULL), 0);
    assert_int_equal(lab_count_overrides(two), 2);
    assert_int_equal(lab_count_overrides(two + 2), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_steps),
        cmocka_unit_test(test_bad_scene),
        cmocka_unit_test(test_count),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
