#include "check.h"

#include "choice/plan.h"

static pel_scene make_scene(double dt, double duration, double every, int32_t every_frame)
{
    pel_scene scene = {.duration = duration, .output = {.every = every, .every_frame = every_frame}};
    scene.sim.solver.dt = dt;
    return scene;
}

static void check_plan(const pel_run_plan *plan, int64_t step_total, int64_t frame_total)
{
    assert_int_equal(plan->step_total, step_total);
    assert_int_equal(plan->frame_total, frame_total);
    assert_int_equal(pel_run_plan_step(plan, 0), 0);
    for (int64_t frame = 1; frame <= frame_total; frame++)
        assert_true(pel_run_plan_step(plan, frame) > pel_run_plan_step(plan, frame - 1));
    assert_int_equal(pel_run_plan_step(plan, frame_total), step_total);
}

static void test_frames(void **unused)
{
    (void)unused;
    const struct {
        double dt, duration, every;
        int32_t every_frame;
        int64_t steps, frames;
    } cases[] = {
        {0.01, 10, 0.1, 0, 1000, 100},    {0.01, 10, 0, 10, 1000, 100},    {0.01, 10, 0.3, 0, 1000, 34},
        {1.0 / 60, 10, 0.1, 0, 600, 100}, {0.0166667, 10, 0, 1, 600, 600}, {0.01, 1, 0.001, 0, 100, 100},
        {0.01, 1, 0.015, 0, 100, 67},     {0.01, 0.001, 0.1, 0, 1, 1},     {0.01, 1, 5, 0, 100, 1},
        {0.003, 1, 0.01, 0, 333, 100},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        pel_scene scene = make_scene(cases[i].dt, cases[i].duration, cases[i].every, cases[i].every_frame);
        pel_run_plan plan = pel_run_plan_make(&scene, 0);
        check_plan(&plan, cases[i].steps, cases[i].frames);
        assert_int_equal(plan.frame_end, plan.frame_total);
    }
}

static void test_ends(void **unused)
{
    (void)unused;
    pel_scene scene = make_scene(0.01, 10, 0.1, 0);
    scene.output.checkpoint = 0.5;
    pel_run_plan plan = pel_run_plan_make(&scene, 7);
    assert_int_equal(plan.frame_end, 7);
    assert_int_equal(plan.checkpoint_steps, 50);
    assert_true(pel_run_plan_time(&plan, 7) == 70 * 0.01);
    assert_int_equal(pel_run_plan_make(&scene, 1000).frame_end, 100);
    assert_int_equal(pel_run_plan_make(&scene, 1).frame_end, 1);
    /* a time ends the plan too; more steps than can be counted are as many as can be */
    scene.time_limit = 2.5;
    assert_int_equal(pel_run_plan_make(&scene, 0).step_total, 250);
    scene = make_scene(1e-300, 1e300, 0, 1);
    plan = pel_run_plan_make(&scene, 0);
    assert_true(plan.step_total == INT64_C(1000000000000000) && plan.frame_total == plan.step_total);
}

/* the last moment at which anything is scheduled to change */
/* what a run still writes, from its start and where it goes on */
static void test_need(void **unused)
{
    (void)unused;
    pel_scene scene = make_scene(0.01, 10, 0.1, 0);
    scene.output.checkpoint = 0.5;
    pel_run_plan plan = pel_run_plan_make(&scene, 0);
    pel_disk_need need = pel_run_plan_need(&plan, &scene, 0, 0);
    assert_true(need.frame_count == 101 && need.checkpoint_count == 20 && !need.may_take_less);
    assert_near(need.frame_seconds, 0.1, 1e-12);
    assert_near(need.checkpoint_seconds, 0.5, 1e-12);
    need = pel_run_plan_need(&plan, &scene, 50, 500);
    assert_true(need.frame_count == 51 && need.checkpoint_count == 10);
    plan = pel_run_plan_make(&scene, 7);
    need = pel_run_plan_need(&plan, &scene, 0, 0);
    assert_true(need.frame_count == 8 && need.checkpoint_count == 1);
    scene.output.checkpoint = 0;
    plan = pel_run_plan_make(&scene, 0);
    assert_true(pel_run_plan_need(&plan, &scene, 0, 0).checkpoint_count == 0);
    for (int rule = 0; rule < 4; rule++) {
        pel_scene ends = scene;
        ends.rest_speed = rule == 0;
        ends.least_volume_ratio = rule == 1;
        ends.stop_at_contact = rule == 2;
        ends.sim.solver.path = rule == 3 ? PEL_PATH_ARC_LENGTH : ends.sim.solver.path;
        assert_true(pel_run_plan_need(&plan, &ends, 0, 0).may_take_less);
    }
}

static void test_settled(void **unused)
{
    (void)unused;
    const pel_key keys[2] = {{0, 1}, {3, 2}};
    const pel_pose_key poses[2] = {{.time = 0}, {.time = 4}};
    pel_load_def load = {.from = 1, .until = (double)HUGE_VAL, .keys = keys, .key_count = 2};
    pel_tool_def tool = {.keys = poses, .key_count = 2, .grasp = true, .grasp_from = 2, .grasp_until = 6};
    pel_body_def body = {.spring_stiffness = {.keys = keys, .key_count = 2}};
    pel_scene scene = make_scene(0.01, 10, 0.1, 0);
    assert_true(pel_run_plan_make(&scene, 0).settled_time == 0);
    scene.model.bodies = &body;
    scene.model.body_count = 1;
    assert_true(pel_run_plan_make(&scene, 0).settled_time == 3);
    scene.sim.loads = &load;
    scene.sim.load_count = 1;
    load.until = 3.5;
    assert_true(pel_run_plan_make(&scene, 0).settled_time == 3.5);
    scene.sim.tools = &tool;
    scene.sim.tool_count = 1;
    assert_true(pel_run_plan_make(&scene, 0).settled_time == 6);
    tool.grasp = false;
    assert_true(pel_run_plan_make(&scene, 0).settled_time == 4);
    /* parts of a shell that change over time */
    const pel_key late[3][2] = {{{0, 1}, {7, 2}}, {{0, 1}, {8, 2}}, {{0, 1}, {9, 2}}};
    pel_anisotropy_def fibres = {.rest_length = {.keys = late[2], .key_count = 2}};
    body.shell.pressure.outside = (pel_quantity){.keys = late[0], .key_count = 2};
    assert_true(pel_run_plan_make(&scene, 0).settled_time == 7);
    body.shell.pressure.target = (pel_quantity){.keys = late[1], .key_count = 2};
    assert_true(pel_run_plan_make(&scene, 0).settled_time == 8);
    body.shell.pressure.outside = (pel_quantity){0};
    assert_true(pel_run_plan_make(&scene, 0).settled_time == 8);
    body.shell.anisotropies = &fibres;
    body.shell.anisotropy_count = 1;
    assert_true(pel_run_plan_make(&scene, 0).settled_time == 9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_frames), cmocka_unit_test(test_ends),
                                       cmocka_unit_test(test_need), cmocka_unit_test(test_settled)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
