/* Every allocation of model and sim fails once, and a step allocates nothing. */
#include "failing_malloc.h"
#include "pellicle/sim_ledger.h"
#include "pellicle/sim_reading.h"
#include "sim/fixture.h"
#include "stage/stage.h"

static pel_body_def keyed_body(const pel_mesh *mesh)
{
    static const pel_key keys[2] = {{0, 1}, {1, 2}};
    static const int32_t pinned[1] = {3};
    static double stiffness[92];
    for (int v = 0; v < 92; v++)
        stiffness[v] = 1 + v;
    pel_body_def body = ball_body(mesh);
    body.spring_stiffness.field = stiffness;
    body.volumetric_stiffness = (pel_quantity){.keys = keys, .key_count = 2};
    body.pinned = pinned;
    body.pinned_count = 1;
    return body;
}

static pel_status create_model(const void *mesh, pel_error *error)
{
    pel_body_def body = keyed_body(mesh);
    pel_model_def def = pel_model_def_default();
    def.bodies = &body;
    def.body_count = 1;
    pel_model *model;
    pel_status status = pel_model_create(&def, &model, error);
    assert_true((model == NULL) == (status != PEL_OK));
    pel_model_destroy(model);
    return status;
}

static pel_sim_def sim_def(const pel_model *model)
{
    static const pel_pose_key keys[2] = {{0, {0, 0, 1.3}, {0, 0, 0, 1}, {0}}, {1, {0, 0, 1}, {0, 0, 0, 1}, {0}}};
    static const pel_key factors[2] = {{0, 0}, {1, 1}};
    static pel_load_def load;
    static pel_tool_def tool;
    load = pel_load_def_default();
    load.force[0] = 1;
    load.keys = factors;
    load.key_count = 2;
    tool = pel_tool_def_default();
    tool.name = "probe";
    tool.radius = 0.2;
    tool.keys = keys;
    tool.key_count = 2;
    tool.grasp = true;
    tool.grasp_from = 0.5;
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    def.loads = &load;
    def.load_count = 1;
    def.tools = &tool;
    def.tool_count = 1;
    def.thread_count = 1;
    return def;
}

static void test_every_allocation(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(3);
    assert_true(for_every_allocation_failure(create_model, mesh) > 20);
    pel_body_def body = keyed_body(mesh);
    pel_model *model = make_model(&body);
    pel_sim_def def = sim_def(model);
    def.solver.method = PEL_METHOD_EXPLICIT;
    def.solver.dt = 1e-3;
    assert_true(for_every_allocation_failure(create_sim, &def) > 10);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static void test_steps_do_not_allocate(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(3);
    pel_body_def body = keyed_body(mesh);
    pel_model *model = make_model(&body);
    for (int method = 0; method < 2; method++) {
        pel_sim_def def = sim_def(model);
        def.solver.method = (pel_method)method;
        def.solver.dt = 2e-3;
        pel_sim *sim = make_sim(&def);
        pel_sim_measures measures;
        pel_tool_reading reading;
        int touching = 0;
        failing_malloc_begin(0);
        for (int n = 0; n < 500; n++) {
            assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
            pel_sim_get_tool(sim, 0, &reading);
            touching += reading.contact_count > 0;
        }
        pel_sim_measure(sim, &measures);
        allocation_count count = failing_malloc_end();
        assert_int_equal(count.calls, 0);
        assert_true(touching > 10);
        pel_sim_destroy(sim);
    }
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation),
        cmocka_unit_test(test_steps_do_not_allocate),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
