#define _XOPEN_SOURCE 700 /* nftw */
#include "check.h"

#include "base/memory.h"
#include "failing_malloc.h"
#include "io/file.h"
#include "pellicle/frames.h"
#include "pellicle/json.h"
#include "pellicle/run.h"
#include "pellicle/study.h"
#include "study/study.h"

#include <ftw.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const char scene_text[] =
    "version: 1\n"
    "bodies:\n"
    "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 2 }, mass: { per_vertex: 1 },\n"
    "      springs: { stiffness: 3, damping: 0.5 }, volumetric: { stiffness: 1.5, damping: 0.5 } }\n"
    "loads: [{ name: finger, body: ball, force: [0, 0, -1], at: { nearest: [0, 0, 1] } }]\n"
    "solver: { method: quasi-static, alpha: 20, dt: 0.01 }\n"
    "duration: 0.2\noutput: { every_frame: 5 }\n";

/* the second value is refused, and the third alpha too */
static const char mixed[] =
    "scene: scene.yaml\n"
    "vary:\n"
    "  - { bodies.ball.springs.stiffness: [1, -2, 3], loads.finger.force: [[0, 0, -1], [0, 0, -2], "
    "[0, 0, -3]] }\n"
    "  - { solver.alpha: [10, 20, 1e9] }\n"
    "measure:\n"
    "  depth: max_displacement\n"
    "  hash: state_hash\n"
    "  start: { column: max_displacement, at: start }\n"
    "  end: { column: max_displacement }\n"
    "  least: { column: volume_ratio, at: min }\n"
    "  most: { column: volume_ratio, at: max }\n"
    "  mean: { column: volume_ratio, at: mean }\n";

static char folder[64];

static int remove_entry(const char *path, const struct stat *information, int kind, struct FTW *place)
{
    (void)information;
    (void)kind;
    (void)place;
    return remove(path);
}

static char *in_folder(char path[256], const char *name)
{
    snprintf(path, 256, "%s/%s", folder, name);
    return path;
}

static void write_file(const char *name, const char *text)
{
    char path[256];
    FILE *file = fopen(in_folder(path, name), "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

static char *read_file(const char *name)
{
    char path[256], *bytes;
    size_t size;
    assert_int_equal(pel_file_read(in_folder(path, name), &bytes, &size, NULL), PEL_OK);
    return bytes;
}

static int set_up(void **unused)
{
    (void)unused;
    snprintf(folder, sizeof folder, "study-test-XXXXXX");
    if (mkdtemp(folder) == NULL)
        return -1;
    write_file("scene.yaml", scene_text);
    return 0;
}

static int tear_down(void **unused)
{
    (void)unused;
    nftw(folder, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
    return 0;
}

static pel_status parse(const char *text, pel_study **study, pel_error *error)
{
    char path[256];
    return pel_study_parse(in_folder(path, "study.yaml"), text, strlen(text), study, error);
}

static pel_study *make_study(const char *text)
{
    pel_study *study;
    pel_error error;
    char message[1200];
    pel_status status = parse(text, &study, &error);
    if (status != PEL_OK)
        print_error("%s\n", pel_error_text(&error, message, sizeof message));
    assert_int_equal(status, PEL_OK);
    return study;
}

static pel_study_summary execute(const char *text, const char *place, int32_t threads, int32_t chunk, int32_t count)
{
    char path[256];
    pel_study *study = make_study(text);
    pel_study_def def = pel_study_def_default();
    pel_study_summary summary;
    def.folder = in_folder(path, place);
    def.thread_count = threads;
    def.chunk = chunk;
    def.chunk_count = count;
    assert_int_equal(pel_study_execute(study, &def, &summary, NULL), PEL_OK);
    pel_study_destroy(study);
    return summary;
}

static void check_same(const char *first, const char *second)
{
    char *a = read_file(first), *b = read_file(second);
    assert_string_equal(a, b);
    pel_free(a);
    pel_free(b);
}

/* ---- the design ---- */

static void row_of(const pel_study *study, int64_t run, char row[8192])
{
    assert_true(pel_study_row_size(study) <= 8192);
    assert_int_equal(pel_study_run(study, run, NULL, NULL, NULL, row, NULL), PEL_OK);
}

static void check_start(const pel_study *study, int64_t run, const char *expected)
{
    char row[8192];
    row_of(study, run, row);
    if (strncmp(row, expected, strlen(expected)) != 0)
        print_error("row '%s' does not begin with '%s'\n", row, expected);
    assert_memory_equal(row, expected, strlen(expected));
}

static void test_design(void **unused)
{
    (void)unused;
    pel_study *study = make_study("scene: scene.yaml\nvary:\n"
                                  "  solver.alpha: [10, 20]\n"
                                  "  solver.dt: { from: 0.01, to: 0.04, count: 3, scale: log }\n"
                                  "  bodies.ball.springs.stiffness: { from: 1, to: 3, sobol: 4 }\n"
                                  "  bodies.ball.volumetric.stiffness: { from: 1, to: 2, sobol: 4 }\n"
                                  "measure: [steps]\n");
    assert_int_equal(pel_study_run_count(study), 2 * 3 * 4);
    assert_string_equal(pel_study_header(study), "run,solver.alpha,solver.dt,bodies.ball.springs.stiffness,"
                                                 "bodies.ball.volumetric.stiffness,steps,status,error");
    check_start(study, 0, "0,10,0.01,1,1,20,done,");
    check_start(study, 1, "1,10,0.01,2,1.5,20,done,");
    check_start(study, 2, "2,10,0.01,2.5,1.25,20,done,");
    check_start(study, 4, "4,10,0.02,1,1,10,done,");
    check_start(study, 23, "23,20,0.04,1.5,1.75,5,done,");
    pel_study_destroy(study);
}

/* one value in each strip of a Latin hypercube; another seed gives others */
static void test_latin(void **unused)
{
    (void)unused;
    enum { COUNT = 16 };
    char row[8192], first[64] = "", text[300];
    for (int seed = 1; seed <= 2; seed++) {
        int seen[COUNT] = {0};
        snprintf(text, sizeof text,
                 "scene: scene.yaml\nvary: { solver.alpha: { from: 0, to: 16, latin: 16, seed: %d } }\n", seed);
        pel_study *study = make_study(text);
        for (int run = 0; run < COUNT; run++) {
            row_of(study, run, row);
            double alpha = strtod(strchr(row, ',') + 1, NULL);
            seen[(int)alpha]++;
            if (run == 0 && seed == 1)
                snprintf(first, sizeof first, "%.17g", alpha);
            else if (run == 0)
                assert_true(strtod(first, NULL) != alpha);
        }
        for (int i = 0; i < COUNT; i++)
            assert_int_equal(seen[i], 1);
        pel_study_destroy(study);
    }
}

/* ---- rows ---- */

/* spreadsheets compute none of the texts, and numbers stay numbers */
static void test_cells(void **unused)
{
    (void)unused;
    static const char *const cells[][2] = {
        {"=1+1", "'=1+1"}, {"+cmd|x", "'+cmd|x"},     {"-2", "-2"},          {"-1.5e-3", "-1.5e-3"},
        {"+inf", "+inf"},  {"@SUM(A1)", "'@SUM(A1)"}, {"-x,y", "\"'-x,y\""}, {"a=b", "a=b"},
        {"", ""},          {"\tx", "'\tx"},           {"-", "'-"},
    };
    for (size_t i = 0; i < sizeof cells / sizeof *cells; i++) {
        char *text = NULL;
        size_t size;
        FILE *file = open_memstream(&text, &size);
        pel_json json = {.file = file};
        pel_study_put_cell(&json, cells[i][0]);
        fclose(file);
        assert_string_equal(text, cells[i][1]);
        free(text);
    }
}

static void test_failed_runs_are_rows(void **unused)
{
    (void)unused;
    pel_study_summary summary = execute(mixed, "mixed", 1, 1, 1);
    assert_int_equal(summary.runs, 9);
    assert_int_equal(summary.done, 9);
    assert_int_equal(summary.failed, 5);
    char *table = read_file("mixed/runs.csv");
    assert_non_null(strstr(table, "\n3,-2,\"[0, 0, -2]\",10,,,,,,,,refused,"));
    assert_non_null(strstr(table, "must be >= 0"));
    assert_non_null(strstr(table, "\n8,3,\"[0, 0, -3]\",1e9,,,,,,,,refused,"));
    pel_free(table);
}

/* the numbers are those of the run's own files */
static void test_measures(void **unused)
{
    (void)unused;
    char path[256], row[8192], expected[1000];
    const char *const overrides[] = {"bodies.ball.springs.stiffness=3", "loads.finger.force=[0, 0, -3]",
                                     "solver.alpha=20"};
    pel_scene *scene;
    pel_run_def def = pel_run_def_default();
    pel_run_summary summary;
    assert_int_equal(pel_scene_load(in_folder(path, "scene.yaml"), overrides, 3, NULL, &scene, NULL), PEL_OK);
    char run_path[256];
    def.folder = in_folder(run_path, "one");
    assert_int_equal(pel_run(scene, &def, &summary, NULL), PEL_OK);
    pel_scene_destroy(scene);

    const char *const columns[] = {"max_displacement", "volume_ratio"};
    pel_series *series;
    assert_int_equal(pel_series_read(in_folder(path, "one/series.csv"), columns, 2, &series, NULL), PEL_OK);
    double least = 9, most = 0, sum = 0;
    for (int64_t i = 0; i < series->row_count; i++) {
        double ratio = pel_series_value(series, 1, i);
        least = fmin(least, ratio), most = fmax(most, ratio), sum += ratio;
    }
    pel_study *study = make_study(mixed);
    row_of(study, 7, row);
    snprintf(expected, sizeof expected, "%016llx", (unsigned long long)summary.state_hash);
    assert_non_null(strstr(row, expected));
    /* depth, hash, start, end, least, most, mean follow the values */
    char *at = strstr(row, "]\",20,") + strlen("]\",20,");
    assert_near(strtod(at, &at), summary.max_displacement, 0);
    at = strchr(at + 1, ',') + 1;
    assert_near(strtod(at, &at), 0, 0);
    assert_near(strtod(at + 1, &at), pel_series_value(series, 0, series->row_count - 1), 0);
    assert_near(strtod(at + 1, &at), least, 0);
    assert_near(strtod(at + 1, &at), most, 0);
    assert_near(strtod(at + 1, &at), sum / (double)series->row_count, 0);
    pel_series_destroy(series);
    pel_study_destroy(study);
}

/* a column that the series of a run does not have leaves its cell empty */
static void test_column_of_some_runs(void **unused)
{
    (void)unused;
    char row[8192];
    pel_study *study = make_study(
        "scene: scene.yaml\n"
        "vary:\n  tools: [[{ name: probe, shape: sphere, radius: 0.2, motion: [{ position: [0, 0, 1.3] }] }],\n"
        "          [{ name: tip, shape: sphere, radius: 0.2, motion: [{ position: [0, 0, 1.3] }] }]]\n"
        "measure: { force: { column: probe_force }, end: { column: time } }\n");
    row_of(study, 0, row);
    assert_non_null(strstr(row, "]\",0,0.2,done,"));
    row_of(study, 1, row);
    assert_non_null(strstr(row, "]\",,0.2,done,"));
    pel_study_destroy(study);
}

static void test_kept_runs(void **unused)
{
    (void)unused;
    const char *text = "scene: scene.yaml\nvary: { solver.alpha: [10, 20] }\nkeep: true\n";
    execute(text, "kept", 1, 1, 1);
    char *summary = read_file("kept/runs/00001/summary.json");
    assert_non_null(strstr(summary, "\"status\": \"done\""));
    pel_free(summary);
    execute("scene: scene.yaml\nvary: { solver.alpha: [10, 20] }\n", "lost", 1, 1, 1);
    check_same("kept/runs.csv", "lost/runs.csv");
    char path[256];
    assert_int_not_equal(access(in_folder(path, "lost/runs"), F_OK), 0);
}

/* ---- the same table ---- */

static void test_same_table(void **unused)
{
    (void)unused;
    execute(mixed, "one-thread", 1, 1, 1);
    execute(mixed, "threads", 3, 1, 1);
    check_same("one-thread/runs.csv", "threads/runs.csv");
    for (int chunk = 3; chunk >= 1; chunk--)
        assert_int_equal(execute(mixed, "chunks", 2, chunk, 3).missing, 3 * (chunk - 1));
    check_same("one-thread/runs.csv", "chunks/runs.csv");
}

static bool three_runs_only(void *user)
{
    return *(const int *)user < 3;
}

static void count_runs(void *user, const pel_study_progress *progress)
{
    *(int *)user = (int)progress->done;
}

static void test_stop_and_continue(void **unused)
{
    (void)unused;
    char path[256];
    int done = 0;
    pel_study *study = make_study(mixed);
    pel_study_def def = pel_study_def_default();
    pel_study_summary summary;
    def.folder = in_folder(path, "stopped");
    def.thread_count = 1;
    def.wanted = three_runs_only;
    def.progress = count_runs;
    def.user = &done;
    assert_int_equal(pel_study_execute(study, &def, &summary, NULL), PEL_STOPPED);
    assert_int_equal(summary.done, 3);
    assert_int_equal(summary.missing, 6);
    char table[256];
    assert_int_not_equal(access(in_folder(table, "stopped/runs.csv"), F_OK), 0);
    def.wanted = NULL;
    assert_int_equal(pel_study_execute(study, &def, &summary, NULL), PEL_OK);
    assert_int_equal(summary.present, 3);
    assert_int_equal(summary.done, 6);
    assert_int_equal(pel_study_execute(study, &def, &summary, NULL), PEL_OK);
    assert_int_equal(summary.done, 0);
    pel_study_destroy(study);
    execute(mixed, "whole", 1, 1, 1);
    check_same("whole/runs.csv", "stopped/runs.csv");
}

/* a column of zeros, such as the force on a tool that never touches, is told; not counts, starts, what nobody asked
 * for, nor what one run has */
static void test_zeros(void **unused)
{
    (void)unused;
    static const char common[] = "scene: scene.yaml\nvary: { bodies.ball.springs.stiffness: [1, 3] }\n";
    char text[600];
    pel_study_summary summary = execute(common, "usual", 1, 1, 1);
    assert_string_equal(summary.zeros, "");
    snprintf(text, sizeof text,
             "%smeasure: { hash: state_hash, tip: max_tool_force, depth: max_displacement, count: "
             "self_intersections_final, first: { column: max_displacement, at: start }, work: energy.work_tools }\n",
             common);
    summary = execute(text, "zeros", 1, 1, 2);
    assert_string_equal(summary.zeros, "");
    summary = execute(text, "zeros", 1, 2, 2);
    assert_string_equal(summary.zeros, "tip, work");
    /* the first run has no force, the others have */
    summary = execute("scene: scene.yaml\nvary: { loads.finger.force: [[0, 0, 0], [0, 0, -1]] }\n"
                      "measure: { depth: max_displacement }\n",
                      "some", 1, 1, 1);
    assert_string_equal(summary.zeros, "");
}

/* the codes of warnings are a column, and the runs of each are counted */
static void test_warnings(void **unused)
{
    (void)unused;
    static const char disc[] = "version: 1\nbodies:\n  - name: disc\n    mesh: { shape: disk, radius: 1, rings: 4 }\n"
                               "    membrane: { material: stvk, young: 1.0e9, poisson: 0.55, thickness: 0.01 }\n"
                               "    supports: [ { at: boundary, rotation: fixed } ]\n"
                               "loads: [ { name: finger, force: [0, 0, -1.0e-3], at: { nearest: [0, 0, 0] } } ]\n"
                               "solver: { method: static }\n";
    static const char common[] =
        "scene: disc.yaml\nvary: { bodies.disc.mesh.rings: [4, 6, 18], loads.finger.force: [[0, "
        "0, 0], [0, 0, -1.0e-3]] }\n";
    char text[600];
    write_file("disc.yaml", disc);
    pel_study_summary summary = execute(common, "codes", 1, 1, 1);
    assert_string_equal(summary.warnings,
                        "poisson-above-half in 6 runs, nothing-acts in 3 runs, coarse-load in 2 runs");
    snprintf(text, sizeof text, "%smeasure: [warning_codes, max_displacement]\n", common);
    summary = execute(text, "codes-first", 1, 1, 1);
    assert_string_equal(summary.warnings,
                        "poisson-above-half in 6 runs, nothing-acts in 3 runs, coarse-load in 2 runs");
    snprintf(text, sizeof text, "%smeasure: [max_displacement]\n", common);
    summary = execute(text, "no-codes", 1, 1, 1);
    assert_string_equal(summary.warnings, "");
}

static void kill_at_four(void *user, const pel_study_progress *progress)
{
    (void)user;
    if (progress->done == 4)
        raise(SIGKILL);
}

static void test_kill(void **unused)
{
    (void)unused;
    char path[256];
    in_folder(path, "killed");
    pid_t child = fork();
    if (child == 0) {
        pel_study_def def = pel_study_def_default();
        def.folder = path;
        def.thread_count = 1;
        def.progress = kill_at_four;
        pel_study_execute(make_study(mixed), &def, NULL, NULL);
        _exit(0);
    }
    int result = 0;
    assert_true(waitpid(child, &result, 0) == child && WIFSIGNALED(result));
    /* what a kill leaves of a row that was being written, and a row that was spoilt */
    FILE *file = fopen(in_folder(path, "killed/rows/1-of-1.rows"), "a");
    assert_non_null(file);
    fputs("0123456789abcdef 5,3,\"[0, 0, -3]\",10,1,2,3,4,5,6,7,done,\n0123456789abcdef 6,3", file);
    assert_int_equal(fclose(file), 0);
    pel_study_summary summary = execute(mixed, "killed", 2, 1, 1);
    assert_int_equal(summary.present, 4);
    assert_int_equal(summary.done, 5);
    execute(mixed, "alive", 1, 1, 1);
    check_same("alive/runs.csv", "killed/runs.csv");
}

/* ---- runs that take their process with them ---- */

/* the second one has a large mesh, and never ends by itself */
static const char crashing[] =
    "scene: scene.yaml\nvary: [{ duration: [0.2, 1e9, 0.1, 0.3], bodies.ball.mesh.frequency: [2, 90, 2, 2] }]\n"
    "measure: [steps]\n";

/* what becomes of workers that are forked from here on: they fail to get memory, or a large mesh ends them by a signal,
   always at the same place */
static struct {
    bool have_no_memory, end_at_large_meshes;
} workers;

static void in_worker(void)
{
    failing_malloc_end();
    if (workers.have_no_memory)
        failing_malloc_begin(1);
    if (workers.end_at_large_meshes)
        failing_malloc_ends_at((size_t)1 << 20);
}

static void test_a_crash_is_a_row(void **unused)
{
    (void)unused;
    char path[256];
    workers.end_at_large_meshes = true;
    pel_study_summary summary = execute(crashing, "crash", 2, 1, 1);
    workers.end_at_large_meshes = false;
    assert_int_equal(summary.done, 4);
    assert_int_equal(summary.missing, 0);
    assert_int_equal(summary.failed, 1);
    char *table = read_file("crash/runs.csv");
    assert_non_null(strstr(table, "\n0,0.2,2,20,done,\n1,1e9,90,,crashed,"));
    assert_non_null(strstr(table, "ended twice, the last time by signal 14 (Alarm clock)"));
    assert_non_null(strstr(table, "\n2,0.1,2,10,done,\n3,0.3,2,30,done,\n"));
    pel_free(table);
    /* only what failed is done again, and only when asked for */
    assert_int_equal(execute(crashing, "crash", 2, 1, 1).done, 0);
    pel_study *study = make_study(crashing);
    pel_study_def def = pel_study_def_default();
    def.folder = in_folder(path, "crash");
    def.run_seconds = 0.1;
    def.retry = true;
    assert_int_equal(pel_study_execute(study, &def, &summary, NULL), PEL_OK);
    assert_int_equal(summary.done, 1);
    assert_int_equal(summary.present, 3);
    table = read_file("crash/runs.csv");
    assert_non_null(strstr(table, "\n1,1e9,90,,timeout,"));
    pel_free(table);
    pel_study_destroy(study);
}

/* a run of many that a worker was given ahead crashes: each row is that of its run */
static void test_a_crash_behind_others(void **unused)
{
    (void)unused;
    workers.end_at_large_meshes = true;
    pel_study_summary summary =
        execute("scene: scene.yaml\nvary: [{ duration: [0.01, 0.02, 0.03, 0.04, 1e9, 0.05, 0.06, 0.07],\n"
                "  bodies.ball.mesh.frequency: [2, 2, 2, 2, 90, 2, 2, 2] }]\nmeasure: [steps]\n",
                "behind", 1, 1, 1);
    workers.end_at_large_meshes = false;
    assert_int_equal(summary.done, 8);
    assert_int_equal(summary.failed, 1);
    char *table = read_file("behind/runs.csv");
    assert_non_null(
        strstr(table, "\n0,0.01,2,1,done,\n1,0.02,2,2,done,\n2,0.03,2,3,done,\n3,0.04,2,4,done,\n4,1e9,90,,crashed,"));
    assert_non_null(strstr(table, "\n5,0.05,2,5,done,\n6,0.06,2,6,done,\n7,0.07,2,7,done,\n"));
    pel_free(table);
}

static void test_a_late_run_is_a_row(void **unused)
{
    (void)unused;
    char path[256];
    pel_study *study = make_study("scene: scene.yaml\nvary: { duration: [0.2, 1e9, 0.1] }\nmeasure: [steps]\n");
    pel_study_def def = pel_study_def_default();
    pel_study_summary summary;
    def.folder = in_folder(path, "late");
    def.thread_count = 1;
    def.run_seconds = IS_SLOW ? 5 : 1;
    assert_int_equal(pel_study_execute(study, &def, &summary, NULL), PEL_OK);
    assert_int_equal(summary.done, 3);
    assert_int_equal(summary.failed, 1);
    char *table = read_file("late/runs.csv");
    assert_non_null(strstr(table, "\n0,0.2,20,done,\n1,1e9,,timeout,"));
    assert_non_null(strstr(table, "took more than"));
    assert_non_null(strstr(table, "\n2,0.1,10,done,\n"));
    pel_free(table);
    pel_study_destroy(study);
}

/* of two rows of a run the one that is done counts, whichever came last */
static void test_rows_of_one_run(void **unused)
{
    (void)unused;
    char path[256];
    pel_study_store *store;
    pel_study *study = make_study("scene: scene.yaml\nvary: { solver.alpha: [10, 11] }\nmeasure: [steps]\n");
    assert_int_equal(pel_study_store_open(study, in_folder(path, "twice"), 1, 1, &store, NULL), PEL_OK);
    const char *const rows[] = {"0,10,,crashed,a", "0,10,20,done,", "0,10,,crashed,b", "1,11,,failed,a",
                                "1,11,,failed,b"};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        assert_int_equal(pel_study_store_add(store, rows[i], NULL), PEL_OK);
    int64_t failed;
    assert_int_equal(pel_study_store_collect(store, NULL, &failed, NULL), PEL_OK);
    assert_int_equal(failed, 1);
    pel_study_store_close(store);
    char *table = read_file("twice/runs.csv");
    assert_non_null(strstr(table, "\n0,10,20,done,\n1,11,,failed,b\n"));
    pel_free(table);
    assert_int_equal(pel_study_store_open(study, path, 1, 1, &store, NULL), PEL_OK);
    assert_true(!pel_study_store_needs(store, 0) && !pel_study_store_failed(store, 0));
    assert_true(!pel_study_store_needs(store, 1) && pel_study_store_failed(store, 1));
    assert_false(pel_study_store_failed(store, 2));
    pel_study_store_close(store);
    pel_study_destroy(study);
}

/* the row of a run with an error of some letters, in a block of its own */
static char *long_row(int run, int length)
{
    char *row = malloc((size_t)length + 64);
    assert_non_null(row);
    int begin = snprintf(row, 64, "%d,%d,,failed,", run, run + 1);
    memset(row + begin, 'a' + run % 26, (size_t)length);
    row[begin + length] = '\0';
    return row;
}

/* a line that no row is as long as, and the begin of one, behind the rows of a file */
static void spoil_rows(const char *name)
{
    char path[256];
    FILE *file = fopen(in_folder(path, name), "a");
    assert_non_null(file);
    fprintf(file, "%0*d\n0123456789abcdef 3,4,", 70000, 0);
    assert_int_equal(fclose(file), 0);
}

/* Rows of all lengths, in any order over three files, thirteen that follow each other in one: the table has each at its
   place, in blocks whose number does not grow with that of the rows. */
static void test_rows_of_many_files(void **unused)
{
    (void)unused;
    enum { RUNS = 1201, CHUNKS = 3, BLOCKS = 40 };
    char path[256], *rows[RUNS];
    pel_study *study =
        make_study("scene: scene.yaml\nvary: { solver.alpha: { from: 1, to: 1201, count: 1201 } }\nmeasure: [steps]\n");
    assert_int_equal(pel_study_run_count(study), RUNS);
    int most = (int)pel_study_row_size(study) - 40;
    for (int run = 0; run < RUNS; run++)
        rows[run] = long_row(run, run % 7 == 0 ? most : run % 7 == 1 ? 0 : run * 37 % 200);
    for (int chunk = 1; chunk <= CHUNKS; chunk++) {
        pel_study_store *store;
        assert_int_equal(pel_study_store_open(study, in_folder(path, "many"), chunk, CHUNKS, &store, NULL), PEL_OK);
        for (int i = 0; i < RUNS; i++)
            if (i * 500 % RUNS / 13 % CHUNKS == chunk - 1)
                assert_int_equal(pel_study_store_gather(store, rows[i * 500 % RUNS], NULL), PEL_OK);
        assert_int_equal(pel_study_store_flush(store, NULL), PEL_OK);
        pel_study_store_close(store);
    }
    spoil_rows("many/rows/3-of-3.rows");
    pel_study_store *store;
    int64_t missing, failed;
    assert_int_equal(pel_study_store_open(study, in_folder(path, "many"), 1, CHUNKS, &store, NULL), PEL_OK);
    failing_malloc_begin(0);
    assert_int_equal(pel_study_store_collect(store, &missing, &failed, NULL), PEL_OK);
    allocation_count count = failing_malloc_end();
    assert_true(missing == 0 && failed == RUNS);
    assert_true(count.calls < BLOCKS);
    pel_study_store_close(store);
    char *table = read_file("many/runs.csv"), *at = strchr(table, '\n') + 1;
    for (int run = 0; run < RUNS; run++) {
        size_t length = strlen(rows[run]);
        assert_memory_equal(at, rows[run], length);
        assert_int_equal(at[length], '\n');
        at += length + 1;
        free(rows[run]);
    }
    assert_int_equal(*at, '\0');
    pel_free(table);
    pel_study_destroy(study);
}

/* a row that would have no room when it is read again */
static void test_too_long_row(void **unused)
{
    (void)unused;
    char path[256];
    pel_study_store *store;
    pel_study *study = make_study("scene: scene.yaml\nvary: { solver.alpha: [10] }\nmeasure: [steps]\n");
    assert_int_equal(pel_study_store_open(study, in_folder(path, "long"), 1, 1, &store, NULL), PEL_OK);
    int size = (int)pel_study_row_size(study), begin = (int)strlen("0,1,,failed,");
    char *row = long_row(0, size - begin);
    assert_int_equal(pel_study_store_add(store, row, NULL), PEL_BAD_ARGUMENT);
    row[size - 1] = '\0';
    assert_int_equal(pel_study_store_add(store, row, NULL), PEL_OK);
    assert_int_equal(pel_study_store_collect(store, NULL, NULL, NULL), PEL_OK);
    char *table = read_file("long/runs.csv");
    assert_non_null(strstr(table, row));
    pel_free(table);
    free(row);
    pel_study_store_close(store);
    pel_study_destroy(study);
}

static void test_lost_rows(void **unused)
{
    (void)unused;
    char row[8192];
    pel_study *study = make_study(mixed);
    assert_int_equal(pel_study_lost_run(study, 4, "crashed", "an \"end\", so", "try", row, NULL), PEL_OK);
    assert_string_equal(row, "4,-2,\"[0, 0, -2]\",20,,,,,,,,crashed,\"error: an \"\"end\"\", so. try\"");
    assert_int_equal(pel_study_lost_run(study, 9, "crashed", "why", NULL, row, NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_study_lost_run(study, 4, "done", "why", NULL, row, NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_study_lost_run(study, 4, "a,b", "why", NULL, row, NULL), PEL_BAD_ARGUMENT);
    pel_study_destroy(study);
}

static void test_other_study(void **unused)
{
    (void)unused;
    char path[256];
    pel_error error;
    pel_study_store *store, *second;
    execute("scene: scene.yaml\nvary: { solver.alpha: [10] }\n", "other", 1, 1, 1);
    pel_study *study = make_study("scene: scene.yaml\nvary: { solver.alpha: [11] }\n");
    assert_int_equal(pel_study_store_open(study, in_folder(path, "other"), 1, 1, &store, &error), PEL_BAD_FILE);
    assert_null(store);
    assert_non_null(strstr(error.what, "another study"));
    /* one program a chunk */
    assert_int_equal(pel_study_store_open(study, in_folder(path, "busy"), 1, 1, &store, NULL), PEL_OK);
    assert_int_equal(pel_study_store_open(study, path, 1, 1, &second, &error), PEL_BAD_FILE);
    assert_non_null(strstr(error.what, "another program"));
    assert_int_equal(pel_study_store_add(store, "7,10,done,", NULL), PEL_BAD_ARGUMENT);
    pel_study_store_close(store);
    pel_study_destroy(study);
}

/* ---- bad studies ---- */

static void test_bad_studies(void **unused)
{
    (void)unused;
    static const struct {
        const char *text, *place, *what;
    } cases[] = {
        {"vary: { solver.dt: [1] }\n", "study.yaml:1:1", "no scene"},
        {"scene: scene.yaml\n", "study.yaml:1:1", "no vary"},
        {"scene: scene.yaml\nvari: {}\n", "study.yaml:2:1", "did you mean 'vary'"},
        {"scene: none.yaml\nvary: { solver.dt: [1] }\n", "study.yaml:1:8", "error"},
        {"scene: scene.yaml\nvary:\n  solver.dd: [1]\n", "study.yaml:3:3", "unknown key 'dd'"},
        {"scene: scene.yaml\nvary: { solver.dt: 1 }\n", "study.yaml:2:20", "several values"},
        {"scene: scene.yaml\nvary: { solver.dt: [] }\n", "study.yaml:2:20", "empty"},
        {"scene: scene.yaml\nvary: {}\n", "study.yaml:2:7", "nothing varies"},
        {"scene: scene.yaml\nvary: { solver.dt: { from: 1, count: 2 } }\n", "study.yaml:2:20", "both ends"},
        {"scene: scene.yaml\nvary: { solver.dt: { from: 1, to: 2 } }\n", "study.yaml:2:20", "one of count"},
        {"scene: scene.yaml\nvary: { solver.dt: { from: 1, to: x, count: 2 } }\n", "study.yaml:2:35", "number"},
        {"scene: scene.yaml\nvary: { solver.dt: { from: 0, to: 1, count: 2, scale: log } }\n", "study.yaml:2:20",
         "log"},
        {"scene: scene.yaml\nvary: { solver.dt: { from: 0, to: 1, count: 0 } }\n", "study.yaml:2:45", "whole number"},
        {"scene: scene.yaml\nvary: [{ solver.dt: [1, 2], solver.alpha: [1] }]\n", "study.yaml:2:43", "vary together"},
        {"scene: scene.yaml\nvary: { solver.dt: [1], solver.dt: [2] }\n", "study.yaml:2:25", "twice"},
        {"scene: scene.yaml\nvary: { solver.dt: [0.01] }\nmeasure: [max_displacment]\n", "study.yaml:3:11",
         "did you mean 'max_displacement'"},
        {"scene: scene.yaml\nvary: { solver.dt: [0.01] }\nmeasure: { a: { column: force } }\n", "study.yaml:3:25",
         "no column 'force'"},
        {"scene: scene.yaml\nvary: { solver.dt: [0.01] }\nmeasure: { a: { column: step_ms } }\n", "study.yaml:3:25",
         "time of this machine"},
        {"scene: scene.yaml\nvary: { solver.dt: [0.01] }\nmeasure: { run: steps }\n", "study.yaml:3:17", "already"},
        {"scene: scene.yaml\nvary: { a: { from: 0, to: 1, count: 9999 }, b: { from: 0, to: 1, count: 9999 } }\n",
         "study.yaml:2:7", "more than"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        pel_study *study;
        pel_error error;
        char text[1200];
        pel_status status = parse(cases[i].text, &study, &error);
        pel_error_text(&error, text, sizeof text);
        if (status == PEL_OK || strstr(text, cases[i].place) == NULL || strstr(text, cases[i].what) == NULL)
            print_error("case %d: %s\nexpected %s ... %s\n", (int)i, status == PEL_OK ? "accepted" : text,
                        cases[i].place, cases[i].what);
        assert_int_not_equal(status, PEL_OK);
        assert_non_null(strstr(text, cases[i].place));
        assert_non_null(strstr(text, cases[i].what));
        assert_null(study);
    }
}

/* ---- fits ---- */

static void test_fit(void **unused)
{
    (void)unused;
    char path[256], *json, text[1200];
    pel_error error;
    write_file("curve.csv", "x,y\n1,2\n");
    write_file("fit.yaml", "scene: scene.yaml\nparameters: { solver.alpha: { start: 2, from: 1, to: 3 } }\n"
                           "data: [{ file: curve.csv, x: time, y: max_force }]\n");
    assert_int_equal(pel_fit_load(in_folder(path, "fit.yaml"), &json, NULL), PEL_OK);
    assert_non_null(strstr(json, "{\"start\": 2, \"from\": 1, \"to\": 3}"));
    assert_non_null(strstr(json, "curve.csv"));
    pel_fit_destroy(json);
    write_file("fit.yaml", "scene: scene.yaml\nparameters: { solver.alpha: { start: 4, from: 1, to: 3 } }\n"
                           "data: [{ file: curve.csv, x: time, y: max_force }]\n");
    assert_int_equal(pel_fit_load(path, &json, &error), PEL_BAD_SCENE);
    assert_null(json);
    assert_non_null(strstr(pel_error_text(&error, text, sizeof text), "fit.yaml:2:29"));
    write_file("fit.yaml", "scene: scene.yaml\nparameter: {}\n");
    assert_int_equal(pel_fit_load(path, &json, &error), PEL_BAD_SCENE);
    assert_non_null(strstr(pel_error_text(&error, text, sizeof text), "fit.yaml:2:1"));
}

/* ---- memory ---- */

static pel_status load_case(const void *data, pel_error *error)
{
    pel_study *study;
    pel_status status = pel_study_load(data, &study, error);
    assert_true((study != NULL) == (status == PEL_OK));
    pel_study_destroy(study);
    return status;
}

static pel_status parse_case(const void *data, pel_error *error)
{
    pel_study *study;
    static const char text[] =
        "scene: scene.yaml\nvary: [{ solver.alpha: [1, 2], loads.0.force: [[1, 0, 0], [2, 0, 0]] }]\n";
    pel_status status = pel_study_parse(data, text, strlen(text), &study, error);
    assert_true((study != NULL) == (status == PEL_OK));
    pel_study_destroy(study);
    return status;
}

static const pel_study *opened;

static pel_status open_case(const void *data, pel_error *error)
{
    pel_study_store *store;
    pel_status status = pel_study_store_open(opened, data, 1, 1, &store, error);
    assert_true((store != NULL) == (status == PEL_OK));
    pel_study_store_close(store);
    return status;
}

static pel_status execute_case(const void *data, pel_error *error)
{
    pel_study_def def = pel_study_def_default();
    def.folder = data;
    def.thread_count = 1;
    return pel_study_execute(opened, &def, NULL, error);
}

static pel_status run_case(const void *data, pel_error *error)
{
    char row[8192];
    (void)data;
    return pel_study_run(opened, 0, NULL, NULL, NULL, row, error);
}

static pel_status lost_case(const void *data, pel_error *error)
{
    char row[8192];
    (void)data;
    return pel_study_lost_run(opened, 0, "crashed", "why", NULL, row, error);
}

static void test_no_memory_is_a_row(void **unused)
{
    (void)unused;
    workers.have_no_memory = true;
    pel_study_summary summary = execute("scene: scene.yaml\nvary: { solver.alpha: [10] }\n", "poor", 1, 1, 1);
    workers.have_no_memory = false;
    assert_int_equal(summary.failed, 1);
    char *table = read_file("poor/runs.csv");
    assert_non_null(strstr(table, ",failed,"));
    assert_non_null(strstr(table, "out of memory"));
    pel_free(table);
}

static pel_status fit_case(const void *data, pel_error *error)
{
    char *json;
    pel_status status = pel_fit_load(data, &json, error);
    assert_true((json != NULL) == (status == PEL_OK));
    pel_fit_destroy(json);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    char path[256];
    write_file("memory.yaml", "scene: scene.yaml\nvary: { solver.alpha: { from: 1, to: 2, sobol: 2 } }\n");
    write_file("memory-fit.yaml", "scene: scene.yaml\nparameters: { solver.alpha: { start: 2, from: 1, to: 3 } }\n"
                                  "data: [{ file: scene.yaml, x: time, y: max_force }]\n");
    assert_true(for_every_allocation_failure(load_case, in_folder(path, "memory.yaml")) > 10);
    assert_true(for_every_allocation_failure(parse_case, in_folder(path, "study.yaml")) > 10);
    pel_study *study = make_study("scene: scene.yaml\nvary: { solver.alpha: [10] }\n");
    opened = study;
    assert_true(for_every_allocation_failure(open_case, in_folder(path, "memory")) > 3);
    assert_true(for_every_allocation_failure(execute_case, in_folder(path, "memory-runs")) > 10);
    assert_true(for_every_allocation_failure(run_case, NULL) > 10);
    assert_true(for_every_allocation_failure(lost_case, NULL) > 0);
    pel_study_destroy(study);
    assert_true(for_every_allocation_failure(fit_case, in_folder(path, "memory-fit.yaml")) > 3);
}

int main(void)
{
    pthread_atfork(NULL, NULL, in_worker);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_crash_behind_others),
        cmocka_unit_test(test_column_of_some_runs),
        cmocka_unit_test(test_design),
        cmocka_unit_test(test_latin),
        cmocka_unit_test(test_cells),
        cmocka_unit_test(test_failed_runs_are_rows),
        cmocka_unit_test(test_measures),
        cmocka_unit_test(test_kept_runs),
        cmocka_unit_test(test_same_table),
        cmocka_unit_test(test_stop_and_continue),
        cmocka_unit_test(test_zeros),
        cmocka_unit_test(test_warnings),
        cmocka_unit_test(test_kill),
        cmocka_unit_test(test_a_crash_is_a_row),
        cmocka_unit_test(test_a_late_run_is_a_row),
        cmocka_unit_test(test_no_memory_is_a_row),
        cmocka_unit_test(test_rows_of_one_run),
        cmocka_unit_test(test_rows_of_many_files),
        cmocka_unit_test(test_too_long_row),
        cmocka_unit_test(test_lost_rows),
        cmocka_unit_test(test_other_study),
        cmocka_unit_test(test_bad_studies),
        cmocka_unit_test(test_fit),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
