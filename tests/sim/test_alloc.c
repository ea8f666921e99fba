/* Model and simulation with every single allocation failing; steps that do not allocate. */
#include "check.h"
#include "failing_malloc.h"

#include "pellicle/shape.h"
#include "pellicle/sim.h"

static pel_mesh *sphere(void)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

/* data: a pel_model_def */
static pel_status make_model(const void *data, pel_error *error)
{
    pel_model *model;
    pel_status status = pel_model_create(data, &model, error);
    if (status != PEL_OK)
        assert_null(model);
    pel_model_destroy(model);
    return status;
}

/* data: a pel_sim_def */
static pel_status make_sim(const void *data, pel_error *error)
{
    pel_sim *sim;
    pel_status status = pel_sim_create(data, &sim, error);
    if (status != PEL_OK)
        assert_null(sim);
    pel_sim_destroy(sim);
    return status;
}

/* no step touches the heap, nor does what is read between steps */
static void assert_steps_without_heap(const pel_sim_def *def)
{
    pel_sim *sim;
    pel_error error;
    pel_sim_measures measures;
    pel_tool_reading reading;
    int contacts = 0;
    assert_int_equal(pel_sim_create(def, &sim, &error), PEL_OK);
    failing_malloc_begin(0);
    for (int step = 0; step < 150; step++) {
        assert_int_equal(pel_sim_step(sim, &error), PEL_OK);
        pel_sim_measure(sim, &measures);
        pel_sim_get_tool(sim, step % 2, &reading);
        contacts += reading.contact_count;
    }
    assert_int_equal(failing_malloc_end().calls, 0);
    assert_true(contacts > 0);
    pel_sim_destroy(sim);
}

/* two bodies with everything that a body can have, under loads and tools of every kind */
static void test_simulation(void **unused)
{
    (void)unused;
    pel_mesh *mesh = sphere();
    double ones[252];
    for (int v = 0; v < 252; v++)
        ones[v] = 1;
    const int32_t pinned[3] = {100, 101, 102};
    const pel_key ramp[2] = {{0, 0}, {1, 1}};
    pel_body_def bodies[2] = {pel_body_def_default(), pel_body_def_default()};
    bodies[0].name = "first";
    bodies[0].mesh = mesh;
    bodies[0].pinned = pinned;
    bodies[0].pinned_count = 3;
    bodies[0].spring_stiffness.field = ones;
    bodies[1].name = "second";
    bodies[1].mesh = mesh;
    bodies[1].volumetric_stiffness.keys = ramp;
    bodies[1].volumetric_stiffness.key_count = 2;
    pel_model_def model_def = pel_model_def_default();
    model_def.bodies = bodies;
    model_def.body_count = 2;
    assert_true(for_every_allocation_failure(make_model, &model_def) > 10);

    pel_load_def loads[2] = {pel_load_def_default(), pel_load_def_default()};
    loads[0].force[0] = 0.1;
    loads[0].until = 1;
    loads[1].body = 1;
    loads[1].force[2] = 0.1;
    loads[1].until = 1;
    loads[1].vertices = pinned;
    loads[1].weights = ones;
    loads[1].vertex_count = 3;
    loads[1].keys = ramp;
    loads[1].key_count = 2;
    const pel_pose_key keys[2] = {{0, {0, 0, 1.51}, {0, 0, 0, 1}}, {1, {0, 0, 1.4}, {0, 0, 0, 1}}};
    pel_tool_def tools[2] = {pel_tool_def_default(), pel_tool_def_default()};
    tools[0].name = "ball";
    tools[0].radius = 0.5;
    tools[0].keys = keys;
    tools[0].key_count = 2;
    tools[0].press = true;
    tools[1] = tools[0];
    tools[1].name = "grip";
    tools[1].press = false;
    tools[1].grasp = true;
    tools[1].grasp_from = 0.2;
    tools[1].grasp_until = 0.8;
    tools[1].reach = 0.2;
    pel_sim_def def = pel_sim_def_default();
    def.loads = loads;
    def.load_count = 2;
    def.tools = tools;
    def.tool_count = 2;
    def.thread_count = 2;
    pel_model *model;
    assert_int_equal(pel_model_create(&model_def, &model, NULL), PEL_OK);
    def.model = model;
    assert_true(for_every_allocation_failure(make_sim, &def) > 10);
    assert_steps_without_heap(&def);
    def.solver.method = PEL_METHOD_EXPLICIT;
    assert_true(for_every_allocation_failure(make_sim, &def) > 10);
    assert_steps_without_heap(&def);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_simulation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
