/* Places of tools, sizes and regions that a scene gives by its bodies. */
#include "check.h"
#include "failing_malloc.h"

#include "math/vec3.h"
#include "pellicle/scene.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define BALL                                                                                                           \
    "version: 1\nduration: 1\nbodies:\n  - {name: ball, mesh: {shape: geodesic-sphere, frequency: 8, radius: 0.1}}\n"
/* flat, 1 m wide, in the plane z = 0, with a vertex in its middle */
#define SHEET "version: 1\nduration: 1\nbodies:\n  - {name: sheet, mesh: {shape: grid}}\n"
/* two loops of boundary: radius 0.1 at z = -0.5 and at z = 0.5 */
#define TUBE                                                                                                           \
    "version: 1\nduration: 1\nbodies:\n  - {name: tube, mesh: {shape: cylinder, radius: 0.1, height: 1, capped: "      \
    "false}%s}\n"

static pel_scene *load(const char *text)
{
    pel_scene *scene;
    pel_error error;
    char message[1000];
    if (pel_scene_parse("place.yaml", text, strlen(text), NULL, 0, NULL, &scene, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, message, sizeof message));
    return scene;
}

/* the position of the only key of the only tool, with the scene's text before "tools" */
static void place(const char *scene_text, const char *tool, const char *position, double found[3])
{
    char text[1000];
    snprintf(text, sizeof text, "%stools: [{%s, motion: [{position: %s}]}]\n", scene_text, tool, position);
    pel_scene *scene = load(text);
    assert_int_equal(scene->sim.tools[0].key_count, 1);
    pel_vec3_copy(scene->sim.tools[0].keys[0].position, found);
    /* the resolved scene has the same numbers */
    pel_scene *again = load(pel_scene_text(scene));
    assert_memory_equal(again->sim.tools[0].keys[0].position, found, 3 * sizeof *found);
    pel_scene_destroy(again);
    pel_scene_destroy(scene);
}

static void check_place(const char *scene_text, const char *tool, const char *position, double x, double y, double z)
{
    double found[3];
    place(scene_text, tool, position, found);
    assert_near(found[0], x, 1e-12);
    assert_near(found[1], y, 1e-12);
    assert_near(found[2], z, 1e-12);
}

/* a tool touches the highest point with the side that faces it */
static void test_highest(void **unused)
{
    (void)unused;
    check_place(BALL, "shape: sphere, radius: 0.03", "{above: highest}", 0, 0, 0.13);
    check_place(BALL, "shape: sphere, radius: 0.03", "{above: highest, by: 0.01}", 0, 0, 0.14);
    check_place(BALL, "shape: sphere, radius: 0.03", "{above: highest, by: -0.02}", 0, 0, 0.11);
    check_place(BALL, "shape: box, size: [0.1, 0.2, 0.06]", "{above: highest}", 0, 0, 0.13);
    check_place(BALL, "shape: capsule, radius: 0.01, length: 0.1", "{above: highest}", 0, 0, 0.16);
    /* lying, a capsule is as thick as its radius, and a box as its side */
    check_place(BALL, "shape: capsule, radius: 0.01, length: 0.1",
                "{above: highest}, rotation: {axis: [1, 0, 0], angle: 90}", 0, 0, 0.11);
    check_place(BALL, "shape: box, size: [0.1, 0.2, 0.06]", "{above: highest}, rotation: {axis: [1, 0, 0], angle: 90}",
                0, 0, 0.2);
    /* with contact, by its thickness: a ten thousandth of the diagonal, or what is given */
    const double thickness = 1e-4 * 0.2 * sqrt(3);
    check_place(BALL "contact: {}\n", "mesh: {shape: cylinder, radius: 0.05, height: 0.1}", "{above: highest}", 0, 0,
                0.15 + 1.001 * thickness);
    check_place(BALL "contact: {thickness: 0.002}\n", "shape: sphere, radius: 0.03, thickness: 0.004",
                "{above: highest, by: 0.001}", 0, 0, 0.13 + 1.001 * 0.003);
    check_place(BALL "contact: {}\n", "shape: sphere, radius: 0.03", "{above: highest, by: -0.02}", 0, 0, 0.11);
    /* the middle of a level top */
    check_place(SHEET, "shape: sphere, radius: 0.1", "{above: highest}", 0, 0, 0.1);
    /* a floor under the lowest point, and under the middle of a level bottom */
    check_place(BALL, "shape: box, size: [1, 1, 0.06]", "{below: lowest}", 0, 0, -0.13);
    check_place(BALL, "shape: box, size: [1, 1, 0.06]", "{below: lowest, by: 0.01}", 0, 0, -0.14);
    check_place(SHEET, "shape: box, size: [1, 1, 0.06]", "{below: lowest}", 0, 0, -0.03);
    check_place("up: y\n" BALL, "shape: sphere, radius: 0.03", "{below: lowest}", 0, -0.13, 0);
    /* relative to the diagonal of the box about the bodies */
    check_place(BALL, "shape: sphere, radius: 0.03", "{above: highest, by: relative 0.5}", 0, 0, 0.13 + 0.1 * sqrt(3));
    /* another axis */
    check_place(BALL "up: x\n", "shape: sphere, radius: 0.03", "{above: highest}", 0.13, 0, 0);
}

static void test_vertices_and_rays(void **unused)
{
    (void)unused;
    double found[3];
    pel_scene *scene = load(BALL);
    const double *p = scene->model.bodies->mesh->positions[17];
    place(BALL, "shape: sphere, radius: 0.03", "{above: {vertex: 17}, by: 0.01}", found);
    assert_near(pel_vec3_length(found), 0.14, 1e-5);
    assert_near(pel_vec3_distance(found, p), 0.04, 1e-12);
    pel_scene_destroy(scene);
    /* the sheet is met from both sides, and the tool stays on the side that the ray comes from */
    check_place(SHEET, "shape: sphere, radius: 0.1", "{above: {ray: {origin: [0.2, 0.1, 3], direction: [0, 0, -2]}}}",
                0.2, 0.1, 0.1);
    check_place(SHEET, "shape: sphere, radius: 0.1",
                "{above: {ray: {origin: [0.2, 0.1, -3], direction: [0, 0, 1]}}, by: 0.05}", 0.2, 0.1, -0.15);
    /* of two bodies the nearer one, or the one that is named */
    static const char two[] = "version: 1\nduration: 1\nbodies:\n  - {name: low, mesh: {shape: grid}}\n"
                              "  - {name: high, mesh: {shape: grid, translate: [0, 0, 1]}}\n";
    check_place(two, "shape: sphere, radius: 0.1",
                "{above: {ray: {origin: [0, 0, 3], direction: [0, 0, -1]}}, by: 0.1}", 0, 0, 1.2);
    check_place(two, "shape: sphere, radius: 0.1", "{above: highest, body: low, by: 0.1}", 0, 0, 0.2);
}

static void test_sizes(void **unused)
{
    (void)unused;
    const double diagonal = 0.2 * sqrt(3);
    static const char key[] = "motion: [{position: [0, 0, 1]}]";
    char text[1000];
    snprintf(text, sizeof text,
             BALL "tools:\n  - {shape: sphere, radius: auto, %s}\n  - {shape: box, size: auto, %s}\n"
                  "  - {shape: capsule, radius: auto, length: auto, %s}\n",
             key, key, key);
    pel_scene *scene = load(text);
    const pel_tool_def *tools = scene->sim.tools;
    assert_near(tools[0].radius, 0.06 * diagonal, 1e-12);
    for (int i = 0; i < 3; i++)
        assert_near(tools[1].half_extents[i], 0.06 * diagonal, 1e-12);
    assert_near(tools[2].radius, 0.03 * diagonal, 1e-12);
    assert_near(tools[2].half_length, 0.1 * diagonal, 1e-12);
    pel_scene_destroy(scene);
}

/* the pinned vertices of a body with that region */
static pel_scene *pin(const char *body, const char *region)
{
    char keys[400], text[1000];
    snprintf(keys, sizeof keys, ", pinned: %s", region);
    if (strchr(body, '%') != NULL)
        snprintf(text, sizeof text, TUBE, keys);
    else
        snprintf(text, sizeof text, "%.*s%s}\n", (int)strlen(body) - 2, body, keys);
    return load(text);
}

static int32_t count_pins(const char *body, const char *region)
{
    pel_scene *scene = pin(body, region);
    const int32_t count = scene->model.bodies->pinned_count;
    pel_scene_destroy(scene);
    return count;
}

static void test_regions(void **unused)
{
    (void)unused;
    pel_scene *scene = pin(BALL, "{plane: {point: [0, 0, 0.02], normal: [0, 0, 3]}}");
    const pel_body_def *ball = scene->model.bodies;
    int32_t above = 0;
    for (int32_t v = 0; v < ball->mesh->vertex_count; v++)
        above += ball->mesh->positions[v][2] >= 0.02;
    assert_int_equal(ball->pinned_count, above);
    const int32_t all = ball->mesh->vertex_count;
    pel_scene_destroy(scene);
    assert_int_equal(count_pins(BALL, "{not: {plane: {point: [0, 0, 0.02], normal: [0, 0, 1]}}}"), all - above);
    assert_int_equal(
        count_pins(BALL, "{union: [{vertices: [1, 2]}, {vertices: [2, 3]}, {not: {not: {vertices: [9]}}}]}"), 4);
    /* the tube has two ends */
    const int32_t both = count_pins(TUBE, "boundary");
    assert_int_equal(count_pins(TUBE, "{boundary: 0}"), both / 2);
    assert_int_equal(count_pins(TUBE, "{union: [{boundary: 0}, {boundary: 1}]}"), both);
    scene = pin(BALL, "{ray: {origin: [0, 0, 1], direction: [0, 0, -1]}}");
    assert_int_equal(scene->model.bodies->pinned_count, 1);
    assert_near(scene->model.bodies->mesh->positions[scene->model.bodies->pinned[0]][2], 0.1, 1e-12);
    pel_scene_destroy(scene);
    /* weights of a union are the larger ones, those of the outside add up with them to 1 */
    scene = load(BALL "loads: [{force: [0, 0, 1], at: {not: {plane: {normal: [0, 0, -1]}, falloff: 0.05}}}]\n");
    const pel_load_def *pull = scene->sim.loads;
    for (int32_t i = 0; i < pull->vertex_count; i++) {
        const double s = fmin(1, scene->model.bodies->mesh->positions[pull->vertices[i]][2] / 0.05);
        assert_near(pull->weights[i], s * s * (3 - 2 * s), 1e-12);
    }
    pel_scene_destroy(scene);
}

#define FILE_NAME "scene-place.obj"

static void test_groups(void **unused)
{
    (void)unused;
    FILE *stream = fopen(FILE_NAME, "wb");
    assert_non_null(stream);
    fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\ng left\nf 1 2 3\ng right\nf 2 4 3\nf 2 5 4\n", stream);
    fclose(stream);
    static const char body[] =
        "version: 1\nduration: 1\nbodies:\n  - {name: a, membrane: {preset: rubber}, mesh: {file: " FILE_NAME "}}\n";
    assert_int_equal(count_pins(body, "{group: left}"), 3);
    assert_int_equal(count_pins(body, "{group: right}"), 4);
    pel_scene *scene;
    pel_error error;
    char text[400];
    snprintf(text, sizeof text, "%.*s, pinned: {group: lift}}\n", (int)sizeof body - 3, body);
    assert_int_equal(pel_scene_parse("place.yaml", text, strlen(text), NULL, 0, NULL, &scene, &error), PEL_BAD_SCENE);
    assert_string_equal(error.what, "unknown group of the mesh 'lift'");
    assert_string_equal(error.remedy, "did you mean 'left'?");
    unlink(FILE_NAME);
}

static void test_mistakes(void **unused)
{
    (void)unused;
    static const char two[] =
        "version: 1\nduration: 1\nbodies: [{mesh: {shape: grid}}, {mesh: {shape: grid, translate: [0, 0, 1]}}]\n";
    static const struct {
        const char *scene, *position, *what;
    } cases[] = {
        {BALL, "{above: highest, body: bell}", "unknown body 'bell'"},
        {BALL, "{above: {vertex: 642}}", "the mesh has no vertex 642"},
        {two, "{above: {vertex: 1}}", "the place does not say of which body the vertex is"},
        {BALL, "{above: {ray: {origin: [0, 0, 1], direction: [0, 0, 1]}}}", "the ray meets no body"},
        {BALL, "{above: {ray: {origin: [0, 0, 1], direction: [0, 0, 0]}}}", "the direction has no length"},
        {BALL, "{above: highest, by: 5 mm}", "`by` '5 mm' is not a distance"},
        {BALL, "{by: 5}", "tools.0.motion.0.position lacks one of its main keys"},
        {BALL, "{above: {}}", "tools.0.motion.0.position.above lacks one of its main keys"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[600];
        pel_scene *scene;
        pel_error error;
        snprintf(text, sizeof text, "%stools: [{shape: sphere, radius: 1, motion: [{position: %s}]}]\n", cases[i].scene,
                 cases[i].position);
        assert_int_equal(pel_scene_parse("place.yaml", text, strlen(text), NULL, 0, NULL, &scene, &error),
                         PEL_BAD_SCENE);
        assert_null(scene);
        assert_string_equal(error.what, cases[i].what);
        assert_true(error.line >= 4 && error.remedy[0] != '\0');
    }
}

static pel_status parse_case(const void *text, pel_error *error)
{
    pel_scene *scene;
    pel_status status = pel_scene_parse("place.yaml", text, strlen(text), NULL, 0, NULL, &scene, error);
    pel_scene_destroy(scene);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    static const char text[] =
        "version: 1\nduration: 1\nbodies: [{mesh: {shape: grid, nx: 2, ny: 2}, springs: {stiffness: 1},"
        " mass: {total: 1}, pinned: {union: [{boundary: 0}, {not: {vertices: [1]}}]}}]\n"
        "solver: {method: quasi-static}\n"
        "tools: [{shape: sphere, radius: auto, motion: [{position: {above: highest}}]}]\n";
    assert_true(for_every_allocation_failure(parse_case, text) > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_highest),
        cmocka_unit_test(test_vertices_and_rays),
        cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_regions),
        cmocka_unit_test(test_groups),
        cmocka_unit_test(test_mistakes),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
