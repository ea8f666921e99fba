/* A refined zone follows a tool and lets go of what it has left, within a second. */
#include "sim/refine_fixture.h"

typedef enum ground { BALL, SHEET } ground;

static pel_mesh *make_ground(ground what)
{
    pel_shape_def def = pel_shape_def_default(what == BALL ? PEL_SHAPE_GEODESIC_SPHERE : PEL_SHAPE_GRID);
    def.frequency = 12;
    def.nx = def.ny = 30;
    def.size_x = def.size_y = 3;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

enum { PATH = 61, SECOND = 100 };

/* the centre of a ball of radius 0.2 that dips 3 cm into the ground and slides along it for 3 s */
static void slide_path(ground what, pel_pose_key keys[PATH])
{
    for (int k = 0; k < PATH; k++) {
        double s = (double)k / (PATH - 1), lift = k == 0 ? 0.21 : 0.17, angle = -0.6 + 1.2 * s;
        keys[k] = (pel_pose_key){3 * s, {0, 0, lift}, {0, 0, 0, 1}, {0, 0, 0}};
        keys[k].position[0] = what == BALL ? (1 + lift) * sin(angle) : -1 + 2 * s;
        keys[k].position[2] = what == BALL ? (1 + lift) * cos(angle) : lift;
    }
}

/* distance of a point from where the tool was during the last second */
static double path_distance(double path[][3], int step, const double x[3])
{
    double least = HUGE_VAL;
    for (int n = step < SECOND ? 0 : step - SECOND; n <= step; n++)
        least = fmin(least, pel_vec3_distance(path[n], x));
    return least;
}

static void slide(ground what, double above, double near_tools, bool contact)
{
    pel_mesh *mesh = make_ground(what);
    pel_body_def body = ball(mesh, 2);
    body.refine.above = above;
    body.refine.below = above / 2;
    body.refine.near_tools = near_tools;
    pel_pose_key keys[PATH];
    slide_path(what, keys);
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "ball";
    tool.radius = 0.2;
    tool.keys = keys;
    tool.key_count = PATH;
    pel_sim_def def = pel_sim_def_default();
    def.tools = &tool;
    def.tool_count = 1;
    def.contact.enabled = contact;
    bench made = begin(mesh, &body, &def);
    static double path[400][3], x[3 * 200000];
    double farthest = 0;
    int32_t most = 0;
    for (int n = 0; n < 300; n++) {
        pel_tool_reading reading;
        run_steps(made.sim, 1);
        pel_sim_get_tool(made.sim, 0, &reading);
        memcpy(path[n], reading.position, sizeof path[n]);
        int32_t count = pel_sim_vertex_count(made.sim, 0);
        most = count > most ? count : most;
        pel_sim_get_positions(made.sim, 0, x);
        for (int32_t v = mesh->vertex_count; v < count; v++)
            farthest = fmax(farthest, path_distance(path, n, &x[3 * v]));
    }
    assert_true(most > mesh->vertex_count + 200);
    /* radius, 1.25 x near_tools, two rings and their transition */
    assert_true(farthest < (what == BALL ? 0.5 : 0.65));
    print_message("%s, above %g, near %g, contact %d: %d vertices more, up to %.2f m from the path of a second\n",
                  what == BALL ? "ball" : "sheet", above, near_tools, contact, (int)(most - mesh->vertex_count),
                  farthest);
    end(&made);
}

static void test_force(void **unused)
{
    (void)unused;
    slide(BALL, 1, 0, false);
    slide(SHEET, 0.5, 0, false);
}

static void test_near_tools(void **unused)
{
    (void)unused;
    slide(BALL, 0, 0.05, false);
    slide(SHEET, 0, 0.05, false);
}

static void test_both(void **unused)
{
    (void)unused;
    skip_if_long();
    slide(BALL, 0.5, 0.05, true);
    slide(SHEET, 0.5, 0.05, true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_force),
        cmocka_unit_test(test_near_tools),
        cmocka_unit_test(test_both),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
