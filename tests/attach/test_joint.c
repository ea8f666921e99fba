/* Joints of rigid bodies against closed forms: pendulums, slides, motors, limits, momenta. */
#include "attach/joint.h"
#include "contact/set.h"
#include "failing_malloc.h"
#include "joint_scene.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

static double energy_of(const rigid_scene *scene)
{
    double sum = 0;
    for (int32_t b = 0; b < scene->body_count; b++) {
        pel_rigid_reading body = rigid_scene_read(scene, b);
        sum += body.kinetic_energy - body.mass * scene->gravity * body.center[2];
    }
    return sum;
}

/* a bar on a hinge swings with 2 pi sqrt(I / (M g d)) (1 + angle^2 / 16), whichever body comes first */
static void test_pendulum(void **state)
{
    (void)state;
    static const double center[3] = {0.05, 0, 0}, d = 0.15;
    pel_joint_def joint = joint_of("hinge", PEL_JOINT_HINGE, -0.1, 0, 0);
    rigid_scene scene;
    begin_joints(&scene, PEL_METHOD_XPBD, &joint, 1);
    scene.gravity = -GRAVITY;
    rigid_scene_add(&scene, make_box(0.4, 0.1, 0.02, center), 1000);
    rigid_scene_make(&scene);
    double moment = (0.4 * 0.4 + 0.02 * 0.02) / 12 + d * d, last = 0, times[2] = {0}, energy = energy_of(&scene);
    int turns = 0;
    for (int i = 0; i < 400 && turns < 2; i++) {
        rigid_scene_run(&scene, 0.01 * (i + 1));
        pel_joint_reading now = read_joint(&scene, 0);
        /* through the lowest point, forth and back */
        double before = last - pi / 2, after = now.position - pi / 2;
        if (i > 0 && before * after < 0)
            times[turns++] = 0.01 * (i + before / (before - after));
        last = now.position;
    }
    /* from the level: K(sin 45 degrees) */
    double period = 4 * 1.8540746773013719 * sqrt(moment / (GRAVITY * d));
    assert_near(2 * (times[1] - times[0]) / period, 1, 1e-4);
    assert_near(energy_of(&scene), energy, 1e-3 * 0.8 * GRAVITY * d);
    pel_rigid_reading bar = rigid_scene_read(&scene, 0);
    assert_near(hypot(bar.center[0] + 0.1, bar.center[2]), d, 1e-7);
    assert_near(bar.center[1], 0, 1e-12);
    pel_sim_ledger ledger;
    pel_sim_get_ledger(scene.sim, &ledger);
    assert_true(fabs(ledger.energy_error) < 0.02 * 0.8 * GRAVITY * d);
    rigid_scene_end(&scene);
}

/* a bar that is told to turn about its center starts about the joint, with its angular momentum about it: w I / (I + M
   d^2); what the joint takes is no energy of the run, under any method */
static void test_start_speed(void **state)
{
    (void)state;
    static const double center[3] = {0.05, 0, 0}, d = 0.15;
    static const pel_method methods[] = {PEL_METHOD_XPBD, PEL_METHOD_IMPLICIT, PEL_METHOD_EXPLICIT};
    for (int m = 0; m < 3; m++) {
        pel_joint_def joint = joint_of("hinge", PEL_JOINT_HINGE, -0.1, 0, 0);
        rigid_scene scene;
        begin_joints(&scene, methods[m], &joint, 1);
        pel_body_def *body = rigid_scene_add(&scene, make_box(0.4, 0.1, 0.02, center), 1000);
        pel_vec3_set(body->angular_velocity, 0.5, 2, 0);
        rigid_scene_make(&scene);
        double own = (0.4 * 0.4 + 0.02 * 0.02) / 12, spin = 2 * own / (own + d * d);
        pel_rigid_reading bar = rigid_scene_read(&scene, 0);
        assert_near(bar.spin[0], 0, 1e-9);
        assert_near(bar.spin[1], spin, 1e-9);
        assert_near(bar.velocity[2], -spin * d, 1e-9);
        rigid_scene_run(&scene, 0.05);
        pel_sim_ledger ledger;
        pel_sim_get_ledger(scene.sim, &ledger);
        assert_near(ledger.kinetic_start / (0.8 * (own + d * d) * spin * spin / 2), 1, 1e-6);
        assert_near(ledger.kinetic / ledger.kinetic_start, 1, 2e-3);
        rigid_scene_end(&scene);
    }
}

/* two free bodies on a joint of each kind: momentum and angular momentum stay, and so does what the joint holds */
static void test_pairs(void **state)
{
    (void)state;
    static const double centers[2][3] = {{0, 0, 0}, {0.25, 0.02, 0.01}};
    for (int kind = 0; kind < PEL_JOINT_KIND_COUNT; kind++) {
        pel_joint_def joint = joint_of("j", (pel_joint_kind)kind, 0.12, 0, 0);
        rigid_scene scene;
        double before[2][3], after[2][3];
        joint.to_body = 1;
        begin_joints(&scene, PEL_METHOD_XPBD, &joint, 1);
        for (int b = 0; b < 2; b++) {
            pel_body_def *body = rigid_scene_add(&scene, make_box(0.2, 0.1, 0.05, centers[b]), 500 + 1000 * b);
            pel_vec3_set(body->velocity, 0.3 * b, 0.1, -0.2 * b);
            pel_vec3_set(body->angular_velocity, 1 - 2 * b, 2, 3 * b);
        }
        rigid_scene_make(&scene);
        rigid_scene_momenta(&scene, before[0], before[1]);
        rigid_scene_run(&scene, 1);
        rigid_scene_momenta(&scene, after[0], after[1]);
        for (int i = 0; i < 2; i++)
            assert_true(pel_vec3_distance(before[i], after[i]) < 1e-9 * pel_vec3_length(before[i]));
        pel_rigid_reading a = rigid_scene_read(&scene, 0), b = rigid_scene_read(&scene, 1);
        double points[2][3], axes[2][3], arms[2][3] = {{0.12, 0, 0}, {-0.13, -0.02, -0.01}}, axis[3] = {0, 1, 0};
        pel_rotate(a.rotation, arms[0], points[0]);
        pel_rotate(b.rotation, arms[1], points[1]);
        pel_vec3_add(a.center, points[0], points[0]);
        pel_vec3_add(b.center, points[1], points[1]);
        pel_rotate(a.rotation, axis, axes[0]);
        pel_rotate(b.rotation, axis, axes[1]);
        pel_vec3_subtract(points[0], points[1], points[0]);
        if (kind == PEL_JOINT_SLIDER)
            pel_vec3_along(points[0], -pel_vec3_dot(points[0], axes[1]), axes[1], points[0]);
        assert_true(pel_vec3_length(points[0]) < 1e-7);
        if (kind != PEL_JOINT_BALL)
            assert_near(pel_vec3_dot(axes[0], axes[1]), 1, 1e-9);
        if (kind == PEL_JOINT_WELD)
            assert_near(fabs(pel_vec3_dot(a.rotation, b.rotation) + a.rotation[3] * b.rotation[3]), 1, 1e-12);
        rigid_scene_end(&scene);
    }
}

/* a chain of four bars on ball joints hangs from the world: its first joint carries all */
static void test_chain(void **state)
{
    (void)state;
    enum { LINKS = 4 };
    static const char *const names[LINKS] = {"a", "b", "c", "d"};
    pel_joint_def joints[LINKS];
    rigid_scene scene;
    begin_joints(&scene, PEL_METHOD_XPBD, joints, LINKS);
    scene.gravity = -GRAVITY;
    scene.def.solver.drag = 3;
    for (int i = 0; i < LINKS; i++) {
        const double center[3] = {0.1 * i + 0.05, 0, 0};
        joints[i] = joint_of(names[i], PEL_JOINT_BALL, 0.1 * i, 0, 0);
        joints[i].body = i;
        joints[i].to_body = i - 1;
        rigid_scene_add(&scene, make_box(0.09, 0.02, 0.02, center), 1000);
    }
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 4);
    double weight = 0.036 * GRAVITY;
    for (int i = 0; i < LINKS; i++) {
        pel_joint_reading joint = read_joint(&scene, i);
        assert_near(joint.force[2], (LINKS - i) * weight, 0.02 * LINKS * weight);
        assert_near(rigid_scene_read(&scene, i).center[2], -0.1 * i - 0.05, 2e-3);
    }
    rigid_scene_end(&scene);
}

/* a box on an inclined slider moves with g sin a, until its limit holds it */
static void test_slider(void **state)
{
    (void)state;
    const double angle = 0.5;
    pel_joint_def joint;
    rigid_scene scene;
    begin_slider(&scene, PEL_METHOD_XPBD, &joint, angle);
    rigid_scene_run(&scene, 0.4);
    double along = GRAVITY * sin(angle);
    double h = 0.0025;
    assert_near(read_joint(&scene, 0).position / (0.5 * along * 0.4 * (0.4 + h)), 1, 1e-4);
    assert_near(read_joint(&scene, 0).speed / (along * (0.395 + 0.5 * h)), 1, 1e-4);
    rigid_scene_run(&scene, 2);
    pel_joint_reading end = read_joint(&scene, 0);
    pel_rigid_reading box = rigid_scene_read(&scene, 0);
    assert_near(end.position, 0.6, 1e-6);
    assert_near(end.load, -along, 1e-3 * along);
    assert_near(end.force[2], GRAVITY, 1e-3 * GRAVITY);
    assert_near(box.center[0], 0.3 - 0.6 * cos(angle), 1e-6);
    assert_near(box.rotation[3], 1, 1e-12);
    rigid_scene_end(&scene);
}

/* a motor turns a bar with its strength up to its speed, and its work is the energy of the bar; several turns */
static void test_motor(void **state)
{
    (void)state;
    static const double center[3] = {0, 0, 0};
    pel_joint_def joint = joint_of("motor", PEL_JOINT_HINGE, 0, 0, 0);
    double moment = 0.8 / 12 * (0.4 * 0.4 + 0.02 * 0.02), torque = 0.05, speed = 10;
    rigid_scene scene;
    joint.speed = speed;
    joint.strength = torque;
    begin_joints(&scene, PEL_METHOD_XPBD, &joint, 1);
    rigid_scene_add(&scene, make_box(0.4, 0.1, 0.02, center), 1000);
    rigid_scene_make(&scene);
    rigid_scene_run(&scene, 1);
    pel_joint_reading early = read_joint(&scene, 0);
    assert_near(early.position / (0.5 * torque / moment), 1, 0.01);
    assert_near(early.load, torque, 1e-9);
    rigid_scene_run(&scene, 4);
    pel_joint_reading end = read_joint(&scene, 0);
    pel_sim_ledger ledger;
    pel_sim_get_ledger(scene.sim, &ledger);
    double energy = 0.5 * moment * speed * speed;
    assert_near(end.speed, speed, 1e-6);
    assert_near(end.load, 0, 1e-6 * torque);
    assert_near(end.position, speed * 4 - 0.5 * speed * speed * moment / torque, 0.02);
    assert_near(end.work / energy, 1, 1e-3);
    assert_near(ledger.energy_error / energy, 0, 1e-3);
    assert_near(rigid_scene_read(&scene, 0).spin[1], speed, 1e-3);
    rigid_scene_end(&scene);
}

/* a bar falls on a hinge against its limit, lies there, and a motor lifts it again */
static void test_limit(void **state)
{
    (void)state;
    static const double center[3] = {0.2, 0, 0};
    pel_joint_def joint = joint_of("door", PEL_JOINT_HINGE, 0, 0, 0);
    rigid_scene scene;
    joint.most = 0.4;
    for (int k = 0; k < 2; k++) {
        joint.strength = k == 0 ? 0 : 4;
        joint.speed = k == 0 ? 0 : -1;
        begin_joints(&scene, PEL_METHOD_XPBD, &joint, 1);
        scene.gravity = -GRAVITY;
        rigid_scene_add(&scene, make_box(0.4, 0.1, 0.02, center), 1000);
        rigid_scene_make(&scene);
        rigid_scene_run(&scene, 1);
        pel_joint_reading end = read_joint(&scene, 0);
        if (k == 0) {
            assert_near(end.position, 0.4, 1e-6);
            assert_near(end.load, -0.8 * GRAVITY * 0.2 * cos(0.4), 2e-3);
        } else {
            double moment = 0.8 * ((0.4 * 0.4 + 0.02 * 0.02) / 12 + 0.2 * 0.2);
            double energy = 0.5 * moment + 0.8 * GRAVITY * 0.2 * sin(1);
            pel_sim_ledger ledger;
            pel_sim_get_ledger(scene.sim, &ledger);
            assert_near(end.position, -1, 0.02);
            assert_near(end.work / energy, 1, 0.01);
            assert_near(ledger.energy_error / energy, 0, 0.01);
            assert_near(ledger.dissipated_solver / energy, 0, 0.01);
        }
        rigid_scene_end(&scene);
    }
}

/* A box on a floor and one that it carries by a weld or a brake fall asleep together, the load of the joint stays, and
   a push of one wakes both. A motor that runs keeps them awake. */
static void test_sleep(void **state)
{
    (void)state;
    static const double centers[2][3] = {{0, 0, 0.055}, {0.11, 0, 0.1}}, speeds[3] = {0, 0, 1e-9};
    for (int k = 0; k < 3; k++) {
        pel_joint_def joint = joint_of("j", k == 0 ? PEL_JOINT_WELD : PEL_JOINT_HINGE, 0.055, 0, 0.055);
        rigid_scene scene;
        joint.to_body = 1;
        joint.strength = k == 0 ? 0 : 1;
        joint.speed = speeds[k];
        begin_joints(&scene, PEL_METHOD_XPBD, &joint, 1);
        scene.def.contact.enabled = true;
        scene.def.contact.friction = 0.3;
        scene.gravity = -GRAVITY;
        for (int b = 0; b < 2; b++)
            rigid_scene_add(&scene, make_box(0.1, 0.1, 0.1, centers[b]), 1500 - 1000 * b);
        rigid_scene_floor(&scene, 0);
        rigid_scene_make(&scene);
        rigid_scene_run(&scene, 4);
        assert_int_equal(scene.sim->contacts->asleep_count, k < 2 ? 2 : 0);
        if (k < 2) {
            static const double up[8][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1},
                                            {0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
            pel_joint_reading before = read_joint(&scene, 0);
            assert_near(before.force[2], -0.5 * GRAVITY, 1e-3 * GRAVITY);
            rigid_scene_run(&scene, 4.1);
            pel_joint_reading after = read_joint(&scene, 0);
            assert_memory_equal(before.force, after.force, sizeof after.force);
            assert_true(before.load == after.load && after.speed == 0);
            assert_int_equal(pel_sim_set_velocities(scene.sim, 1, up[0], NULL), PEL_OK);
            rigid_scene_run(&scene, 4.12);
            assert_int_equal(scene.sim->contacts->asleep_count, 0);
        } else {
            /* it does not creep */
            double before = read_joint(&scene, 0).position;
            rigid_scene_run(&scene, 5);
            assert_near(read_joint(&scene, 0).position - before, joint.speed, 1e-8);
        }
        rigid_scene_end(&scene);
    }
}

/* a motor drives into a limit and stays there; then the work that it did is what the bar lost there */
static void test_stop(void **state)
{
    (void)state;
    static const double center[3] = {0};
    pel_joint_def joint = joint_of("motor", PEL_JOINT_SLIDER, 0, 0, 0);
    rigid_scene scene;
    pel_sim_ledger ledger;
    joint.strength = 2;
    joint.speed = 10;
    joint.most = 0.3;
    begin_joints(&scene, PEL_METHOD_XPBD, &joint, 1);
    rigid_scene_add(&scene, make_box(0.1, 0.1, 0.1, center), 1000);
    rigid_scene_make(&scene);
    for (int i = 0; i < 200; i++) {
        rigid_scene_run(&scene, 0.01 * (i + 1));
        assert_true(read_joint(&scene, 0).position < 0.3 + 1e-9);
    }
    pel_joint_reading end = read_joint(&scene, 0);
    pel_sim_get_ledger(scene.sim, &ledger);
    assert_near(end.position, 0.3, 1e-9);
    assert_near(end.speed, 0, 1e-9);
    assert_near(end.work / (joint.strength * 0.3), 1, 0.01);
    assert_near(ledger.work_tools, end.work, 1e-12);
    assert_near(ledger.dissipated_solver / end.work, 1, 1e-6);
    rigid_scene_end(&scene);
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
        begin_joints(&scenes[i], PEL_METHOD_XPBD, &joint, 1);
        rigid_scene_add(&scenes[i], make_box(0.4, 0.1, 0.02, center), 1000);
        rigid_scene_make(&scenes[i]);
    }
    rigid_scene_run(&scenes[0], 1);
    size_t size = pel_sim_save_size(scenes[0].sim);
    void *bytes = malloc(size);
    pel_sim_save(scenes[0].sim, bytes);
    assert_int_equal(pel_sim_load(scenes[1].sim, bytes, size, NULL), PEL_OK);
    for (int i = 0; i < 2; i++)
        rigid_scene_run(&scenes[i], 1.5);
    pel_joint_reading a = read_joint(&scenes[0], 0), b = read_joint(&scenes[1], 0);
    assert_true(a.position > 2 * pi);
    assert_memory_equal(&a, &b, sizeof a);
    assert_true(pel_sim_hash(scenes[0].sim) == pel_sim_hash(scenes[1].sim));
    free(bytes);
    for (int i = 0; i < 2; i++)
        rigid_scene_end(&scenes[i]);
}

static void expect(rigid_scene *scene, const char *what)
{
    pel_error error = {0};
    assert_int_equal(rigid_scene_try(scene, &error), PEL_BAD_ARGUMENT);
    if (strstr(error.what, what) == NULL || error.remedy[0] == '\0')
        fail_msg("'%s' instead of '%s' (%s)", error.what, what, error.remedy);
    pel_model_destroy(scene->model);
}

static void test_refusals(void **state)
{
    (void)state;
    static const double center[3] = {0};
    pel_joint_def joints[2] = {joint_of("a", PEL_JOINT_HINGE, 0, 0, 0), joint_of("a", PEL_JOINT_BALL, 0, 0, 0)};
    rigid_scene scene;
    begin_joints(&scene, PEL_METHOD_XPBD, joints, 2);
    rigid_scene_add(&scene, make_box(0.1, 0.1, 0.1, center), 1000);
    rigid_scene_add(&scene, make_box(0.1, 0.1, 0.1, center), 1000)->rigid.on = false;
    expect(&scene, "two joints are called 'a'");
    scene.def.joint_count = 1;
    joints[0].body = 1;
    expect(&scene, "not rigid");
    joints[0].body = joints[0].to_body = 0;
    expect(&scene, "from a body to itself");
    joints[0].to_body = -1;
    joints[0].least = 0.1;
    expect(&scene, "beyond its limits");
    joints[0].kind = PEL_JOINT_BALL;
    expect(&scene, "without an axis");
    joints[0] = joint_of("", PEL_JOINT_BALL, 0, 0, 0);
    expect(&scene, "no name");
    joints[0] = joint_of("a", PEL_JOINT_SLIDER, 0, (double)NAN, 0);
    expect(&scene, "out of range");
    joints[0] = joint_of("a", PEL_JOINT_SLIDER, 0, 0, 0);
    pel_vec3_set(joints[0].axis, 0, 0, 0);
    expect(&scene, "no length");
    joints[0].kind = (pel_joint_kind)PEL_JOINT_KIND_COUNT;
    expect(&scene, "unknown kind");
    scene.model = NULL;
    rigid_scene_end(&scene);
}

static pel_status create(const void *data, pel_error *error)
{
    pel_sim *sim;
    pel_status status = pel_sim_create(data, &sim, error);
    if (status != PEL_OK)
        assert_null(sim);
    pel_sim_destroy(sim);
    return status;
}

static void test_memory(void **state)
{
    (void)state;
    static const double center[3] = {0};
    pel_joint_def joint = joint_of("a", PEL_JOINT_HINGE, 0, 0, 0);
    rigid_scene scene;
    begin_joints(&scene, PEL_METHOD_XPBD, &joint, 1);
    rigid_scene_add(&scene, make_box(0.1, 0.1, 0.1, center), 1000);
    rigid_scene_make(&scene);
    pel_sim_destroy(scene.sim);
    scene.sim = NULL;
    for_every_allocation_failure(create, &scene.def);
    rigid_scene_end(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pendulum), cmocka_unit_test(test_start_speed), cmocka_unit_test(test_pairs),
        cmocka_unit_test(test_chain),    cmocka_unit_test(test_slider),      cmocka_unit_test(test_motor),
        cmocka_unit_test(test_limit),    cmocka_unit_test(test_sleep),       cmocka_unit_test(test_stop),
        cmocka_unit_test(test_snapshot), cmocka_unit_test(test_refusals),    cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
