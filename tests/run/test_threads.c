/* The library under threads, mainly for ThreadSanitizer: a model shared by several simulations, runs side by side with
   their writers of frames, meshes read and checked side by side. Results are those of one thread. */
#include "check.h"
#include "source_dir.h"

#include <pellicle/mesh_check.h>
#include <pellicle/mesh_io.h>
#include <pellicle/run.h>
#include <pellicle/shape.h>

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum { THREADS = 4, STEPS = 20 };

static const char scene_text[] =
    "version: 1\n"
    "bodies:\n"
    "  - name: ball\n"
    "    mesh: { shape: geodesic-sphere, frequency: 4 }\n"
    "    refine: { levels: 1, above: 0.05, below: 0.02 }\n"
    "loads: [{ body: ball, force: [0, 0, -1], at: { nearest: [0, 0, 1] } }]\n"
    "tools: [{ name: probe, shape: sphere, radius: 0.2, body: ball,\n"
    "          motion: [{ time: 0, position: [0, 0, 1.25] }, { time: 0.2, position: [0, 0, 1.1] }] }]\n"
    "solver: { alpha: 20, dt: 0.01 }\n"
    "duration: 0.2\n"
    "output: { every: 0.01, fields: [force, energy] }\n";

static pel_scene *load_scene(void)
{
    pel_scene *scene;
    pel_error error;
    char text[700];
    if (pel_scene_parse("threads.yaml", scene_text, strlen(scene_text), NULL, 0, NULL, &scene, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, text, sizeof text));
    return scene;
}

/* one thread's work on shared data, and its result */
typedef struct shared_work {
    const pel_scene *scene;
    const pel_model *model;
    int number;
    uint64_t hash; /* 0 = failed */
} shared_work;

static void start_all(shared_work works[THREADS], const shared_work *common, void *(*run)(void *))
{
    pthread_t threads[THREADS];
    for (int i = 0; i < THREADS; i++) {
        works[i] = *common;
        works[i].number = i;
        assert_int_equal(pthread_create(&threads[i], NULL, run, &works[i]), 0);
    }
    for (int i = 0; i < THREADS; i++)
        pthread_join(threads[i], NULL);
    for (int i = 0; i < THREADS; i++) {
        assert_true(works[i].hash != 0);
        assert_true(works[i].hash == works[0].hash);
    }
}

static void *simulate(void *argument)
{
    shared_work *work = argument;
    pel_sim_def def = work->scene->sim;
    pel_sim *sim = NULL;
    def.model = work->model;
    def.thread_count = 1 + work->number % 3;
    pel_status status = pel_sim_create(&def, &sim, NULL);
    for (int step = 0; status == PEL_OK && step < STEPS; step++)
        status = pel_sim_step(sim, NULL);
    work->hash = status == PEL_OK ? pel_sim_hash(sim) : 0;
    pel_sim_destroy(sim);
    return NULL;
}

static void test_shared_model(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene();
    pel_model *model;
    shared_work works[THREADS];
    assert_int_equal(pel_model_create(&scene->model, &model, NULL), PEL_OK);
    start_all(works, &(shared_work){.scene = scene, .model = model}, simulate);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
}

/* a scene is shared too; each run has its own thread that writes frames */
static void *run_scene(void *argument)
{
    shared_work *work = argument;
    char folder[64];
    pel_run_def def = pel_run_def_default();
    pel_run_summary *summary = calloc(1, sizeof *summary);
    snprintf(folder, sizeof folder, "of-thread-run-%d", work->number);
    def.folder = folder;
    def.thread_count = 2;
    work->hash = summary != NULL && pel_run(work->scene, &def, summary, NULL) == PEL_OK ? summary->state_hash : 0;
    free(summary);
    return NULL;
}

static void test_runs(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene();
    shared_work works[THREADS];
    start_all(works, &(shared_work){.scene = scene}, run_scene);
    pel_scene_destroy(scene);
}

/* all into one folder: the first run gets it, the others are refused */
static void *run_in_one_folder(void *argument)
{
    shared_work *work = argument;
    pel_run_def def = pel_run_def_default();
    pel_run_summary *summary = calloc(1, sizeof *summary);
    pel_error error;
    def.folder = "of-thread-one";
    pel_status status = summary != NULL ? pel_run(work->scene, &def, summary, &error) : PEL_OUT_OF_MEMORY;
    bool refused = status == PEL_BAD_FILE && strstr(error.what, "another run is writing") != NULL;
    work->hash = status == PEL_OK || refused ? 1 : 0;
    free(summary);
    return NULL;
}

static void test_one_folder(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene();
    shared_work works[THREADS];
    /* in later rounds there is an older run, which one of them moves aside */
    for (int round = 0; round < 3; round++)
        start_all(works, &(shared_work){.scene = scene}, run_in_one_folder);
    assert_int_equal(access("of-thread-one/.pellicle-lock", F_OK), -1);
    assert_int_equal(access("of-thread-one/summary.json", F_OK), 0);
    pel_scene_destroy(scene);
}

static void *check_meshes(void *argument)
{
    shared_work *work = argument;
    static const char *const names[] = {"bean", "sac", "flap"};
    work->hash = 1;
    for (int i = 0; i < 3; i++) {
        char path[600];
        pel_mesh *mesh = NULL;
        pel_mesh_report *report = NULL;
        snprintf(path, sizeof path, PEL_SOURCE_DIR "/tests/data/%s.obj", names[i]);
        if (pel_mesh_read(path, PEL_FORMAT_AUTO, NULL, &mesh, NULL) != PEL_OK ||
            pel_mesh_check(mesh, &report, NULL) != PEL_OK || report->error_count != 0)
            work->hash = 0;
        pel_mesh_report_destroy(report);
        pel_mesh_destroy(mesh);
    }
    return NULL;
}

static void test_meshes(void **unused)
{
    (void)unused;
    shared_work works[THREADS];
    start_all(works, &(shared_work){.number = 0}, check_meshes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shared_model),
        cmocka_unit_test(test_runs),
        cmocka_unit_test(test_one_folder),
        cmocka_unit_test(test_meshes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
