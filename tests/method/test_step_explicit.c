/* Rigid bodies under the explicit method: free motion, collisions with each other and with sheets, joints, motors,
   pins, grasps; snapshots, refusals. */
#include "../attach/joint_scene.h"
#include "failing_malloc.h"
#include "pellicle/sim_contact.h"
#include "stage/stage.h"

static const double origin[3] = {0};
/* relative; positions of the preset `single` have 7 digits */
#define TIGHT (sizeof(pel_real) == sizeof(double) ? 1e-9 : 1e-4)

static void begin(rigid_scene *scene, double dt)
{
    rigid_scene_begin(scene);
    scene->def.solver.method = PEL_METHOD_EXPLICIT;
    scene->def.solver.dt = dt;
}

/* an elastic square in the plane z = 0, 1 kg/m2, with a pinned rim or none */
static void add_sheet(rigid_scene *scene, int cells, double size, int32_t *rim)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    pel_mesh *mesh;
    int32_t count = 0;
    def.nx = def.ny = cells;
    def.size_x = def.size_y = size;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    pel_body_def *body = rigid_scene_add(scene, mesh, 1000);
    *body = pel_body_def_sheet(body->name, mesh, 5e5, 1e-3, 1000);
    for (int32_t v = 0; v < mesh->vertex_count && rim != NULL; v++)
        if (fabs(mesh->positions[v][0]) > 0.499 * size || fabs(mesh->positions[v][1]) > 0.499 * size)
            rim[count++] = v;
    body->pinned = rim;
    body->pinned_count = count;
}

/* J; that of contact is lost, so that only a gain is an error */
static double balance(const rigid_scene *scene)
{
    pel_sim_ledger ledger;
    pel_sim_get_ledger(scene->sim, &ledger);
    return ledger.energy_error;
}

/* ---- alone and with each other ---- */

static void test_fall(void **state)
{
    (void)state;
    rigid_scene scene;
    begin(&scene, 1e-3);
    scene.gravity = -GRAVITY;
    pel_body_def *body = rigid_scene_add(&scene, make_box(0.1, 0.2, 0.4, origin), 700);
    pel_vec3_set(body->velocity, 1, 0, 3);
    pel_vec3_set(body->angular_velocity, 0.1, 6, 0);
    rigid_scene_make(&scene);
    pel_rigid_reading start = rigid_scene_read(&scene, 0);
    rigid_scene_run(&scene, 0.8);
    pel_rigid_reading end = rigid_scene_read(&scene, 0);
    assert_near(end.center[0], 0.8, TIGHT);
    assert_near(end.center[2], 3 * 0.8 - 0.5 * GRAVITY * 0.64, TIGHT);
    for (int k = 0; k < 3; k++)
        assert_near(end.angular_momentum[k], start.angular_momentum[k], 1e-12);
    assert_near(balance(&scene), 0, 1e3 * TIGHT * end.kinetic_energy);
    rigid_scene_end(&scene);
}

/* oblique and off the centers, with friction and restitution */
static void test_collision(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        rigid_scene scene;
        double before[2][3], after[2][3];
        begin(&scene, 1e-3);
        scene.def.contact.friction = 0.5;
        scene.def.contact.restitution = k == 0 ? -1 : 0.6;
        pel_body_def *a = rigid_scene_add(&scene, make_ball(0.1, 4, 0, 0, 0), 500);
        rigid_scene_add(&scene, make_ball(0.1, 4, 0.3, 0.06, 0.02), 2000);
        pel_vec3_set(a->velocity, 1.5, 0.5, 0);
        pel_vec3_set(a->angular_velocity, 0, 0, 8);
        rigid_scene_make(&scene);
        rigid_scene_momenta(&scene, before[0], before[1]);
        rigid_scene_run(&scene, 0.3);
        rigid_scene_momenta(&scene, after[0], after[1]);
        double parting = pel_vec3_distance(rigid_scene_read(&scene, 0).velocity, rigid_scene_read(&scene, 1).velocity);
        assert_true(rigid_scene_read(&scene, 1).velocity[0] > 0.05);
        assert_true(parting < 1.55);
        for (int i = 0; i < 2; i++)
            assert_true(pel_vec3_distance(before[i], after[i]) < TIGHT * pel_vec3_length(before[i]));
        rigid_scene_end(&scene);
    }
}

/* ---- joints ---- */

/* a disk on a ball joint with a level axis precesses at M g d / (I3 w) */
static void test_top(void **state)
{
    (void)state;
    pel_joint_def joint = joint_of("foot", PEL_JOINT_BALL, 0, 0, 0);
    static const double center[3] = {0.08, 0, 0};
    const double spin = 200, d = 0.08, rate = GRAVITY * d / (0.1 * 0.1 / 6 * spin);
    rigid_scene scene;
    begin_joints(&scene, PEL_METHOD_EXPLICIT, &joint, 1);
    scene.def.solver.dt = 5e-4;
    scene.gravity = -GRAVITY;
    pel_body_def *body = rigid_scene_add(&scene, make_box(0.02, 0.1, 0.1, center), 1000);
    pel_vec3_set(body->angular_velocity, spin, 0, rate);
    pel_vec3_set(body->velocity, 0, rate * d, 0);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 0.6);
    pel_rigid_reading end = rigid_scene_read(&scene, 0);
    assert_near(atan2(end.center[1], end.center[0]) / (0.6 * rate), 1, 0.01);
    assert_near(end.center[2], 0, 0.01 * d);
    assert_near(pel_vec3_length(end.center), d, 1e-8);
    rigid_scene_end(&scene);
}

/* two bars on hinges, let go level: energy and joints hold */
static void test_pendulum(void **state)
{
    (void)state;
    pel_joint_def joints[2] = {joint_of("a", PEL_JOINT_HINGE, 0, 0, 0), joint_of("b", PEL_JOINT_HINGE, 0.3, 0, 0)};
    joints[1].body = 1;
    joints[1].to_body = 0;
    rigid_scene scene;
    begin_joints(&scene, PEL_METHOD_EXPLICIT, joints, 2);
    joints[0].to_body = -1;
    scene.def.solver.dt = 5e-4;
    scene.gravity = -GRAVITY;
    for (int i = 0; i < 2; i++) {
        const double center[3] = {0.15 + 0.3 * i, 0, 0};
        rigid_scene_add(&scene, make_box(0.28, 0.03, 0.03, center), 1000);
    }
    rigid_scene_make(&scene);
    double supplied = 0;
    for (int n = 0; n < 1500; n++) {
        rigid_scene_run(&scene, pel_sim_time(scene.sim) + 4e-4);
        supplied =
            fmax(supplied, rigid_scene_read(&scene, 0).kinetic_energy + rigid_scene_read(&scene, 1).kinetic_energy);
    }
    double energy = 0, arm[2][3] = {{0.15, 0, 0}, {-0.15, 0, 0}};
    for (int i = 0; i < 2; i++) {
        pel_rigid_reading now = rigid_scene_read(&scene, i);
        energy += now.kinetic_energy + now.mass * GRAVITY * now.center[2];
        pel_rotate(now.rotation, arm[i], arm[i]);
        pel_vec3_add(arm[i], now.center, arm[i]);
    }
    assert_near(energy, 0, 5e-3 * supplied);
    assert_near(pel_vec3_distance(arm[0], arm[1]), 0, 1e-7);
    rigid_scene_end(&scene);
}

/* a motor on a bar: its speed and its work */
static void test_motor(void **state)
{
    (void)state;
    static const double center[3] = {0.2, 0, 0};
    pel_joint_def joint = joint_of("motor", PEL_JOINT_HINGE, 0, 0, 0);
    joint.speed = 3;
    joint.strength = 0.5;
    rigid_scene scene;
    begin_joints(&scene, PEL_METHOD_EXPLICIT, &joint, 1);
    scene.def.solver.dt = 1e-3;
    rigid_scene_add(&scene, make_box(0.4, 0.05, 0.02, center), 1000);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 1);
    pel_joint_reading end = read_joint(&scene, 0);
    assert_near(end.speed, 3, 1e-6);
    assert_near(end.work, rigid_scene_read(&scene, 0).kinetic_energy, 1e-3 * end.work);
    assert_near(balance(&scene), 0, 1e-3 * end.work);
    rigid_scene_end(&scene);
}

/* ---- sheets ---- */

/* a ball of 100 times the mass of the vertices under it comes to rest on a sheet, and weighs its weight */
static void test_weight(void **state)
{
    (void)state;
    enum { STEPS = 400 };
    int32_t rim[64];
    rigid_scene scene;
    double sum = 0;
    begin(&scene, 1e-3);
    scene.gravity = -GRAVITY;
    scene.def.solver.drag = 8;
    scene.def.contact.friction = 0.3;
    add_sheet(&scene, 8, 0.4, rim);
    rigid_scene_add(&scene, make_ball(0.04, 3, 0.003, 0.002, 0.045), 900);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 1.5);
    for (int n = 0; n < STEPS; n++) {
        pel_support_reading reading;
        rigid_scene_run(&scene, pel_sim_time(scene.sim) + 9e-4);
        pel_sim_get_support(scene.sim, 0, &reading);
        sum -= reading.force[2] / STEPS;
    }
    double weight = rigid_scene_read(&scene, 1).mass * GRAVITY, sheet = 0.4 * 0.4 * GRAVITY;
    assert_near(sum, weight + sheet, 0.01 * weight);
    assert_true(balance(&scene) < 1e-3 * weight * 0.04);
    rigid_scene_end(&scene);
}

/* a loose sheet that a ball runs into: the momentum of both stays, and no energy appears */
static void test_loose(void **state)
{
    (void)state;
    rigid_scene scene;
    begin(&scene, 5e-4);
    scene.def.contact.friction = 0.3;
    add_sheet(&scene, 6, 0.2, NULL);
    pel_body_def *ball = rigid_scene_add(&scene, make_ball(0.03, 3, 0.01, 0, 0.05), 500);
    pel_vec3_set(ball->velocity, 0.3, 0, -1);
    rigid_scene_make(&scene);
    double start = rigid_scene_read(&scene, 1).kinetic_energy, momentum[3], sum[3];
    pel_vec3_copy(rigid_scene_read(&scene, 1).momentum, momentum);
    rigid_scene_run(&scene, 0.15);
    pel_vec3_copy(rigid_scene_read(&scene, 1).momentum, sum);
    for (int32_t v = 0; v < scene.sim->model->bodies[0].slice_end * PEL_WIDTH; v++)
        for (int k = 0; k < 3; k++)
            sum[k] += (double)scene.sim->model->mass[v] * (double)scene.sim->state->velocity[v][k];
    assert_true(rigid_scene_read(&scene, 1).velocity[2] > -0.9);
    assert_true(pel_vec3_distance(sum, momentum) < TIGHT * pel_vec3_length(momentum));
    assert_true(balance(&scene) < 1e-3 * start);
    rigid_scene_end(&scene);
}

/* ---- pins, tools, the rest of a simulation ---- */

/* a bar that hangs from two pins, and a ball on the floor: each carries its weight */
static void test_carried(void **state)
{
    (void)state;
    static const double center[3] = {0, 1.02, 0.3};
    static const int32_t pins[2] = {4, 7};
    rigid_scene scene;
    begin(&scene, 2e-3);
    scene.gravity = -GRAVITY;
    scene.def.solver.drag = 20;
    pel_body_def *body = rigid_scene_add(&scene, make_box(0.02, 0.1, 0.4, center), 1000);
    body->pinned = pins;
    body->pinned_count = 2;
    rigid_scene_add(&scene, make_box(0.1, 0.1, 0.1, (const double[3]){0, 0, 0.051}), 1000);
    rigid_scene_floor(&scene, 0);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 2);
    pel_support_reading support;
    pel_tool_reading floor;
    pel_sim_get_support(scene.sim, 0, &support);
    pel_sim_get_tool(scene.sim, 0, &floor);
    assert_near(support.force[2], -0.8 * GRAVITY, 1e-4 * GRAVITY);
    assert_near(floor.force[2], -GRAVITY, 2e-3 * GRAVITY);
    rigid_scene_end(&scene);
}

/* a tool holds a ball, carries its weight and lets it go */
static void test_grasp(void **state)
{
    (void)state;
    rigid_scene scene;
    begin(&scene, 2e-3);
    scene.gravity = -GRAVITY;
    rigid_scene_add(&scene, make_ball(0.05, 3, 0, 0, 0), 1000);
    pel_pose_key keys[2] = {{.rotation = {0, 0, 0, 1}, .position = {0, 0, 0.05}},
                            {.time = 0.2, .rotation = {0, 0, 0, 1}, .position = {0, 0, 0.15}}};
    pel_tool_def *tool = &scene.tools[scene.tool_count++];
    *tool = pel_tool_def_default();
    tool->name = "forceps";
    tool->shape = PEL_TOOL_SPHERE;
    tool->radius = 0.02;
    tool->press = false;
    tool->grasp = true;
    tool->grasp_until = 0.5;
    tool->keys = keys;
    tool->key_count = 2;
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 0.4);
    pel_rigid_reading held = rigid_scene_read(&scene, 0);
    pel_tool_reading reading;
    pel_sim_get_tool(scene.sim, 0, &reading);
    assert_near(held.center[2], 0.1, 1e-6);
    assert_near(reading.force[2], -held.mass * GRAVITY, 1e-3 * held.mass * GRAVITY);
    rigid_scene_run(&scene, 0.7);
    assert_near(rigid_scene_read(&scene, 0).velocity[2], -GRAVITY * 0.2, 0.02);
    rigid_scene_end(&scene);
}

/* a loaded state goes on with the same bits */
static void test_snapshot(void **state)
{
    (void)state;
    rigid_scene scenes[2];
    for (int i = 0; i < 2; i++) {
        begin(&scenes[i], 1e-3);
        scenes[i].gravity = -GRAVITY;
        scenes[i].def.contact.friction = 0.4;
        add_sheet(&scenes[i], 5, 0.3, NULL);
        pel_body_def *ball = rigid_scene_add(&scenes[i], make_ball(0.05, 2, 0.02, 0, 0.06), 1000);
        pel_vec3_set(ball->angular_velocity, 3, 2, 1);
        rigid_scene_floor(&scenes[i], 0);
        scenes[i].keys[0].position[2] -= 0.01;
        rigid_scene_make(&scenes[i]);
    }
    rigid_scene_run(&scenes[0], 0.1);
    size_t size = pel_sim_save_size(scenes[0].sim);
    void *bytes = malloc(size);
    pel_sim_save(scenes[0].sim, bytes);
    assert_int_equal(pel_sim_load(scenes[1].sim, bytes, size, NULL), PEL_OK);
    for (int i = 0; i < 2; i++)
        rigid_scene_run(&scenes[i], 0.2);
    assert_true(pel_sim_hash(scenes[0].sim) == pel_sim_hash(scenes[1].sim));
    free(bytes);
    for (int i = 0; i < 2; i++)
        rigid_scene_end(&scenes[i]);
}

static void test_refusals(void **state)
{
    (void)state;
    pel_error error = {0};
    rigid_scene scene;
    begin(&scene, 1e-3);
    scene.def.solver.symplectic = false;
    rigid_scene_add(&scene, make_box(0.1, 0.2, 0.4, origin), 1000);
    assert_int_equal(rigid_scene_try(&scene, &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.what, "forward Euler has no rigid bodies");
    rigid_scene_end(&scene);
    pel_mesh *mesh = make_box(0.1, 0.2, 0.4, origin);
    const rigid_case made = {mesh, PEL_METHOD_EXPLICIT, true};
    assert_true(for_allocation_failures(rigid_scene_lone, &made, 1) > 0);
    pel_mesh_destroy(mesh);
}

/* ---- stiffening ---- */

/* Steps a balloon of a rubber whose chains end, blown up at once, for up to 10 ms; J that appeared, relative. */
static pel_status blow_up(const pel_mesh *mesh, double dt, double *excess, pel_error *error)
{
    pel_body_def body = pel_body_def_sheet("balloon", mesh, 1e6, 1e-3, 1000);
    pel_model_def model_def = pel_model_def_default();
    pel_sim_def def = pel_sim_def_default();
    pel_model *model;
    pel_sim *sim;
    pel_sim_ledger ledger;
    body.shell.membrane.kind = PEL_MEMBRANE_GENT;
    body.shell.membrane.extension_limit = 3;
    body.shell.membrane.poisson = 0.5;
    body.shell.pressure.kind = PEL_PRESSURE_GIVEN;
    body.shell.pressure.outside.value = -9000;
    model_def.bodies = &body;
    model_def.body_count = 1;
    assert_int_equal(pel_model_create(&model_def, &model, NULL), PEL_OK);
    def.model = model;
    def.solver.method = PEL_METHOD_EXPLICIT;
    def.solver.dt = dt;
    if (!(dt > 0))
        assert_int_equal(pel_sim_stable_dt(&def, &def.solver.dt, NULL), PEL_OK);
    assert_int_equal(pel_sim_create(&def, &sim, NULL), PEL_OK);
    pel_status status = PEL_OK;
    while (status == PEL_OK && pel_sim_time(sim) < 0.01)
        status = pel_sim_step(sim, error);
    pel_sim_get_ledger(sim, &ledger);
    *excess = (ledger.energy_error + ledger.dissipated_solver) / ledger.supplied;
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    return status;
}

/* half of the limit at rest is too long when the rubber is near its end: the error names a step that holds */
static void test_stiffening(void **state)
{
    (void)state;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    pel_mesh *mesh;
    pel_error error = {0};
    double excess, dt = 0;
    shape.frequency = 4;
    shape.radius = 0.1;
    assert_int_equal(pel_shape_create(&shape, &mesh, NULL), PEL_OK);
    assert_int_equal(blow_up(mesh, 0, &excess, &error), PEL_DIVERGED);
    assert_int_equal(sscanf(error.remedy, "use solver.dt: %lf:", &dt), 1);
    assert_true(dt > 1e-6);
    assert_int_equal(blow_up(mesh, dt, &excess, &error), PEL_OK);
    print_message("%s; energy off by %.2g\n", error.remedy, excess);
    assert_true(excess < 0.01);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fall),     cmocka_unit_test(test_collision), cmocka_unit_test(test_top),
        cmocka_unit_test(test_pendulum), cmocka_unit_test(test_motor),     cmocka_unit_test(test_weight),
        cmocka_unit_test(test_loose),    cmocka_unit_test(test_carried),   cmocka_unit_test(test_grasp),
        cmocka_unit_test(test_snapshot), cmocka_unit_test(test_refusals),  cmocka_unit_test(test_stiffening),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
