/* Pieces that come off under a static method: they stay, the rest is in balance, and nothing else is held. */
#include "failing_malloc.h"
#include "pellicle/sim_reading.h"
#include "sim/cut_fixture.h"
#include "tear/loose.h"

enum { CELLS = 10, ROW = CELLS + 1 };

typedef struct sheet {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
} sheet;

/* m, a sheet of 1 x 1 that hangs from its upper border */
static sheet make_sheet(pel_method method, pel_tool_def *tool)
{
    static int32_t pins[ROW];
    sheet s = {.mesh = make_grid(CELLS, CELLS, 1, 1, PEL_GRID_UNION_JACK)};
    pel_body_def body = pel_body_def_sheet("sheet", s.mesh, 1e6, 1e-3, 1000);
    body.pinned = pins;
    for (int32_t v = 0; v < s.mesh->vertex_count; v++)
        if (s.mesh->positions[v][1] > 0.499)
            pins[body.pinned_count++] = v;
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    def.gravity[1] = -9.81;
    assert_int_equal(pel_model_create(&def, &s.model, NULL), PEL_OK);
    pel_sim_def sim = lone_sim(s.model, method, 0.1);
    sim.tools = tool;
    sim.tool_count = tool != NULL;
    s.sim = make_sim(&sim);
    return s;
}

static void end_sheet(sheet *s)
{
    pel_sim_destroy(s->sim);
    pel_model_destroy(s->model);
    pel_mesh_destroy(s->mesh);
}

/* from side to side at a height of the grid */
static void cut_across(const sheet *s, int32_t row)
{
    int32_t path[ROW];
    pel_error error;
    for (int32_t i = 0; i < ROW; i++)
        path[i] = row * ROW + i;
    if (pel_cut(s->sim, 0, path, ROW, &error) != PEL_OK)
        fail_msg("%s", error.what);
}

static void step(const sheet *s, bool has_to_converge)
{
    pel_error error;
    pel_solver_reading reading;
    if (pel_sim_step(s->sim, &error) != PEL_OK)
        fail_msg("%s", error.what);
    pel_sim_get_solver(s->sim, &reading);
    assert_true(reading.converged || !has_to_converge);
}

static int32_t count_loose(const pel_sim *sim)
{
    int32_t count = 0;
    for (int32_t v = 0; sim->loose != NULL && v < sim->model->vertex_count; v++)
        count += sim->loose[v];
    return count;
}

/* N, of the pins */
static double pull_of(pel_sim *sim)
{
    pel_support_reading reading;
    pel_sim_get_support(sim, 0, &reading);
    return fabs(reading.force[1]);
}

/* the pins carry the weight of what hangs on them, less with each piece that comes off, and the pieces stay */
static void stays(void **unused)
{
    (void)unused;
    const double weight = 1000 * 1e-3 * 9.81;
    sheet s = make_sheet(PEL_METHOD_STATIC, NULL);
    step(&s, true);
    assert_int_equal(pel_loose_body(s.sim), -1);
    for (int32_t row = 3, pieces = 1; row < 9; row += 3, pieces++) {
        cut_across(&s, row);
        int32_t count = pel_sim_vertex_count(s.sim, 0);
        assert_int_equal(count_loose(s.sim), row * ROW + pieces * ROW);
        assert_int_equal(pel_loose_body(s.sim), 0);
        double *before = calloc((size_t)count, 24), *after = calloc((size_t)count, 24);
        pel_sim_get_positions(s.sim, 0, before);
        for (int i = 0; i < 3; i++)
            step(&s, true);
        pel_sim_get_positions(s.sim, 0, after);
        for (int32_t v = 0; v < count; v++)
            for (int c = 0; c < 3 && s.sim->loose[s.sim->model->bodies[0].model_index[v]]; c++)
                assert_true(before[3 * v + c] == after[3 * v + c]);
        assert_near(pull_of(s.sim), weight * (CELLS - row) / CELLS, 1e-6 * weight);
        free(before);
        free(after);
    }
    end_sheet(&s);
}

static void returns(void **unused)
{
    (void)unused;
    static unsigned char kept[1 << 18];
    sheet s = make_sheet(PEL_METHOD_STATIC, NULL), other = make_sheet(PEL_METHOD_STATIC, NULL);
    step(&s, true);
    cut_across(&s, 5);
    size_t size = pel_sim_save_size(s.sim);
    assert_true(size <= sizeof kept);
    pel_sim_save(s.sim, kept);
    step(&s, true);
    assert_int_equal(pel_sim_load(other.sim, kept, size, NULL), PEL_OK);
    step(&other, true);
    assert_int_equal(count_loose(other.sim), count_loose(s.sim));
    assert_true(pel_sim_hash(other.sim) == pel_sim_hash(s.sim));
    end_sheet(&s);
    end_sheet(&other);
}

/* a method in which pieces move, and a tool that may hold one */
static void leaves_alone(void **unused)
{
    (void)unused;
    sheet s = make_sheet(PEL_METHOD_IMPLICIT, NULL);
    cut_across(&s, 5);
    assert_null(s.sim->loose);
    end_sheet(&s);
    const pel_pose_key key = {.position = {0, -0.5, 0}, .rotation = {0, 0, 0, 1}};
    pel_tool_def tool = pel_tool_def_default();
    tool.name = "hand";
    tool.radius = 0.15;
    tool.press = false;
    tool.grasp = true;
    tool.keys = &key;
    tool.key_count = 1;
    s = make_sheet(PEL_METHOD_STATIC, &tool);
    step(&s, true);
    cut_across(&s, 5);
    assert_null(s.sim->loose);
    step(&s, true);
    end_sheet(&s);
}

static pel_status create_cut(const void *data, pel_error *error)
{
    const pel_sim_def *def = data;
    int32_t path[ROW];
    pel_sim *sim;
    pel_status status = pel_sim_create(def, &sim, error);
    if (status != PEL_OK)
        return status;
    for (int32_t i = 0; i < ROW; i++)
        path[i] = 5 * ROW + i;
    status = pel_cut(sim, 0, path, ROW, error);
    assert_true(status != PEL_OK || count_loose(sim) == 6 * ROW);
    pel_sim_destroy(sim);
    return status;
}

static void allocation_failures(void **unused)
{
    (void)unused;
    sheet s = make_sheet(PEL_METHOD_STATIC, NULL);
    pel_sim_def def = lone_sim(s.model, PEL_METHOD_STATIC, 0.1);
    assert_true(for_allocation_failures(create_cut, &def, ROUNDS(3, 17)) > 40);
    end_sheet(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stays),
        cmocka_unit_test(returns),
        cmocka_unit_test(leaves_alone),
        cmocka_unit_test(allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
