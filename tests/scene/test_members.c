/* The reader of members: every form of a value reaches the member of its row, and what is not given keeps its value. */
#include "check.h"

#include "pellicle/scene.h"

#include <stdlib.h>

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

#define BALL "version: 1\nduration: 2\nbodies:\n  - mesh: {shape: geodesic-sphere, frequency: 2}\n"

/* a word is the value of its enum or switch, also where scenes name the values in another order */
static void test_words(void **unused)
{
    (void)unused;
    pel_scene *scene = load(BALL "solver: {method: explicit, integrator: forward, velocity: keep, descent: gradient, "
                                 "second_order: false}\noutput: {precision: double}\n");
    const pel_solver_def *solver = &scene->sim.solver;
    assert_true(solver->method == PEL_METHOD_EXPLICIT && !solver->symplectic && solver->keep_velocity);
    assert_true(solver->gradient_only && solver->second_order == PEL_NO && scene->output.float64);
    pel_scene_destroy(scene);
    scene = load(BALL "solver: {integrator: symplectic, second_order: true}\n");
    assert_true(scene->sim.solver.symplectic && scene->sim.solver.second_order == PEL_YES);
    assert_true(!scene->sim.solver.keep_velocity && !scene->output.float64);
    pel_scene_destroy(scene);
}

/* units of keys and members may differ; auto is a number of the member's own */
static void test_numbers(void **unused)
{
    (void)unused;
    pel_scene *scene = load(BALL "solver: {budget: 500, iterations: auto, substeps: 3, threads: 2}\n"
                                 "contact: {memory_limit: 0.5, sweeps: 7}\n"
                                 "stop: {frames: 12, time: 1.5, self_contact: true}\n"
                                 "output: {every_frame: 4, checkpoint: 0.25, compress: true}\ntitle: a title\n"
                                 "tools: [{shape: box, size: [2, 4, 6], motion: [{position: [0, 0, 9]}]}]\n");
    assert_true(scene->sim.solver.budget == 0.5 && scene->sim.solver.iterations == 0);
    assert_true(scene->sim.solver.substeps == 3 && scene->sim.thread_count == 2);
    assert_true(scene->sim.contact.memory_limit == 1 && scene->sim.contact.sweeps == 7);
    assert_true(scene->frame_limit == 12 && scene->time_limit == 1.5 && scene->stop_at_contact);
    assert_true(scene->output.every == 0 && scene->output.every_frame == 4 && scene->output.checkpoint == 0.25);
    assert_true(scene->output.compress && scene->duration == 2);
    assert_string_equal(scene->title, "a title");
    const double *half = scene->sim.tools[0].half_extents;
    assert_true(half[0] == 1 && half[1] == 2 && half[2] == 3);
    pel_scene_destroy(scene);
}

/* a map that is there switches its part on; the rest keeps the numbers of new defs */
static void test_parts(void **unused)
{
    (void)unused;
    pel_scene *scene = load(BALL "    membrane: {young: 10, thickness: 0.1}\n    bending: {weight: auto}\n"
                                 "tools:\n  - {shape: sphere, radius: 1, grasp: {reach: 2}, motion: [{position: [0, 0, "
                                 "9]}]}\n  - {shape: sphere, radius: 1, friction: 0.5, motion: [{position: [0, 0, "
                                 "9]}]}\n");
    const pel_shell_def *shell = &scene->model.bodies[0].shell;
    assert_true(shell->membrane.on && shell->membrane.stiffening == 10 && shell->membrane.strain_limit == 0);
    assert_true(shell->bending.weight < 0 && shell->bending.stiffness.value < 0);
    const pel_tool_def *tools = scene->sim.tools;
    assert_true(tools[0].grasp && tools[0].reach == 2 && isinf(tools[0].grasp_until) && tools[0].friction < 0);
    assert_true(!tools[1].grasp && tools[1].friction == 0.5 && tools[1].body == -1);
    assert_false(scene->sim.contact.enabled);
    pel_scene_destroy(scene);
}

/* an inside pressure is a negative outside one, as a number and over time */
static void test_keys(void **unused)
{
    (void)unused;
    pel_scene *scene = load(BALL "    pressure: {inside: {keys: [[0, 1], [2, 3]]}}\n"
                                 "loads: [{force: [0, 0, 1], keys: [[0, 0], [1, 2], [3, 1]], until: 4}]\n");
    const pel_quantity *outside = &scene->model.bodies[0].shell.pressure.outside;
    assert_int_equal(outside->key_count, 2);
    assert_true(outside->keys[1].time == 2 && outside->keys[1].value == -3 && outside->field == NULL);
    const pel_load_def *load_def = scene->sim.loads;
    assert_int_equal(load_def->key_count, 3);
    assert_true(load_def->keys[1].value == 2 && load_def->until == 4 && load_def->force[2] == 1);
    pel_scene_destroy(scene);

    pel_error error;
    assert_int_equal(parse(BALL "    pressure: {inside: {keys: [[2, 1], [0, 3]]}}\n", &scene, &error), PEL_BAD_SCENE);
    assert_non_null(strstr(error.what, "do not increase: 0 after 2"));
    assert_int_equal(error.line, 5);
}

/* numbers on the vertices from a field of the mesh, in the range of their row */
static void test_fields(void **unused)
{
    (void)unused;
    static const char path[] = "scene_members.ply";
    char text[400];
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    fputs("ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
          "property double f\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
          "0 0 0 0\n1 0 0 0.5\n0 1 0 1\n3 0 1 2\n",
          out);
    fclose(out);
    static const char head[] = "version: 1\nduration: 1\nbodies:\n  - mesh: {file: %s}\n%s";
    snprintf(text, sizeof text, head, path,
             "    springs: {stiffness: {field: f, map: [3, 5]}}\n    pressure: {inside: {field: f}}\n");
    pel_scene *scene = load(text);
    const pel_body_def *body = scene->model.bodies;
    const double *stiffness = body->spring_stiffness.field, *outside = body->shell.pressure.outside.field;
    assert_true(stiffness[0] == 3 && stiffness[1] == 4 && stiffness[2] == 5);
    assert_true(outside[1] == -0.5 && outside[2] == -1);
    pel_scene_destroy(scene);

    pel_error error;
    snprintf(text, sizeof text, head, path, "    membrane: {young: {field: f}, thickness: 0.1}\n");
    assert_int_equal(parse(text, &scene, &error), PEL_BAD_SCENE);
    assert_non_null(strstr(error.what, "young is 0 at vertex 0, out of range"));
    assert_non_null(strstr(error.remedy, "> 0 Pa"));
    remove(path);
}

/* a number with others in parts of the body; later parts take precedence, and a falloff fades */
static void test_regions_of_numbers(void **unused)
{
    (void)unused;
    static const char head[] =
        "version: 1\nduration: 1\nbodies:\n  - mesh: {shape: grid, nx: 4, ny: 1, size_x: 4, size_y: 1}\n"
        "    membrane: {thickness: 0.1, young: %s}\n";
    char text[800];
    snprintf(text, sizeof text, head,
             "{base: 3, regions: [{region: {plane: {point: [0.5, 0, 0], normal: [1, 0, 0]}}, value: 7}, "
             "{region: {box: {min: [1.9, -1, -1], max: [3, 1, 1]}}, value: 9}]}");
    pel_scene *scene = load(text);
    const pel_body_def *body = scene->model.bodies;
    for (int32_t v = 0; v < body->mesh->vertex_count; v++) {
        const double x = body->mesh->positions[v][0];
        assert_true(body->shell.membrane.young.field[v] == (x > 1.9 ? 9 : x > 0.5 ? 7 : 3));
    }
    pel_scene_destroy(scene);
    /* all vertices, then what fades over what is there, then two parts at once */
    snprintf(text, sizeof text, head,
             "{base: 3, regions: [{region: all, value: 5}, "
             "{region: {sphere: {center: [-2, 0, 0], radius: 1}, falloff: 2}, value: 7}, "
             "{region: {union: [{box: {min: [0.9, -1, -1], max: [1.1, 1, 1]}}, "
             "{not: {plane: {point: [1.5, 0, 0], normal: [-1, 0, 0]}}}]}, value: 11}]}");
    scene = load(text);
    body = scene->model.bodies;
    for (int32_t v = 0; v < body->mesh->vertex_count; v++) {
        const double *x = body->mesh->positions[v], share = 0.5 * (hypot(x[0] + 2, x[1]) - 1);
        const double weight = share >= 1 ? 0 : share <= 0 ? 1 : 1 - share * share * (3 - 2 * share);
        assert_near(body->shell.membrane.young.field[v], x[0] > 0.5 ? 11 : 5 + 2 * weight, 1e-14);
    }
    pel_scene_destroy(scene);

    static const char *const bad[][2] = {
        {"{base: 3, regions: [{region: all, value: 0}]}", "young.regions.0.value is out of range: 0 Pa"},
        {"{base: -1, regions: [{region: all, value: 1}]}", "young.base is out of range: -1 Pa"},
        {"{regions: [{region: all, value: 1}]}", "base"},
        {"{base: 3, regions: [{region: {sphere: {center: [9, 9, 9], radius: 1}}, value: 1}]}", "the region is empty"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        pel_error error;
        snprintf(text, sizeof text, head, bad[i][0]);
        if (parse(text, &scene, &error) != PEL_BAD_SCENE || strstr(error.what, bad[i][1]) == NULL)
            fail_msg("%s: %s", bad[i][0], error.what);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_words), cmocka_unit_test(test_numbers), cmocka_unit_test(test_parts),
        cmocka_unit_test(test_keys),  cmocka_unit_test(test_fields),  cmocka_unit_test(test_regions_of_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
