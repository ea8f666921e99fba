/* Shared by the tests of whole runs: scenes, a folder for their results, runs that are stopped, killed or hindered. */
#ifndef PEL_TESTS_RUN_FIXTURE_H
#define PEL_TESTS_RUN_FIXTURE_H

#include "check.h"

#include "base/memory.h"
#include "failing_malloc.h"
#include "io/file.h"
#include "pellicle/mesh_io.h"
#include "pellicle/results.h"
#include "pellicle/run.h"
#include "pellicle/topology.h"

#include <dirent.h>
#include <ftw.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* two bodies, a tool that presses and one that grasps, a load; 60 steps, a frame every 7 steps and at the end */
static const char busy[] =
    "version: 1\n"
    "bodies:\n"
    "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 4 }, mass: { per_vertex: 1 },\n"
    "      springs: { stiffness: 3, damping: 0.5 }, volumetric: { stiffness: 1.5, damping: 0.5 } }\n"
    "  - { name: lens, mesh: { shape: lens-capsule, scale: 100, translate: [5, 0, 0] }, mass: { per_vertex: 1 },\n"
    "      springs: { stiffness: 3, damping: 0.5 }, volumetric: { stiffness: 1.5, damping: 0.5 } }\n"
    "loads:\n"
    "  - { body: ball, force: [0.5, 0, 0], from: 0.1, until: 0.4 }\n"
    "tools:\n"
    "  - { name: probe, shape: sphere, radius: 0.3, body: ball,\n"
    "      motion: [{ time: 0, position: [0, 0, 1.35] }, { time: 0.3, position: [0, 0, 1.1] }] }\n"
    "  - { name: clamp, shape: sphere, radius: 0.2, body: ball, press: false,\n"
    "      grasp: { from: 0.1, until: 0.5, reach: 0.2 },\n"
    "      motion: [{ time: 0, position: [0, -1.2, 0] }, { time: 0.6, position: [0, -1.4, 0] }] }\n"
    "solver: { method: quasi-static, dt: 0.01, velocity: keep }\n"
    "duration: 0.6\n"
    "output: { every_frame: 7, fields: [displacement, velocity, force, energy, contact, thickness], checkpoint: 0.11 "
    "}\n";

/* 100 steps of an icosahedron: its series becomes longer than its frames and checkpoints */
static const char small[] =
    "version: 1\nbodies: [{ mesh: { shape: geodesic-sphere, frequency: 1 }, preset: paper-a }]\n"
    "tools: [{ shape: sphere, radius: 0.1, motion: [{ time: 0, position: [0, 0, 3] }] }]\n"
    "solver: { dt: 0.01 }\nduration: 1\noutput: { every_frame: 1, checkpoint: 0.1 }\n";

/* the same without a tool: its frames are the smallest files */
static const char smallest[] =
    "version: 1\nbodies: [{ mesh: { shape: geodesic-sphere, frequency: 1 }, preset: paper-a }]\n"
    "solver: { dt: 0.01 }\nduration: 1\noutput: { every_frame: 1, checkpoint: 0.1 }\n";

static char folder[64];

/* of the runs that do not say; with more than one, frames are written beside the simulation */
static int32_t thread_count;

/* ---- help ---- */

static inline int remove_entry(const char *path, const struct stat *information, int kind, struct FTW *place)
{
    (void)information;
    (void)kind;
    (void)place;
    return remove(path);
}

static inline void remove_folder(const char *path)
{
    nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

static inline int make_folder(void **unused)
{
    (void)unused;
    snprintf(folder, sizeof folder, "run-test-XXXXXX");
    return mkdtemp(folder) == NULL;
}

static inline int clear_folder(void **unused)
{
    (void)unused;
    remove_folder(folder);
    return 0;
}

static inline char *in_folder(char path[256], const char *run, const char *name)
{
    snprintf(path, 256, "%s/%s%s%s", folder, run, name[0] != '\0' ? "/" : "", name);
    return path;
}

static inline bool exists(const char *run, const char *name)
{
    char path[256];
    return access(in_folder(path, run, name), F_OK) == 0;
}

static inline void read_text(const char *run, const char *name, char **bytes, size_t *size)
{
    char path[256];
    size_t unused;
    assert_int_equal(pel_file_read(in_folder(path, run, name), bytes, size != NULL ? size : &unused, NULL), PEL_OK);
}

static inline void check_contains(const char *run, const char *name, const char *text)
{
    char *bytes;
    read_text(run, name, &bytes, NULL);
    if (strstr(bytes, text) == NULL)
        print_error("%s/%s has no '%s':\n%s\n", run, name, text, bytes);
    assert_non_null(strstr(bytes, text));
    pel_free(bytes);
}

static inline pel_scene *load_scene(const char *text, const char *const *overrides, int32_t override_count)
{
    pel_scene *scene;
    pel_error error;
    char message[900];
    pel_status status =
        pel_scene_parse("test.yaml", text, strlen(text), overrides, override_count, NULL, &scene, &error);
    if (status != PEL_OK)
        print_error("%s\n", pel_error_text(&error, message, sizeof message));
    assert_int_equal(status, PEL_OK);
    return scene;
}

/* options of a test's run */
typedef struct run_case {
    const char *run;    /* folder */
    const char *resume; /* checkpoint in it, nullable */
    int64_t stop_at;    /* step, 0 = no */
    int64_t kill_at;    /* step, 0 = no */
    int64_t fill_at;    /* step from which on files can have file_size bytes only, 0 = no */
    rlim_t file_size;
    const char *block;   /* name in the folder that another folder takes at step 30; nullable */
    double keep_seconds; /* 0 = as by default */
    int32_t nap;         /* ms that the run sleeps where it stops */
    int64_t max_frames;
    bool overwrite;
    int32_t threads;
    pel_run_summary summary;
    pel_error error;
    int64_t calls;
} run_case;

static inline void limit_files(rlim_t size)
{
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit.rlim_cur = size;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

static inline void unlimit_files(void)
{
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit_files(limit.rlim_max);
}

static inline bool watch(void *user, const pel_run_progress *progress)
{
    run_case *test = user;
    test->calls++;
    assert_true(progress->step <= progress->step_total && progress->frame <= progress->frame_total);
    if (test->kill_at > 0 && progress->step >= test->kill_at)
        raise(SIGKILL);
    if (test->fill_at > 0 && progress->step == test->fill_at)
        limit_files(test->file_size);
    char path[256];
    if (test->block != NULL && progress->step == 30)
        assert_int_equal(mkdir(in_folder(path, test->run, test->block), 0777), 0);
    bool goes_on = test->stop_at == 0 || progress->step < test->stop_at;
    if (!goes_on && test->nap > 0)
        nanosleep(&(struct timespec){.tv_nsec = 1000000L * test->nap}, NULL);
    return goes_on;
}

static inline pel_status do_run(const pel_scene *scene, run_case *test)
{
    char path[256], resume[256];
    pel_run_def def = pel_run_def_default();
    def.folder = in_folder(path, test->run, "");
    def.resume = test->resume != NULL ? in_folder(resume, test->run, test->resume) : NULL;
    def.max_frames = test->max_frames;
    def.overwrite = test->overwrite;
    def.thread_count = test->threads > 0 ? test->threads : thread_count;
    def.keep_seconds = test->keep_seconds > 0 ? test->keep_seconds : def.keep_seconds;
    def.progress = watch;
    def.user = test;
    return pel_run(scene, &def, &test->summary, &test->error);
}

static inline void check_run(const pel_scene *scene, run_case *test, pel_status expected)
{
    char message[900];
    pel_status status = do_run(scene, test);
    if (status != expected && status != PEL_OK)
        print_error("%s\n", pel_error_text(&test->error, message, sizeof message));
    assert_int_equal(status, expected);
}

static inline int64_t count_rows(const char *run)
{
    size_t size;
    char *bytes;
    read_text(run, "series.csv", &bytes, &size);
    int64_t rows = -1;
    for (size_t i = 0; i < size; i++)
        rows += bytes[i] == '\n';
    assert_int_equal(bytes[size - 1], '\n');
    pel_free(bytes);
    return rows;
}

/* every frame and every surface of a tool that the list names is there and whole; counts both */
static inline int64_t check_parts(const char *run, int64_t *tools)
{
    char *bytes, path[256];
    int64_t count = 0;
    *tools = 0;
    read_text(run, "frames.pvd", &bytes, NULL);
    assert_non_null(strstr(bytes, "</VTKFile>\n"));
    for (char *at = strstr(bytes, "file=\""); at != NULL; at = strstr(at + 1, "file=\"")) {
        char name[64] = "";
        pel_mesh *mesh;
        double time, listed;
        sscanf(at, "file=\"%63[^\"]", name);
        assert_int_equal(pel_vtp_read(in_folder(path, run, name), &mesh, &time, NULL), PEL_OK);
        const char *begin = at;
        while (strncmp(begin, "timestep=\"", 10) != 0)
            begin--;
        listed = strtod(begin + 10, NULL);
        assert_true(listed == time);
        pel_mesh_destroy(mesh);
        *(strncmp(name, "frames/t", 8) == 0 ? tools : &count) += 1;
    }
    pel_free(bytes);
    return count;
}

/* how many frames there are */
static inline int64_t check_list(const char *run)
{
    int64_t tools;
    return check_parts(run, &tools);
}

/* no half-written file, no frame beyond the list's end */
static inline void check_whole(const char *run)
{
    char path[256];
    int64_t frames = 0, tools = 0, listed_tools, listed = check_parts(run, &listed_tools);
    const char *const parts[2] = {"", "frames"};
    for (int i = 0; i < 2; i++) {
        DIR *stream = opendir(in_folder(path, run, parts[i]));
        assert_non_null(stream);
        for (struct dirent *entry = readdir(stream); entry != NULL; entry = readdir(stream)) {
            assert_null(strstr(entry->d_name, ".tmp"));
            if (strstr(entry->d_name, ".vtp") != NULL)
                *(entry->d_name[0] == 't' ? &tools : &frames) += 1;
        }
        closedir(stream);
    }
    assert_int_equal(frames, listed);
    assert_int_equal(tools, listed_tools);
    assert_int_equal(count_rows(run), listed);
}

/* blanks the columns of the series whose names end in _ms */
static inline void blank_columns(char *bytes)
{
    enum { MOST_COLUMNS = 1200 };
    bool is_time[MOST_COLUMNS] = {false};
    int column = 0;
    char *at = bytes;
    for (; *at != '\n'; at++)
        if (at[1] == ',' || at[1] == '\n') {
            assert_true(column < MOST_COLUMNS);
            is_time[column++] = at - bytes > 2 && strncmp(at - 2, "_ms", 3) == 0;
        }
    for (column = 0; *at != '\0'; at++) {
        column = *at == '\n' ? 0 : column + (*at == ',');
        if (is_time[column] && *at != ',' && *at != '\n')
            *at = '?';
    }
}

/* blanks values that depend on the wall clock, the number of threads or the folder */
static inline void blank_times(const char *name, char *bytes)
{
    if (strcmp(name, "series.csv") == 0) {
        blank_columns(bytes);
        return;
    }
    const char *const keys[] = {"\"wall_s\": ", "\"steps_per_second\": ", "\"threads\": ", "\"checkpoint\": ",
                                "\"find_s\": ", "\"solve_s\": ",          "\"guard_s\": ", "\"worst_step_ms\": "};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        char *at = strstr(bytes, keys[i]);
        for (at = at != NULL ? at + strlen(keys[i]) : NULL; at != NULL && *at != '\n' && *at != ',' && *at != '}'; at++)
            *at = '?';
    }
}

/* removes all question marks, so that numbers of different lengths compare equal */
static inline void squeeze(char *bytes)
{
    char *out = bytes;
    for (const char *at = bytes; *at != '\0'; at++)
        if (*at != '?')
            *out++ = *at;
    *out = '\0';
}

static inline void check_same_file(const char *a, const char *b, const char *name)
{
    size_t a_size, b_size;
    char *a_bytes, *b_bytes;
    read_text(a, name, &a_bytes, &a_size);
    read_text(b, name, &b_bytes, &b_size);
    if (strcmp(name, "series.csv") == 0 || strcmp(name, "summary.json") == 0) {
        blank_times(name, a_bytes);
        blank_times(name, b_bytes);
        squeeze(a_bytes);
        squeeze(b_bytes);
        assert_string_equal(a_bytes, b_bytes);
    } else {
        if (a_size != b_size || memcmp(a_bytes, b_bytes, a_size) != 0)
            print_error("%s differs\n", name);
        assert_int_equal(a_size, b_size);
        assert_memory_equal(a_bytes, b_bytes, a_size);
    }
    pel_free(a_bytes);
    pel_free(b_bytes);
}

static inline void check_same_results(const char *a, const char *b, int64_t frames)
{
    const char *const names[] = {"series.csv", "summary.json", "frames.pvd", "final.ply", "scene.yaml"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        check_same_file(a, b, names[i]);
    for (int64_t frame = 0; frame < frames; frame++) {
        char name[64];
        snprintf(name, sizeof name, "frames/f%05d.vtp", (int)frame);
        check_same_file(a, b, name);
    }
}

/* the largest number in a column of the series, from 0 */
static inline double largest_in_series(const char *run, int column)
{
    char *bytes;
    double largest = 0;
    read_text(run, "series.csv", &bytes, NULL);
    for (char *line = strchr(bytes, '\n') + 1; *line != '\0'; line = strchr(line, '\n') + 1) {
        char *at = line;
        for (int i = 0; i < column; i++)
            at = strchr(at, ',') + 1;
        largest = fmax(largest, strtod(at, NULL));
    }
    pel_free(bytes);
    return largest;
}

static inline void write_text(const char *run, const char *name, const char *text)
{
    char path[256];
    FILE *stream = fopen(in_folder(path, run, name), "w");
    assert_non_null(stream);
    fputs(text, stream);
    fclose(stream);
}

#endif
