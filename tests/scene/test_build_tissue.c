/* Bodies by density and Young's modulus: closed forms, and the same response of coarse and fine meshes. */
#include "check.h"

#include "pellicle/measure.h"
#include "pellicle/scene.h"
#include "pellicle/sim_forces.h"
#include "pellicle/sim_reading.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static pel_scene *load(const char *text)
{
    pel_scene *scene;
    pel_error error;
    char message[1000];
    if (pel_scene_parse("test.yaml", text, strlen(text), NULL, 0, NULL, &scene, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, message, sizeof message));
    return scene;
}

static double area_of(const pel_mesh *mesh)
{
    return pel_surface_area(mesh->positions[0], mesh->triangles[0], mesh->triangle_count);
}

static double volume_of(const pel_mesh *mesh)
{
    return pel_surface_volume(mesh->positions[0], mesh->triangles[0], mesh->triangle_count, NULL);
}

/* sizes that follow from the mesh */
static void test_sizes(void **unused)
{
    (void)unused;
    static const char *const scales[] = {"0.01", "1"};
    for (int i = 0; i < 2; i++) {
        char text[300];
        snprintf(
            text, sizeof text,
            "version: 1\nduration: 1\nbodies:\n  - mesh: {shape: geodesic-sphere, scale: %s}\n    volumetric: {}\n",
            scales[i]);
        pel_scene *scene = load(text);
        const pel_body_def *body = scene->model.bodies;
        double area = area_of(body->mesh), volume = volume_of(body->mesh);
        assert_near(body->thickness.value, volume / area, 1e-12 * volume / area);
        assert_near(body->volumetric_depth, 3 * volume / area, 1e-12 * volume / area);
        assert_near(body->spring_thickness, 0.3 * volume / area, 1e-12 * volume / area);
        assert_true(body->volumetric_stiffness.value == 5000 && body->spring_stiffness.value == 5000);
        pel_scene_destroy(scene);
    }
    pel_scene *scene = load("version: 1\nduration: 1\nbodies:\n  - mesh: {shape: grid}\n    volumetric: {}\n");
    double radius = sqrt(area_of(scene->model.bodies->mesh) / (4 * acos(-1)));
    assert_near(scene->model.bodies->volumetric_depth, radius, 1e-12 * radius);
    assert_near(scene->model.bodies->thickness.value, 0.1 * radius, 1e-12 * radius);
    pel_scene_destroy(scene);
}

/* given numbers stay; the filling takes the modulus of the skin */
static void test_given(void **unused)
{
    (void)unused;
    pel_scene *scene = load("version: 1\nduration: 1\nbodies:\n  - mesh: {shape: geodesic-sphere}\n"
                            "    mass: {density: 900, thickness: 0.25}\n"
                            "    springs: {young: {keys: [[0, 10], [1, 20]]}, thickness: 0.5, drag: 3}\n"
                            "    volumetric: {depth: 2, drag: 4}\n");
    const pel_body_def *body = scene->model.bodies;
    assert_true(body->mass == 900 && body->thickness.value == 0.25);
    assert_true(body->spring_thickness == 0.5 && body->spring_damping.value == 3);
    assert_int_equal(body->spring_stiffness.key_count, 2);
    assert_int_equal(body->volumetric_stiffness.key_count, 2);
    assert_true(body->volumetric_stiffness.keys[1].value == 20);
    assert_true(body->volumetric_depth == 2 && body->volumetric_damping.value == 4);
    pel_scene_destroy(scene);
    scene = load("version: 1\nduration: 1\nbodies:\n  - mesh: {shape: geodesic-sphere}\n    preset: paper-a\n"
                 "    mass: {total: 2}\n    springs: {young: 10}\n    volumetric: {stiffness: 7}\n");
    body = scene->model.bodies;
    assert_true(body->mass_kind == PEL_MASS_TOTAL && body->mass == 2);
    assert_true(body->spring_thickness > 0 && body->spring_stiffness.value == 10);
    assert_true(body->volumetric_depth == 0 && body->volumetric_stiffness.value == 7);
    pel_scene_destroy(scene);
}

/* runs a scene to its end */
static pel_sim *run(const pel_scene *scene, pel_model **model)
{
    pel_sim *sim;
    pel_sim_def def = scene->sim;
    assert_int_equal(pel_model_create(&scene->model, model, NULL), PEL_OK);
    def.model = *model;
    assert_int_equal(pel_sim_create(&def, &sim, NULL), PEL_OK);
    while (pel_sim_time(sim) < scene->duration - 0.5 * def.solver.dt)
        assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
    return sim;
}

/* a uniform force moves a filled body by F depth / (E A), on every mesh */
static void test_uniform_load(void **unused)
{
    (void)unused;
    static const int frequencies[] = {4, 9};
    for (int i = 0; i < 2; i++) {
        char text[500];
        snprintf(text, sizeof text,
                 "version: 1\nduration: 1\nbodies:\n"
                 "  - mesh: {shape: geodesic-sphere, frequency: %d, scale: [0.1, 0.2, 0.1]}\n"
                 "    springs: {young: 0}\n    volumetric: {young: 2000, depth: 0.05}\n"
                 "gravity: [0, 0, -9.81]\nsolver: {method: static}\n",
                 frequencies[i]);
        pel_scene *scene = load(text);
        const pel_mesh *mesh = scene->model.bodies->mesh;
        double weight = 9.81 * 1000 * volume_of(mesh), expected = weight * 0.05 / (2000 * area_of(mesh));
        pel_model *model;
        pel_sim *sim = run(scene, &model);
        double *x = malloc(3 * (size_t)mesh->vertex_count * sizeof *x);
        assert_non_null(x);
        pel_sim_get_positions(sim, 0, x);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            assert_near(mesh->positions[v][2] - x[3 * v + 2], expected, 1e-5 * expected);
        free(x);
        pel_sim_destroy(sim);
        pel_model_destroy(model);
        pel_scene_destroy(scene);
    }
}

/* a stretch of all edges by 1 + s stores 1.5 E h A s^2, however irregular the mesh is */
static void test_skin(void **unused)
{
    (void)unused;
    pel_scene *scene = load("version: 1\nduration: 1\nbodies:\n"
                            "  - mesh: {shape: geodesic-sphere, frequency: 6, scale: [0.3, 0.1, 0.2]}\n"
                            "    springs: {young: 3000, thickness: 0.002}\n");
    const pel_mesh *mesh = scene->model.bodies->mesh;
    size_t count = (size_t)mesh->vertex_count;
    double *x = malloc(3 * count * sizeof *x), *spring = malloc(2 * count * sizeof *spring), sum = 0, share = 1e-3;
    assert_true(x != NULL && spring != NULL);
    for (size_t i = 0; i < 3 * count; i++)
        x[i] = (1 + share) * mesh->positions[i / 3][i % 3];
    pel_model *model;
    pel_sim *sim;
    pel_sim_def def = scene->sim;
    assert_int_equal(pel_model_create(&scene->model, &model, NULL), PEL_OK);
    def.model = model;
    assert_int_equal(pel_sim_create(&def, &sim, NULL), PEL_OK);
    assert_int_equal(pel_sim_set_positions(sim, 0, x, NULL), PEL_OK);
    pel_sim_get_energies(sim, 0, spring, spring + count);
    for (size_t v = 0; v < count; v++)
        sum += spring[v];
    double expected = 1.5 * 3000 * 0.002 * area_of(mesh) * share * share;
    /* 1e-3 of strain has four digits in float */
    assert_near(sum, expected, 2e-3 * expected);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
    free(x);
    free(spring);
}

/* force on a ball that is pressed 1 cm into a body of 8 cm */
static double press(const char *mesh)
{
    char text[700];
    snprintf(text, sizeof text,
             "version: 1\nduration: 1\nbodies: [{mesh: %s, volumetric: {}}]\n"
             "tools: [{shape: sphere, radius: 0.08,\n"
             "         motion: [{position: [0, 0, 0.161]}, {time: 0.5, position: [0, 0, 0.15]}]}]\n",
             mesh);
    pel_scene *scene = load(text);
    pel_model *model;
    pel_sim *sim = run(scene, &model);
    pel_tool_reading reading;
    pel_sim_get_tool(sim, 0, &reading);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
    return reading.force[2];
}

static void test_fineness(void **unused)
{
    (void)unused;
    double coarse = press("{shape: geodesic-sphere, frequency: 12, radius: 0.08}"),
           fine = press("{shape: geodesic-sphere, frequency: 18, radius: 0.08}");
    /* a rigid ball on an elastic half space, 4/3 E / (1 - nu^2) sqrt(R) d^1.5 of two equal radii, within a factor of 2
     */
    double hertz = 4.0 / 3 * 5000 / 0.75 * sqrt(0.04) * pow(0.01, 1.5);
    if (!(fabs(coarse / fine - 1) < 0.05))
        fail_msg("%g N on the coarse and %g N on the fine mesh", coarse, fine);
    assert_true(fine > hertz / 3 && fine < hertz);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sizes), cmocka_unit_test(test_given),    cmocka_unit_test(test_uniform_load),
        cmocka_unit_test(test_skin),  cmocka_unit_test(test_fineness),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
