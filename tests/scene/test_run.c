#define _XOPEN_SOURCE 700 /* nftw */
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
static const char small[] = "version: 1\nbodies: [{ mesh: { shape: geodesic-sphere, frequency: 1 } }]\n"
                            "tools: [{ shape: sphere, radius: 0.1, motion: [{ time: 0, position: [0, 0, 3] }] }]\n"
                            "solver: { dt: 0.01 }\nduration: 1\noutput: { every_frame: 1, checkpoint: 0.1 }\n";

static char folder[64];

/* of the runs that do not say; with more than one, frames are written beside the simulation */
static int32_t thread_count;

/* ---- help ---- */

static int remove_entry(const char *path, const struct stat *information, int kind, struct FTW *place)
{
    (void)information;
    (void)kind;
    (void)place;
    return remove(path);
}

static void remove_folder(const char *path)
{
    nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

static int make_folder(void **unused)
{
    (void)unused;
    snprintf(folder, sizeof folder, "run-test-XXXXXX");
    return mkdtemp(folder) == NULL;
}

static int clear_folder(void **unused)
{
    (void)unused;
    remove_folder(folder);
    return 0;
}

static char *in_folder(char path[256], const char *run, const char *name)
{
    snprintf(path, 256, "%s/%s%s%s", folder, run, name[0] != '\0' ? "/" : "", name);
    return path;
}

static bool exists(const char *run, const char *name)
{
    char path[256];
    return access(in_folder(path, run, name), F_OK) == 0;
}

static void read_text(const char *run, const char *name, char **bytes, size_t *size)
{
    char path[256];
    size_t unused;
    assert_int_equal(pel_file_read(in_folder(path, run, name), bytes, size != NULL ? size : &unused, NULL), PEL_OK);
}

static void check_contains(const char *run, const char *name, const char *text)
{
    char *bytes;
    read_text(run, name, &bytes, NULL);
    if (strstr(bytes, text) == NULL)
        print_error("%s/%s has no '%s':\n%s\n", run, name, text, bytes);
    assert_non_null(strstr(bytes, text));
    pel_free(bytes);
}

static pel_scene *load_scene(const char *text, const char *const *overrides, int32_t override_count)
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

/* what a test wants of a run */
typedef struct run_case {
    const char *run;    /* folder */
    const char *resume; /* checkpoint in it, nullable */
    int64_t stop_at;    /* step, 0 = no */
    int64_t kill_at;    /* step, 0 = no */
    int64_t fill_at;    /* step from which on files can have file_size bytes only, 0 = no */
    rlim_t file_size;
    const char *block;   /* name in the folder that another folder takes at step 30; nullable */
    double keep_seconds; /* 0 = as by default */
    int64_t max_frames;
    int32_t threads;
    pel_run_summary summary;
    pel_error error;
    int64_t calls;
} run_case;

static void limit_files(rlim_t size)
{
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit.rlim_cur = size;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

static void unlimit_files(void)
{
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit_files(limit.rlim_max);
}

static bool watch(void *user, const pel_run_progress *progress)
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
    return test->stop_at == 0 || progress->step < test->stop_at;
}

static pel_status do_run(const pel_scene *scene, run_case *test)
{
    char path[256], resume[256];
    pel_run_def def = pel_run_def_default();
    def.folder = in_folder(path, test->run, "");
    def.resume = test->resume != NULL ? in_folder(resume, test->run, test->resume) : NULL;
    def.max_frames = test->max_frames;
    def.thread_count = test->threads > 0 ? test->threads : thread_count;
    def.keep_seconds = test->keep_seconds > 0 ? test->keep_seconds : def.keep_seconds;
    def.progress = watch;
    def.user = test;
    return pel_run(scene, &def, &test->summary, &test->error);
}

static void check_run(const pel_scene *scene, run_case *test, pel_status expected)
{
    char message[900];
    pel_status status = do_run(scene, test);
    if (status != expected && status != PEL_OK)
        print_error("%s\n", pel_error_text(&test->error, message, sizeof message));
    assert_int_equal(status, expected);
}

static int64_t count_rows(const char *run)
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

/* every frame that the list names is there and whole; returns how many */
static int64_t check_list(const char *run)
{
    char *bytes, path[256];
    int64_t count = 0;
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
        count++;
    }
    pel_free(bytes);
    return count;
}

/* no half-written file, no frame beyond the list's end */
static void check_whole(const char *run)
{
    char path[256];
    int64_t frames = 0, listed = check_list(run);
    const char *const parts[2] = {"", "frames"};
    for (int i = 0; i < 2; i++) {
        DIR *stream = opendir(in_folder(path, run, parts[i]));
        assert_non_null(stream);
        for (struct dirent *entry = readdir(stream); entry != NULL; entry = readdir(stream)) {
            assert_null(strstr(entry->d_name, ".tmp"));
            frames += strstr(entry->d_name, ".vtp") != NULL;
        }
        closedir(stream);
    }
    assert_int_equal(frames, listed);
    assert_int_equal(count_rows(run), listed);
}

/* blanks what depends on the wall clock, the number of threads or the folder */
static void blank_times(const char *name, char *bytes)
{
    if (strcmp(name, "series.csv") == 0) {
        int column = 0;
        for (char *at = bytes; *at != '\0'; at++) {
            column = *at == '\n' ? 0 : column + (*at == ',');
            if (column == 11 && *at != ',' && *at != '\n')
                *at = '?';
        }
        return;
    }
    const char *const keys[4] = {"\"wall_s\": ", "\"steps_per_second\": ", "\"threads\": ", "\"checkpoint\": "};
    for (int i = 0; i < 4; i++) {
        char *at = strstr(bytes, keys[i]);
        for (at = at != NULL ? at + strlen(keys[i]) : NULL; at != NULL && *at != '\n'; at++)
            *at = '?';
    }
}

/* removes all question marks, so that numbers of different lengths compare equal */
static void squeeze(char *bytes)
{
    char *out = bytes;
    for (const char *at = bytes; *at != '\0'; at++)
        if (*at != '?')
            *out++ = *at;
    *out = '\0';
}

static void check_same_file(const char *a, const char *b, const char *name)
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

static void check_same_results(const char *a, const char *b, int64_t frames)
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
static double largest_in_series(const char *run, int column)
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

/* ---- tests ---- */

static void test_files(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(busy, NULL, 0), *again;
    run_case test = {.run = "deep/er/files"};
    char path[256];
    check_run(scene, &test, PEL_OK);
    assert_int_equal(test.calls, 61);
    assert_string_equal(test.summary.status, "done");
    assert_int_equal(test.summary.frames, 10);
    assert_int_equal(test.summary.steps, 60);
    assert_near(test.summary.time_simulated, 0.6, 1e-12);
    enum { MAX_DISPLACEMENT = 6, PROBE_FORCE = 12, PROBE_FORCE_MAX = 20 };
    assert_true(test.summary.max_displacement == largest_in_series(test.run, MAX_DISPLACEMENT));
    assert_true(test.summary.max_tool_force == largest_in_series(test.run, PROBE_FORCE_MAX));
    assert_true(test.summary.max_tool_force > largest_in_series(test.run, PROBE_FORCE));
    check_whole(test.run);
    assert_int_equal(check_list(test.run), 10);
    check_contains(test.run, "series.csv",
                   "frame,time,volume_ratio,area_ratio,kinetic_energy,elastic_energy,max_displacement,max_force,"
                   "vertices,triangles,contacts,step_ms,probe_force,probe_force_x,probe_force_y,probe_force_z,"
                   "probe_contacts,probe_x,probe_y,probe_z,probe_force_max,clamp_force,");
    check_contains(test.run, "summary.json", "{\n  \"status\": \"done\",\n  \"frames\": 10,\n  \"steps\": 60,\n");
    check_contains(test.run, "summary.json", "\"self_intersections_final\": 0,");
    assert_int_equal(test.summary.self_intersections_final, 0);
    check_contains(test.run, "summary.json", "{\"name\": \"probe\", \"max_force\": ");
    check_contains(test.run, "scene.yaml", "# state_hash: ");

    pel_mesh *mesh;
    assert_int_equal(pel_mesh_read(in_folder(path, test.run, "final.ply"), PEL_FORMAT_AUTO, NULL, &mesh, NULL), PEL_OK);
    assert_int_equal(mesh->vertex_count, test.summary.vertices_final);
    assert_non_null(pel_mesh_field(mesh, "body"));
    assert_non_null(pel_mesh_field(mesh, "thickness"));
    assert_true(pel_mesh_field(mesh, "body")->values[mesh->vertex_count - 1] == 1);
    pel_mesh_destroy(mesh);

    /* the resolved scene is a scene, and the same one */
    assert_int_equal(pel_scene_load(in_folder(path, test.run, "scene.yaml"), NULL, 0, NULL, &again, NULL), PEL_OK);
    assert_string_equal(pel_scene_text(again), pel_scene_text(scene));
    pel_scene_destroy(again);
    pel_scene_destroy(scene);
}

/* the fields of a frame are those of the state that the frame shows */
static void test_frame_fields(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(busy, NULL, 0);
    run_case test = {.run = "fields"};
    char path[256];
    pel_mesh *first, *last;
    double time;
    check_run(scene, &test, PEL_OK);
    assert_int_equal(pel_vtp_read(in_folder(path, "fields", "frames/f00000.vtp"), &first, NULL, NULL), PEL_OK);
    assert_int_equal(pel_vtp_read(in_folder(path, "fields", "frames/f00009.vtp"), &last, &time, NULL), PEL_OK);
    assert_int_equal(last->field_count, 7);
    assert_near(time, 0.6, 1e-12);
    const double *u = pel_mesh_field(last, "displacement")->values;
    const double *thickness = pel_mesh_field(last, "thickness")->values;
    double contacts = 0, energy = 0, largest = 0;
    for (int32_t v = 0; v < last->vertex_count; v++) {
        double square = 0;
        for (int c = 0; c < 3; c++) {
            assert_near(u[3 * v + c], last->positions[v][c] - first->positions[v][c], 1e-5);
            square += u[3 * v + c] * u[3 * v + c];
        }
        largest = fmax(largest, sqrt(square));
        contacts += pel_mesh_field(last, "contact")->values[v];
        energy += pel_mesh_field(last, "energy")->values[v];
        bool lens = pel_mesh_field(last, "body")->values[v] == 1;
        assert_true((thickness[v] > 0) == lens);
    }
    assert_true(contacts > 0 && energy > 0);
    assert_near(largest, test.summary.residual_displacement, 1e-6);
    assert_true(test.summary.max_displacement >= test.summary.residual_displacement);
    pel_mesh_destroy(first);
    pel_mesh_destroy(last);
    pel_scene_destroy(scene);
}

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
        /* the very state at which it stopped, though older checkpoints were written on the way */
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

/* frames of a body that refines are the changing mesh, each whole and closed, with levels and places in the mesh */
static int32_t check_refined_frame(const char *run, int frame)
{
    char path[256], name[32];
    pel_mesh *mesh;
    pel_topology *topology;
    int32_t finest = 0;
    snprintf(name, sizeof name, "frames/f%05d.vtp", frame);
    assert_int_equal(pel_vtp_read(in_folder(path, run, name), &mesh, NULL, NULL), PEL_OK);
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    assert_int_equal(topology->boundary_edge_count, 0);
    const pel_field *level = pel_mesh_field(mesh, "level"), *weights = pel_mesh_field(mesh, "mesh_weights");
    assert_true(level != NULL && weights != NULL && pel_mesh_field(mesh, "mesh_vertices") != NULL);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        const double *w = weights->values + 3 * (size_t)v;
        finest = level->values[v] > finest ? (int32_t)level->values[v] : finest;
        assert_near(w[0] + w[1] + w[2], 1, 1e-6);
    }
    pel_topology_destroy(topology);
    pel_mesh_destroy(mesh);
    return finest;
}

static void test_refinement(void **unused)
{
    (void)unused;
    const char *overrides[] = {"bodies.ball.refine.above=4", "bodies.ball.refine.levels=2",
                               "bodies.ball.refine.dwell=5", "bodies.ball.refine.interval=3",
                               "output.fields.6=area",       "output.fields.7=stress"};
    pel_scene *scene = load_scene(busy, overrides, 6);
    const pel_refine_def *refine = &scene->model.bodies[0].refine;
    assert_true(refine->levels == 2 && refine->above == 4 && refine->below == 2 && refine->dwell == 5 &&
                refine->interval == 3 && refine->rings == 2 && !refine->everywhere);
    assert_int_equal(scene->model.bodies[1].refine.levels, 0);
    run_case whole = {.run = "refine"};
    check_run(scene, &whole, PEL_OK);
    check_whole("refine");
    assert_int_equal(check_refined_frame("refine", 0), 0);
    assert_int_equal(check_refined_frame("refine", 5), 2);
    assert_true(whole.summary.triangles_final >
                scene->model.bodies[0].mesh->triangle_count + scene->model.bodies[1].mesh->triangle_count);
    const int64_t stops[] = {2, 22, 40};
    for (size_t i = 0; i < sizeof stops / sizeof stops[0]; i++) {
        char run[32];
        snprintf(run, sizeof run, "refine-%d", (int)stops[i]);
        run_case test = {.run = run, .stop_at = stops[i]}, rest = {.run = run, .resume = "checkpoint"};
        check_run(scene, &test, PEL_STOPPED);
        check_run(scene, &rest, PEL_OK);
        assert_true(rest.summary.state_hash == whole.summary.state_hash);
        check_same_results("refine", run, whole.summary.frames);
    }
    pel_scene_destroy(scene);
}

/* goes back to an older checkpoint: what came after it is replaced */
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

/* killed at a step: everything is valid, and the run goes on from its last checkpoint */
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

/* a state that cannot be kept is told, and the run goes on */
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

/* what is read to go on from is freed again */
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

/* another mesh file under the same name is another scene, also when its fields alone have changed */
static void test_changed_mesh(void **unused)
{
    (void)unused;
    static const char *const changes[4] = {"0.25", "0.75", "0.25", "0.25"},
                             *const names[4] = {"stiff", "stiff", "soft", "stiff"},
                             *const tips[4] = {"1", "1", "1", "2"};
    char path[256], text[1000], mesh[400];
    in_folder(path, "changed.ply", "");
    snprintf(text, sizeof text, "version: 1\nduration: 0.1\nbodies: [{ mesh: { file: %s } }]\n", path);
    run_case test = {.run = "changed", .stop_at = 3};
    for (int i = 0; i < 4; i++) {
        snprintf(mesh, sizeof mesh,
                 "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
                 "property double %s\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n"
                 "0 0 0 0.5\n1 0 0 0.5\n0 1 0 0.5\n0 0 %s %s\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n",
                 names[i], tips[i], changes[i]);
        FILE *stream = fopen(path, "w");
        assert_non_null(stream);
        fputs(mesh, stream);
        fclose(stream);
        pel_scene *scene = load_scene(text, NULL, 0);
        check_run(scene, &test, i == 0 ? PEL_STOPPED : PEL_BAD_FORMAT);
        assert_true(i == 0 || strstr(test.error.what, "another scene") != NULL);
        test = (run_case){.run = "changed", .resume = "checkpoint"};
        pel_scene_destroy(scene);
    }
}

/* one closed body is enough for a volume to stop at, wherever it stands */
static void test_volume_of_any_body(void **unused)
{
    (void)unused;
    static const char *const bodies[2] = {"{ shape: grid }", "{ shape: geodesic-sphere, frequency: 2 }"};
    for (int i = 0; i < 4; i++) {
        char text[400];
        snprintf(
            text, sizeof text,
            "version: 1\nduration: 0.02\nbodies: [{ mesh: %s }, { mesh: %s }]\nstop: { volume_ratio_below: 0.5 }\n",
            bodies[i / 2], bodies[i % 2]);
        pel_scene *scene = load_scene(text, NULL, 0);
        run_case test = {.run = "volume"};
        check_run(scene, &test, i == 0 ? PEL_BAD_SCENE : PEL_OK);
        pel_scene_destroy(scene);
    }
}

/* steps a second are those of this call, and the time that is left follows from them */
static bool watch_speed(void *user, const pel_run_progress *progress)
{
    double *numbers = user;
    struct timespec pause = {.tv_nsec = 2000000};
    nanosleep(&pause, NULL);
    numbers[0] = progress->steps_per_second;
    if (progress->step == 20)
        numbers[1] = progress->remaining * progress->steps_per_second;
    if (progress->step == 0)
        numbers[2] = progress->remaining;
    return true;
}

static void test_speed(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(small, NULL, 0);
    char path[256];
    double numbers[3] = {0, 0, 0};
    pel_run_summary summary;
    pel_run_def def = pel_run_def_default();
    def.folder = in_folder(path, "speed", "");
    def.progress = watch_speed;
    def.user = numbers;
    assert_int_equal(pel_run(scene, &def, &summary, NULL), PEL_OK);
    /* 100 steps, each with a pause of 2 ms: at most 500 a second, and not a hundredth of that */
    assert_true(numbers[0] < 510 && numbers[0] > 5);
    assert_near(numbers[1], 80, 1e-6);
    assert_near(numbers[2], -1, 0);
    pel_scene_destroy(scene);
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

static void write_text(const char *run, const char *name, const char *text)
{
    char path[256];
    FILE *stream = fopen(in_folder(path, run, name), "w");
    assert_non_null(stream);
    fputs(text, stream);
    fclose(stream);
}

/* an older, longer run is replaced; files that are none of a run stay */
static void test_takes_over_folder(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(busy, NULL, 0);
    run_case test = {.run = "again"};
    check_run(scene, &test, PEL_OK);
    write_text("again", "notes.txt", "mine");
    write_text("again", "frames/picture.png", "mine");
    write_text("again", "frames/.pellicle-1-0.tmp", "left over");
    test.max_frames = 2;
    check_run(scene, &test, PEL_OK);
    assert_int_equal(test.summary.frames, 3);
    assert_int_equal(test.summary.steps, 14);
    check_whole("again");
    assert_false(exists("again", "frames/f00003.vtp"));
    assert_false(exists("again", "checkpoint-22.pel"));
    assert_true(exists("again", "notes.txt") && exists("again", "frames/picture.png"));
    /* a run cut short by max_frames can go on */
    run_case rest = {.run = "again", .resume = "checkpoint"}, whole = {.run = "again-whole"};
    check_run(scene, &rest, PEL_OK);
    check_run(scene, &whole, PEL_OK);
    check_same_results("again-whole", "again", whole.summary.frames);
    pel_scene_destroy(scene);
}

static void test_refuses_checkpoints(void **unused)
{
    (void)unused;
    const char *const override = "bodies.ball.springs.stiffness=4";
    pel_scene *scene = load_scene(busy, NULL, 0), *other = load_scene(busy, &override, 1);
    run_case test = {.run = "refuse", .stop_at = 25};
    char path[256];
    size_t size;
    check_run(scene, &test, PEL_STOPPED);
    char *series, *bytes, *now;
    read_text("refuse", "series.csv", &series, NULL);
    read_text("refuse", "checkpoint", &bytes, &size);
    test.resume = "checkpoint";
    check_run(other, &test, PEL_BAD_FORMAT);
    assert_non_null(strstr(test.error.what, "another scene"));
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
    pel_scene_destroy(other);
    pel_scene_destroy(scene);
}

static void test_bad_folders(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(busy, NULL, 0);
    run_case test = {.run = "in-the-way"};
    write_text(".", "in-the-way", "a file");
    check_run(scene, &test, PEL_BAD_FILE);
    assert_string_equal(test.summary.status, "");
    test.run = "in-the-way/below";
    check_run(scene, &test, PEL_BAD_FILE);
    char path[256];
    assert_int_equal(mkdir(in_folder(path, "closed", ""), 0555), 0);
    test.run = "closed";
    if (geteuid() != 0) {
        check_run(scene, &test, PEL_BAD_FILE);
        assert_false(exists("closed", "frames"));
    }
    pel_scene_destroy(scene);
}

/* a scene that cannot run leaves no folder */
static void test_nothing_written(void **unused)
{
    (void)unused;
    const char *const unstable = "solver.alpha=1e6";
    pel_scene *scene = load_scene(busy, &unstable, 1);
    run_case test = {.run = "never"};
    check_run(scene, &test, PEL_UNSTABLE);
    assert_string_equal(test.error.file, "--set solver.alpha=1e6");
    assert_false(exists("never", ""));
    pel_scene_destroy(scene);
}

/* the scene that is being run is never overwritten */
static void test_own_scene(void **unused)
{
    (void)unused;
    char path[256];
    pel_scene *scene;
    mkdir(in_folder(path, "own", ""), 0777);
    write_text("own", "scene.yaml", busy);
    assert_int_equal(pel_scene_load(in_folder(path, "own", "scene.yaml"), NULL, 0, NULL, &scene, NULL), PEL_OK);
    run_case test = {.run = "own"};
    check_run(scene, &test, PEL_BAD_FILE);
    char *text;
    read_text("own", "scene.yaml", &text, NULL);
    assert_string_equal(text, busy);
    pel_free(text);
    pel_scene_destroy(scene);
}

static void test_divergence(void **unused)
{
    (void)unused;
    const char *const overrides[] = {"loads.0.force=[0, 0, 1e9]", "loads.0.from=0.25", "solver.method=explicit",
                                     "output.checkpoint=0"};
    pel_scene *scene = load_scene(busy, overrides, 4);
    run_case test = {.run = "diverged"};
    check_run(scene, &test, PEL_DIVERGED);
    assert_string_equal(test.summary.status, "diverged");
    assert_true(test.summary.steps >= 25 && test.summary.steps < 60);
    assert_true(exists("diverged", "checkpoint"));
    assert_non_null(strstr(test.error.remedy, "diverged/checkpoint"));
    check_contains("diverged", "summary.json", "\"status\": \"diverged\"");
    check_contains("diverged", "summary.json", "diverged in step");
    check_whole("diverged");
    pel_scene_destroy(scene);
}

/* what is there is whole; with room again, it goes on from what was kept */
static void check_after_failure(const pel_scene *scene, const run_case *test)
{
    if (!exists(test->run, "frames.pvd"))
        return;
    check_whole(test->run);
    if (test->summary.checkpoint[0] == '\0')
        return;
    run_case rest = {.run = test->run, .resume = "checkpoint"}, whole = {.run = "whole-again"};
    check_run(scene, &rest, PEL_OK);
    check_run(scene, &whole, PEL_OK);
    check_same_results(whole.run, rest.run, whole.summary.frames);
}

/* A limit on the size of files acts like a full disk: whichever file meets it first, it is named and what is there is
   whole. */
static void test_full_disk(void **unused)
{
    (void)unused;
    enum { KIND_COUNT = 4 };
    const char *const kinds[KIND_COUNT] = {"scene.yaml", ".vtp", "series.csv", "checkpoint"};
    const char *const checkpoints[2] = {"output.checkpoint=0.1", "output.checkpoint=0"};
    int seen[KIND_COUNT] = {0}, done = 0;
    signal(SIGXFSZ, SIG_IGN);
    for (int i = 0; i < 60; i++) {
        rlim_t size = i / 2 < 20 ? 150 * (rlim_t)(i / 2 + 1) : 3000 * (rlim_t)(i / 2 - 18);
        pel_scene *scene = load_scene(small, &checkpoints[i % 2], 1);
        run_case test = {.run = "full"};
        limit_files(size);
        pel_status status = do_run(scene, &test);
        unlimit_files();
        if (status == PEL_OK) {
            done++;
            pel_scene_destroy(scene);
            continue;
        }
        assert_int_equal(status, PEL_BAD_FILE);
        assert_non_null(strstr(test.error.file, "full/"));
        assert_non_null(strstr(test.error.remedy, "disk space"));
        for (int k = 0; k < KIND_COUNT; k++)
            seen[k] += strstr(test.error.file, kinds[k]) != NULL;
        check_after_failure(scene, &test);
        pel_scene_destroy(scene);
    }
    for (int k = 0; k < KIND_COUNT; k++)
        assert_true(seen[k] > 0);
    assert_true(done > 0);
    signal(SIGXFSZ, SIG_DFL);
}

/* a frame does not fit, the checkpoint does: the run goes on with this very frame, also when the simulation was steps
   beyond it already */
static void test_full_disk_at_frame(void **unused)
{
    (void)unused;
    const char *const overrides[] = {"output.compress=false", "output.precision=double", "output.checkpoint=0"};
    pel_scene *scene = load_scene(busy, overrides, 3);
    run_case whole = {.run = "frame-whole"};
    run_case test = {.run = "frame", .fill_at = 30};
    char path[256], remedy[64];
    struct stat frame, checkpoint;
    check_run(scene, &whole, PEL_OK);
    assert_int_equal(stat(in_folder(path, "frame-whole", "frames/f00005.vtp"), &frame), 0);
    test.file_size = (rlim_t)frame.st_size - 1;
    signal(SIGXFSZ, SIG_IGN);
    check_run(scene, &test, PEL_BAD_FILE);
    unlimit_files();
    signal(SIGXFSZ, SIG_DFL);
    assert_int_equal(stat(in_folder(path, "frame", "checkpoint"), &checkpoint), 0);
    assert_true(checkpoint.st_size < frame.st_size);
    /* beside the simulation, frames of earlier steps may meet the limit already */
    int64_t number = test.summary.steps / 7;
    assert_true(number == 5 || (thread_count > 1 && number >= 2 && number < 5));
    assert_int_equal(test.summary.steps, 7 * number);
    assert_int_equal(test.summary.frames, number);
    snprintf(remedy, sizeof remedy, "f%05d.vtp", (int)number);
    assert_non_null(strstr(test.error.file, remedy));
    snprintf(remedy, sizeof remedy, "of step %d, is in", (int)test.summary.steps);
    assert_non_null(strstr(test.error.remedy, remedy));
    check_whole("frame");
    run_case rest = {.run = "frame", .resume = "checkpoint"};
    check_run(scene, &rest, PEL_OK);
    check_same_results("frame-whole", "frame", whole.summary.frames);
    pel_scene_destroy(scene);
}

/* the simulation diverges and a frame before that cannot be written: the frame is what failed, as in one thread */
static void test_frame_fails_before_divergence(void **unused)
{
    (void)unused;
    const char *const overrides[] = {"loads.0.force=[0, 0, 1e9]", "loads.0.from=0.36", "solver.method=explicit",
                                     "output.checkpoint=0"};
    pel_scene *scene = load_scene(busy, overrides, 4);
    run_case test = {.run = "blocked"};
    char path[256];
    check_run(scene, &test, PEL_DIVERGED);
    int64_t diverged_at = test.summary.steps;
    assert_true(diverged_at >= 36);
    test.block = "frames/f00005.vtp";
    check_run(scene, &test, PEL_BAD_FILE);
    assert_int_equal(test.summary.steps, 35);
    assert_int_equal(test.summary.frames, 5);
    assert_string_equal(test.summary.status, "failed");
    rmdir(in_folder(path, "blocked", "frames/f00005.vtp"));
    check_whole("blocked");
    run_case rest = {.run = "blocked", .resume = "checkpoint"};
    check_run(scene, &rest, PEL_DIVERGED);
    assert_int_equal(rest.summary.steps, diverged_at);
    check_whole("blocked");
    pel_scene_destroy(scene);
}

static void test_at_rest(void **unused)
{
    (void)unused;
    const char *const overrides[] = {"duration=100", "stop.at_rest=1e-3", "loads.0.force=[0, 0, -1]",
                                     "loads.0.until=0.5"};
    pel_scene *scene = load_scene(small, overrides, 4);
    run_case test = {.run = "rest"};
    check_run(scene, &test, PEL_OK);
    assert_string_equal(test.summary.status, "done");
    assert_true(test.summary.time_simulated > 0.5 && test.summary.time_simulated < 90);
    check_whole("rest");
    pel_scene_destroy(scene);
}

static pel_status run_briefly(const void *data, pel_error *error)
{
    char path[256];
    pel_run_summary summary;
    pel_run_def def = pel_run_def_default();
    def.folder = in_folder(path, "memory", "");
    def.max_frames = 2;
    def.thread_count = thread_count;
    return pel_run(data, &def, &summary, error);
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(small, NULL, 0);
    assert_true(for_every_allocation_failure(run_briefly, scene) > 50);
    pel_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_frame_fields),
        cmocka_unit_test(test_resume_after_stop),
        cmocka_unit_test(test_refinement),
        cmocka_unit_test(test_resume_from_older),
        cmocka_unit_test(test_resume_at_end),
        cmocka_unit_test(test_kill),
        cmocka_unit_test(test_resume_leaks_nothing),
        cmocka_unit_test(test_changed_mesh),
        cmocka_unit_test(test_volume_of_any_body),
        cmocka_unit_test(test_speed),
        cmocka_unit_test(test_kept_state),
        cmocka_unit_test(test_state_not_kept),
        cmocka_unit_test(test_takes_over_folder),
        cmocka_unit_test(test_refuses_checkpoints),
        cmocka_unit_test(test_bad_folders),
        cmocka_unit_test(test_nothing_written),
        cmocka_unit_test(test_own_scene),
        cmocka_unit_test(test_divergence),
        cmocka_unit_test(test_full_disk),
        cmocka_unit_test(test_full_disk_at_frame),
        cmocka_unit_test(test_frame_fails_before_divergence),
        cmocka_unit_test(test_at_rest),
        cmocka_unit_test(test_allocation_failures),
    };
    int failed = 0;
    /* what one thread does alone is no less with two */
    for (thread_count = ROUNDS(1, 2); thread_count <= 2; thread_count++)
        failed += cmocka_run_group_tests(tests, make_folder, clear_folder);
    return failed;
}
