/* The surfaces of tools in the frames of a run: shapes, poses, and resumed runs. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "run_fixture.h"

#include "pellicle/frames.h"
#include "results/folder.h"
#include "results/tool_surface.h"

static const char tools[] =
    "version: 1\n"
    "bodies: [{ mesh: { shape: geodesic-sphere, frequency: 4 }, preset: paper-a }]\n"
    "tools:\n"
    "  - { name: ball, shape: sphere, radius: 0.3,\n"
    "      motion: [{ time: 0, position: [0, 0, 2] }, { time: 0.2, position: [0, 0, 1.1] }] }\n"
    "  - { name: bar, shape: capsule, radius: 0.1, length: 0.5,\n"
    "      motion: [{ time: 0, position: [3, 0, 0] }, { time: 0.2, position: [3, 1, 0], rotation: { axis: [1, 0, 0], "
    "angle: 90 } }] }\n"
    "  - { name: 'a <box>', shape: box, size: [0.2, 0.4, 0.6], motion: [{ time: 0, position: [-3, 0, 1] }] }\n"
    "solver: { dt: 0.01 }\nduration: 0.2\noutput: { every: 0.05, precision: double, checkpoint: 0.05 }\n";

/* distance of a point from the solid of a tool, in the tool's frame */
static double distance_of(const pel_tool_def *tool, const double p[3])
{
    if (tool->shape == PEL_TOOL_BOX) {
        double most = -HUGE_VAL;
        for (int i = 0; i < 3; i++)
            most = fmax(most, fabs(p[i]) - tool->half_extents[i]);
        return most;
    }
    double beyond = fmax(fabs(p[2]) - tool->half_length, 0);
    return sqrt(p[0] * p[0] + p[1] * p[1] + beyond * beyond) - tool->radius;
}

/* a closed surface whose vertices lie on the tool at its pose of the time */
static void check_surface(const pel_mesh *mesh, const pel_tool_def *tool, double time)
{
    double position[3], q[4];
    pel_topology *topology;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    assert_int_equal(topology->boundary_edge_count, 0);
    pel_topology_destroy(topology);
    pel_tool_def_pose(tool, time, position, q);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double arm[3], local[3];
        for (int i = 0; i < 3; i++)
            arm[i] = mesh->positions[v][i] - position[i];
        /* turned back about x, the only axis of this scene */
        double c = 1 - 2 * q[0] * q[0], s = 2 * q[0] * q[3];
        local[0] = arm[0];
        local[1] = c * arm[1] + s * arm[2];
        local[2] = c * arm[2] - s * arm[1];
        assert_near(distance_of(tool, local), 0, 1e-12);
    }
}

static void check_frames(const pel_scene *scene, const char *run)
{
    char path[256];
    pel_frames *frames;
    assert_int_equal(pel_frames_open(in_folder(path, run, ""), &frames, NULL), PEL_OK);
    assert_int_equal(frames->frame_count, 5);
    assert_int_equal(frames->tool_count, 3);
    for (int32_t i = 0; i < 3; i++) {
        assert_string_equal(frames->tool_names[i], scene->sim.tools[i].name);
        for (int32_t f = 0; f < frames->frame_count; f++) {
            pel_mesh *mesh;
            assert_int_equal(pel_frames_read_tool(frames, f, i, &mesh, NULL), PEL_OK);
            check_surface(mesh, &scene->sim.tools[i], frames->times[f]);
            pel_mesh_destroy(mesh);
        }
    }
    pel_frames_close(frames);
}

static void test_surfaces(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(tools, NULL, 0);
    run_case test = {.run = "tools"};
    check_run(scene, &test, PEL_OK);
    check_whole("tools");
    check_frames(scene, "tools");
    pel_scene_destroy(scene);
}

/* numbers stay those of the first part, and files beyond the checkpoint are removed */
static void test_resume(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(tools, NULL, 0);
    run_case test = {.run = "resumed", .stop_at = 13}, rest = {.run = "resumed", .resume = "checkpoint"};
    check_run(scene, &test, PEL_STOPPED);
    check_run(scene, &rest, PEL_OK);
    check_whole("resumed");
    check_frames(scene, "resumed");
    pel_scene_destroy(scene);
}

/* a resumed run that ends before its first frame still lists the tools of the frames that are there */
static void test_resume_without_frames(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(tools, NULL, 0);
    run_case test = {.run = "again", .stop_at = 13}, rest = {.run = "again", .resume = "checkpoint", .stop_at = 14};
    char path[256];
    pel_frames *frames;
    check_run(scene, &test, PEL_STOPPED);
    check_run(scene, &rest, PEL_STOPPED);
    assert_int_equal(pel_frames_open(in_folder(path, "again", ""), &frames, NULL), PEL_OK);
    assert_int_equal(frames->tool_count, 3);
    for (int32_t i = 0; i < 3; i++)
        assert_string_equal(frames->tool_names[i], scene->sim.tools[i].name);
    pel_frames_close(frames);
    pel_scene_destroy(scene);
}

/* a tool of the same name takes its new shape: surfaces that were read before write the files of new ones */
static void test_other_shapes(void **unused)
{
    (void)unused;
    static const char *const overrides[] = {"duration=0.2",       "tools.1.length=0.9",           "tools.1.radius=0.2",
                                            "tools.0.radius=0.4", "tools.2.size=[0.2, 0.4, 0.5]", "duration=0.2"};
    enum { COUNT = sizeof overrides / sizeof *overrides };
    pel_tool_surfaces used = {0};
    char used_folder[256], new_folder[256];
    assert_int_equal(pel_run_folder_open(in_folder(used_folder, "used", ""), NULL), PEL_OK);
    assert_int_equal(pel_run_folder_open(in_folder(new_folder, "new", ""), NULL), PEL_OK);
    for (int i = 0; i < COUNT; i++) {
        pel_scene *scene = load_scene(tools, &overrides[i], 1);
        pel_tool_surfaces new = {0};
        pel_model *model;
        pel_sim *sim;
        assert_int_equal(pel_model_create(&scene->model, &model, NULL), PEL_OK);
        scene->sim.model = model;
        assert_int_equal(pel_sim_create(&scene->sim, &sim, NULL), PEL_OK);
        assert_int_equal(pel_tool_surfaces_read(&used, sim, NULL), PEL_OK);
        assert_int_equal(pel_tool_surfaces_read(&new, sim, NULL), PEL_OK);
        assert_int_equal(pel_tool_surfaces_write(&used, &scene->output, used_folder, i, NULL), PEL_OK);
        assert_int_equal(pel_tool_surfaces_write(&new, &scene->output, new_folder, i, NULL), PEL_OK);
        for (int32_t tool = 0; tool < 3; tool++) {
            char name[PEL_RUN_FILE_SIZE];
            check_same_file("used", "new", pel_run_tool_path(name, NULL, i, tool));
        }
        pel_tool_surfaces_destroy(&new);
        pel_sim_destroy(sim);
        pel_model_destroy(model);
        pel_scene_destroy(scene);
    }
    pel_tool_surfaces_destroy(&used);
}

static pel_status create_surface(const void *context, pel_error *error)
{
    pel_mesh *mesh;
    pel_status status = pel_tool_def_surface(context, &mesh, error);
    assert_true((mesh == NULL) == (status != PEL_OK));
    pel_mesh_destroy(mesh);
    return status;
}

/* the surface of a def, which a picture shows; a support has none */
static void test_surface_of_a_def(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene(tools, NULL, 0);
    for (int32_t i = 0; i < 3; i++) {
        pel_tool_def def = scene->sim.tools[i];
        pel_mesh *mesh;
        assert_int_equal(pel_tool_def_surface(&def, &mesh, NULL), PEL_OK);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            assert_near(distance_of(&def, mesh->positions[v]), 0, 1e-12);
        assert_true(for_every_allocation_failure(create_surface, &def) > 3);
        def.shape = PEL_TOOL_MESH;
        assert_int_equal(create_surface(&def, NULL), PEL_BAD_ARGUMENT);
        def.mesh = mesh;
        assert_int_equal(create_surface(&def, NULL), PEL_OK);
        def.shape = PEL_TOOL_SUPPORT;
        assert_int_equal(create_surface(&def, NULL), PEL_BAD_ARGUMENT);
        pel_mesh_destroy(mesh);
    }
    assert_int_equal(create_surface(NULL, NULL), PEL_BAD_ARGUMENT);
    pel_scene_destroy(scene);
}

int main(void)
{
    thread_count = 2;
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_surfaces), cmocka_unit_test(test_resume),
                                       cmocka_unit_test(test_resume_without_frames),
                                       cmocka_unit_test(test_other_shapes), cmocka_unit_test(test_surface_of_a_def)};
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
