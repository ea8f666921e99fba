/* Runs that are stopped or killed, and go on. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "run/run_fixture.h"

static void test_resume_after_stop(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(busy, NULL, 0);
    run_case whole = {.run = "whole", .threads = 3 - thread_count};
    check_run(scene, &whole, PEL_OK);
    const int64_t stops[] = {1, 7, 13, 22, 35, 59};
    for (size_t i = 0; i < sizeof stops / sizeof stops[0]; i++) {
        char run[32];
        snprintf(run, sizeof run, "stop-%d", (int)stops[i]);
        run_case test = {.run = run, .stop_at = stops[i]};
        check_run(scene, &test, PEL_STOPPED);
        assert_string_equal(test.summary.status, "stopped");
        assert_int_equal(test.summary.steps, stops[i]);
        /* exactly the state at which it stopped, although older checkpoints were written before */
        char kept[64];
        snprintf(kept, sizeof kept, "the last good state, of step %d, is in ", (int)stops[i]);
        assert_non_null(strstr(test.error.remedy, kept));
        check_contains(run, "summary.json", "\"status\": \"stopped\"");
        check_whole(run);
        run_case rest = {.run = run, .resume = "checkpoint"};
        check_run(scene, &rest, PEL_OK);
        assert_true(rest.summary.state_hash == whole.summary.state_hash);
        check_same_results("whole", run, whole.summary.frames);
    }
    pel_scene_destroy(scene);
}

/* the wall time of a run goes on after a resume: that of both parts, and none beside */
static void test_wall_time(void **unused)
{
    (void)unused;
    enum { NAP = 300 };
    pel_scene *scene = load_scene(busy, NULL, 0);
    run_case test = {.run = "wall", .stop_at = 50, .nap = NAP};
    double start = pel_seconds();
    check_run(scene, &test, PEL_STOPPED);
    test.stop_at = 0;
    test.resume = "checkpoint";
    check_run(scene, &test, PEL_OK);
    assert_true(test.summary.wall_s >= 1e-3 * NAP);
    assert_true(test.summary.wall_s <= pel_seconds() - start);
    pel_scene_destroy(scene);
}

/* stopped before its first step, resumed and stopped there again, with no frame that is due: measured all the same */
static void test_stops_at_start(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(busy, NULL, 0);
    run_case test = {.run = "start", .stop_at = -1};
    check_run(scene, &test, PEL_STOPPED);
    assert_int_equal(test.summary.steps, 0);
    assert_near(test.summary.volume_ratio_final, 1, 1e-12);
    assert_near(test.summary.area_ratio_final, 1, 1e-12);
    test.resume = "checkpoint";
    check_run(scene, &test, PEL_STOPPED);
    assert_int_equal(test.summary.steps, 0);
    assert_near(test.summary.volume_ratio_final, 1, 1e-12);
    assert_near(test.summary.area_ratio_final, 1, 1e-12);
    pel_scene_destroy(scene);
}

/* returns to an older checkpoint: later frames are replaced */
static void test_resume_from_older(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(busy, NULL, 0);
    run_case whole = {.run = "older-whole"}, test = {.run = "older"};
    check_run(scene, &whole, PEL_OK);
    check_run(scene, &test, PEL_OK);
    assert_true(exists("older", "checkpoint-11.pel") && exists("older", "checkpoint-55.pel"));
    test.resume = "checkpoint-22.pel";
    test.stop_at = 24;
    check_run(scene, &test, PEL_STOPPED);
    assert_false(exists("older", "frames/f00004.vtp"));
    check_whole("older");
    test.resume = "checkpoint";
    test.stop_at = 0;
    check_run(scene, &test, PEL_OK);
    check_same_results("older-whole", "older", whole.summary.frames);
    pel_scene_destroy(scene);
}

/* killed at a step: all files are valid, and the run continues from its last checkpoint */
static void check_kill(const pel_scene *scene, const run_case *whole, int64_t step, double keep_seconds)
{
    run_case test = {.run = "killed", .kill_at = step, .keep_seconds = keep_seconds};
    pid_t child = fork();
    if (child == 0) {
        do_run(scene, &test);
        _exit(1);
    }
    int ended;
    assert_int_equal(waitpid(child, &ended, 0), child);
    assert_true(WIFSIGNALED(ended) && WTERMSIG(ended) == SIGKILL);
    assert_false(exists("killed", "summary.json"));
    assert_true(check_list("killed") > 0);
    assert_true(count_rows("killed") >= check_list("killed"));
    run_case rest = {.run = "killed", .resume = "checkpoint"};
    check_run(scene, &rest, PEL_OK);
    check_same_results(whole->run, "killed", whole->summary.frames);
}

static void test_kill(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(busy, NULL, 0);
    run_case whole = {.run = "kill-whole"};
    check_run(scene, &whole, PEL_OK);
    for (int64_t step = 11; step < 60; step += 8)
        check_kill(scene, &whole, step, 0);
    pel_scene_destroy(scene);
}

/* a run that asks for no checkpoints keeps its state all the same, from the first step on when it may */
static void test_kept_state(void **unused)
{
    (void)unused;
    const char *const override = "output.checkpoint=0";
    pel_scene *scene = load_scene(busy, &override, 1);
    run_case whole = {.run = "kept-whole", .keep_seconds = 1e-9};
    check_run(scene, &whole, PEL_OK);
    assert_false(exists("kept-whole", "checkpoint"));
    for (int64_t step = 2; step < 60; step += 25)
        check_kill(scene, &whole, step, 1e-9);
    pel_scene_destroy(scene);
}

static bool limit_for_a_while(void *user, const pel_run_progress *progress)
{
    (void)user;
    if (progress->step == 0)
        limit_files(16);
    else if (progress->step == 5)
        unlimit_files();
    return true;
}

static void take_note(void *user, const char *text)
{
    snprintf(user, 400, "%s", text);
}

/* a state that cannot be kept is reported, and the run continues */
static void test_state_not_kept(void **unused)
{
    (void)unused;
    const char *const overrides[2] = {"output.checkpoint=0", "output.every_frame=50"};
    pel_scene *scene = load_scene(small, overrides, 2);
    char path[256], note[400] = "";
    const pel_log log = {take_note, note};
    pel_run_def def = pel_run_def_default();
    pel_run_summary summary;
    def.folder = in_folder(path, "not-kept", "");
    def.keep_seconds = 1e-9;
    def.progress = limit_for_a_while;
    def.log = &log;
    def.thread_count = 1;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(pel_run(scene, &def, &summary, NULL), PEL_OK);
    signal(SIGXFSZ, SIG_DFL);
    assert_non_null(strstr(note, "the state of step 1 is not kept: "));
    assert_string_equal(summary.status, "done");
    check_whole("not-kept");
    def.keep_seconds = -1;
    assert_int_equal(pel_run(scene, &def, &summary, NULL), PEL_BAD_ARGUMENT);
    pel_scene_destroy(scene);
}

/* memory of a resumed state is freed again */
static void test_resume_leaks_nothing(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(small, NULL, 0);
    run_case test = {.run = "leaks", .stop_at = 5};
    check_run(scene, &test, PEL_STOPPED);
    test = (run_case){.run = "leaks", .resume = "checkpoint", .max_frames = 8};
    failing_malloc_begin(0);
    pel_status status = do_run(scene, &test);
    long live = failing_malloc_end().live;
    assert_int_equal(status, PEL_OK);
    assert_int_equal(live, 0);
    pel_scene_destroy(scene);
}

/* another mesh file under the same name is another scene, of a body or a tool, also when its fields alone have changed
 */
static void check_changed_mesh(const char *scene_text, const char *run)
{
    static const char *const changes[5] = {"0.25", "0.75", "0.25", "0.25", "0.25"},
                             *const names[5] = {"stiff", "stiff", "soft", "stiff", "stiff"},
                             *const tips[5] = {"1", "1", "1", "2", "1"},
                             *const faces[5] = {"0 2 1", "0 2 1", "0 2 1", "0 2 1", "2 1 0"};
    char path[256], text[1000], mesh[400];
    in_folder(path, "changed.ply", "");
    snprintf(text, sizeof text, scene_text, path);
    run_case test = {.run = run, .stop_at = 3};
    for (int i = 0; i < 5; i++) {
        snprintf(mesh, sizeof mesh,
                 "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
                 "property double %s\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
                 "0 0 0 0.5\n1 0 0 0.5\n0 1 0 0.5\n0 0 %s %s\n3 %s\n3 0 1 3\n3 1 2 3\n3 2 0 3\n",
                 names[i], tips[i], changes[i], faces[i]);
        FILE *stream = fopen(path, "w");
        assert_non_null(stream);
        fputs(mesh, stream);
        fclose(stream);
        pel_scene *scene = load_scene(text, NULL, 0);
        check_run(scene, &test, i == 0 ? PEL_STOPPED : PEL_BAD_FORMAT);
        assert_true(i == 0 || strstr(test.error.what, "another scene") != NULL);
        test = (run_case){.run = run, .resume = "checkpoint"};
        pel_scene_destroy(scene);
    }
}

static void test_changed_mesh(void **unused)
{
    (void)unused;
    check_changed_mesh("version: 1\nduration: 0.1\nbodies: [{ mesh: { file: %s } }]\n", "changed");
    check_changed_mesh("version: 1\nduration: 0.1\nbodies: [{ mesh: { shape: geodesic-sphere, frequency: 2 } }]\n"
                       "tools: [{ name: probe, mesh: { file: %s }, motion: [{ position: [5, 0, 0] }] }]\n"
                       "contact: { friction: 0 }\n",
                       "changed-tool");
}

/* a run that is over stays as it is */
static void test_resume_at_end(void **unused)
{
    (void)unused;
    const char *const override = "output.checkpoint=0.1";
    pel_scene *scene = load_scene(busy, &override, 1);
    run_case whole = {.run = "end-whole"}, test = {.run = "end"};
    check_run(scene, &whole, PEL_OK);
    check_run(scene, &test, PEL_OK);
    test.resume = "checkpoint-60.pel";
    check_run(scene, &test, PEL_OK);
    assert_int_equal(test.summary.frames, 10);
    check_same_results("end-whole", "end", whole.summary.frames);
    check_whole("end");
    pel_scene_destroy(scene);
}

static void test_refuses_checkpoints(void **unused)
{
    (void)unused;
    const char *const override = "bodies.ball.springs.stiffness=4";
    const char *const duration = "duration=0.7", *const press = "tools.probe.press=false";
    pel_scene *scene = load_scene(busy, NULL, 0), *other = load_scene(busy, &override, 1);
    pel_scene *later = load_scene(busy, &duration, 1), *bare = load_scene(busy, &press, 1);
    run_case test = {.run = "refuse", .stop_at = 25};
    char path[256];
    size_t size;
    check_run(scene, &test, PEL_STOPPED);
    char *series, *bytes, *now;
    read_text("refuse", "series.csv", &series, NULL);
    read_text("refuse", "checkpoint", &bytes, &size);
    test.resume = "checkpoint";
    check_run(other, &test, PEL_BAD_FORMAT);
    assert_string_equal(test.error.what, "the checkpoint belongs to another scene: it was made with other springs");
    check_run(later, &test, PEL_BAD_FORMAT);
    assert_non_null(strstr(test.error.what, "made with other output, duration, stop or names"));
    check_run(bare, &test, PEL_BAD_FORMAT);
    assert_non_null(strstr(test.error.what, "made with other tools"));
    assert_string_equal(test.error.file, in_folder(path, "refuse", "checkpoint"));
    test.resume = "no-such-checkpoint";
    check_run(scene, &test, PEL_BAD_FILE);
    test.resume = "damaged";
    const size_t places[] = {0, 9, 30, 50, size / 2, size - 1};
    for (size_t i = 0; i <= sizeof places / sizeof places[0]; i++) {
        bool cut = i == sizeof places / sizeof places[0];
        FILE *stream = fopen(in_folder(path, "refuse", "damaged"), "wb");
        bytes[cut ? 0 : places[i]] ^= (char)(cut ? 0 : 4);
        fwrite(bytes, 1, cut ? size / 2 : size, stream);
        bytes[cut ? 0 : places[i]] ^= (char)(cut ? 0 : 4);
        fclose(stream);
        check_run(scene, &test, PEL_BAD_FORMAT);
    }
    FILE *old = fopen(in_folder(path, "refuse", "damaged"), "wb");
    bytes[6]--;
    fwrite(bytes, 1, size, old);
    fclose(old);
    check_run(scene, &test, PEL_BAD_FORMAT);
    assert_non_null(strstr(test.error.what, "written by another version"));
    /* in another folder there is no series to go on with */
    run_case elsewhere = {.run = "refuse-elsewhere", .resume = "../refuse/checkpoint"};
    mkdir(in_folder(path, "refuse-elsewhere", ""), 0777);
    check_run(scene, &elsewhere, PEL_BAD_FILE);
    assert_non_null(strstr(elsewhere.error.remedy, "folder of the run"));
    write_text("refuse-elsewhere", "series.csv", "frame,time\n0,0\n");
    check_run(scene, &elsewhere, PEL_BAD_FORMAT);
    /* nothing was touched by all that */
    read_text("refuse", "series.csv", &now, NULL);
    assert_string_equal(series, now);
    pel_free(now);
    pel_free(series);
    pel_free(bytes);
    pel_scene_destroy(bare);
    pel_scene_destroy(later);
    pel_scene_destroy(other);
    pel_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_resume_after_stop),
        cmocka_unit_test(test_resume_from_older),
        cmocka_unit_test(test_resume_at_end),
        cmocka_unit_test(test_kill),
        cmocka_unit_test(test_resume_leaks_nothing),
        cmocka_unit_test(test_changed_mesh),
        cmocka_unit_test(test_kept_state),
        cmocka_unit_test(test_state_not_kept),
        cmocka_unit_test(test_refuses_checkpoints),
        cmocka_unit_test(test_stops_at_start),
        cmocka_unit_test(test_wall_time),
    };
    int failed = 0;
    /* two threads give the results of one */
    for (thread_count = ROUNDS(1, 2); thread_count <= 2; thread_count++)
        failed += cmocka_run_group_tests(tests, make_folder, clear_folder);
    return failed;
}
