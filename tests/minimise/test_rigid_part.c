/* Rigid bodies under implicit and static: free and pinned motion, momenta in collisions, weights on sheets, the
   equilibrium that both find, refusals. */
#include "../rigid/rigid_scene.h"
#include "failing_malloc.h"

#define GRAVITY 9.81
static const double origin[3] = {0};
/* relative; positions and velocities of the preset `single` have 7 digits */
#define TIGHT (sizeof(pel_real) == sizeof(double) ? 1e-9 : 1e-4)

static void begin(rigid_scene *scene, pel_method method, double dt)
{
    rigid_scene_begin(scene);
    scene->def.solver.method = method;
    scene->def.solver.dt = dt;
}

/* an elastic square in the plane z = 0, 0.9 kg/m2; all or none of its rim is pinned */
static void add_sheet(rigid_scene *scene, int cells, double size, int32_t *rim)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    pel_mesh *mesh;
    int32_t count = 0;
    def.nx = def.ny = cells;
    def.size_x = def.size_y = size;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    pel_body_def *body = rigid_scene_add(scene, mesh, 1000);
    *body = pel_body_def_sheet(body->name, mesh, 1e6, 1e-3, 900);
    for (int32_t v = 0; v < mesh->vertex_count && rim != NULL; v++)
        if (fabs(mesh->positions[v][0]) > 0.499 * size || fabs(mesh->positions[v][1]) > 0.499 * size)
            rim[count++] = v;
    body->pinned = rim;
    body->pinned_count = count;
}

/* ---- alone ---- */

/* the first step of a fall is one of first order; what nothing turns keeps angular momentum and energy */
static void test_flight(void **state)
{
    (void)state;
    rigid_scene scene;
    begin(&scene, PEL_METHOD_IMPLICIT, 0.01);
    scene.gravity = -GRAVITY;
    pel_body_def *body = rigid_scene_add(&scene, make_box(0.1, 0.2, 0.4, origin), 700);
    pel_vec3_set(body->velocity, 1, 0, 3);
    pel_vec3_set(body->angular_velocity, 0.1, 6, 0);
    rigid_scene_make(&scene);
    pel_rigid_reading start = rigid_scene_read(&scene, 0);
    rigid_scene_run(&scene, 0.8);
    pel_rigid_reading end = rigid_scene_read(&scene, 0);
    assert_near(end.center[0], 0.8, TIGHT);
    assert_near(end.velocity[2], 3 - GRAVITY * 0.8, 10 * TIGHT);
    assert_near(end.center[2], 3 * 0.8 - 0.5 * GRAVITY * 0.64, GRAVITY * 1e-4 + TIGHT);
    for (int k = 0; k < 3; k++)
        assert_near(end.angular_momentum[k], start.angular_momentum[k],
                    TIGHT * pel_vec3_length(start.angular_momentum));
    double spin_energy = end.kinetic_energy - 0.5 * end.mass * pel_vec3_squared_length(end.velocity);
    assert_near(spin_energy, start.kinetic_energy - 0.5 * start.mass * 10, 1000 * TIGHT * start.kinetic_energy);
    rigid_scene_end(&scene);
}

/* A bar on a hinge, or on a ball joint: let go level it comes to the other side in half a period. It hangs from one pin
   of a corner, or two. */
static void test_pendulum(void **state)
{
    (void)state;
    static const double center[3] = {0.2, 0, 0};
    static const int32_t pins[2] = {4, 7};
    for (int count = 1; count <= 2; count++) {
        double heights[2];
        for (int m = 0; m < 2; m++) {
            rigid_scene scene;
            begin(&scene, m == 0 ? PEL_METHOD_IMPLICIT : PEL_METHOD_XPBD, 0.0025);
            scene.gravity = -GRAVITY;
            scene.def.contact.enabled = false;
            pel_body_def *body = rigid_scene_add(&scene, make_box(0.4, 0.05, 0.02, center), 1000);
            body->pinned = pins;
            body->pinned_count = count;
            rigid_scene_make(&scene);
            rigid_scene_run(&scene, 0.3);
            pel_rigid_reading now = rigid_scene_read(&scene, 0);
            assert_near(now.kinetic_energy / (now.mass * GRAVITY * (center[2] - now.center[2])), 1, 0.02);
            heights[m] = now.center[2];
            rigid_scene_end(&scene);
        }
        assert_true(heights[1] < -0.05);
        assert_near(heights[0] / heights[1], 1, 0.02);
    }
}

/* ---- together ---- */

static double momentum_of(const rigid_scene *scene, int32_t body, int k)
{
    pel_rigid_reading reading;
    if (pel_sim_get_rigid(scene->sim, body, &reading))
        return reading.momentum[k];
    double velocities[200][3], masses[200], sum = 0;
    int32_t count = scene->meshes[body]->vertex_count;
    assert_true(count <= 200);
    pel_sim_get_velocities(scene->sim, body, velocities[0]);
    pel_sim_get_masses(scene->sim, body, masses);
    for (int32_t v = 0; v < count; v++)
        sum += masses[v] * velocities[v][k];
    return sum;
}

/* a ball flies into a loose sheet, with friction: momentum stays, and no energy appears */
static void test_collision(void **state)
{
    (void)state;
    rigid_scene scene;
    begin(&scene, PEL_METHOD_IMPLICIT, 0.005);
    scene.def.contact.friction = 0.5;
    add_sheet(&scene, 10, 0.2, NULL);
    pel_body_def *ball = rigid_scene_add(&scene, make_ball(0.03, 3, 0.01, 0, 0.04), 300);
    pel_vec3_set(ball->velocity, 0.5, 0, -1);
    rigid_scene_make(&scene);
    double before[3], energy = rigid_scene_read(&scene, 1).kinetic_energy;
    for (int k = 0; k < 3; k++)
        before[k] = momentum_of(&scene, 0, k) + momentum_of(&scene, 1, k);
    rigid_scene_run(&scene, 0.1);
    for (int k = 0; k < 3; k++)
        assert_near(momentum_of(&scene, 0, k) + momentum_of(&scene, 1, k), before[k], TIGHT * fabs(before[2]));
    pel_rigid_reading end = rigid_scene_read(&scene, 1);
    assert_true(end.velocity[2] > -0.9 && pel_vec3_length(end.spin) > 0.1);
    pel_sim_ledger ledger;
    pel_sim_get_ledger(scene.sim, &ledger);
    assert_true(ledger.kinetic + ledger.elastic < energy);
    rigid_scene_end(&scene);
}

/* Load of a box on a sheet whose rim is pinned over its weight, and how far it has come down [m], at rest. It slides to
   the middle: static needs some steps. */
static double rest_on_sheet(pel_method method, double time, double *fall)
{
    static const double center[3] = {0.01, 0.005, 0.0155};
    int32_t rim[64];
    rigid_scene scene;
    begin(&scene, method, method == PEL_METHOD_STATIC ? 0.1 : 0.01);
    scene.gravity = -GRAVITY;
    scene.def.solver.drag = method == PEL_METHOD_STATIC ? 0 : 15;
    add_sheet(&scene, 10, 0.2, rim);
    rigid_scene_add(&scene, make_box(0.06, 0.06, 0.03, center), 2000);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, time);
    double forces[8][3], load = 0;
    pel_sim_get_contact_forces(scene.sim, 1, forces[0]);
    for (int v = 0; v < 8; v++)
        load += forces[v][2];
    *fall = center[2] - rigid_scene_read(&scene, 1).center[2];
    double weight = GRAVITY * rigid_scene_read(&scene, 1).mass;
    rigid_scene_end(&scene);
    return load / weight;
}

static void test_rest(void **state)
{
    (void)state;
    double falls[3];
    assert_near(rest_on_sheet(PEL_METHOD_STATIC, 1, &falls[0]), 1, 1e-3);
    assert_near(rest_on_sheet(PEL_METHOD_IMPLICIT, 1.2, &falls[1]), 1, 0.01);
    assert_true(rest_on_sheet(PEL_METHOD_XPBD, 1.2, &falls[2]) > 0);
    assert_true(falls[0] > 0.016);
    assert_near(falls[1] / falls[0], 1, 0.005);
    assert_near(falls[2] / falls[0], 1, 0.015);
}

/* How deep a box of 0.4 kg hangs in a soft sheet after so many steps [m]: the sheet slides along the box and leans on
   its edges as it comes down. */
static double hang(int steps)
{
    static const double center[3] = {0, 0, 0.0155};
    int32_t rim[64];
    rigid_scene scene;
    begin(&scene, PEL_METHOD_STATIC, 1);
    scene.gravity = -GRAVITY;
    add_sheet(&scene, 10, 0.2, rim);
    rigid_scene_add(&scene, make_box(0.06, 0.06, 0.03, center), 4000);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, steps);
    double depth = center[2] - rigid_scene_read(&scene, 1).center[2];
    rigid_scene_end(&scene);
    return depth;
}

/* contacts are taken where the step ends, not where it found them */
static void test_one_step(void **state)
{
    (void)state;
    double depth = hang(1);
    assert_true(depth > 0.019);
    assert_near(hang(2), depth, 1e-3 * depth);
}

/* A ball of .1 kg without friction, `gap` above a sheet: under static it falls and rolls to where it rests. Where that
   is, and the load over its weight. */
static double fall_to_rest(double gap, double *load)
{
    int32_t rim[64];
    rigid_scene scene;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    pel_mesh *ball;
    double forces[128][3], sum = 0;
    def.frequency = 3;
    def.radius = 0.03;
    assert_int_equal(pel_shape_create(&def, &ball, NULL), PEL_OK);
    for (int32_t v = 0; v < ball->vertex_count; v++) {
        ball->positions[v][0] += 0.004;
        ball->positions[v][2] += 0.03 + gap;
    }
    begin(&scene, PEL_METHOD_STATIC, 1);
    scene.gravity = -GRAVITY;
    add_sheet(&scene, 10, 0.2, rim);
    rigid_scene_add(&scene, ball, 900);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 1);
    pel_solver_reading reading;
    pel_sim_get_solver(scene.sim, &reading);
    assert_true(reading.converged);
    pel_sim_get_contact_forces(scene.sim, 1, forces[0]);
    for (int32_t v = 0; v < ball->vertex_count; v++)
        sum += forces[v][2];
    pel_rigid_reading rest = rigid_scene_read(&scene, 1);
    *load = sum / (GRAVITY * rest.mass);
    rigid_scene_end(&scene);
    return rest.center[2];
}

static void test_fall_to_rest(void **state)
{
    (void)state;
    double load, near = fall_to_rest(2e-4, &load);
    assert_near(load, 1, 5e-3);
    double far = fall_to_rest(0.02, &load);
    assert_near(load, 1, 5e-3);
    assert_near(far, near, 0.02 * 0.03);
}

/* a box that starts level hangs from the hinge of two pinned corners, in one step: where it is level nothing turns it
 */
static void test_hinge_at_rest(void **state)
{
    (void)state;
    rigid_scene scene;
    begin(&scene, PEL_METHOD_STATIC, 0.01);
    scene.gravity = -GRAVITY;
    pel_body_def *body = rigid_scene_add(&scene, make_box(0.3, 0.2, 0.01, origin), 1000);
    static int32_t pins[2];
    int count = 0;
    for (int32_t v = 0; v < scene.meshes[0]->vertex_count; v++) {
        const double *x = scene.meshes[0]->positions[v];
        if (x[0] < -0.149 && x[2] < 0 && fabs(x[1]) > 0.099 && count < 2)
            pins[count++] = v;
    }
    assert_int_equal(count, 2);
    body->pinned = pins;
    body->pinned_count = count;
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 0.01);
    pel_rigid_reading plate = rigid_scene_read(&scene, 0);
    assert_near(plate.center[0], -0.15, 1e-6);
    assert_near(plate.center[1], 0, 1e-12);
    assert_near(plate.center[2], -0.005 - hypot(0.15, 0.005), 1e-6);
    rigid_scene_end(&scene);
}

/* ---- refusals ---- */

static void test_refusals(void **state)
{
    (void)state;
    pel_error error = {0};
    rigid_scene scene;
    begin(&scene, PEL_METHOD_STATIC, 0.01);
    scene.def.solver.path = PEL_PATH_ARC_LENGTH;
    rigid_scene_add(&scene, make_box(0.1, 0.2, 0.4, origin), 1000);
    assert_int_equal(rigid_scene_try(&scene, &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.what, "analyses and paths do not know rigid bodies");
    rigid_scene_end(&scene);
}

static void test_memory(void **state)
{
    (void)state;
    pel_mesh *mesh = make_box(0.1, 0.2, 0.4, origin);
    const rigid_case made = {mesh, PEL_METHOD_IMPLICIT, true};
    assert_true(for_allocation_failures(rigid_scene_lone, &made, 1) > 0);
    pel_mesh_destroy(mesh);
}

/* under static a box falls on a floor and rests there: the floor bears its weight */
static void test_floor(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        rigid_scene scene;
        pel_shape_def def = pel_shape_def_default(PEL_SHAPE_BOX);
        pel_transform up = pel_transform_default();
        pel_mesh *mesh;
        def.size_x = def.size_y = def.size_z = 0.1;
        up.translation[2] = i == 0 ? 0.0505 : 0.2;
        assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
        assert_int_equal(pel_mesh_transform(mesh, &up, NULL), PEL_OK);
        begin(&scene, PEL_METHOD_STATIC, 1);
        scene.gravity = -GRAVITY;
        rigid_scene_add(&scene, mesh, 1000);
        rigid_scene_floor(&scene, 0);
        rigid_scene_make(&scene);
        assert_int_equal(pel_sim_step(scene.sim, NULL), PEL_OK);
        pel_rigid_reading box = rigid_scene_read(&scene, 0);
        pel_tool_reading floor;
        pel_sim_get_tool(scene.sim, 0, &floor);
        assert_near(box.center[2], 0.05, 1e-3);
        assert_near(floor.force[2], -GRAVITY * box.mass, 1e-3 * GRAVITY * box.mass);
        rigid_scene_end(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_flight),        cmocka_unit_test(test_pendulum), cmocka_unit_test(test_collision),
        cmocka_unit_test(test_rest),          cmocka_unit_test(test_one_step), cmocka_unit_test(test_fall_to_rest),
        cmocka_unit_test(test_hinge_at_rest), cmocka_unit_test(test_refusals), cmocka_unit_test(test_memory),
        cmocka_unit_test(test_floor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
