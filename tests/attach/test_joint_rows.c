/* Joints of rigid bodies under implicit and static: pendulums, slides, motors, limits, momenta, states of rest. */
#include "attach/joint.h"
#include "failing_malloc.h"
#include "joint_scene.h"
#include "math/pose.h"

#include <math.h>

/* of the forces in a step in time, by the tolerance of its solver */
#define SOLVED 2e-5
static const double pi = 3.14159265358979323846;

static void begin(rigid_scene *scene, pel_method method, pel_joint_def *joints, int32_t count)
{
    begin_joints(scene, method, joints, count);
    scene->gravity = -GRAVITY;
}

/* m: how far the points of both bodies of a joint are apart */
static double apart(const rigid_scene *scene, int32_t joint)
{
    double points[2][3];
    for (int side = 0; side < 2; side++)
        pel_joint_point(&scene->sim->joints->items[joint], side, points[side]);
    return pel_vec3_distance(points[0], points[1]);
}

/* a bar on a hinge swings with 4 K(sin 45 degrees) sqrt(I / (M g d)) from the level; the hinge holds it */
static void swing(double dt, bool has_contact)
{
    static const double center[3] = {0.05, 0, 0}, d = 0.15;
    pel_joint_def joint = joint_of("hinge", PEL_JOINT_HINGE, -0.1, 0, 0);
    rigid_scene scene;
    begin(&scene, PEL_METHOD_IMPLICIT, &joint, 1);
    scene.def.solver.dt = dt;
    scene.def.contact.enabled = has_contact;
    rigid_scene_add(&scene, make_box(0.4, 0.1, 0.02, center), 1000);
    rigid_scene_make(&scene);
    double moment = (0.4 * 0.4 + 0.02 * 0.02) / 12 + d * d, last = 0, times[2] = {0}, farthest = 0;
    int turns = 0;
    for (int i = 0; i < 1600 && turns < 2; i++) {
        rigid_scene_run(&scene, dt * (i + 1));
        pel_joint_reading now = read_joint(&scene, 0);
        double before = last - pi / 2, after = now.position - pi / 2;
        if (i > 0 && before * after < 0)
            times[turns++] = dt * (i + before / (before - after));
        last = now.position;
        farthest = fmax(farthest, apart(&scene, 0));
        assert_near(rigid_scene_read(&scene, 0).center[1], 0, 1e-9);
    }
    double period = 4 * 1.8540746773013719 * sqrt(moment / (GRAVITY * d));
    assert_near(2 * (times[1] - times[0]) / period, 1, 0.01);
    assert_true(farthest < 1e-9);
    pel_rigid_reading bar = rigid_scene_read(&scene, 0);
    double energy = bar.kinetic_energy + bar.mass * GRAVITY * bar.center[2];
    assert_near(energy, 0, 0.002 * 0.8 * GRAVITY * d);
    rigid_scene_end(&scene);
}

static void test_pendulum(void **state)
{
    (void)state;
    swing(0.0025, false);
    swing(0.01, true);
}

/* two free bodies on a joint of each kind: momentum stays, and so does what the joint holds */
static void test_pairs(void **state)
{
    (void)state;
    static const double centers[2][3] = {{0, 0, 0}, {0.25, 0.02, 0.01}};
    for (int kind = 0; kind < PEL_JOINT_KIND_COUNT; kind++) {
        pel_joint_def joint = joint_of("j", (pel_joint_kind)kind, 0.12, 0, 0);
        rigid_scene scene;
        double before[2][3], after[2][3], axes[2][3], axis[3] = {0, 1, 0};
        joint.to_body = 1;
        begin(&scene, PEL_METHOD_IMPLICIT, &joint, 1);
        scene.gravity = 0;
        scene.def.solver.dt = 0.0025;
        for (int b = 0; b < 2; b++) {
            pel_body_def *body = rigid_scene_add(&scene, make_box(0.2, 0.1, 0.05, centers[b]), 500 + 1000 * b);
            pel_vec3_set(body->velocity, 0.3 * b, 0.1, -0.2 * b);
            pel_vec3_set(body->angular_velocity, 1 - 2 * b, 2, 3 * b);
        }
        rigid_scene_make(&scene);
        rigid_scene_momenta(&scene, before[0], before[1]);
        rigid_scene_run(&scene, 0.5);
        rigid_scene_momenta(&scene, after[0], after[1]);
        assert_true(pel_vec3_distance(before[0], after[0]) < 1e-8 * pel_vec3_length(before[0]));
        assert_true(pel_vec3_distance(before[1], after[1]) < 0.01 * pel_vec3_length(before[1]));
        assert_true(kind == PEL_JOINT_SLIDER || apart(&scene, 0) < 1e-8);
        pel_rigid_reading a = rigid_scene_read(&scene, 0), b = rigid_scene_read(&scene, 1);
        pel_rotate(a.rotation, axis, axes[0]);
        pel_rotate(b.rotation, axis, axes[1]);
        if (kind != PEL_JOINT_BALL)
            assert_near(pel_vec3_dot(axes[0], axes[1]), 1, 1e-9);
        if (kind == PEL_JOINT_WELD)
            assert_near(fabs(pel_vec3_dot(a.rotation, b.rotation) + a.rotation[3] * b.rotation[3]), 1, 1e-12);
        rigid_scene_end(&scene);
    }
}

/* a box on an inclined slider moves with g sin a, until its limit holds it, from which it does not jump back */
static void test_slider(void **state)
{
    (void)state;
    const double angle = 0.5;
    pel_joint_def joint;
    rigid_scene scene;
    begin_slider(&scene, PEL_METHOD_IMPLICIT, &joint, angle);
    rigid_scene_run(&scene, 0.4);
    double along = GRAVITY * sin(angle);
    assert_near(read_joint(&scene, 0).position / (0.5 * along * 0.4 * 0.4), 1, 0.01);
    while (pel_sim_time(scene.sim) < 1.2) {
        rigid_scene_run(&scene, pel_sim_time(scene.sim) + 0.01);
        assert_true(read_joint(&scene, 0).position < 0.6 + 1e-8);
        if (pel_sim_time(scene.sim) > 0.6)
            assert_near(read_joint(&scene, 0).position, 0.6, 1e-7);
    }
    pel_joint_reading end = read_joint(&scene, 0);
    assert_near(end.load, -along, SOLVED * along);
    assert_near(end.force[2], GRAVITY, SOLVED * GRAVITY);
    assert_near(rigid_scene_read(&scene, 0).rotation[3], 1, 1e-12);
    rigid_scene_end(&scene);
}

/* a motor turns a bar with its strength up to its speed, and its work is the energy of the bar */
static void test_motor(void **state)
{
    (void)state;
    static const double center[3] = {0, 0, 0};
    pel_joint_def joint = joint_of("motor", PEL_JOINT_HINGE, 0, 0, 0);
    double moment = 0.8 / 12 * (0.4 * 0.4 + 0.02 * 0.02), torque = 0.05, speed = 10;
    rigid_scene scene;
    pel_sim_ledger ledger;
    joint.speed = speed;
    joint.strength = torque;
    begin(&scene, PEL_METHOD_IMPLICIT, &joint, 1);
    scene.gravity = 0;
    rigid_scene_add(&scene, make_box(0.4, 0.1, 0.02, center), 1000);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 1);
    assert_near(read_joint(&scene, 0).position / (0.5 * torque / moment), 1, 0.015);
    assert_near(read_joint(&scene, 0).load, torque, 1e-9);
    rigid_scene_run(&scene, 4);
    pel_joint_reading end = read_joint(&scene, 0);
    pel_sim_get_ledger(scene.sim, &ledger);
    double energy = 0.5 * moment * speed * speed;
    assert_near(end.speed, speed, SOLVED * speed);
    assert_near(end.position, speed * 4 - 0.5 * speed * speed * moment / torque, 0.1);
    assert_near(end.work / energy, 1, 0.02);
    assert_near(ledger.work_tools, end.work, 1e-12);
    assert_near(rigid_scene_read(&scene, 0).spin[1], speed, 1e-3);
    rigid_scene_end(&scene);
}

/* a plate that starts level hangs from an oblique hinge through it, and from a ball, in one step; so does a chain */
static void test_hanging(void **state)
{
    (void)state;
    static const double center[3] = {0}, axis[3] = {0.3, 1, 0};
    for (int kind = PEL_JOINT_BALL; kind <= PEL_JOINT_HINGE; kind++) {
        pel_joint_def joint = joint_of("j", (pel_joint_kind)kind, -0.1, 0.02, 0);
        rigid_scene scene;
        pel_vec3_copy(axis, joint.axis);
        begin(&scene, PEL_METHOD_STATIC, &joint, 1);
        rigid_scene_add(&scene, make_box(0.3, 0.2, 0.01, center), 1000);
        rigid_scene_make(&scene);
        rigid_scene_run(&scene, scene.def.solver.dt);
        pel_joint_reading end = read_joint(&scene, 0);
        pel_rigid_reading plate = rigid_scene_read(&scene, 0);
        double arm[3], torque[3], weight[3] = {0, 0, -plate.mass * GRAVITY}, moved[3];
        pel_vec3_subtract(plate.center, joint.point, arm);
        pel_vec3_cross(arm, weight, torque);
        double turns = kind == PEL_JOINT_BALL ? pel_vec3_length(torque) : pel_vec3_dot(torque, axis);
        assert_near(turns / (plate.mass * GRAVITY * 0.1), 0, 1e-6);
        assert_true(arm[2] < 0);
        /* the turn about the vertical through a ball joint is neutral */
        pel_solver_reading solver;
        pel_sim_get_solver(scene.sim, &solver);
        assert_true(solver.converged && !solver.unstable);
        pel_vec3_scale(weight, -1, weight);
        assert_true(pel_vec3_distance(end.force, weight) < 1e-6 * weight[2]);
        pel_vec3_subtract(center, joint.point, moved);
        pel_rotate(plate.rotation, moved, moved);
        assert_true(pel_vec3_distance(moved, arm) < 1e-9);
        rigid_scene_end(&scene);
    }
}

static void test_chain(void **state)
{
    (void)state;
    enum { LINKS = 4 };
    static const char *const names[LINKS] = {"a", "b", "c", "d"};
    pel_joint_def joints[LINKS];
    rigid_scene scene;
    begin(&scene, PEL_METHOD_STATIC, joints, LINKS);
    for (int i = 0; i < LINKS; i++) {
        const double center[3] = {0.1 * i + 0.05, 0, 0};
        joints[i] = joint_of(names[i], PEL_JOINT_BALL, 0.1 * i, 0, 0);
        joints[i].body = i;
        joints[i].to_body = i - 1;
        rigid_scene_add(&scene, make_box(0.09, 0.02, 0.02, center), 1000);
    }
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, scene.def.solver.dt);
    for (int i = 0; i < LINKS; i++) {
        assert_near(read_joint(&scene, i).force[2], (LINKS - i) * 0.036 * GRAVITY, 1e-6);
        assert_near(rigid_scene_read(&scene, i).center[2], -0.1 * i - 0.05, 1e-6);
    }
    rigid_scene_end(&scene);
}

/* at rest on the limit of a hinge, and held by its motor, a brake */
static void test_held(void **state)
{
    (void)state;
    static const double center[3] = {0.2, 0, 0};
    for (int k = 0; k < 2; k++) {
        pel_joint_def joint = joint_of("door", PEL_JOINT_HINGE, 0, 0, 0);
        rigid_scene scene;
        joint.most = k == 0 ? 0.4 : joint.most;
        joint.strength = k == 0 ? 0 : 4;
        begin(&scene, PEL_METHOD_STATIC, &joint, 1);
        rigid_scene_add(&scene, make_box(0.4, 0.1, 0.02, center), 1000);
        rigid_scene_make(&scene);
        rigid_scene_run(&scene, 3 * scene.def.solver.dt);
        pel_joint_reading end = read_joint(&scene, 0);
        double angle = k == 0 ? 0.4 : 0;
        assert_near(end.position, angle, 1e-7);
        assert_near(end.load, -0.8 * GRAVITY * 0.2 * cos(angle), 1e-6);
        rigid_scene_end(&scene);
    }
}

static void test_snapshot(void **state)
{
    (void)state;
    static const double center[3] = {0.2, 0, 0};
    pel_joint_def joint = joint_of("motor", PEL_JOINT_HINGE, 0, 0, 0);
    rigid_scene scenes[2];
    joint.strength = 1;
    joint.speed = 20;
    for (int i = 0; i < 2; i++) {
        begin(&scenes[i], PEL_METHOD_IMPLICIT, &joint, 1);
        rigid_scene_add(&scenes[i], make_box(0.4, 0.1, 0.02, center), 1000);
        rigid_scene_make(&scenes[i]);
    }
    rigid_scene_run(&scenes[0], 0.3);
    size_t size = pel_sim_save_size(scenes[0].sim);
    void *bytes = malloc(size);
    pel_sim_save(scenes[0].sim, bytes);
    assert_int_equal(pel_sim_load(scenes[1].sim, bytes, size, NULL), PEL_OK);
    for (int i = 0; i < 2; i++)
        rigid_scene_run(&scenes[i], 0.5);
    pel_joint_reading a = read_joint(&scenes[0], 0), b = read_joint(&scenes[1], 0);
    assert_memory_equal(&a, &b, sizeof a);
    assert_true(pel_sim_hash(scenes[0].sim) == pel_sim_hash(scenes[1].sim));
    free(bytes);
    for (int i = 0; i < 2; i++)
        rigid_scene_end(&scenes[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pendulum), cmocka_unit_test(test_pairs),    cmocka_unit_test(test_slider),
        cmocka_unit_test(test_motor),    cmocka_unit_test(test_hanging),  cmocka_unit_test(test_chain),
        cmocka_unit_test(test_held),     cmocka_unit_test(test_snapshot),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
