/* Cuts of scenes: paths of points and vertices, bodies by name, errors with their places; runs, frames and exports of
   surfaces that open. */
#include "check.h"

#include "failing_malloc.h"
#include "pellicle/export.h"
#include "pellicle/frames.h"
#include "pellicle/run.h"
#include "pellicle/scene.h"
#include "pellicle/sim.h"
#include "results/opened_mesh.h"

#include <stdlib.h>
#include <unistd.h>

#define SHEET                                                                                                          \
    "version: 1\nduration: 0.1\noutput: {every: 0.02}\nsolver: {method: xpbd, dt: 0.01}\n"                             \
    "gravity: [0, -9.81, 0]\nbodies:\n"                                                                                \
    "  - name: sheet\n    mesh: {shape: grid, nx: 10, ny: 10, size_x: 1, size_y: 1}\n"                                 \
    "    membrane: {preset: silicone, thickness: 0.001}\n"                                                             \
    "    pinned: {box: {min: [-1, 0.49, -1], max: [1, 1, 1]}}\n"
#define BALL "  - name: ball\n    mesh: {shape: geodesic-sphere, frequency: 3}\n    springs: {stiffness: 3}\n"

static pel_status parse(const char *text, pel_scene **scene, pel_error *error)
{
    return pel_scene_parse("test.yaml", text, strlen(text), NULL, 0, NULL, scene, error);
}

static pel_scene *load(const char *text)
{
    pel_scene *scene;
    pel_error error;
    char message[1000];
    if (parse(text, &scene, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, message, sizeof message));
    return scene;
}

static void test_paths(void **unused)
{
    (void)unused;
    pel_scene *scene = load(SHEET BALL "cuts:\n"
                                       "  - {body: sheet, path: [60, 61, 62, 63]}\n"
                                       "  - {body: ball, at: 0.02, path: [[1, 0, 0], [0, 0, 1]]}\n"
                                       "  - {body: sheet, at: 0.03, path: [[-0.2, -0.23, 0], [0.2, -0.31, 0]]}\n");
    const pel_cut_def *cuts = scene->sim.cuts;
    assert_int_equal(scene->sim.cut_count, 3);
    assert_int_equal(cuts[0].vertex_count, 4);
    assert_true(cuts[0].vertices[3] == 63 && cuts[0].body == 0 && cuts[1].body == 1 && cuts[1].at == 0.02);
    const pel_mesh *mesh = scene->model.bodies[0].mesh;
    const double *first = mesh->positions[cuts[2].vertices[0]];
    const double *last = mesh->positions[cuts[2].vertices[cuts[2].vertex_count - 1]];
    assert_near(first[0], -0.2, 1e-12);
    assert_near(first[1], -0.23, 1e-12);
    assert_near(last[0], 0.2, 1e-12);
    assert_near(last[1], -0.31, 1e-12);
    pel_scene_destroy(scene);
}

/* what a hook holds at most is of the tool itself: it has no grasp */
static void test_hook(void **unused)
{
    (void)unused;
    static const char hook[] = "tools:\n  - {name: hook, shape: hook, edge: [[0, 0, -0.1], [0, 0, 0.1]], %s"
                               "motion: [{position: [0, -0.6, 0]}, {time: 0.1, position: [0, -0.5, 0]}]}\n";
    static const char *const forces[] = {"", "max_force: 2.5, ", "max_force: auto, "};
    for (int i = 0; i < 3; i++) {
        char tool[400], text[1200];
        pel_scene *scene;
        pel_error error;
        snprintf(tool, sizeof tool, hook, forces[i]);
        snprintf(text, sizeof text, "%s%s", SHEET, tool);
        assert_int_equal(parse(text, &scene, &error), i < 2 ? PEL_OK : PEL_BAD_SCENE);
        if (i == 2)
            continue;
        assert_near(scene->sim.tools[0].grasp_max_force, i * 2.5, 0);
        assert_int_equal(scene->sim.tools[0].shape, PEL_TOOL_HOOK);
        pel_scene_destroy(scene);
    }
}

static void test_errors(void **unused)
{
    (void)unused;
    static const struct {
        const char *text, *words;
        int line;
    } faults[] = {
        {SHEET "cuts:\n  - {path: [[2, 0, 0], [0, 0, 0]]}\n", "begins off the surface", 12},
        {SHEET "cuts:\n  - {path: [[0, 0, 0], [0, 1, 0]]}\n", "leaves the surface", 12},
        {SHEET "cuts:\n  - {path: [[0, 0, 0], 12]}\n", "points and vertices", 12},
        {SHEET "cuts:\n  - {path: [12, [0, 0, 0]]}\n", "points and vertices", 12},
        {SHEET "cuts:\n  - {path: [[0, 0, 0], [0, 0, 0]]}\n", "are the same", 12},
        {SHEET "cuts:\n  - {path: [12, 121]}\n", "no vertex 121", 12},
        {SHEET "cuts:\n  - {path: [12]}\n", "1 element", 12},
        {SHEET "cuts:\n  - {at: 1}\n", "path", 12},
        {SHEET "cuts:\n  - {at: 1, path: [60, 61, 62]}\n  - {at: 0.5, path: [50, 51, 52]}\n", "earlier", 13},
        {SHEET BALL "cuts:\n  - {path: [60, 61, 62]}\n", "which body", 15},
        {SHEET BALL "    fluid: {}\ncuts:\n  - {body: ball, path: [[1, 0, 0], [0, 0, 1]]}\n", "a liquid fills", 16},
        {SHEET "cuts:\n  - {body: shet, path: [60, 61, 62]}\n", "shet", 12},
    };
    for (size_t f = 0; f < sizeof faults / sizeof *faults; f++) {
        pel_scene *scene;
        pel_error error = {0};
        assert_int_equal(parse(faults[f].text, &scene, &error), PEL_BAD_SCENE);
        if (strstr(error.what, faults[f].words) == NULL || error.line != faults[f].line || error.remedy[0] == '\0')
            fail_msg("%d: line %d: %s", (int)f, (int)error.line, error.what);
    }
}

/* ---- runs ---- */

static char folder[64];

static void run_scene(const char *text, pel_run_summary *summary, pel_status expected, const char *words)
{
    pel_scene *scene = load(text);
    pel_run_def def = {0};
    pel_error error = {0};
    snprintf(folder, sizeof folder, "/tmp/pel_cuts_XXXXXX");
    assert_non_null(mkdtemp(folder));
    def = pel_run_def_default();
    def.folder = folder;
    pel_status status = pel_run(scene, &def, summary, &error);
    if (status != expected || strstr(error.what, words) == NULL)
        fail_msg("%d: %s", (int)status, error.what);
    pel_scene_destroy(scene);
}

static void remove_folder(void)
{
    char command[100];
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

static pel_status open_frames(const void *context, pel_error *error)
{
    pel_opened_mesh *opened;
    pel_mesh *mesh = NULL;
    pel_status status = pel_opened_mesh_create(context, &opened, error);
    if (status == PEL_OK)
        status = pel_opened_mesh_read(opened, 0, &mesh, error);
    assert_true((mesh == NULL) == (status != PEL_OK));
    pel_mesh_destroy(mesh);
    pel_opened_mesh_destroy(opened);
    return status;
}

/* frames have the surface that they had; exports have one of all */
static void test_frames(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    run_scene(SHEET BALL "cuts:\n  - {body: sheet, at: 0.05, path: [[-0.5, 0, 0], [0.1, 0.02, 0]]}\n", &summary, PEL_OK,
              "");
    pel_frames *frames;
    pel_frames_outline outline;
    pel_opened_mesh *opened;
    assert_int_equal(pel_frames_open(folder, &frames, NULL), PEL_OK);
    assert_int_equal(pel_frames_check(frames, &outline, NULL), PEL_OK);
    assert_int_equal(outline.changed_frame, 3);
    assert_int_equal(pel_opened_mesh_create(frames, &opened, NULL), PEL_OK);
    assert_int_equal(opened->vertex_count, summary.vertices_final);
    assert_true(opened->vertex_count > outline.vertex_count);
    for (int32_t f = 0; f < frames->frame_count; f++) {
        pel_mesh *own, *common;
        assert_int_equal(pel_frames_read(frames, f, &own, NULL), PEL_OK);
        assert_int_equal(pel_opened_mesh_read(opened, f, &common, NULL), PEL_OK);
        assert_int_equal(common->field_count, own->field_count);
        for (int32_t t = 0; t < own->triangle_count; t++)
            for (int c = 0; c < 3; c++) {
                const double *a = own->positions[own->triangles[t][c]], *b = common->positions[common->triangles[t][c]];
                assert_true(a[0] == b[0] && a[1] == b[1] && a[2] == b[2]);
                for (int32_t i = 0; i < own->field_count; i++) {
                    size_t size = (size_t)own->fields[i].component_count;
                    assert_memory_equal(own->fields[i].values + size * (size_t)own->triangles[t][c],
                                        common->fields[i].values + size * (size_t)common->triangles[t][c],
                                        size * sizeof(double));
                }
            }
        pel_mesh_destroy(own);
        pel_mesh_destroy(common);
    }
    assert_true(for_every_allocation_failure(open_frames, frames) > 10);
    pel_opened_mesh_destroy(opened);
    pel_frames_close(frames);
    remove_folder();
}

static void test_faults_at_run_time(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    run_scene(SHEET "cuts:\n  - {at: 0.05, path: [60, 61]}\n", &summary, PEL_BAD_ARGUMENT, "cut 1 at 0.05 s");
    remove_folder();
    run_scene(SHEET "    refine: {levels: 1, everywhere: true}\ncuts:\n  - {at: 0.05, path: [60, 61, 62]}\n", &summary,
              PEL_BAD_ARGUMENT, "refines");
    remove_folder();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hook),
        cmocka_unit_test(test_paths),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_frames),
        cmocka_unit_test(test_faults_at_run_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
