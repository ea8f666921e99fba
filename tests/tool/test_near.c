/* Lists of near triangles that are kept over many steps, beside a look at every triangle and beside new lists. */
#include "random.h"
#include "sim/refine_fixture.h"
#include "stage/surface_view.h"
#include "tool/near.h"

static const pel_pose_key above = {0, {0.1, 0, 1.5}, {0, 0, 0, 1}, {0, 0, 0}};

static pel_tool_def make_tool(pel_tool_shape shape)
{
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "tool";
    tool.shape = shape;
    tool.radius = 0.4;
    tool.half_length = 0.1;
    for (int i = 0; i < 3; i++)
        tool.half_extents[i] = 0.3;
    tool.keys = &above;
    tool.key_count = 1;
    return tool;
}

static bench make_scene(const pel_tool_def *tool, int32_t levels)
{
    pel_mesh *mesh = make_sphere(6);
    pel_body_def body = ball(mesh, levels);
    if (levels > 0)
        body.refine.near_tools = 0.3;
    pel_sim_def def = pel_sim_def_default();
    def.tools = tool;
    def.tool_count = 1;
    return begin(mesh, &body, &def);
}

/* the result of a list beside that of all triangles; returns how many are near */
static int32_t compare(pel_sim *sim, pel_near_list *list, double margin)
{
    const pel_search_box box = pel_tool_box(&sim->tools->items[0], sim->tools->items[0].press_margin, margin);
    const pel_record *x = sim->state->position;
    int32_t count = pel_tool_near_triangles(sim, &sim->tools->items[0], list, x, margin), expected = 0;
    for (int32_t t = 0; t < sim->model->triangle_count; t++) {
        const pel_search_box around = pel_search_triangle(x, sim->model->triangles[t]);
        if (pel_search_apart(&around, &box))
            continue;
        assert_true(expected < count);
        assert_int_equal(sim->tools->near_triangles[expected++], t);
    }
    assert_int_equal(count, expected);
    return count;
}

/* The surface trembles and the tool glides, in steps of all sizes; two lists have different margins. */
static void compare_steps(pel_tool_shape shape)
{
    const pel_tool_def tool = make_tool(shape);
    bench made = make_scene(&tool, 0);
    random_state random = {17};
    pel_sim *sim = made.sim;
    const double home[3] = {0, 0.1, 1.2};
    double place[3] = {0.1, 0, 1.5}; /* of the tool beside the surface */
    int32_t near = 0;
    enum { STEPS = 2000 };
    for (int n = 0; n < STEPS; n++) {
        double stride = pow(10, random_between(&random, -5, -1.3));
        /* half of the steps move the surface alone, half the tool alone */
        double shift[3];
        for (int c = 0; c < 3; c++)
            shift[c] = stride * random_between(&random, -1, 1) - 0.01 * (place[c] - home[c]);
        for (int32_t v = 0; n % 2 == 0 && v < sim->model->vertex_count; v++)
            for (int c = 0; c < 3; c++)
                sim->state->position[v][c] -= (pel_real)(shift[c] * random_between(&random, 0.9, 1.1));
        for (int c = 0; c < 3; c++) {
            place[c] += shift[c];
            sim->tools->items[0].pose.position[c] += n % 2 == 0 ? 0 : shift[c];
        }
        near += compare(sim, &sim->tools->items[0].near, 0.1);
        near += compare(sim, &sim->tools->items[0].in_reach, 0.2);
    }
    assert_true(near > 40 * STEPS);
    /* they are made in few of the steps */
    assert_in_range(sim->tools->search->fit_count, 10, STEPS / 5);
    end(&made);
}

static void test_sphere(void **unused)
{
    (void)unused;
    compare_steps(PEL_TOOL_SPHERE);
}

static void test_capsule(void **unused)
{
    (void)unused;
    compare_steps(PEL_TOOL_CAPSULE);
}

static void test_box(void **unused)
{
    (void)unused;
    compare_steps(PEL_TOOL_BOX);
}

/* a vertex alone moves across the whole box of a list, and back */
static void test_vertex(void **unused)
{
    (void)unused;
    const pel_tool_def tool = make_tool(PEL_TOOL_SPHERE);
    bench made = make_scene(&tool, 0);
    pel_sim *sim = made.sim;
    int32_t bottom = nearest_vertex(made.mesh, 0, 0, -1), v = pel_output_model_index(sim, 0, bottom);
    compare(sim, &sim->tools->items[0].near, 0.1);
    int32_t before = compare(sim, &sim->tools->items[0].near, 0.1);
    sim->state->position[v][2] = (pel_real)1.2;
    assert_true(compare(sim, &sim->tools->items[0].near, 0.1) > before);
    sim->state->position[v][2] = -1;
    assert_int_equal(compare(sim, &sim->tools->items[0].near, 0.1), before);
    end(&made);
}

/* steps have the same bits with lists that are kept and with new ones, whether the surface changes or not */
static void compare_bits(int32_t levels)
{
    const pel_tool_def tool = make_tool(PEL_TOOL_SPHERE);
    bench made[2] = {make_scene(&tool, levels), make_scene(&tool, levels)};
    const double upright[4] = {0, 0, 0, 1};
    int32_t touched = 0;
    for (int n = 0; n < 120; n++) {
        const double place[3] = {0.1 + 0.002 * n, 0, 1.5 - 0.4 * sin(0.03 * n)};
        for (int i = 0; i < 2; i++) {
            assert_int_equal(pel_sim_set_tool_pose(made[i].sim, 0, place, upright, NULL), PEL_OK);
            assert_int_equal(pel_sim_step(made[i].sim, NULL), PEL_OK);
        }
        touched += made[0].sim->tools->items[0].contact_count;
        made[1].sim->tools->search->is_fitted = false;
        made[1].sim->tools->items[0].near.fit = 0;
        assert_true(pel_sim_hash(made[0].sim) == pel_sim_hash(made[1].sim));
    }
    assert_true(touched > 100);
    if (levels == 0)
        assert_in_range(made[0].sim->tools->search->fit_count, 2, 40);
    for (int i = 0; i < 2; i++)
        end(&made[i]);
}

static void test_bits(void **unused)
{
    (void)unused;
    compare_bits(0);
    compare_bits(2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere), cmocka_unit_test(test_capsule), cmocka_unit_test(test_box),
        cmocka_unit_test(test_vertex), cmocka_unit_test(test_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
