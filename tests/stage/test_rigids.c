/* Rigid bodies in whole simulations against closed forms: falls, collisions, tops, pendulums, slopes, stacks. */
#include "../rigid/rigid_scene.h"
#include "failing_malloc.h"
#include "pellicle/sim_contact.h"
#include "random.h"
#include "stage/rigids.h"

#define GRAVITY 9.81
static const double origin[3] = {0};
/* relative; positions of the preset `single` have 7 digits */
#define TIGHT (sizeof(pel_real) == sizeof(double) ? 1e-9 : 1e-4)

/* ---- free ---- */

/* a parabola, for any step */
static void test_fall(void **state)
{
    (void)state;
    rigid_scene scene;
    rigid_scene_begin(&scene);
    scene.gravity = -GRAVITY;
    pel_body_def *body = rigid_scene_add(&scene, make_box(0.1, 0.2, 0.4, origin), 700);
    pel_vec3_set(body->velocity, 1, 0, 3);
    pel_vec3_set(body->angular_velocity, 0.1, 6, 0);
    rigid_scene_make(&scene);
    pel_rigid_reading start = rigid_scene_read(&scene, 0);
    rigid_scene_run(&scene, 0.8);
    pel_rigid_reading end = rigid_scene_read(&scene, 0);
    assert_near(end.center[0], 0.8, 1e-12);
    assert_near(end.center[2], 3 * 0.8 - 0.5 * GRAVITY * 0.64, 1e-10);
    for (int k = 0; k < 3; k++)
        assert_near(end.angular_momentum[k], start.angular_momentum[k], 1e-12);
    double spin_energy = end.kinetic_energy - 0.5 * end.mass * pel_vec3_squared_length(end.velocity);
    assert_near(spin_energy, start.kinetic_energy - 0.5 * start.mass * 10, 1e-9);
    pel_sim_ledger ledger;
    pel_sim_get_ledger(scene.sim, &ledger);
    assert_near(ledger.energy_error, 0, 1e-6 * end.kinetic_energy);
    rigid_scene_end(&scene);
}

/* oblique, off the centers, with and without friction: momenta stay, and energy does not grow */
static void test_collision(void **state)
{
    (void)state;
    static const double center[3] = {0.3, 0.06, 0.02}, axis[3] = {1, 2, 0.5};
    for (int k = 0; k < 2; k++) {
        rigid_scene scene;
        double before[2][3], after[2][3], spins[2][3];
        rigid_scene_begin(&scene);
        scene.def.contact.friction = k * 0.6;
        pel_mesh *box = make_box(0.1, 0.2, 0.15, center);
        pel_body_def *a = rigid_scene_add(&scene, make_ball(0.1, 6, 0, 0, 0), 500);
        pel_body_def *b = rigid_scene_add(&scene, box, 2000);
        turn_mesh(box, axis, 20);
        pel_vec3_set(a->velocity, 1.5, 0.5, 0);
        pel_vec3_set(a->angular_velocity, 0, 0, 8);
        pel_vec3_set(b->angular_velocity, 1, 0, -2);
        rigid_scene_make(&scene);
        rigid_scene_momenta(&scene, before[0], before[1]);
        double energy = rigid_scene_read(&scene, 0).kinetic_energy + rigid_scene_read(&scene, 1).kinetic_energy;
        pel_vec3_copy(rigid_scene_read(&scene, 1).velocity, spins[0]);
        rigid_scene_run(&scene, 0.5);
        rigid_scene_momenta(&scene, after[0], after[1]);
        pel_vec3_copy(rigid_scene_read(&scene, 1).velocity, spins[1]);
        assert_true(pel_vec3_distance(spins[0], spins[1]) > 0.1);
        for (int i = 0; i < 2; i++)
            assert_true(pel_vec3_distance(before[i], after[i]) < 1e-9 * pel_vec3_length(before[i]));
        assert_true(rigid_scene_read(&scene, 0).kinetic_energy + rigid_scene_read(&scene, 1).kinetic_energy < energy);
        rigid_scene_end(&scene);
    }
}

/* ---- pins ---- */

/* a cone on its tip with a level axis: precesses at M g d / (I3 w3) */
static void test_top(void **state)
{
    (void)state;
    enum { SIDES = 24 };
    double positions[SIDES + 2][3] = {{0, 0, 0}, {0.1, 0, 0}};
    int32_t triangles[2 * SIDES][3], tip = 0;
    for (int i = 0; i < SIDES; i++) {
        double angle = 2 * 3.14159265358979323846 * i / SIDES;
        int32_t here = 2 + i, next = 2 + (i + 1) % SIDES;
        pel_vec3_set(positions[here], 0.1, 0.08 * cos(angle), 0.08 * sin(angle));
        memcpy(triangles[2 * i], ((int32_t[3]){0, next, here}), sizeof triangles[0]);
        memcpy(triangles[2 * i + 1], ((int32_t[3]){1, here, next}), sizeof triangles[0]);
    }
    pel_mesh *mesh;
    rigid_scene scene;
    assert_int_equal(pel_mesh_create(positions[0], SIDES + 2, triangles[0], 2 * SIDES, &mesh, NULL), PEL_OK);
    rigid_scene_begin(&scene);
    scene.gravity = -GRAVITY;
    scene.def.contact.enabled = false;
    pel_body_def *body = rigid_scene_add(&scene, mesh, 1000);
    body->pinned = &tip;
    body->pinned_count = 1;
    /* the moment of a pyramid of 24 sides over that of its cone: (2 + cos) / 3 of the angle of a side */
    double d = 0.075, side = 2 * 3.14159265358979323846 / SIDES, ratio = (2 + cos(side)) / 3;
    double spin = 120, about = 0.3 * 0.08 * 0.08 * ratio, rate = GRAVITY * d / (about * spin);
    pel_vec3_set(body->angular_velocity, spin, 0, rate);
    pel_vec3_set(body->velocity, 0, rate * d, 0);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 0.6);
    pel_rigid_reading end = rigid_scene_read(&scene, 0);
    assert_near(atan2(end.center[1], end.center[0]) / (0.6 * rate), 1, 0.01);
    assert_near(end.center[2], 0, 0.01 * d);
    rigid_scene_end(&scene);
}

/* a bar on a hinge swings with 2 pi sqrt(I / (M g d)) (1 + angle^2 / 16), and its pins carry it */
static void test_pendulum(void **state)
{
    (void)state;
    static const double center[3] = {0, 0, -0.2}, axis[3] = {0, 1, 0};
    static const int32_t pins[2] = {4, 7};
    rigid_scene scene;
    rigid_scene_begin(&scene);
    scene.gravity = -GRAVITY;
    scene.def.contact.enabled = false;
    scene.def.solver.dt = 0.005;
    pel_mesh *mesh = make_box(0.02, 0.1, 0.4, center);
    turn_mesh(mesh, axis, 8);
    pel_body_def *body = rigid_scene_add(&scene, mesh, 1000);
    body->pinned = pins;
    body->pinned_count = 2;
    rigid_scene_make(&scene);
    pel_rigid_reading start = rigid_scene_read(&scene, 0), now = start;
    double arm[2] = {start.center[0] - mesh->positions[4][0], start.center[2] - mesh->positions[4][2]};
    double square = arm[0] * arm[0] + arm[1] * arm[1], angle = atan2(-arm[0], -arm[1]);
    double inertia = (0.02 * 0.02 + 0.4 * 0.4) / 12 + square;
    double period = 2 * 3.14159265358979 * sqrt(inertia / (GRAVITY * sqrt(square))) * (1 + angle * angle / 16);
    double last = now.spin[1], crossed = 0, energy = 0;
    int count = 0;
    while (count < 7) {
        double time = pel_sim_time(scene.sim);
        assert_int_equal(pel_sim_step(scene.sim, NULL), PEL_OK);
        now = rigid_scene_read(&scene, 0);
        if (last * now.spin[1] < 0 && ++count == 7)
            crossed = time + 0.005 * last / (last - now.spin[1]);
        last = now.spin[1];
        energy = fmax(energy, now.kinetic_energy);
    }
    assert_near(crossed / (3.5 * period), 1, 0.005);
    assert_near(energy / (start.mass * GRAVITY * sqrt(square) * (1 - cos(angle))), 1, 0.01);
    assert_near(now.center[1], 0, 1e-12);
    rigid_scene_end(&scene);
}

/* a body that hangs at rest on two pins: each carries its share */
static void test_reaction(void **state)
{
    (void)state;
    static const double center[3] = {0, 0.02, -0.2};
    static const int32_t pins[2] = {4, 7};
    rigid_scene scene;
    rigid_scene_begin(&scene);
    scene.gravity = -GRAVITY;
    scene.def.contact.enabled = false;
    scene.def.solver.drag = 20;
    pel_body_def *body = rigid_scene_add(&scene, make_box(0.02, 0.1, 0.4, center), 1000);
    body->pinned = pins;
    body->pinned_count = 2;
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 3);
    pel_support_reading reading;
    pel_sim_get_support(scene.sim, 0, &reading);
    double weight = 0.8 * GRAVITY;
    assert_near(reading.force[2], -weight, 1e-4 * weight);
    assert_near(reading.force[0], 0, 1e-4 * weight);
    rigid_scene_end(&scene);
}

/* ---- floors ---- */

static pel_mesh *make_box_on_slope(double x, double z, double angle)
{
    static const double axis[3] = {0, 1, 0};
    const double center[3] = {0, 0, 0.5 * z + 1e-4};
    pel_mesh *mesh = make_box(x, x, z, center);
    turn_mesh(mesh, axis, angle * 180 / 3.14159265358979323846);
    return mesh;
}

/* Coulomb: slides with g (sin a - mu cos a), or sticks */
static void test_slide(void **state)
{
    (void)state;
    const double angle = 0.35;
    for (int k = 0; k < 2; k++) {
        rigid_scene scene;
        rigid_scene_begin(&scene);
        scene.gravity = -GRAVITY;
        scene.def.contact.friction = k == 0 ? 0.3 : 0.4;
        rigid_scene_add(&scene, make_box_on_slope(0.1, 0.04, angle), 1000);
        rigid_scene_floor(&scene, angle);
        rigid_scene_make(&scene);
        rigid_scene_run(&scene, 0.2);
        pel_rigid_reading start = rigid_scene_read(&scene, 0);
        rigid_scene_run(&scene, 0.7);
        pel_rigid_reading end = rigid_scene_read(&scene, 0);
        double rate = (pel_vec3_length(end.velocity) - pel_vec3_length(start.velocity)) / 0.5;
        double expected = GRAVITY * (sin(angle) - 0.3 * cos(angle));
        assert_near(rate, k == 0 ? expected : 0, 0.002 * expected);
        rigid_scene_end(&scene);
    }
}

/* a tall box falls over where its center is beyond its edge: tan a > width / height */
static void test_topple(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++) {
        const double angle = atan(0.25) + (k == 0 ? -0.03 : 0.03);
        rigid_scene scene;
        rigid_scene_begin(&scene);
        scene.gravity = -GRAVITY;
        scene.def.contact.friction = 1;
        rigid_scene_add(&scene, make_box_on_slope(0.05, 0.2, angle), 1000);
        rigid_scene_floor(&scene, angle);
        rigid_scene_make(&scene);
        rigid_scene_run(&scene, 1.5);
        double turned = 2 * acos(fmin(1, fabs(rigid_scene_read(&scene, 0).rotation[3])));
        if (k == 0)
            assert_true(turned < 0.02);
        else
            assert_true(turned > 1);
        rigid_scene_end(&scene);
    }
}

/* a ball of many faces rolls with 5/7 g sin a, less what its faces take */
static void test_roll(void **state)
{
    (void)state;
    const double angle = 0.2, r = 0.05;
    rigid_scene scene;
    rigid_scene_begin(&scene);
    scene.gravity = -GRAVITY;
    scene.def.contact.friction = 0.8;
    rigid_scene_add(&scene, make_ball(r, 16, (r + 5e-5) * sin(angle), 0, (r + 5e-5) * cos(angle)), 1000);
    rigid_scene_floor(&scene, angle);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 0.4);
    pel_rigid_reading end = rigid_scene_read(&scene, 0);
    double speed = pel_vec3_length(end.velocity);
    assert_near(speed / (5.0 / 7 * GRAVITY * sin(angle) * 0.4), 1, 0.05);
    assert_near(end.spin[1] * r / speed, 1, 0.02);
    rigid_scene_end(&scene);
}

/* a stack stands still and weighs what its boxes weigh */
static void test_stack(void **state)
{
    (void)state;
    enum { HEIGHT = 6 };
    static const double axis[3] = {0, 0, 1};
    rigid_scene scene;
    rigid_scene_begin(&scene);
    scene.gravity = -GRAVITY;
    scene.def.contact.friction = 0.5;
    scene.def.contact.sleep = false;
    for (int i = 0; i < HEIGHT; i++) {
        const double center[3] = {0.005 * (i % 3), 0.004 * (i % 2), 0.0502 + 0.1002 * i};
        pel_mesh *mesh = make_box(0.1, 0.1, 0.1, center);
        turn_mesh(mesh, axis, 7 * i);
        rigid_scene_add(&scene, mesh, 1000);
    }
    rigid_scene_floor(&scene, 0);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 0.5);
    pel_tool_reading reading;
    pel_sim_get_tool(scene.sim, 0, &reading);
    assert_near(-reading.force[2], HEIGHT * GRAVITY, 2e-3 * HEIGHT * GRAVITY);
    for (int i = 0; i < HEIGHT; i++) {
        pel_rigid_reading box = rigid_scene_read(&scene, i);
        assert_true(box.kinetic_energy < 1e-5);
        assert_near(box.center[2], 0.05 + 0.1 * i, 1e-4 * (i + 1));
    }
    rigid_scene_end(&scene);
}

/* a ball that rolls over another one is not stopped, though the chord of its path crosses it */
static void test_chords(void **state)
{
    (void)state;
    static const int32_t pins[3] = {0, 1, 2};
    rigid_scene scene;
    pel_contact_statistics statistics;
    rigid_scene_begin(&scene);
    scene.gravity = -GRAVITY;
    scene.def.contact.friction = 0.3;
    scene.def.solver.dt = 0.04;
    pel_body_def *below = rigid_scene_add(&scene, make_ball(0.05, 8, 0, 0, 0), 1000);
    below->pinned = pins;
    below->pinned_count = 3;
    pel_vec3_set(rigid_scene_add(&scene, make_ball(0.05, 8, 0, 0, 0.1001), 1000)->velocity, 0.6, 0, 0);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 0.15);
    pel_sim_get_contact_statistics(scene.sim, &statistics);
    assert_true(statistics.contacts > 10);
    assert_int_equal(statistics.fall_backs, 0);
    assert_int_equal(statistics.rounds, 0);
    rigid_scene_end(&scene);
}

/* Boxes thrown with a spin at a soft ball of few triangles. A corner that turns past an edge in a step is let pass
   along its path, while other pairs of the same triangles are tested on the chord. */
static void test_spins(void **state)
{
    (void)state;
    random_state random = {11};
    for (int i = 0; i < LONG(400, 20); i++) {
        rigid_scene scene;
        double axis[3];
        rigid_scene_begin(&scene);
        scene.gravity = -GRAVITY;
        scene.def.contact.friction = 0.3;
        scene.def.solver.substeps = 16;
        pel_body_def *below = rigid_scene_add(&scene, make_ball(0.1, 3, 0, 0, 0), 1000);
        below->rigid.on = false;
        below->mass = 0.01;
        below->spring_stiffness.value = 30;
        below->volumetric_stiffness.value = 10;
        const double center[3] = {random_between(&random, -0.06, 0.06), random_between(&random, -0.06, 0.06), 0.16};
        pel_body_def *body = rigid_scene_add(&scene, make_box(0.1, 0.06, 0.04, center), 1000);
        for (int k = 0; k < 3; k++)
            axis[k] = random_between(&random, -1, 1);
        pel_vec3_scale(axis, 30, body->angular_velocity);
        pel_vec3_set(body->velocity, 0, 0, -2);
        rigid_scene_make(&scene);
        for (int n = 0; n < 25; n++) {
            int64_t pairs = 0;
            rigid_scene_run(&scene, pel_sim_time(scene.sim) + 0.01);
            assert_int_equal(pel_sim_intersections(scene.sim, &pairs, NULL), PEL_OK);
            if (pairs != 0)
                print_error("box %d, step %d\n", i, n);
            assert_int_equal(pairs, 0);
        }
        rigid_scene_end(&scene);
    }
}

/* ---- the rest of a simulation ---- */

static void make_bouncing(rigid_scene *scene)
{
    rigid_scene_begin(scene);
    scene->gravity = -GRAVITY;
    scene->def.contact.friction = 0.4;
    for (int i = 0; i < 2; i++)
        pel_vec3_set(rigid_scene_add(scene, make_ball(0.05, 3, 0.02 * i, 0, 0.06 + 0.11 * i), 1000)->angular_velocity,
                     3, 2, 1);
    rigid_scene_floor(scene, 0);
}

/* a loaded state goes on with the same bits */
static void test_snapshot(void **state)
{
    (void)state;
    rigid_scene scene, other;
    make_bouncing(&scene);
    make_bouncing(&other);
    rigid_scene_make(&scene);
    rigid_scene_make(&other);
    rigid_scene_run(&scene, 0.2);
    void *bytes = malloc(pel_sim_save_size(scene.sim));
    pel_sim_save(scene.sim, bytes);
    assert_int_equal(pel_sim_load(other.sim, bytes, pel_sim_save_size(scene.sim), NULL), PEL_OK);
    rigid_scene_run(&scene, 0.5);
    rigid_scene_run(&other, 0.5);
    assert_true(pel_sim_hash(scene.sim) == pel_sim_hash(other.sim));
    pel_rigid_reading a = rigid_scene_read(&scene, 1), b = rigid_scene_read(&other, 1);
    assert_memory_equal(&a, &b, sizeof a);
    free(bytes);
    rigid_scene_end(&scene);
    rigid_scene_end(&other);
}

/* positions and velocities that are set become the nearest rigid ones */
static void test_setters(void **state)
{
    (void)state;
    rigid_scene scene;
    double positions[8][3], velocities[8][3];
    rigid_scene_begin(&scene);
    rigid_scene_add(&scene, make_box(0.1, 0.2, 0.4, origin), 1000);
    rigid_scene_make(&scene);
    pel_sim_get_positions(scene.sim, 0, positions[0]);
    for (int v = 0; v < 8; v++) {
        double x = positions[v][0];
        positions[v][0] = 1 - positions[v][1];
        positions[v][1] = x;
        pel_vec3_set(velocities[v], -5 * positions[v][1], 5 * positions[v][0], 0.5);
    }
    assert_int_equal(pel_sim_set_positions(scene.sim, 0, positions[0], NULL), PEL_OK);
    assert_int_equal(pel_sim_set_velocities(scene.sim, 0, velocities[0], NULL), PEL_OK);
    pel_rigid_reading reading = rigid_scene_read(&scene, 0);
    assert_near(reading.center[0], 1, TIGHT);
    assert_near(reading.rotation[2], sqrt(0.5), TIGHT);
    assert_near(reading.spin[2], 5, 10 * TIGHT);
    assert_near(reading.velocity[1], 5, 10 * TIGHT);
    assert_near(reading.velocity[2], 0.5, 10 * TIGHT);
    rigid_scene_end(&scene);
}

/* a body on an elastic attachment hangs lower by its weight over the stiffness */
static void test_tie(void **state)
{
    (void)state;
    static const double center[3] = {0, 0, 0.3};
    static const int32_t corners[4] = {4, 5, 6, 7};
    rigid_scene scene;
    rigid_scene_begin(&scene);
    scene.gravity = -GRAVITY;
    scene.def.solver.drag = 30;
    rigid_scene_add(&scene, make_box(0.1, 0.1, 0.1, center), 1000);
    pel_tie_def tie = pel_tie_def_default();
    tie.name = "rope";
    tie.vertices = corners;
    tie.vertex_count = 4;
    tie.target = PEL_TIE_PLACE;
    tie.stiffness = 1000;
    scene.def.ties = &tie;
    scene.def.tie_count = 1;
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 3);
    assert_near(rigid_scene_read(&scene, 0).center[2], 0.3 - GRAVITY / 4000, 1e-5);
    rigid_scene_end(&scene);
}

/* a body on a slack thread moves freely */
static void test_slack(void **state)
{
    (void)state;
    static const double low[3] = {0, 0, 0}, high[3] = {0, 0, 0.4};
    static const int32_t corners[4] = {4, 5, 6, 7};
    rigid_scene scene;
    rigid_scene_begin(&scene);
    rigid_scene_add(&scene, make_box(0.1, 0.1, 0.1, low), 1000)->velocity[2] = 0.5;
    rigid_scene_add(&scene, make_box(0.1, 0.1, 0.1, high), 1000);
    pel_tie_def tie = pel_tie_def_default();
    tie.name = "rope";
    tie.vertices = corners;
    tie.vertex_count = 4;
    tie.target = PEL_TIE_BODY;
    tie.to_body = 1;
    tie.stiffness = 1000;
    scene.def.ties = &tie;
    scene.def.tie_count = 1;
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 0.2);
    pel_rigid_reading thrown = rigid_scene_read(&scene, 0), still = rigid_scene_read(&scene, 1);
    assert_near(thrown.velocity[2], 0.5, 1e-12);
    assert_near(pel_vec3_length(still.velocity), 0, 1e-12);
    rigid_scene_end(&scene);
}

/* a tool that grasps a vertex holds the body as a whole, and carries its weight */
static void test_grasp(void **state)
{
    (void)state;
    rigid_scene scene;
    rigid_scene_begin(&scene);
    scene.gravity = -GRAVITY;
    rigid_scene_add(&scene, make_ball(0.05, 4, 0, 0, 0), 1000);
    pel_pose_key keys[3] = {{.rotation = {0, 0, 0, 1}, .position = {0, 0, 0.05}},
                            {.time = 0.5, .rotation = {0, 0, 0, 1}, .position = {0, 0, 0.25}},
                            {.time = 0.6, .rotation = {0, 0, 0, 1}, .position = {0, 0, 0.25}}};
    pel_tool_def *tool = &scene.tools[scene.tool_count++];
    *tool = pel_tool_def_default();
    tool->name = "forceps";
    tool->shape = PEL_TOOL_SPHERE;
    tool->radius = 0.01;
    tool->press = false;
    tool->grasp = true;
    tool->grasp_until = 1;
    tool->keys = keys;
    tool->key_count = 3;
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 0.9);
    pel_rigid_reading held = rigid_scene_read(&scene, 0);
    pel_tool_reading reading;
    pel_sim_get_tool(scene.sim, 0, &reading);
    assert_near(held.center[2], 0.2, 1e-9);
    assert_near(pel_vec3_length(held.velocity), 0, 1e-9);
    assert_near(reading.force[2], -held.mass * GRAVITY, 1e-6);
    rigid_scene_run(&scene, 1.2);
    assert_true(rigid_scene_read(&scene, 0).center[2] < 0.1);
    rigid_scene_end(&scene);
}

static void test_refusals(void **state)
{
    (void)state;
    pel_error error = {0};
    rigid_scene scene;
    rigid_scene_begin(&scene);
    scene.def.solver.method = PEL_METHOD_QUASI_STATIC;
    rigid_scene_add(&scene, make_box(0.1, 0.2, 0.4, origin), 1000);
    assert_int_equal(rigid_scene_try(&scene, &error), PEL_BAD_ARGUMENT);
    assert_string_equal(error.what, "body 'b0' is rigid, which this method does not know");
    assert_string_equal(error.remedy, "use the method xpbd, implicit, explicit, static, pbd or pbd-distance");
    rigid_scene_end(&scene);
    pel_rigid_reading reading;
    assert_false(pel_sim_get_rigid(NULL, 0, &reading));
}

static void test_memory(void **state)
{
    (void)state;
    pel_mesh *mesh = make_box(0.1, 0.2, 0.4, origin);
    const rigid_case made = {mesh, PEL_METHOD_XPBD, false};
    assert_true(for_allocation_failures(rigid_scene_lone, &made, 1) > 0);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fall),     cmocka_unit_test(test_collision), cmocka_unit_test(test_top),
        cmocka_unit_test(test_pendulum), cmocka_unit_test(test_reaction),  cmocka_unit_test(test_slide),
        cmocka_unit_test(test_topple),   cmocka_unit_test(test_roll),      cmocka_unit_test(test_stack),
        cmocka_unit_test(test_chords),   cmocka_unit_test(test_spins),     cmocka_unit_test(test_snapshot),
        cmocka_unit_test(test_setters),  cmocka_unit_test(test_tie),       cmocka_unit_test(test_slack),
        cmocka_unit_test(test_grasp),    cmocka_unit_test(test_refusals),  cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
