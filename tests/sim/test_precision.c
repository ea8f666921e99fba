/* Answers that the precision of the state must not change: numbers here are those of a build in double. */
#include "pellicle/shape.h"
#include "pellicle/sim_ledger.h"
#include "shell_fixture.h"
#include "sim/fixture.h"
#include "stage/stage.h"

/* a clamped strip of steel, 10 cm long and half a millimetre thick */
typedef struct strip {
    stage s;
    int32_t pinned[8];
    pel_body_def body;
} strip;

enum { CELLS = 24, ROWS = 2 };

static void make_strip(strip *on, pel_method method, double dt, double gravity, pel_sim_def *def)
{
    memset(on, 0, sizeof *on);
    on->s.mesh = make_grid(CELLS, ROWS, 0.1, 0.0125, PEL_GRID_UNION_JACK);
    on->body = shell_body(on->s.mesh, PEL_MEMBRANE_STVK);
    on->body.mass_kind = PEL_MASS_DENSITY;
    on->body.mass = 7850;
    on->body.thickness.value = on->body.shell.membrane.thickness.value = 5e-4;
    on->body.shell.membrane.young.value = 2.1e11;
    on->body.shell.membrane.poisson = 0.3;
    on->body.shell.bending.model = PEL_BENDING_HINGE;
    for (int32_t v = 0; v < on->s.mesh->vertex_count; v++)
        if (on->s.mesh->positions[v][0] < -0.0455)
            on->pinned[on->body.pinned_count++] = v;
    assert_int_equal(on->body.pinned_count, 2 * (ROWS + 1));
    on->body.pinned = on->pinned;
    pel_model_def model = pel_model_def_default();
    model.bodies = &on->body;
    model.body_count = 1;
    pel_vec3_set(model.gravity, 0, 0, -gravity);
    assert_int_equal(pel_model_create(&model, &on->s.model, NULL), PEL_OK);
    *def = lone_sim(on->s.model, method, dt);
}

static double largest_displacement(pel_sim *sim)
{
    pel_sim_measures now;
    pel_sim_measure(sim, &now);
    return now.max_displacement;
}

/* float positions strain the strip by more than its weight does: the balance is found in double */
static void test_weight(void **unused)
{
    (void)unused;
    for (int k = 0; k < 2; k++) {
        strip on;
        pel_sim_def def;
        pel_solver_reading solver;
        make_strip(&on, k == 0 ? PEL_METHOD_DESCENT : PEL_METHOD_STATIC, 1, 9.81, &def);
        def.solver.iterations = 2000;
        on.s.sim = make_sim(&def);
        run_steps(on.s.sim, 2);
        pel_sim_get_solver(on.s.sim, &solver);
        pel_support_reading support;
        pel_sim_get_support(on.s.sim, 0, &support);
        assert_true(solver.converged);
        assert_near(largest_displacement(on.s.sim), 2.59869e-4, 1e-4 * 2.59869e-4);
        assert_near(support.force[2], -0.0481303, 1e-5 * 0.0481303);
        end_stage(&on.s);
    }
}

/* a grasp moves its end at once: nothing has acted before, and only rounding in double may be left */
static void test_grasp(void **unused)
{
    (void)unused;
    strip on;
    pel_sim_def def;
    make_strip(&on, PEL_METHOD_DESCENT, 1, 0, &def);
    const pel_pose_key keys[2] = {{0, {0.05, 0, 0}, {0, 0, 0, 1}, {0}}, {1, {0.05, 0, 0.001}, {0, 0, 0, 1}, {0}}};
    pel_tool_def tool = pel_tool_def_default();
    pel_tool_reading grip;
    tool.name = "grip";
    tool.shape = PEL_TOOL_BOX;
    pel_vec3_set(tool.half_extents, 0.001, 0.1, 0.01);
    tool.press = false;
    tool.grasp = true;
    tool.keys = keys;
    tool.key_count = 2;
    def.tools = &tool;
    def.tool_count = 1;
    def.solver.iterations = 2000;
    on.s.sim = make_sim(&def);
    run_steps(on.s.sim, 1);
    pel_sim_get_tool(on.s.sim, 0, &grip);
    assert_near(grip.force[0], -76.7868, 1e-4 * 76.7868);
    assert_near(grip.force[2], -0.952404, 1e-4 * 0.952404);
    end_stage(&on.s);
}

/* the energy that the midpoint rule makes in the first step is found, although it is less than rounding of positions */
static void test_first_step(void **unused)
{
    (void)unused;
    strip on;
    pel_sim_def def;
    make_strip(&on, PEL_METHOD_IMPLICIT, 0.01, 9.81, &def);
    on.s.sim = make_sim(&def);
    run_steps(on.s.sim, 1);
    assert_true(on.s.sim->state->unresolved > 0);
    run_steps(on.s.sim, 4);
    assert_near(largest_displacement(on.s.sim), 4.15371e-4, 1e-4 * 4.15371e-4);
    end_stage(&on.s);
}

/* far from the origin, where positions round to half a micrometre */
static void test_rest(void **unused)
{
    (void)unused;
    strip on;
    pel_sim_def def;
    pel_sim_measures now;
    make_strip(&on, PEL_METHOD_STATIC, 1, 0, &def);
    pel_model_destroy(on.s.model);
    for (int32_t v = 0; v < on.s.mesh->vertex_count; v++)
        on.s.mesh->positions[v][0] += 5;
    on.s.model = make_model(&on.body);
    def.model = on.s.model;
    on.s.sim = make_sim(&def);
    pel_sim_measure(on.s.sim, &now);
    assert_true(now.membrane_energy < 1e-8); /* J; rounding of positions alone would be 1e-3 */
    end_stage(&on.s);
}

/* a ball of skin that stands on pins */
static void make_ball(int32_t frequency, double radius, const char *name, pel_body_def *body, int32_t pinned[400])
{
    pel_mesh *mesh = make_sphere(frequency);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        pel_vec3_scale(mesh->positions[v], radius, mesh->positions[v]);
    *body = shell_body(mesh, PEL_MEMBRANE_STVK);
    body->name = name;
    body->mass_kind = PEL_MASS_DENSITY;
    body->mass = 1100;
    body->thickness.value = body->shell.membrane.thickness.value = 0.0015;
    body->shell.membrane.young.value = 1.29e5;
    body->shell.membrane.poisson = 0.48;
    body->shell.bending.model = PEL_BENDING_HINGE;
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        if (mesh->positions[v][2] < -0.6 * radius)
            pinned[body->pinned_count++] = v;
    assert_true(body->pinned_count < 400);
    body->pinned = pinned;
}

/* A rod presses a ball onto another one inside it. Rounded gaps would hide from the line search what a step gains:
   steps would be halved without end in sight. */
static void test_layers(void **unused)
{
    (void)unused;
    skip_if_slow();
    int32_t pinned[2][400];
    pel_body_def bodies[2];
    make_ball(8, 0.02, "outer", &bodies[0], pinned[0]);
    make_ball(7, 0.0195, "inner", &bodies[1], pinned[1]);
    pel_model_def model_def = pel_model_def_default();
    pel_model *model;
    model_def.bodies = bodies;
    model_def.body_count = 2;
    assert_int_equal(pel_model_create(&model_def, &model, NULL), PEL_OK);
    pel_sim_def def = lone_sim(model, PEL_METHOD_IMPLICIT, 0.01);
    pel_tool_def tool = pel_tool_def_default();
    const double half = sqrt(0.5);
    const pel_pose_key keys[2] = {{0, {0, 0, 0.0243}, {0, half, 0, half}, {0}},
                                  {0.2, {0, 0, 0.0193}, {0, half, 0, half}, {0}}};
    tool.name = "rod";
    tool.shape = PEL_TOOL_CAPSULE;
    tool.radius = 0.004;
    tool.half_length = 0.02;
    tool.keys = keys;
    tool.key_count = 2;
    def.tools = &tool;
    def.tool_count = 1;
    def.contact.enabled = true;
    pel_sim *sim = make_sim(&def);
    int iterations = 0;
    pel_tool_reading rod;
    for (int n = 0; n < 9; n++) {
        pel_solver_reading solver;
        run_steps(sim, 1);
        pel_sim_get_solver(sim, &solver);
        assert_true(solver.converged);
        iterations += solver.iterations;
    }
    pel_sim_get_tool(sim, 0, &rod);
    /* a step ends when forces of contacts change by less than 5e-3 */
    assert_near(rod.force[2], 0.096815, 5e-3 * 0.096815);
    assert_true(iterations < 130); /* 65 in double */
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    for (int b = 0; b < 2; b++)
        pel_mesh_destroy((pel_mesh *)(uintptr_t)bodies[b].mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_weight), cmocka_unit_test(test_grasp),  cmocka_unit_test(test_first_step),
        cmocka_unit_test(test_rest),   cmocka_unit_test(test_layers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
