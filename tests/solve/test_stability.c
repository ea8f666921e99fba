/* Stability limits: the numbers of the theory for paper A's sphere, and that runs just below a limit stay bounded while
   runs just above it grow. */
#include "model/model.h"
#include "pellicle/sim_ledger.h"
#include "sim/fixture.h"
#include "solve/stability.h"
#include "stage/stage.h"

static pel_model *paper_sphere(double k, double d, double volumetric, double volumetric_damping)
{
    pel_mesh *mesh = make_sphere(5);
    pel_body_def body = ball_body(mesh);
    body.spring_stiffness.value = k;
    body.spring_damping.value = d;
    body.volumetric_stiffness.value = volumetric;
    body.volumetric_damping.value = volumetric_damping;
    pel_model *model = make_model(&body);
    pel_mesh_destroy(mesh);
    return model;
}

static pel_stability refined(const pel_model *model)
{
    pel_stability stability;
    pel_stability_bound(model, &stability);
    assert_int_equal(pel_stability_refine(model, &stability, NULL), PEL_OK);
    return stability;
}

/* lambda_max(K)/k = 5.854 by a dense eigenvalue computation of the reference; the estimate lies up to 0.1 % above */
static void test_largest_eigenvalue(void **unused)
{
    (void)unused;
    pel_model *model = paper_sphere(3, 0.5, 0, 0);
    pel_stability stability = refined(model);
    assert_near(stability.stiffness / 3, 5.854, 0.008);
    assert_true(stability.stiffness <= stability.stiffness_bound);
    assert_near(stability.stiffness_bound, 2 * 6 * 3, 1e-9);
    pel_model_destroy(model);
}

static void test_limits_of_the_theory(void **unused)
{
    (void)unused;
    pel_model *model = paper_sphere(3, 0.5, 1.5, 0);
    pel_stability s = refined(model);
    assert_near(pel_stability_alpha(&s, s.stiffness, 0.01, false), 1049, 3);
    assert_near(pel_stability_alpha(&s, s.stiffness, 0.01, true), 168, 1);
    pel_model_destroy(model);
    model = paper_sphere(20, 2, 20, 0);
    s = refined(model);
    assert_near(pel_stability_alpha(&s, s.stiffness, 0.01, false), 146, 0.5);
    assert_near(pel_stability_alpha(&s, s.stiffness, 0.01, true), 37.4, 0.5);
    pel_model_destroy(model);
    model = paper_sphere(3, 0.5, 0, 0);
    s = refined(model);
    assert_near(pel_stability_dt(&s, s.stiffness, false), 0.0285, 2e-4);
    pel_model_destroy(model);
    model = paper_sphere(3, 0, 0, 0);
    s = refined(model);
    assert_near(pel_stability_dt(&s, s.stiffness, true), 0.477, 2e-3);
    pel_model_destroy(model);
}

/* size of the kick, far above rounding and far below what bends the springs, and what rounding leaves of a decayed one
 */
#define KICK (sizeof(pel_real) == 8 ? 1e-9 : 1e-4)
#define ROUNDING (sizeof(pel_real) == 8 ? 1e-12 : 1e-5)

/* largest displacement after steps from a small kick; infinite when the step reports divergence */
static double growth(const pel_model *model, const pel_solver_def *solver, int steps)
{
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver = *solver;
    pel_sim *sim;
    assert_int_equal(pel_sim_create(&def, &sim, NULL), PEL_OK);
    const pel_mesh *mesh = pel_model_mesh(model, 0);
    double *x = malloc(sizeof *mesh->positions * (size_t)mesh->vertex_count);
    for (int i = 0; i < 3 * mesh->vertex_count; i++)
        x[i] = mesh->positions[i / 3][i % 3] + KICK * sin(1.7 * i * i);
    assert_int_equal(pel_sim_set_positions(sim, 0, x, NULL), PEL_OK);
    free(x);
    pel_sim_measures measures = {.max_displacement = HUGE_VAL};
    pel_status status = PEL_OK;
    for (int n = 0; status == PEL_OK && n < steps; n++)
        status = pel_sim_step(sim, NULL);
    if (status == PEL_OK)
        pel_sim_measure(sim, &measures);
    pel_sim_destroy(sim);
    return measures.max_displacement;
}

static void check_refused(const pel_model *model, const pel_solver_def *solver, const char *word)
{
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver = *solver;
    pel_sim *sim;
    pel_error error;
    assert_int_equal(pel_sim_create(&def, &sim, &error), PEL_UNSTABLE);
    assert_null(sim);
    assert_non_null(strstr(error.what, word));
    assert_non_null(strstr(error.what, "limit"));
}

static void test_alpha_is_refused_at_the_limit_and_stable_below(void **unused)
{
    (void)unused;
    pel_model *model = paper_sphere(3, 0.5, 1.5, 0.5);
    pel_solver_def solver = {.method = PEL_METHOD_QUASI_STATIC, .dt = 0.01, .alpha = 1040};
    assert_true(growth(model, &solver, 3000) < 10 * KICK);
    solver.alpha = 1060;
    check_refused(model, &solver, "alpha");
    solver.alpha = 0;
    assert_true(growth(model, &solver, 3000) < ROUNDING);
    solver.keep_velocity = true;
    assert_true(growth(model, &solver, 3000) < ROUNDING);
    pel_model_destroy(model);
}

/* the radial damping d' counts fully for v kept: just beyond the limit with it, a run grows */
static void test_kept_velocity_limit_is_real(void **unused)
{
    (void)unused;
    pel_model *model = paper_sphere(0, 0.5, 1.5, 0.5);
    pel_stability s = refined(model);
    double limit = pel_stability_alpha(&s, s.stiffness, 0.01, true);
    pel_solver_def solver = {
        .method = PEL_METHOD_QUASI_STATIC, .dt = 0.01, .alpha = 0.99 * limit, .keep_velocity = true};
    assert_true(growth(model, &solver, 5000) < 10 * KICK);
    solver.alpha = 1.01 * limit;
    check_refused(model, &solver, "alpha");
    pel_model_destroy(model);
}

static void test_explicit_limits(void **unused)
{
    (void)unused;
    pel_model *model = paper_sphere(3, 0.5, 1.5, 0);
    pel_stability s = refined(model);
    pel_solver_def solver = {.method = PEL_METHOD_EXPLICIT};
    for (int symplectic = 0; symplectic < 2; symplectic++) {
        double limit = pel_stability_dt(&s, s.stiffness, symplectic);
        solver.symplectic = symplectic;
        solver.dt = 0.98 * limit;
        assert_true(growth(model, &solver, 4000) < 100 * KICK);
        solver.dt = 1.02 * limit;
        check_refused(model, &solver, "dt");
    }
    pel_model_destroy(model);
    model = paper_sphere(3, 0, 0, 0);
    solver = (pel_solver_def){.method = PEL_METHOD_EXPLICIT, .dt = 1e-6};
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver = solver;
    pel_sim *sim;
    pel_error error;
    assert_int_equal(pel_sim_create(&def, &sim, &error), PEL_UNSTABLE);
    assert_non_null(strstr(error.what, "every dt"));
    pel_model_destroy(model);
}

/* Euler's method on one overdamped spring, x'' = -k x - c x': decays below the limit, grows above it */
static void test_overdamped_limit(void **unused)
{
    (void)unused;
    const double stiffness = 4, drags[3] = {4.1, 10, 300};
    for (int i = 0; i < 3; i++) {
        const pel_stability stability = {.drag = drags[i], .radial_drag = drags[i]};
        double limit = pel_stability_dt(&stability, stiffness, false);
        for (int side = -1; side <= 1; side += 2) {
            double dt = (1 + 0.01 * side) * limit, x = 1, v = -1;
            for (int n = 0; n < 20000 && fabs(x) < 1e6; n++) {
                double force = -stiffness * x - drags[i] * v;
                x += dt * v;
                v += dt * force;
            }
            assert_true(side < 0 ? fabs(x) < 1 : fabs(x) >= 1e6);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_largest_eigenvalue),
        cmocka_unit_test(test_limits_of_the_theory),
        cmocka_unit_test(test_alpha_is_refused_at_the_limit_and_stable_below),
        cmocka_unit_test(test_kept_velocity_limit_is_real),
        cmocka_unit_test(test_explicit_limits),
        cmocka_unit_test(test_overdamped_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
