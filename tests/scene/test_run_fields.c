#include "check.h"

#include "failing_malloc.h"
#include "pellicle/measure.h"
#include "scene/run_fields.h"
#include "scene/run_surface.h"

#include <stdlib.h>

/* two bodies, so that the second one's vertices begin somewhere */
static const char text[] =
    "version: 1\n"
    "bodies:\n"
    "  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 4 } }\n"
    "  - { name: cloth, mesh: { shape: grid, translate: [5, 0, 0] } }\n"
    "loads: [{ body: ball, force: [5, 0, 0], at: { nearest: [1, 0, 0] } },\n"
    "    { body: cloth, force: [1, 2, 3], at: { nearest: [5, 0, 0] } }]\n"
    "solver: { method: quasi-static, dt: 0.01 }\n"
    "duration: 1\n"
    "output: { precision: double, fields: [displacement, velocity, force, energy, spring_energy, volumetric_energy,\n"
    "    membrane_energy, bending_energy, fibre_energy, pressure, contact, area, normal, mean_curvature,\n"
    "    gaussian_curvature, stress] }\n";

static pel_scene *load_scene(void)
{
    pel_scene *scene;
    assert_int_equal(pel_scene_parse("test.yaml", text, strlen(text), NULL, 0, NULL, &scene, NULL), PEL_OK);
    return scene;
}

static pel_sim *make_sim(pel_scene *scene, pel_model **model)
{
    pel_sim *sim;
    assert_int_equal(pel_model_create(&scene->model, model, NULL), PEL_OK);
    scene->sim.model = *model;
    assert_int_equal(pel_sim_create(&scene->sim, &sim, NULL), PEL_OK);
    return sim;
}

static const double *values_of(const pel_mesh *frame, const char *name)
{
    const pel_field *field = pel_mesh_field(frame, name);
    assert_non_null(field);
    return field->values;
}

/* the fields of one body of the frame are those of the positions in the frame */
static void check_body(const pel_mesh *frame, const pel_model *model, pel_sim *sim, int32_t body, int32_t first)
{
    const pel_mesh *mesh = pel_model_mesh(model, body);
    pel_topology *topology;
    double *virials = malloc(sizeof *virials * (size_t)mesh->vertex_count), total = 0;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    pel_sim_get_spring_virials(sim, body, virials);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        pel_vertex_measure m;
        pel_vertex_measure_fill(topology, frame->positions[first], v, &m);
        int32_t i = first + v;
        assert_true(values_of(frame, "area")[i] == m.area);
        assert_memory_equal(values_of(frame, "normal") + 3 * i, m.normal, sizeof m.normal);
        assert_true(values_of(frame, "mean_curvature")[i] == m.mean_curvature);
        assert_true(values_of(frame, "gaussian_curvature")[i] == m.gaussian_curvature);
        assert_near(values_of(frame, "stress")[i], virials[v] / (2 * m.area), 1e-15);
        assert_near(values_of(frame, "spring_energy")[i] + values_of(frame, "volumetric_energy")[i],
                    values_of(frame, "energy")[i], 1e-12);
        total += fabs(values_of(frame, "stress")[i]);
    }
    assert_true(total > 1e-4);
    pel_topology_destroy(topology);
    free(virials);
}

static void test_fields_of_a_frame(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene();
    pel_model *model;
    pel_sim *sim = make_sim(scene, &model);
    pel_run_surface surface;
    pel_mesh *frame;
    assert_int_equal(pel_run_surface_create(sim, &scene->output, &surface, NULL), PEL_OK);
    for (int step = 0; step < 30; step++)
        assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
    /* twice, because a stress is made in place of what stood there */
    for (int round = 0; round < 2; round++)
        assert_int_equal(pel_run_surface_write_frame(&surface, sim, &scene->output, "fields.vtp", NULL), PEL_OK);
    assert_int_equal(pel_vtp_read("fields.vtp", &frame, NULL, NULL), PEL_OK);
    assert_int_equal(frame->field_count, PEL_RUN_FIELD_COUNT + 1);
    for (int f = 0; f < PEL_RUN_FIELD_COUNT; f++) {
        assert_int_equal(pel_mesh_field(frame, pel_run_fields[f].name)->component_count,
                         pel_run_fields[f].component_count);
        assert_int_equal(pel_run_field_find(pel_run_fields[f].name), f);
    }
    check_body(frame, model, sim, 0, 0);
    check_body(frame, model, sim, 1, pel_model_mesh(model, 0)->vertex_count);
    pel_mesh_destroy(frame);
    remove("fields.vtp");
    pel_run_surface_destroy(&surface);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
}

/* no topology where nothing is measured; names that do not exist */
static void test_other_fields(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene();
    pel_model *model;
    pel_run_surface surface;
    pel_error error;
    pel_sim *sim = make_sim(scene, &model);
    const char *names[] = {"force", "contact"};
    pel_output_def output = {.fields = names, .field_count = 2};
    assert_int_equal(pel_run_surface_create(sim, &output, &surface, NULL), PEL_OK);
    assert_null(surface.topologies);
    pel_run_surface_destroy(&surface);
    names[1] = "main_curvature";
    assert_int_equal(pel_run_surface_create(sim, &output, &surface, &error), PEL_BAD_SCENE);
    assert_string_equal(error.remedy, "did you mean 'mean_curvature'?");
    pel_run_surface_destroy(&surface);
    assert_int_equal(pel_run_field_find("mood"), PEL_RUN_FIELD_COUNT);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
}

static const pel_output_def *wanted;

static pel_status create_surface(const void *data, pel_error *error)
{
    pel_run_surface surface;
    pel_status status = pel_run_surface_create(data, wanted, &surface, error);
    pel_run_surface_destroy(&surface);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    pel_scene *scene = load_scene();
    pel_model *model;
    pel_sim *sim = make_sim(scene, &model);
    wanted = &scene->output;
    assert_true(for_every_allocation_failure(create_surface, sim) > 20);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fields_of_a_frame),
        cmocka_unit_test(test_other_fields),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
