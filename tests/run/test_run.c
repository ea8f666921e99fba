#define _XOPEN_SOURCE 700 /* nftw */
#include "run/run_fixture.h"

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
    enum { MAX_DISPLACEMENT = 7, PROBE_FORCE = 13, PROBE_FORCE_MAX = 21 };
    assert_true(test.summary.max_displacement == largest_in_series(test.run, MAX_DISPLACEMENT));
    assert_true(test.summary.max_tool_force == largest_in_series(test.run, PROBE_FORCE_MAX));
    assert_true(test.summary.max_tool_force > largest_in_series(test.run, PROBE_FORCE));
    check_whole(test.run);
    assert_int_equal(check_list(test.run), 10);
    check_contains(test.run, "series.csv",
                   "frame,time,volume,volume_ratio,area_ratio,kinetic_energy,elastic_energy,max_displacement,max_force,"
                   "vertices,triangles,contacts,step_ms,probe_force,probe_force_x,probe_force_y,probe_force_z,"
                   "probe_contacts,probe_x,probe_y,probe_z,probe_force_max,probe_held,probe_torque_x,probe_torque_y,"
                   "probe_torque_z,probe_force_known,clamp_force,");
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
    for (size_t i = 0; i < sizeof stops / sizeof stops[0]; i += (size_t)LONG(1, 2)) {
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

/* A body that encloses nothing at rest has a volume and no ratio of it, nor has an open one. */
static void test_ratio_of_nothing(void **unused)
{
    (void)unused;
    static const char text[] =
        "version: 1\nstop: { frames: 4 }\nbodies:\n  - mesh: { file: %s }\n"
        "    membrane: { young: 1e6, thickness: 0.001 }\n    bending: { model: none }\n    pressure: { inside: 200 }\n"
        "solver: { dt: 0.002 }\noutput: { every_frame: 1 }\n";
    /* two triangles on each other */
    static const char flat[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 0\nv 0.4 0.6 0\n"
                               "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 2 1 6\nf 3 2 6\nf 4 3 6\nf 1 4 6\n";
    char path[256], scene_text[700];
    FILE *file = fopen(in_folder(path, "cushion.obj", ""), "w");
    assert_non_null(file);
    fputs(flat, file);
    assert_int_equal(fclose(file), 0);
    snprintf(scene_text, sizeof scene_text, text, path);
    pel_scene *scene = load_scene(scene_text, NULL, 0);
    run_case test = {.run = "cushion"};
    check_run(scene, &test, PEL_OK);
    check_contains("cushion", "summary.json", "\"volume_ratio_final\": null");
    assert_true(isnan(test.summary.volume_ratio_final) && test.summary.volume_final > 0);
    assert_true(test.summary.volume_final == largest_in_series("cushion", 2));
    check_contains("cushion", "series.csv", ",0,,1,");
    pel_scene_destroy(scene);
}

/* far from the origin frames are double, as the state is */
static void test_far_frames(void **unused)
{
    (void)unused;
    static const char text[] =
        "version: 1\nstop: { frames: 1 }\ngravity: [0, 0, -9.81]\nbodies:\n"
        "  - { mesh: { shape: grid, nx: 4, ny: 4, translate: [%s, 5846925, 0] }, membrane: { preset: silicone } }\n"
        "tools: [{ name: pin, shape: sphere, radius: 0.1, motion: [{ position: [%s, 5846925, -3] }] }]\n"
        "output: { every_frame: 1 }\n";
    char scene_text[700], path[256];
    snprintf(scene_text, sizeof scene_text, text, "615850.3", "615850.3");
    pel_scene *scene = load_scene(scene_text, NULL, 0);
    run_case test = {.run = "far"};
    check_run(scene, &test, PEL_OK);
    pel_mesh *mesh[2];
    in_folder(path, "far", "final.ply");
    assert_int_equal(pel_mesh_read(path, PEL_FORMAT_AUTO, NULL, &mesh[0], NULL), PEL_OK);
    in_folder(path, "far", "frames/f00001.vtp");
    assert_int_equal(pel_mesh_read(path, PEL_FORMAT_AUTO, NULL, &mesh[1], NULL), PEL_OK);
    for (int32_t v = 0; v < mesh[0]->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            assert_true(mesh[0]->positions[v][c] == mesh[1]->positions[v][c]);
    pel_mesh_destroy(mesh[0]);
    pel_mesh_destroy(mesh[1]);
    pel_scene_destroy(scene);
}

/* the last columns are sums of what the search for contacts did since the frame before */
static void test_contact_columns(void **unused)
{
    (void)unused;
    static const char text[] =
        "version: 1\nbodies: [{ mesh: { shape: geodesic-sphere, frequency: 3 }, preset: paper-a }]\ncontact: {}\n"
        "tools: [{ name: t, shape: sphere, radius: 0.3, motion: [{ position: [0, 0, 1.31] }, { time: 0.2, position: "
        "[0, 0, 1] }] }]\n"
        "solver: { method: quasi-static, dt: 0.01 }\nduration: 0.2\noutput: { every_frame: 5 }\n";
    pel_scene *scene = load_scene(text, NULL, 0);
    run_case test = {.run = "contact"};
    check_run(scene, &test, PEL_OK);
    char *bytes;
    read_text("contact", "series.csv", &bytes, NULL);
    int column = 0;
    for (const char *at = bytes; at < strstr(bytes, "contact_candidates"); at++)
        column += *at == ',';
    pel_free(bytes);
    assert_true(column > 12);
    assert_true(largest_in_series("contact", column) > 0);
    pel_scene_destroy(scene);
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
    /* the pauses are no time of steps */
    enum { STEP_MS = 12 };
    double step_ms = largest_in_series("speed", STEP_MS);
    assert_true(step_ms > 0 && step_ms < 1e3);
    pel_scene_destroy(scene);
}

typedef struct asking {
    int count, most;
} asking;

static bool is_wanted(void *user)
{
    asking *asked = user;
    return asked->count++ < asked->most;
}

/* the caller is asked within long steps, with its own data, and a run that it stops ends before that step */
static void test_stops_within_steps(void **unused)
{
    (void)unused;
    static const char sheet[] =
        "version: 1\nbodies:\n"
        "  - { name: sheet, mesh: { shape: grid, nx: 12, ny: 12 }, mass: { density: 1000, thickness: 0.01 },\n"
        "      membrane: { young: 1e5, thickness: 0.01 }, pinned: { box: { min: [-1, -1, -1], max: [-0.49, 1, 1] } } "
        "}\n"
        "gravity: [0, 0, -9.81]\nsolver: { method: implicit, dt: 0.05 }\nstop: { frames: 4 }\n";
    pel_scene *scene = load_scene(sheet, NULL, 0);
    asking asked = {0, 1000000};
    pel_run_summary summary;
    pel_run_def def = pel_run_def_default();
    def.wanted = is_wanted;
    def.user = &asked;
    def.thread_count = 1; /* with more, the number of questions depends on which thread is faster */
    assert_int_equal(pel_run(scene, &def, &summary, NULL), PEL_OK);
    int whole = asked.count;
    assert_true(summary.steps > 1 && whole > 2 * summary.steps);
    int64_t steps = summary.steps;
    /* the last question follows the last step */
    for (int stop = 1; stop < whole - 1; stop += whole / 3) {
        asked = (asking){0, stop};
        pel_error error;
        assert_int_equal(pel_run(scene, &def, &summary, &error), PEL_STOPPED);
        assert_true(asked.count == stop + 1 && summary.steps < steps);
    }
    pel_scene_destroy(scene);
}

/* an older, longer run moves aside, or is replaced; files that are none of a run stay */
static void test_takes_over_folder(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(busy, NULL, 0);
    run_case test = {.run = "again"};
    check_run(scene, &test, PEL_OK);
    write_text("again", "notes.txt", "mine");
    write_text("again", "frames/picture.png", "mine");
    write_text("again", "frames/.pellicle-1-0.tmp", "left over");
    check_run(scene, &test, PEL_OK);
    assert_true(exists("again.1", "notes.txt") && exists("again.1", "frames/picture.png"));
    check_same_results("again.1", "again", test.summary.frames);
    write_text("again", "notes.txt", "mine");
    write_text("again", "frames/picture.png", "mine");
    write_text("again", "frames/.pellicle-1-0.tmp", "left over");
    test.max_frames = 2;
    test.overwrite = true;
    check_run(scene, &test, PEL_OK);
    assert_false(exists("again.2", ""));
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

/* a folder with files of others stays as it is, whatever their names */
static void test_folder_of_others(void **unused)
{
    (void)unused;
    static const char *const names[] = {"scene.yaml", "series.csv", "summary.json", "final.ply", "frames.pvd"};
    pel_scene *scene = load_scene(busy, NULL, 0);
    char path[256], *bytes;
    size_t size;
    assert_int_equal(mkdir(in_folder(path, "others", ""), 0777), 0);
    for (int i = 0; i < 5; i++)
        write_text("others", names[i], "mine");
    for (int overwrite = 0; overwrite < 2; overwrite++) {
        run_case test = {.run = "others", .overwrite = overwrite != 0};
        check_run(scene, &test, PEL_BAD_FILE);
        assert_non_null(strstr(test.error.what, "none that says that they are of a run"));
        for (int i = 0; i < 5; i++) {
            read_text("others", names[i], &bytes, &size);
            assert_true(size == 4 && memcmp(bytes, "mine", 4) == 0);
            pel_free(bytes);
        }
        assert_false(exists("others", "frames") || exists("others", ".pellicle-run"));
    }
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

/* nor are its meshes, however they are named; a run that goes on keeps its scene and would take final.ply away */
static void test_own_mesh(void **unused)
{
    (void)unused;
    char file[300], path[256];
    pel_scene *scene = load_scene(busy, NULL, 0);
    run_case first = {.run = "before"}, test = {.run = "before"};
    check_run(scene, &first, PEL_OK);
    pel_scene_destroy(scene);
    const char *const overrides[] = {file};
    snprintf(file, sizeof file, "bodies.0.mesh.file=%s", in_folder(path, "before/frames/..", "final.ply"));
    scene = load_scene(busy, overrides, 1);
    assert_int_equal(scene->mesh_file_count, 1);
    check_run(scene, &test, PEL_BAD_FILE);
    assert_string_equal(test.error.file, scene->mesh_files[0]);
    assert_true(exists("before", "final.ply") && exists("before", "summary.json"));
    test.resume = "nothing";
    check_run(scene, &test, PEL_BAD_FILE);
    assert_non_null(strstr(test.error.what, "its own mesh"));
    run_case other = {.run = "beside"};
    check_run(scene, &other, PEL_OK);
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

/* the pressure goes on acting on a balloon that has burst */
static void test_burst(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene("version: 1\nbodies:\n  - name: balloon\n"
                                  "    mesh: { shape: geodesic-sphere, radius: 0.1, frequency: 4 }\n"
                                  "    membrane: { young: 1e6, thickness: 0.001, toughness: 300, strength: 3e5 }\n"
                                  "    pressure: { inside: 6000 }\ntear: { start: anywhere }\n"
                                  "solver: { dt: 0.0005 }\nduration: 1\n",
                                  NULL, 0);
    run_case test = {.run = "burst"};
    check_run(scene, &test, PEL_DIVERGED);
    assert_non_null(strstr(test.error.remedy, "when the body has opened (inside: { keys: [[0, 6000], [T, 0]] })"));
    pel_scene_destroy(scene);
}

/* existing files are complete; with free space again, the run continues from its checkpoint */
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

/* A limit on the size of files acts like a full disk: the first file that reaches it is named and existing files are
   complete. */
static void test_full_disk(void **unused)
{
    (void)unused;
    enum { KIND_COUNT = 4 };
    const char *const kinds[KIND_COUNT] = {"scene.yaml", ".vtp", "series.csv", "checkpoint"};
    const char *const checkpoints[2] = {"output.checkpoint=0.1", "output.checkpoint=0"};
    int seen[KIND_COUNT] = {0}, done = 0;
    signal(SIGXFSZ, SIG_IGN);
    for (int i = 0; i < 60; i += LONG(1, 3)) {
        rlim_t size = i / 2 < 20 ? 150 * (rlim_t)(i / 2 + 1) : 3000 * (rlim_t)(i / 2 - 18);
        pel_scene *scene = load_scene(i / 2 % 3 == 0 ? small : smallest, &checkpoints[i % 2], 1);
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
        assert_non_null(strstr(test.error.remedy, "ulimit -f"));
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

/* a frame does not fit, the checkpoint does: the run continues with this frame, even if the simulation was already
   beyond it */
static void test_full_disk_at_frame(void **unused)
{
    (void)unused;
    /* with fields enough for a frame to be larger than a checkpoint */
    const char *const overrides[] = {"output.compress=false", "output.precision=double", "output.checkpoint=0",
                                     "output.fields=[displacement, velocity, force, contact_force, normal, pressure]",
                                     "contact=none"};
    pel_scene *scene = load_scene(busy, overrides, 5);
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

/* the simulation diverges and an earlier frame cannot be written: the frame is the error, as in one thread */
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
    assert_true(for_allocation_failures(run_briefly, scene, LONG(1, 3)) > 50);
    pel_scene_destroy(scene);
}

/* pins that move are a tool of the body's name, those that do not move have columns of their own */
static void test_supports(void **unused)
{
    (void)unused;
    static const char text[] =
        "version: 1\nbodies:\n"
        "  - { name: top, mesh: { shape: grid, nx: 4, ny: 4 }, membrane: { young: 1e4, thickness: 0.01 },\n"
        "      pinned: { vertices: [0, 1] } }\n"
        "  - { name: flag, mesh: { shape: grid, nx: 4, ny: 4 }, membrane: { young: 1e4, thickness: 0.01 },\n"
        "      pinned: { vertices: [0, 4] },\n"
        "      support: { center: [1, 2, 3], motion: [{ time: 0 }, { time: 0.1, position: [0, 0, 0.5],\n"
        "        rotation: { axis: [0, 0, 1], angle: 90 } }] } }\n"
        "gravity: [0, 0, -9.81]\nsolver: { method: xpbd, dt: 0.01 }\nduration: 0.2\noutput: { every_frame: 5 }\n";
    char path[256];
    pel_run_summary summary;
    pel_scene *scene = load_scene(text, NULL, 0);
    assert_int_equal(scene->sim.tool_count, 1);
    const pel_tool_def *tool = &scene->sim.tools[0];
    assert_string_equal(tool->name, "flag_support");
    assert_true(tool->shape == PEL_TOOL_SUPPORT && tool->body == 1 && tool->vertex_count == 2 &&
                tool->vertices[1] == 4);
    assert_true(tool->keys[0].position[1] == 2 && tool->keys[1].position[2] == 3.5 && tool->center[0] == 1);
    assert_true(scene->model.bodies[1].pinned_count == 0 && scene->model.bodies[0].pinned_count == 2);
    pel_run_def def = pel_run_def_default();
    def.folder = in_folder(path, "supported", "");
    assert_int_equal(pel_run(scene, &def, &summary, NULL), PEL_OK);
    pel_scene_destroy(scene);
    check_contains("supported", "series.csv", ",flag_support_force,flag_support_force_x,");
    check_contains(
        "supported", "series.csv",
        ",flag_support_held,flag_support_torque_x,flag_support_torque_y,flag_support_torque_z,flag_support_force_"
        "known,top_support_force,top_support_force_x,");
    check_contains("supported", "summary.json", "{\"name\": \"flag_support\", ");
}

/* two balls that fly into each other: the run ends when they touch, if it is told to */
static void test_stops_at_contact(void **unused)
{
    (void)unused;
    static const char balls[] =
        "version: 1\nbodies:\n"
        "  - { name: a, mesh: { shape: geodesic-sphere, frequency: 3 }, mass: { per_vertex: 1 }, velocity: [1, 0, 0] "
        "}\n"
        "  - { name: b, mesh: { shape: geodesic-sphere, frequency: 3, translate: [2.2, 0, 0] },\n"
        "      mass: { per_vertex: 1 }, velocity: [-1, 0, 0] }\n"
        "contact: { friction: 0 }\nsolver: { method: explicit, dt: 0.001 }\nduration: 0.2\n";
    static const char *const stop = "stop.self_contact=true";
    for (int is_told = 0; is_told < 2; is_told++) {
        pel_scene *scene = load_scene(balls, &stop, is_told);
        run_case test = {.run = is_told ? "touching" : "passing"};
        check_run(scene, &test, PEL_OK);
        if (is_told) {
            assert_string_equal(test.summary.stop_reason, "self_contact");
            /* 0.2 m between the spheres, up to 0.25 m between their triangles, at 2 m/s */
            assert_in_range(test.summary.steps, 95, 130);
        } else {
            assert_string_equal(test.summary.stop_reason, "duration");
            assert_int_equal(test.summary.steps, 200);
        }
        pel_scene_destroy(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_supports),
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_frame_fields),
        cmocka_unit_test(test_refinement),
        cmocka_unit_test(test_volume_of_any_body),
        cmocka_unit_test(test_ratio_of_nothing),
        cmocka_unit_test(test_far_frames),
        cmocka_unit_test(test_contact_columns),
        cmocka_unit_test(test_speed),
        cmocka_unit_test(test_stops_within_steps),
        cmocka_unit_test(test_takes_over_folder),
        cmocka_unit_test(test_folder_of_others),
        cmocka_unit_test(test_bad_folders),
        cmocka_unit_test(test_nothing_written),
        cmocka_unit_test(test_own_scene),
        cmocka_unit_test(test_own_mesh),
        cmocka_unit_test(test_divergence),
        cmocka_unit_test(test_burst),
        cmocka_unit_test(test_full_disk),
        cmocka_unit_test(test_full_disk_at_frame),
        cmocka_unit_test(test_frame_fails_before_divergence),
        cmocka_unit_test(test_at_rest),
        cmocka_unit_test(test_stops_at_contact),
        cmocka_unit_test(test_allocation_failures),
    };
    int failed = 0;
    /* two threads give the results of one */
    for (thread_count = LONG(1, 2); thread_count <= 2; thread_count++)
        failed += cmocka_run_group_tests(tests, make_folder, clear_folder);
    return failed;
}
