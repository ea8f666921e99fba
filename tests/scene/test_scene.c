/* Whole scenes: defs, defaults, overrides, the resolved text, allocation failures. */
#define _XOPEN_SOURCE 700 /* mkdtemp */
#include "check.h"
#include "failing_malloc.h"

#include "base/memory.h"
#include "math/vec3.h"
#include "pellicle/scene.h"
#include "pellicle/shape.h"
#include "scene/portable.h"
#include "source_dir.h"

#include <dirent.h>
#include <stdlib.h>
#include <unistd.h>

#define BALL "version: 1\nduration: 2\nbodies:\n  - mesh: {shape: geodesic-sphere}\n"

static pel_scene *load(const char *text, const char *const *overrides, int32_t override_count)
{
    pel_scene *scene;
    pel_error error;
    char message[1000];
    if (pel_scene_parse("test.yaml", text, strlen(text), overrides, override_count, NULL, &scene, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, message, sizeof message));
    return scene;
}

static void test_defaults(void **unused)
{
    (void)unused;
    pel_scene *scene = load(BALL, NULL, 0);
    pel_body_def expected = pel_body_def_default();
    pel_sim_def expected_sim = pel_sim_def_default();
    const pel_body_def *body = scene->model.bodies;
    assert_string_equal(scene->path, "test.yaml");
    assert_string_equal(scene->title, "");
    assert_int_equal(scene->model.body_count, 1);
    assert_string_equal(body->name, "body1");
    assert_int_equal(body->mesh->vertex_count, 252);
    assert_int_equal(body->mass_kind, PEL_MASS_DENSITY);
    assert_true(body->mass == 1000);
    assert_true(body->spring_stiffness.value == 5000 && body->spring_thickness > 0);
    assert_true(body->volumetric_stiffness.value == 0 && body->volumetric_damping.value == 0);
    assert_int_equal(body->reference_count, expected.reference_count);
    assert_int_equal(body->volumetric_by_area, expected.volumetric_by_area);
    assert_int_equal(body->pinned_count, 0);
    assert_int_equal(scene->sim.load_count, 0);
    assert_int_equal(scene->sim.tool_count, 0);
    assert_int_equal(scene->sim.solver.method, PEL_METHOD_XPBD);
    assert_true(scene->sim.solver.dt == expected_sim.solver.dt);
    assert_true(scene->sim.solver.alpha == expected_sim.solver.alpha);
    assert_int_equal(scene->sim.solver.keep_velocity, expected_sim.solver.keep_velocity);
    assert_int_equal(scene->sim.solver.symplectic, expected_sim.solver.symplectic);
    assert_int_equal(scene->sim.thread_count, expected_sim.thread_count);
    assert_true(scene->duration == 2 && scene->rest_speed == 0);
    assert_true(scene->output.every == 0.1 && scene->output.checkpoint == 0);
    assert_int_equal(scene->output.field_count, 2);
    assert_string_equal(scene->output.fields[0], "displacement");
    assert_true(!scene->output.compress && !scene->output.float64);
    pel_scene_destroy(scene);
    /* paper A's numbers are those of the library */
    scene = load(BALL "    preset: paper-a\n    volumetric: {}\n", NULL, 0);
    body = scene->model.bodies;
    assert_int_equal(scene->sim.solver.method, expected_sim.solver.method);
    assert_int_equal(body->mass_kind, expected.mass_kind);
    assert_true(body->mass == expected.mass);
    assert_true(body->spring_thickness == 0 && body->volumetric_depth == 0);
    assert_true(body->spring_stiffness.value == expected.spring_stiffness.value);
    assert_true(body->spring_damping.value == expected.spring_damping.value);
    assert_true(body->volumetric_stiffness.value == expected.volumetric_stiffness.value);
    assert_true(body->volumetric_damping.value == expected.volumetric_damping.value);
    pel_scene_destroy(scene);
    pel_scene_destroy(NULL);
}

static const char everything[] =
    "version: 1\n"
    "title: 'all keys: every one'\n"
    "bodies:\n"
    "  - name: shell\n"
    "    mesh: { shape: lens-capsule, frequency: 4, scale: [2, 2, 2], rotate: { axis: [0, 0, 5], angle: 90 },\n"
    "            translate: [1, 2, 3] }\n"
    "    mass: { density: 1100, thickness: { field: thickness, map: [1e-3, 2e-3] } }\n"
    "    springs: { stiffness: { keys: [[0, 1], [2, .5]] }, damping: 0x10 }\n"
    "    volumetric: { stiffness: { field: thickness }, damping: 0 }\n"
    "    scale_with_area: true\n"
    "    reference_count: 500\n"
    "    pinned: { nearest: [1, 2, -100] }\n"
    "  - name: plate\n"
    "    mesh: { shape: grid, nx: 2, ny: 3, diagonals: union-jack }\n"
    "    mass: { total: 5 }\n"
    "    pinned: all\n"
    "gravity: [0, 0, -9.81]\n"
    "loads:\n"
    "  - { body: plate, force: [1, 2, 3], at: { vertices: [3, 1] }, per: vertex, from: 0.5, until: 0.75,\n"
    "      keys: [[0, 0], [1, 1]] }\n"
    "  - { name: push, body: shell, force: [0, 0, -1], at: { sphere: { center: [1, 2, 3], radius: 100 } } }\n"
    "  - { name: wind, body: plate, force: [0, 1, 0] }\n"
    "tools:\n"
    "  - { name: rod, shape: capsule, radius: 0.5, length: 3, body: plate, press: false,\n"
    "      grasp: { from: 1, until: 2, reach: 0.1 },\n"
    "      motion: [{ position: [0, 0, 9] },\n"
    "               { time: 1, position: [0, 0, 8], rotation: { axis: [0, 2, 0], angle: 450 } }] }\n"
    "  - { shape: box, size: [2, 4, 6], motion: [{ position: [0, 9, 0] }] }\n"
    "solver: { method: explicit, dt: 0.001, alpha: 30, velocity: keep, integrator: forward, threads: 3 }\n"
    "duration: 4\n"
    "stop: { at_rest: 1e-6 }\n"
    "output: { every_frame: 7, fields: [force, thickness], compress: true, precision: double, checkpoint: 2 }\n";

static void check_first_body(const pel_body_def *body)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_LENS_CAPSULE);
    def.frequency = 4;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    assert_int_equal(body->mesh->vertex_count, mesh->vertex_count);
    const double *thickness = pel_mesh_field(mesh, "thickness")->values;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        /* twice the size, a quarter turn about z, then moved */
        assert_near(body->mesh->positions[v][0], 1 - 2 * mesh->positions[v][1], 1e-14);
        assert_near(body->mesh->positions[v][1], 2 + 2 * mesh->positions[v][0], 1e-14);
        assert_near(body->mesh->positions[v][2], 3 + 2 * mesh->positions[v][2], 1e-14);
        assert_near(body->thickness.field[v], 1e-3 + thickness[v] * 1e-3, 1e-18);
        assert_true(body->volumetric_stiffness.field[v] == thickness[v]);
    }
    pel_mesh_destroy(mesh);
    assert_string_equal(body->name, "shell");
    assert_int_equal(body->mass_kind, PEL_MASS_DENSITY);
    assert_true(body->mass == 1100);
    assert_int_equal(body->spring_stiffness.key_count, 2);
    assert_true(body->spring_stiffness.keys[1].time == 2 && body->spring_stiffness.keys[1].value == 0.5);
    assert_true(body->spring_damping.value == 16);
    assert_true(body->volumetric_by_area);
    assert_int_equal(body->reference_count, 500);
    /* the back pole is the last of the vertices below */
    assert_int_equal(body->pinned_count, 1);
    for (int32_t v = 0; v < body->mesh->vertex_count; v++)
        assert_true(body->mesh->positions[v][2] >= body->mesh->positions[body->pinned[0]][2]);
}

static void check_loads(const pel_load_def *loads)
{
    assert_string_equal(loads[0].name, "load1");
    assert_int_equal(loads[0].body, 1);
    assert_int_equal(loads[0].kind, PEL_LOAD_PER_VERTEX);
    assert_int_equal(loads[0].vertex_count, 2);
    assert_int_equal(loads[0].vertices[0], 1);
    assert_int_equal(loads[0].vertices[1], 3);
    assert_null(loads[0].weights);
    assert_true(loads[0].from == 0.5 && loads[0].until == 0.75 && loads[0].force[2] == 3);
    assert_int_equal(loads[0].key_count, 2);
    assert_int_equal(loads[1].body, 0);
    assert_int_equal(loads[1].kind, PEL_LOAD_TOTAL);
    assert_int_equal(loads[1].vertex_count, 162);
    assert_true(isinf(loads[1].until));
    assert_null(loads[2].vertices);
}

static void check_tools(const pel_tool_def *tools)
{
    assert_string_equal(tools[0].name, "rod");
    assert_int_equal(tools[0].shape, PEL_TOOL_CAPSULE);
    assert_true(tools[0].radius == 0.5 && tools[0].half_length == 1.5);
    assert_int_equal(tools[0].body, 1);
    assert_true(!tools[0].press && tools[0].grasp);
    assert_true(tools[0].grasp_from == 1 && tools[0].grasp_until == 2 && tools[0].reach == 0.1);
    assert_int_equal(tools[0].key_count, 2);
    assert_true(tools[0].keys[0].time == 0 && tools[0].keys[0].rotation[3] == 1);
    assert_near(tools[0].keys[1].rotation_vector[1], 450 * 3.14159265358979323846 / 180, 1e-15);
    assert_true(tools[0].keys[1].rotation[3] == 1);
    assert_string_equal(tools[1].name, "tool2");
    assert_int_equal(tools[1].shape, PEL_TOOL_BOX);
    assert_true(tools[1].half_extents[0] == 1 && tools[1].half_extents[2] == 3);
    assert_int_equal(tools[1].body, -1);
    assert_true(tools[1].press && !tools[1].grasp);
}

static void test_everything(void **unused)
{
    (void)unused;
    pel_scene *scene = load(everything, NULL, 0);
    assert_string_equal(scene->title, "all keys: every one");
    check_first_body(&scene->model.bodies[0]);
    assert_int_equal(scene->model.bodies[1].mass_kind, PEL_MASS_TOTAL);
    assert_int_equal(scene->model.bodies[1].mesh->vertex_count, 12);
    assert_int_equal(scene->model.bodies[1].pinned_count, 12);
    assert_true(scene->model.gravity[2] == -9.81);
    check_loads(scene->sim.loads);
    check_tools(scene->sim.tools);
    assert_int_equal(scene->sim.solver.method, PEL_METHOD_EXPLICIT);
    assert_true(scene->sim.solver.dt == 0.001 && scene->sim.solver.alpha == 30);
    assert_true(scene->sim.solver.keep_velocity && !scene->sim.solver.symplectic);
    assert_int_equal(scene->sim.thread_count, 3);
    assert_true(scene->rest_speed == 1e-6);
    assert_true(scene->output.every == 0 && scene->output.checkpoint == 2);
    assert_int_equal(scene->output.every_frame, 7);
    assert_true(scene->output.compress && scene->output.float64);
    pel_scene_destroy(scene);
}

static void test_falloff(void **unused)
{
    (void)unused;
    pel_scene *scene =
        load(BALL "loads: [{force: [0, 0, 1], at: {sphere: {center: [0, 0, 1], radius: 0.5}, falloff: 1}}]\n", NULL, 0);
    const pel_load_def *load_def = scene->sim.loads;
    const pel_mesh *mesh = scene->model.bodies->mesh;
    assert_true(load_def->vertex_count > 10 && load_def->vertex_count < mesh->vertex_count);
    for (int32_t i = 0; i < load_def->vertex_count; i++) {
        const double *x = mesh->positions[load_def->vertices[i]];
        double s = sqrt(x[0] * x[0] + x[1] * x[1] + (x[2] - 1) * (x[2] - 1)) - 0.5;
        assert_near(load_def->weights[i], s <= 0 ? 1 : 1 - s * s * (3 - 2 * s), 1e-14);
        assert_true(load_def->weights[i] > 0);
    }
    pel_scene_destroy(scene);
}

/* the model and the sim accept what the reader makes */
static void test_scene_runs(void **unused)
{
    (void)unused;
    pel_scene *scene = load(BALL "loads: [{force: [0, 0, -1], at: {nearest: [0, 0, 1]}}]\n", NULL, 0);
    pel_model *model;
    pel_sim *sim;
    pel_sim_def def = scene->sim;
    assert_int_equal(pel_model_create(&scene->model, &model, NULL), PEL_OK);
    def.model = model;
    assert_int_equal(pel_sim_create(&def, &sim, NULL), PEL_OK);
    assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
}

/* axes are orthonormal and right-handed, and the first one is along `x` */
static void check_axes(const double axes[3][3], double x, double y, double z)
{
    const double along[3] = {x, y, z};
    double third[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            assert_near(pel_vec3_dot(axes[i], axes[k]), i == k, 1e-15);
    pel_vec3_cross(axes[0], axes[1], third);
    assert_near(pel_vec3_distance(third, axes[2]), 0, 1e-15);
    assert_near(pel_vec3_dot(axes[0], along), pel_vec3_length(along), 1e-15 * pel_vec3_length(along));
}

static void test_supports(void **unused)
{
    (void)unused;
    pel_scene *scene =
        load(BALL "    supports:\n"
                  "      - {at: {nearest: [0, 0, 1]}, symmetry: x}\n"
                  "      - {name: mirror, at: all, symmetry: y}\n"
                  "      - {at: all, symmetry: z}\n"
                  "      - {at: all, symmetry: [1, 2, -2]}\n"
                  "      - {at: all, symmetry: [0, -5, 1]}\n"
                  "  - mesh: {shape: geodesic-sphere}\n"
                  "    name: low\n"
                  "    supports:\n"
                  "      - {at: all, fix: [x, z], frame: {x: [3, 4, 0], y: [1, 0, 0]}, rotation: fixed,\n"
                  "         displacement: [0.1, 0, 0.2], keys: [[0, 0], [1, 1], [2, 0.5]]}\n"
                  "      - {at: all, fix: [y], frame: {x: [0, 0, 2]}, stiffness: 7}\n"
                  "      - {at: all, fix: [], rotation: fixed}\n"
                  "      - {at: all, foundation: 9}\n",
             NULL, 0);
    const pel_support_def *s = scene->sim.supports;
    assert_int_equal(scene->sim.support_count, 9);
    for (int i = 0; i < 9; i++)
        assert_int_equal(s[i].body, i >= 5);
    assert_string_equal(s[0].name, "body1_support1");
    assert_string_equal(s[1].name, "body1_mirror");
    assert_string_equal(s[5].name, "low_support1");
    assert_true(s[0].vertex_count == 1 && s[2].vertex_count == 252);
    for (int32_t v = 0; v < 252; v++)
        assert_int_equal(s[2].vertices[v], v);
    for (int i = 0; i < 5; i++)
        assert_true(s[i].fix[0] && !s[i].fix[1] && !s[i].fix[2] && s[i].fix_rotation);
    check_axes(s[0].axes, 1, 0, 0);
    check_axes(s[1].axes, 0, 1, 0);
    check_axes(s[2].axes, 0, 0, 1);
    check_axes(s[3].axes, 1, 2, -2);
    check_axes(s[4].axes, 0, -5, 1);
    /* the second axis is that of the smallest component, less its part along the first */
    assert_true(s[3].axes[1][0] > 0.9 && s[4].axes[1][0] == 1);
    check_axes(s[5].axes, 3, 4, 0);
    assert_near(s[5].axes[1][0], 0.8, 1e-15);
    assert_true(s[5].fix[0] && !s[5].fix[1] && s[5].fix[2] && s[5].fix_rotation);
    assert_true(s[5].displacement[0] == 0.1 && s[5].displacement[1] == 0 && s[5].displacement[2] == 0.2);
    assert_true(s[5].key_count == 3 && s[5].keys[2].time == 2 && s[5].keys[2].value == 0.5);
    assert_true(s[5].stiffness == 0 && s[5].foundation == 0);
    check_axes(s[6].axes, 0, 0, 2);
    assert_true(!s[6].fix[0] && s[6].fix[1] && !s[6].fix[2] && !s[6].fix_rotation && s[6].stiffness == 7);
    assert_true(!s[7].fix[0] && !s[7].fix[1] && !s[7].fix[2] && s[7].fix_rotation);
    assert_true(s[8].fix[0] && s[8].fix[1] && s[8].fix[2] && s[8].foundation == 9 && s[8].stiffness == 0);
    check_axes(s[8].axes, 1, 0, 0);
    pel_scene_destroy(scene);
}

static void test_session(void **unused)
{
    (void)unused;
    pel_scene *scene = load(BALL "session:\n  - 0 grab 3 0.5\n  - 7 release\n  - '7  x'\n", NULL, 0);
    const pel_scene_command *commands = scene->session;
    assert_int_equal(scene->session_count, 3);
    assert_true(commands[0].step == 0 && commands[1].step == 7 && commands[2].step == 7);
    assert_string_equal(commands[0].line, "grab 3 0.5");
    assert_string_equal(commands[1].line, "release");
    assert_string_equal(commands[2].line, " x");
    assert_true(commands[1].at_line == 7 && commands[1].at_column == 5);
    pel_scene_destroy(scene);
    scene = load(BALL, NULL, 0);
    assert_int_equal(scene->session_count, 0);
    pel_scene_destroy(scene);
}

static void test_overrides(void **unused)
{
    (void)unused;
    const char *const overrides[] = {
        "bodies.0.name=ball",
        "bodies.ball.springs.stiffness=5",
        "bodies.ball.volumetric.stiffness.keys=[[0, 1], [1, 2]]",
        "bodies.ball.mesh.frequency=2",
        "loads.0.force=[0, 0, 7]",
        "loads.0.at.nearest=[0, 0, 1]",
        "loads.1={force: [1, 0, 0]}",
        "loads.load.force.1=4",
        "loads.0.name=load",
        "output.every_frame=3",
        "output.fields.0=energy",
        "title=ball # 1: the first",
        "solver.alpha=20",
        "solver.alpha=",
        "stop=null",
    };
    int32_t count = sizeof overrides / sizeof overrides[0];
    /* an element can be named once it has a name */
    const char *const named[] = {"loads.0.force=[0, 0, 7]", "loads.0.name=load", "loads.load.force.1=4"};
    pel_scene *scene = load(BALL "stop: {at_rest: 1}\n", named, 3);
    assert_true(scene->sim.loads[0].force[1] == 4 && scene->sim.loads[0].force[2] == 7);
    assert_true(scene->rest_speed == 1);
    pel_scene_destroy(scene);
    pel_error error;
    assert_int_equal(pel_scene_parse("t", BALL, strlen(BALL), overrides, count, NULL, &scene, &error), PEL_BAD_SCENE);
    assert_string_equal(error.file, "--set loads.load.force.1=4");
    const char *right[sizeof overrides / sizeof overrides[0]];
    memcpy(right, overrides, sizeof overrides);
    right[7] = "loads.1.force.1=4";
    scene = load(BALL "stop: {at_rest: 1}\noutput: {every: 1, fields: [force, velocity]}\n", right, count);
    const pel_body_def *body = scene->model.bodies;
    assert_string_equal(body->name, "ball");
    assert_true(body->spring_stiffness.value == 5);
    assert_int_equal(body->volumetric_stiffness.key_count, 2);
    assert_int_equal(body->mesh->vertex_count, 42);
    assert_int_equal(scene->sim.load_count, 2);
    assert_int_equal(scene->sim.loads[0].vertex_count, 1);
    assert_true(scene->sim.loads[1].force[0] == 1 && scene->sim.loads[1].force[1] == 4);
    assert_true(scene->output.every == 0 && scene->output.every_frame == 3);
    assert_string_equal(scene->output.fields[0], "energy");
    assert_string_equal(scene->output.fields[1], "velocity");
    assert_string_equal(scene->title, "ball # 1: the first");
    assert_true(scene->sim.solver.alpha == 0 && scene->rest_speed == 0);
    pel_scene_destroy(scene);
}

/* an alternative takes the place of another with all that belongs to it */
static void test_override_replaces_alternative(void **unused)
{
    (void)unused;
    const char *const density[] = {"bodies.0.mass.density=900", "bodies.0.mass.thickness=0.01"};
    pel_scene *scene = load(BALL "    mass: {total: 3}\n", density, 2);
    assert_int_equal(scene->model.bodies->mass_kind, PEL_MASS_DENSITY);
    pel_scene_destroy(scene);
    const char *const total[] = {"bodies.0.mass.total=3"};
    scene = load(BALL "    mass: {density: 3, thickness: 1}\n", total, 1);
    assert_int_equal(scene->model.bodies->mass_kind, PEL_MASS_TOTAL);
    pel_scene_destroy(scene);
}

static void test_aliases(void **unused)
{
    (void)unused;
    pel_scene *scene = load("version: 1\nduration: 1\nbodies:\n"
                            "  - {name: a, mesh: &ball {shape: geodesic-sphere, frequency: &f 3}}\n"
                            "  - {name: b, mesh: *ball}\n"
                            "  - {name: c, mesh: {shape: lens-capsule, frequency: *f}}\n",
                            (const char *const[]){"bodies.a.mesh.frequency=1"}, 1);
    assert_int_equal(scene->model.bodies[0].mesh->vertex_count, 12);
    assert_int_equal(scene->model.bodies[1].mesh->vertex_count, 92);
    assert_int_equal(scene->model.bodies[2].mesh->vertex_count, 92);
    pel_scene_destroy(scene);
}

static void test_json(void **unused)
{
    (void)unused;
    pel_scene *scene = load("{\n\t\"version\": 1,\n\t\"duration\": 1.5e0, \"bodies\": [\n\t\t{\"mesh\": {\"shape\": "
                            "\"torus\"},\n\t\t \"name\": \"\\u00e4\\\"\"}]\n}\n",
                            NULL, 0);
    assert_string_equal(scene->model.bodies[0].name, "\xc3\xa4\"");
    assert_true(scene->duration == 1.5);
    pel_scene_destroy(scene);
}

/* a resolved scene gives the same text again */
static void check_fixed_point(const char *path, const char *text)
{
    pel_scene *scene = load(text, NULL, 0);
    pel_scene *again = load(pel_scene_text(scene), NULL, 0);
    if (strcmp(pel_scene_text(scene), pel_scene_text(again)) != 0)
        fail_msg("%s: resolved\n%s\nagain\n%s", path, pel_scene_text(scene), pel_scene_text(again));
    assert_non_null(strstr(pel_scene_text(scene), "pellicle " PEL_VERSION));
    assert_int_equal(scene->model.body_count, again->model.body_count);
    assert_int_equal(scene->sim.load_count, again->sim.load_count);
    pel_scene_destroy(scene);
    pel_scene_destroy(again);
}

static void test_fixed_point(void **unused)
{
    (void)unused;
    check_fixed_point("everything", everything);
    check_fixed_point("ball", BALL "loads: [{force: [1, 0, 0]}]\n");
    check_fixed_point("rigid", "version: 1\nduration: 1\nbodies: [{mesh: {shape: geodesic-sphere}, rigid: {}}]\n");
    check_fixed_point("names", "version: 1\nduration: 1\nbodies:\n"
                               "  - {name: 'true', mesh: {shape: grid}}\n  - {name: 12, mesh: {shape: grid}}\n"
                               "  - {name: 'a: #b\\', mesh: {shape: grid}}\n  - {name: \"\\x01\\t\\n\\\"\", mesh: "
                               "{shape: grid}}\n  - {name: null, mesh: {shape: grid}}\n  - {name: 'null', mesh: "
                               "{shape: grid}}\n  - {name: \"\\u2028\\u0085\\ufeff\", mesh: {shape: grid}}\n");
}

/* any text is the same in the resolved scene: words with a meaning, numbers, signs, any letters */
static void test_texts(void **unused)
{
    (void)unused;
    static const char *const texts[] = {"true",     "No",          "NULL",         "y",
                                        "on",       "offset",      "Yes",          "nullify",
                                        "12",       "1e5",         "0x1F",         ".5",
                                        "~",        "-",           "- a",          "a: b",
                                        "a #b",     "#",           "[a",           "{a}",
                                        "&a",       "*a",          "!a",           "|",
                                        ">",        "%a",          "@a",           "`a",
                                        "'a'",      "\"a\"",       "a\\b",         "\\",
                                        " a",       "a ",          "a\tb",         "a\nb",
                                        "\n",       "\x7f",        "\x01",         "?",
                                        "? a",      ":",           "a:",           ",",
                                        "/a/b",     "...",         "---",          "<<",
                                        "=",        "caf\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\x98\x80",
                                        "\xc2\x85", "\xe2\x80\xa8"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        char override[64];
        snprintf(override, sizeof override, "title=%s", texts[i]);
        pel_scene *scene = load(BALL, (const char *const[]){override}, 1);
        assert_string_equal(scene->title, texts[i]);
        pel_scene *again = load(pel_scene_text(scene), NULL, 0);
        assert_string_equal(again->title, texts[i]);
        assert_string_equal(pel_scene_text(again), pel_scene_text(scene));
        /* only texts that every YAML reader accepts as text are written without quotes */
        snprintf(override, sizeof override, "\ntitle: %s\n", texts[i]);
        bool plain = strstr(pel_scene_text(scene), override) != NULL;
        assert_int_equal(plain, strcmp(texts[i], "offset") == 0 || strcmp(texts[i], "nullify") == 0 ||
                                    strcmp(texts[i], "/a/b") == 0);
        pel_scene_destroy(again);
        pel_scene_destroy(scene);
    }
}

static void test_shipped_scenes(void **unused)
{
    (void)unused;
    DIR *folder = opendir(PEL_SOURCE_DIR "/scenes");
    assert_non_null(folder);
    int count = 0;
    for (const struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        char path[1000], message[1000];
        if (strstr(entry->d_name, ".yaml") == NULL)
            continue;
        snprintf(path, sizeof path, PEL_SOURCE_DIR "/scenes/%s", entry->d_name);
        pel_scene *scene;
        pel_error error;
        if (pel_scene_load(path, NULL, 0, NULL, &scene, &error) != PEL_OK)
            fail_msg("%s", pel_error_text(&error, message, sizeof message));
        check_fixed_point(path, pel_scene_text(scene));
        pel_scene_destroy(scene);
        count++;
    }
    closedir(folder);
    assert_true(count >= 5);
}

/* a mesh in the scene's folder is found from any folder */
static void test_file_mesh(void **unused)
{
    (void)unused;
    char folder[] = "scene_test_XXXXXX", path[200], mesh_path[200];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/a.yaml", folder);
    snprintf(mesh_path, sizeof mesh_path, "%s/tetra.obj", folder);
    FILE *file = fopen(mesh_path, "w");
    fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n", file);
    fclose(file);
    file = fopen(path, "w");
    fputs("version: 1\nduration: 1\nbodies: [{mesh: {file: tetra.obj, scale: 0.5}}]\n"
          "tools: [{name: a, mesh: {file: tetra.obj}, motion: [{position: [3, 0, 0]}]}]\ncontact: {friction: 0}\n",
          file);
    fclose(file);
    pel_scene *scene, *again;
    assert_int_equal(pel_scene_load(path, NULL, 0, NULL, &scene, NULL), PEL_OK);
    assert_int_equal(scene->model.bodies->mesh->vertex_count, 4);
    assert_true(scene->model.bodies->mesh->positions[1][0] == 0.5);
    assert_int_equal(scene->sim.tools[0].shape, PEL_TOOL_MESH);
    assert_int_equal(scene->sim.tools[0].mesh->vertex_count, 4);
    const char *text = pel_scene_text(scene);
    assert_int_equal(pel_scene_parse("elsewhere/a.yaml", text, strlen(text), NULL, 0, NULL, &again, NULL), PEL_OK);
    assert_string_equal(text, pel_scene_text(again));
    assert_true(again->model.bodies->mesh->positions[1][0] == 0.5);
    pel_scene_destroy(again);
    /* with other names for its files */
    assert_int_equal(scene->mesh_file_count, 2);
    assert_non_null(strstr(text, scene->mesh_files[0]));
    char *portable = pel_scene_portable_text(scene, (const char *const[]){"ball.obj", "ball.obj"});
    assert_null(strstr(portable, "tetra.obj"));
    const char *first = strstr(portable, "file: ball.obj");
    assert_non_null(first);
    assert_non_null(strstr(first + 1, "file: ball.obj"));
    pel_free(portable);
    pel_scene_destroy(scene);
    /* a file takes the place of a shape */
    char override[450], absolute[200];
    assert_non_null(getcwd(absolute, sizeof absolute));
    snprintf(override, sizeof override, "bodies.0.mesh.file=%s/%s", absolute, mesh_path);
    scene = load(BALL, (const char *const[]){override}, 1);
    assert_int_equal(scene->model.bodies->mesh->vertex_count, 4);
    pel_scene_destroy(scene);
    remove(path);
    remove(mesh_path);
    rmdir(folder);
}

/* A file in unknown units, scaled by the longest side of its box after `scale`. The text of the scene has the scale
   alone, so that it gives the same bits; an animation of the body is scaled with it (test_follow). */
static void test_size(void **unused)
{
    (void)unused;
    static const struct {
        const char *more;
        double x, z;
    } cases[] = {{"size: 0.3", 0.1, 0.3}, {"size: 0.3, scale: [3, 1, 0.5]", 0.3, 0.15}};
    FILE *file = fopen("size_test.obj", "w");
    assert_non_null(file);
    fputs("v 0 0 0\nv 7 0 0\nv 0 7 0\nv 0 0 21\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n", file);
    fclose(file);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[300];
        snprintf(text, sizeof text,
                 "version: 1\nduration: 1\nbodies: [{mesh: {file: size_test.obj, %s, translate: [1, 0, 0]}}]\n",
                 cases[i].more);
        pel_scene *scene, *again;
        assert_int_equal(pel_scene_parse("a.yaml", text, strlen(text), NULL, 0, NULL, &scene, NULL), PEL_OK);
        double(*x)[3] = scene->model.bodies->mesh->positions;
        assert_near(x[1][0], 1 + cases[i].x, 1e-12);
        assert_near(x[3][2], cases[i].z, 1e-12);
        const char *made = pel_scene_text(scene);
        assert_null(strstr(made, "size:"));
        assert_int_equal(pel_scene_parse("a.yaml", made, strlen(made), NULL, 0, NULL, &again, NULL), PEL_OK);
        assert_memory_equal(x, again->model.bodies->mesh->positions, 4 * sizeof *x);
        pel_scene_destroy(again);
        pel_scene_destroy(scene);
    }
    remove("size_test.obj");
}

static pel_status parse_everything(const void *unused, pel_error *error)
{
    (void)unused;
    pel_scene *scene;
    const char *const overrides[] = {"bodies.0.springs.damping.keys=[[0, 1]]", "loads.0.name=first"};
    pel_status status =
        pel_scene_parse("test.yaml", everything, sizeof everything - 1, overrides, 2, NULL, &scene, error);
    if (status != PEL_OK)
        assert_null(scene);
    pel_scene_destroy(scene);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    assert_true(for_every_allocation_failure(parse_everything, NULL) > 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_defaults),    cmocka_unit_test(test_everything),
        cmocka_unit_test(test_falloff),     cmocka_unit_test(test_scene_runs),
        cmocka_unit_test(test_supports),    cmocka_unit_test(test_session),
        cmocka_unit_test(test_overrides),   cmocka_unit_test(test_override_replaces_alternative),
        cmocka_unit_test(test_aliases),     cmocka_unit_test(test_json),
        cmocka_unit_test(test_fixed_point), cmocka_unit_test(test_shipped_scenes),
        cmocka_unit_test(test_texts),       cmocka_unit_test(test_file_mesh),
        cmocka_unit_test(test_size),        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
