/* A minimisation under a tool against the state of rest of methods in time. */
#include "pellicle/shape.h"
#include "pellicle/sim_ledger.h"
#include "sim/descent_fixture.h"
#include "stage/stage.h"

/* of the force, and of the depth of the tool; xpbd is a little softer than its material (pel_sim_softness) */
#define FORCE_TOLERANCE (method == PEL_METHOD_XPBD ? 0.03 : 0.02)
#define PLACE_TOLERANCE 0.02

typedef struct outcome {
    double force, depth, *x;
} outcome;

/* pressed for a second, then at rest; the mean force of the last quarter of the time: in time, contact chatters */
static outcome press_by(pel_method method, double depth, double young)
{
    press_scene scene;
    press_begin(&scene, 5, young);
    press_move(&scene, 1.5, depth);
    scene.keys[2] = scene.keys[1];
    scene.keys[2].time = 2;
    pel_solver_def *solver = &scene.def.solver;
    solver->method = method;
    bool in_time = method != PEL_METHOD_DESCENT;
    /* springs of paper A are slow */
    bool is_slow = young == 0;
    double duration = !in_time ? 1 : is_slow ? 80 : 8;
    solver->drag = !in_time ? 0 : is_slow ? 1 : 4;
    solver->dt = method == PEL_METHOD_EXPLICIT ? is_slow ? 0.01 : 2e-3 : method == PEL_METHOD_XPBD ? 0.01 : 0.1;
    solver->iterations = in_time ? 0 : 400;
    solver->substeps = method == PEL_METHOD_XPBD ? 32 : 0;
    pel_sim *sim = press_create(&scene);
    int steps = (int)(duration / solver->dt + 0.5), last = in_time ? steps / 4 : 1;
    outcome result = {.depth = depth, .x = malloc(3 * (size_t)scene.mesh->vertex_count * sizeof *result.x)};
    for (int n = 1; n <= steps; n++) {
        run_steps(sim, 1);
        if (n > steps - last)
            result.force += reading_of(sim, 0).force[2] / last;
    }
    pel_sim_get_positions(sim, 0, result.x);
    for (int32_t v = 0; v < scene.mesh->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            result.x[3 * v + k] -= scene.mesh->positions[v][k];
    press_end(&scene, sim);
    return result;
}

static void check_against(pel_method method, double young)
{
    const double depth = 0.08;
    outcome still = press_by(PEL_METHOD_DESCENT, depth, young), moved = press_by(method, depth, young);
    pel_mesh *mesh = make_sphere(5);
    assert_true(still.force > 0);
    assert_near(moved.force / still.force, 1, FORCE_TOLERANCE);
    for (int32_t i = 0; i < 3 * mesh->vertex_count; i++)
        assert_near(moved.x[i], still.x[i], PLACE_TOLERANCE * depth);
    pel_mesh_destroy(mesh);
    free(still.x);
    free(moved.x);
}

static void test_shell_against_leapfrog(void **unused)
{
    (void)unused;
    skip_if_slow();
    check_against(PEL_METHOD_EXPLICIT, 1e5);
}

static void test_shell_against_xpbd(void **unused)
{
    (void)unused;
    skip_if_slow();
    /* in float short substeps lose small motions (docs/solvers.md) */
    if (sizeof(pel_real) == 4)
        skip();
    check_against(PEL_METHOD_XPBD, 1e5);
}

static void test_springs_against_leapfrog(void **unused)
{
    (void)unused;
    skip_if_slow();
    check_against(PEL_METHOD_EXPLICIT, 0);
}

/* the reading is of the constrained problem: converged only if the gaps are closed too, with the residual */
static void test_reading(void **unused)
{
    (void)unused;
    for (int32_t iterations = 1; iterations <= 400; iterations += 399) {
        press_scene scene;
        press_begin(&scene, 4, 1e5);
        press_move(&scene, 1.5, 0.1);
        scene.def.solver.iterations = iterations;
        pel_sim *sim = press_create(&scene);
        run_steps(sim, 2);
        pel_solver_reading reading = solver_of(sim);
        rest_state rest = find_rest(sim);
        double square = 0, force = reading_of(sim, 0).force[2];
        for (int32_t v = 0; v < scene.mesh->vertex_count; v++)
            if (!is_pinned(&scene, v) && rest.contact[v] == 0)
                square += pel_vec3_squared_length(rest.force[v]);
        /* where something touches, its load is in the residual as well */
        assert_true(sqrt(square) <= reading.residual * (1 + 1e-6) + LEFT_SHARE * 1e-2 * force);
        assert_int_equal(reading.converged, iterations > 1);
        pel_sim_measures measures;
        pel_sim_measure(sim, &measures);
        assert_near(reading.energy / measures.elastic_energy, 1, sizeof(pel_real) == 4 ? 1e-3 : 1e-6);
        free_rest(&rest);
        press_end(&scene, sim);
    }
}

/* a strip of steel, clamped at one end */
static pel_mesh *make_strip(void)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    def.nx = 48;
    def.ny = 6;
    def.size_x = 1;
    def.size_y = 0.125;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

static pel_model *make_steel(const pel_mesh *mesh, double gravity)
{
    int32_t clamped[40];
    pel_body_def body = pel_body_def_sheet("strip", mesh, 2e11, 1e-3, 7800);
    body.shell.bending.model = PEL_BENDING_HINGE;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (mesh->positions[v][0] < -0.47)
            clamped[body.pinned_count++] = v;
    body.pinned = clamped;
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    def.gravity[2] = gravity;
    pel_model *model;
    assert_int_equal(pel_model_create(&def, &model, NULL), PEL_OK);
    return model;
}

static pel_sim *make_still(const pel_model *model, int32_t iterations)
{
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.solver.method = PEL_METHOD_DESCENT;
    def.solver.iterations = iterations;
    return make_sim(&def);
}

/* a step that says it converged has balanced the weight, however stiff the body is; one that stalls says so */
static void test_convergence_is_relative(void **unused)
{
    (void)unused;
    const double share = sizeof(pel_real) == 4 ? 2e-3 : 1e-6;
    pel_mesh *mesh = make_strip();
    pel_model *model = make_steel(mesh, -9.81);
    pel_sim *sim = make_still(model, 50);
    /* of the weights of the vertices, root of the sum of squares: no more than all of the weight */
    const double weight = 9.81 * 7800 * 1e-3 * 0.125;
    for (int n = 0; n < 5; n++) {
        run_steps(sim, 1);
        pel_solver_reading reading = solver_of(sim);
        /* in float the rounding of the forces at rest is a hundred times the weight: no direction goes down */
        assert_true(reading.iterations > 0 || sizeof(pel_real) == 4);
        assert_true(!reading.converged || reading.residual <= share * weight);
    }
    assert_false(solver_of(sim).converged);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* a body at rest without forces converges immediately, and does not move */
static void test_rest_has_converged(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_strip();
    pel_model *model = make_steel(mesh, 0);
    pel_sim *sim = make_still(model, 50);
    run_steps(sim, 2);
    assert_true(solver_of(sim).converged);
    assert_int_equal(solver_of(sim).iterations, 0);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

/* a grasp alone leaves no gaps to close: the step continues until the forces balance, for any number of rounds */
static void test_grasp_converges(void **unused)
{
    (void)unused;
    press_scene scene;
    press_begin(&scene, 8, 1e5);
    press_move(&scene, 1.3, -0.3);
    scene.tool.press = false;
    scene.tool.grasp = true;
    scene.tool.reach = 1e-3;
    scene.def.solver.iterations = 2;
    pel_sim *sim = press_create(&scene);
    int32_t most = 0;
    for (int n = 0; n < 10; n++) {
        run_steps(sim, 1);
        pel_solver_reading reading = solver_of(sim);
        assert_true(reading.converged);
        most = reading.iterations > most ? reading.iterations : most;
    }
    assert_true(most > 2);
    press_end(&scene, sim);
}

/* without loads a body that comes back is measured by what held it before, also after a snapshot */
static void test_release_converges(void **unused)
{
    (void)unused;
    press_scene scene;
    press_begin(&scene, 4, 0);
    scene.def.tool_count = 0;
    scene.def.solver.iterations = 2000;
    pel_load_def load = pel_load_def_default();
    load.force[2] = -0.5;
    load.until = 0.35;
    scene.def.loads = &load;
    scene.def.load_count = 1;
    pel_sim *sim = press_create(&scene);
    for (int n = 0; n < 8; n++) {
        run_steps(sim, 1);
        assert_true(solver_of(sim).converged);
        if (n == 2 || n == 4)
            sim = resume_sim(sim, &scene.def);
    }
    press_end(&scene, sim);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shell_against_leapfrog),   cmocka_unit_test(test_shell_against_xpbd),
        cmocka_unit_test(test_springs_against_leapfrog), cmocka_unit_test(test_reading),
        cmocka_unit_test(test_convergence_is_relative),  cmocka_unit_test(test_rest_has_converged),
        cmocka_unit_test(test_grasp_converges),          cmocka_unit_test(test_release_converges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
