/* Joints of scenes: units, bodies by name, defaults, and bad input with its place. */
#include "scene_run.h"

#include <math.h>

#define BOX(name, x)                                                                                                   \
    "  - name: " name "\n    mesh: { shape: box, size_x: 0.1, size_y: 0.1, size_z: 0.1, translate: [" x                \
    ", 0, 0] }\n    rigid: {}\n"
#define SOFT                                                                                                           \
    "  - name: soft\n    mesh: { shape: grid, nx: 4, ny: 4, size_x: 0.1, size_y: 0.1, translate: [0, 0, 1] }\n"        \
    "    membrane: { young: 1e5, thickness: 1e-3 }\n"
#define TWO "version: 1\nbodies:\n" BOX("a", "0") BOX("b", "0.2") "duration: 1\njoints:\n"
#define ONE "version: 1\nbodies:\n" BOX("a", "0") "duration: 1\njoints:\n"

static void test_units(void **unused)
{
    (void)unused;
    const double degree = 3.14159265358979323846 / 180;
    run r;
    check_begin(&r,
                TWO "  - { body: b, to: a, kind: hinge, point: [1, 2, 3], least: -90, motor: { speed: 45, strength: "
                    "2 } }\n  - { name: rail, body: a, kind: slider, point: [0, 0, 0], axis: [1, 0, 0], least: "
                    "-0.5, most: 0.25, motor: { speed: 2, strength: 3 } }\n");
    const pel_joint_def *joints = r.scene->sim.joints;
    assert_int_equal(pel_sim_joint_count(r.sim), 2);
    assert_string_equal(pel_sim_joint_name(r.sim, 0), "joint1");
    assert_string_equal(pel_sim_joint_name(r.sim, 1), "rail");
    assert_true(joints[0].body == 1 && joints[0].to_body == 0 && joints[0].kind == PEL_JOINT_HINGE);
    assert_true(joints[0].point[1] == 2 && joints[0].axis[2] == 1 && joints[0].strength == 2);
    assert_near(joints[0].least, -90 * degree, 1e-12);
    assert_near(joints[0].speed, 45 * degree, 1e-12);
    assert_true(isinf(joints[0].most) && joints[0].most > 0);
    assert_true(joints[1].body == 0 && joints[1].to_body == -1 && joints[1].axis[0] == 1);
    assert_true(joints[1].least == -0.5 && joints[1].most == 0.25 && joints[1].speed == 2);
    end(&r);
}

/* one body needs no name */
static void test_one(void **unused)
{
    (void)unused;
    run r;
    check_begin(&r, ONE "  - { kind: ball, point: [0, 0, 0] }\n");
    pel_joint_reading reading;
    assert_false(pel_sim_get_joint(r.sim, 1, &reading));
    assert_true(pel_sim_get_joint(r.sim, 0, &reading));
    assert_true(reading.position == 0 && reading.force[2] == 0);
    end(&r);
}

static void test_refusals(void **unused)
{
    (void)unused;
    static const refusal cases[] = {
        {TWO "  - { body: c, kind: ball, point: [0, 0, 0] }\n", "unknown body 'c'"},
        {TWO "  - { kind: ball, point: [0, 0, 0] }\n", "does not say on which body"},
        {TWO "  - { body: a, to: c, kind: ball, point: [0, 0, 0] }\n", "unknown body 'c'"},
        {TWO "  - { body: a, to: a, kind: ball, point: [0, 0, 0] }\n", "from a body to itself"},
        {TWO "  - { body: a, kind: ball }\n", "point"},
        {TWO "  - { body: a, kind: spring, point: [0, 0, 0] }\n", "spring"},
        {TWO "  - { body: a, kind: ball, point: [0, 0, 0], most: 3 }\n", "without an axis"},
        {TWO "  - { body: a, kind: hinge, point: [0, 0, 0], least: 3 }\n", "beyond its limits"},
        {TWO "  - { body: a, kind: hinge, point: [0, 0, 0], motor: { speed: 1 } }\n", "strength"},
        {"version: 1\nbodies:\n" SOFT "duration: 1\njoints:\n  - { kind: ball, point: [0, 0, 0] }\n", "not rigid"},
    };
    check_refusals(cases, sizeof cases / sizeof *cases);
}

#define RAIL "  - { name: rail, body: a, kind: slider, point: [0, 0, 0], axis: [1, 0, -1]"
#define STATIC "gravity: [0, 0, -9.81]\nsolver: { method: static }\n"

/* a weight on a slanted slider has an equilibrium at a limit below it alone */
static void test_free_slider(void **unused)
{
    (void)unused;
    static const refusal bad[] = {
        {ONE RAIL " }\n" STATIC,
         "joint 'rail' leaves body 'a' free to slide along (0.707, 0, -0.707), where 6.94 N act"},
        {ONE RAIL ", least: -0.1 }\n" STATIC, "free to slide"},
    };
    check_refusals(bad, sizeof bad / sizeof *bad);
    run r;
    check_begin(&r, ONE RAIL ", most: 0.05 }\n" STATIC);
    assert_int_equal(pel_sim_step(r.sim, NULL), PEL_OK);
    pel_joint_reading reading;
    pel_sim_get_joint(r.sim, 0, &reading);
    assert_near(reading.position, 0.05, 1e-6);
    assert_near(reading.load, -9.81 / sqrt(2), 1e-4);
    end(&r);
    check_begin(&r, ONE "  - { body: a, kind: slider, point: [0, 0, 0], axis: [1, 0, 0] }\n" STATIC);
    end(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_units),
        cmocka_unit_test(test_one),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_free_slider),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
