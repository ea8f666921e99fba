/* The explicit method under a tool: the force is that of equilibrium and does not chatter; blows, depths, pinned
 * borders. */
#include "math/vec3.h"
#include "pellicle/shape.h"
#include "pellicle/sim_ledger.h"
#include "pellicle/sim_reading.h"
#include "sim/fixture.h"

#define RADIUS 0.2

/* A square drum with a pinned border, of 1 mm of a material of 1 MPa, and a ball that presses it by 7 cm beside its
   middle; or, with a speed, a free sheet that flies against the ball. */
static stage make_drum(double radius, double speed, pel_method method, double dt, bool contact)
{
    stage s;
    const pel_pose_key keys[2] = {{0, {0.01, 0.02, radius + 0.005}, {0, 0, 0, 1}, {0}},
                                  {0.3, {0.01, 0.02, radius + (speed > 0 ? 0.005 : -0.07)}, {0, 0, 0, 1}, {0}}};
    pel_shape_def grid = pel_shape_def_default(PEL_SHAPE_GRID);
    grid.nx = grid.ny = 12;
    grid.diagonals = PEL_GRID_UNION_JACK;
    assert_int_equal(pel_shape_create(&grid, &s.mesh, NULL), PEL_OK);
    pel_body_def body = pel_body_def_sheet("sheet", s.mesh, 1e6, 0.001, 300);
    body.shell.membrane.poisson = 0.3;
    int32_t border[48], count = 0;
    for (int32_t v = 0; v < s.mesh->vertex_count; v++)
        if (fmax(fabs(s.mesh->positions[v][0]), fabs(s.mesh->positions[v][1])) > 0.499)
            border[count++] = v;
    body.pinned = border;
    body.pinned_count = speed > 0 ? 0 : count;
    body.velocity[2] = speed;
    s.model = make_model(&body);
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "ball";
    tool.radius = radius;
    tool.keys = keys;
    tool.key_count = 2;
    pel_sim_def def = lone_sim(s.model, method, dt);
    def.solver.symplectic = true;
    def.solver.drag = method == PEL_METHOD_EXPLICIT && !(speed > 0) ? 20 : 0;
    def.tools = &tool;
    def.tool_count = 1;
    def.contact.enabled = contact;
    s.sim = make_sim(&def);
    return s;
}

/* within 3 % of equilibrium in each step, for balls of a few and of many cells, with contact and without */
static void test_drum(void **unused)
{
    (void)unused;
    for (int i = 0; i < 4; i += ROUNDS(1, 3)) {
        const double radius = i % 2 == 0 ? RADIUS : RADIUS / 2, dt = 2e-4;
        pel_tool_reading reading;
        stage still = make_drum(radius, 0, PEL_METHOD_STATIC, 0.05, i / 2 == 1);
        run_steps(still.sim, 7);
        pel_sim_get_tool(still.sim, 0, &reading);
        const double expected = reading.force[2];
        end_stage(&still);
        stage s = make_drum(radius, 0, PEL_METHOD_EXPLICIT, dt, i / 2 == 1);
        run_steps(s.sim, (int)(0.8 / dt));
        double least = HUGE_VAL, most = 0, sum = 0;
        for (int n = 0; n < 200; n++) {
            run_steps(s.sim, 1);
            pel_sim_get_tool(s.sim, 0, &reading);
            least = fmin(least, reading.force[2]);
            most = fmax(most, reading.force[2]);
            sum += reading.force[2] / 200;
        }
        print_message("ball of %g m: %.4f to %.4f N, mean %.4f, equilibrium %.4f\n", radius, least, most, sum,
                      expected);
        assert_near(sum, expected, 0.01 * expected);
        assert_true(least > 0.97 * expected && most < 1.03 * expected);
        end_stage(&s);
    }
}

/* a free sheet that flies at 2 m/s against a ball: impulses take energy and give none */
static void test_blow(void **unused)
{
    (void)unused;
    stage s = make_drum(RADIUS, 2, PEL_METHOD_EXPLICIT, 2e-4, false);
    pel_sim_ledger ledger;
    double start = 0, most = 0;
    for (int n = 0; n < 500; n++) {
        run_steps(s.sim, 1);
        pel_sim_get_ledger(s.sim, &ledger);
        start = n == 0 ? ledger.kinetic + ledger.elastic : start;
        most = fmax(most, ledger.kinetic + ledger.elastic);
    }
    print_message("energy: %.6f J at first, %.6f at most\n", start, most);
    assert_true(start > 0.5 && most < 1.001 * start);
    end_stage(&s);
}

/* A blade of 4 mm that is pressed by `depth` into a drum along its border of pinned vertices, where these hold all but
   1 to 6 % of the points below it: it stays in there, since free vertices would be thrown by more than 100 times the
   depth. */
static double press_border(pel_method method, double depth)
{
    stage s = make_drum(RADIUS, 0, method, 1e-3, false);
    const pel_pose_key keys[2] = {{0, {0, -0.497, 0.007}, {0, 0, 0, 1}, {0}},
                                  {0.01, {0, -0.497, 0.002 - depth}, {0, 0, 0, 1}, {0}}};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "blade";
    tool.shape = PEL_TOOL_BOX;
    pel_vec3_set(tool.half_extents, 1, 0.002, 0.002);
    tool.keys = keys;
    tool.key_count = 2;
    pel_sim_destroy(s.sim);
    pel_sim_def def = lone_sim(s.model, method, 1e-4);
    def.solver.symplectic = true;
    def.tools = &tool;
    def.tool_count = 1;
    s.sim = make_sim(&def);
    run_steps(s.sim, 120);
    double x[169][3], most = 0;
    assert_int_equal(s.mesh->vertex_count, 169);
    pel_sim_get_positions(s.sim, 0, &x[0][0]);
    for (int32_t v = 0; v < 169; v++) {
        assert_true(isfinite(x[v][2]));
        most = fmax(most, pel_vec3_distance(x[v], s.mesh->positions[v]));
    }
    end_stage(&s);
    return most;
}

static void test_pinned_border(void **unused)
{
    (void)unused;
    const pel_method methods[] = {PEL_METHOD_EXPLICIT, PEL_METHOD_QUASI_STATIC};
    for (int i = 0; i < 2; i++) {
        const double depth = 0.001, most = press_border(methods[i], depth);
        print_message("pressed by %g m, moved by %g\n", depth, most);
        assert_true(most < 10 * depth);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_drum), cmocka_unit_test(test_blow),
                                       cmocka_unit_test(test_pinned_border)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
