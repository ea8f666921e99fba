/* The score of a tear: forces against those of the tools, the way back, instruments on the far side. */
#define _XOPEN_SOURCE 700
#include "run/warned.h"
#include "session/play.h"

#include "math/vec3.h"
#include "pellicle/sim_reading.h"

static const char lens[] =
    "version: 1\n"
    "bodies:\n"
    "  - mesh: {shape: lens-capsule, frequency: 6}\n"
    "    mass: {per_vertex: 1.0e-6}\n"
    "    springs: {young: 1.5e6, thickness: 13e-6, toughness: 1300}\n"
    "    pinned: {box: {min: [-1, -1, -1], max: [1, 1, 0.001]}}\n"
    "cuts:\n"
    "  - path: [[0, 0, 0.00218], [0.00275, 0, 0.001562], [0.002382, 0.001375, 0.001562], [0.001375, 0.002382, "
    "0.001562]]\n"
    "tools:\n"
    "  - {name: forceps, shape: sphere, radius: 0.0003, press: false, grasp: {reach: 3e-4%s}, motion: [{position: "
    "[0.0021, 0.00153, 0.002]}]}\n"
    "solver: {method: quasi-static, dt: 0.0005}\n"
    "duration: 1\n";

static void write_lens(bool leads, char text[2000])
{
    snprintf(text, 2000, lens, leads ? ", lead: {radius: 0.00275, speed: 0.004, regrasp: 0.003}" : "");
}

static play begin_lens(bool leads)
{
    char text[2000];
    write_lens(leads, text);
    return begin(text);
}

static pel_score score(const play *made)
{
    pel_score read;
    assert_true(pel_sim_get_score(made->sim, &read));
    return read;
}

static void test_forces(void **unused)
{
    (void)unused;
    play made = begin_lens(true);
    /* a tool that touches nothing comes after the forceps */
    apply(&made, "press hook 0.0001 0 0 0.02 0 0 0 1");
    double peak = 0, squares = 0, begin_time = -1, time = 0;
    int pulls = 0;
    bool done;
    assert_true(score(&made).force_rms == 0 && score(&made).hole.aim == 0.00275);
    for (int i = 0; i < 400; i++) {
        pel_tool_reading tool;
        steps(&made, 1);
        pel_sim_get_tool(made.sim, 0, &tool);
        double force = pel_vec3_length(tool.force);
        if (force > 0) {
            time = pel_sim_time(made.sim);
            begin_time = begin_time < 0 ? time : begin_time;
            peak = fmax(peak, force);
            squares += force * force;
            pulls++;
        }
    }
    pel_score read = score(&made);
    assert_true(pulls > 100 && peak > 0.001);
    assert_near(read.force_peak, peak, 0);
    assert_near(read.force_rms, sqrt(squares / pulls), 1e-12);
    assert_near(read.time, time - begin_time, 1e-12);
    assert_true(read.hole.swept > 0.9 && read.touch_count == 0);
    apply(&made, "mark");
    steps(&made, 200);
    assert_true(score(&made).time > read.time);
    assert_int_equal(pel_session_undo(made.session, &done, NULL), PEL_OK);
    assert_true(score(&made).time == read.time && score(&made).force_rms == read.force_rms);
    assert_int_equal(pel_session_reset(made.session, NULL), PEL_OK);
    assert_true(score(&made).force_peak == 0);
    end(&made);
}

/* the posterior pole is at z = -2.3 mm: a point within the lens does not touch it, one beyond does; reset forgets */
static void test_far_side(void **unused)
{
    (void)unused;
    play made = begin_lens(true);
    /* forceps that begin at the far side take the flap instead */
    apply(&made, "grasp 0.001 0 -1 0 0 1 0.0003 1");
    steps(&made, 3);
    assert_int_equal(score(&made).touch_count, 0);
    apply(&made, "release");
    apply(&made, "press hook 0.0001 0 0 -0.001 0 0 0 1");
    steps(&made, 1);
    assert_int_equal(score(&made).touch_count, 0);
    apply(&made, "move 0 0 -0.004");
    steps(&made, 600);
    assert_true(score(&made).touch_count > 10 && score(&made).touch_count < 600);
    assert_int_equal(pel_session_reset(made.session, NULL), PEL_OK);
    assert_int_equal(score(&made).touch_count, 0);
    end(&made);
}

static void test_nothing(void **unused)
{
    (void)unused;
    play made = begin_lens(false);
    pel_score read = {.force_peak = 1};
    steps(&made, 1);
    assert_false(pel_sim_get_score(made.sim, &read));
    assert_true(read.force_peak == 0);
    end(&made);
}

/* the first cut covers 60 degrees of the circle */
static void test_summary(void **unused)
{
    (void)unused;
    char text[2000];
    const char *brief = "duration=0.002";
    pel_run_summary summary;
    write_lens(true, text);
    run_scene(text, &brief, 1, NULL, 0, &summary);
    check_contains("warned", "summary.json", "\"hole\": {\"whole\": false, \"swept\": 1.");
    check_contains("warned", "summary.json", "\"score\": {\"force_peak\": 0");
    check_contains("warned", "summary.json", "\"roundness\": null, \"run_outs\": 0, \"largest_radius\": 0.002");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forces),
        cmocka_unit_test(test_far_side),
        cmocka_unit_test(test_nothing),
        cmocka_unit_test(test_summary),
    };
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
