#include "check.h"
#include "failing_malloc.h"
#include "math/vec3.h"
#include "observe/field.h"
#include "pellicle/measure.h"
#include "pellicle/mesh_io.h"
#include "pellicle/shape.h"
#include "pellicle/sim_forces.h"
#include "pellicle/sim_ledger.h"
#include "results/surface.h"
#include "stage/stage.h"

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
    "    membrane_energy, bending_energy, fibre_energy, pressure, contact, contact_force, reaction, level, area, "
    "normal, "
    "mean_curvature,\n"
    "    gaussian_curvature, stress, strain, piola_stress, cauchy_stress, membrane_force, bending_moment,\n"
    "    principal_strain, principal_stress, principal_direction, von_mises_top, von_mises_bottom,\n"
    "    membrane_energy_density, bending_energy_density, fibre_energy_density] }\n";

static pel_scene *load_text(const char *scene_text)
{
    pel_scene *scene;
    pel_error error;
    char message[1000];
    if (pel_scene_parse("test.yaml", scene_text, strlen(scene_text), NULL, 0, NULL, &scene, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, message, sizeof message));
    return scene;
}

static pel_scene *load_scene(void)
{
    return load_text(text);
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

/* a third of the areas of the triangles at a vertex */
static double thirds_at(const pel_mesh *frame, int32_t v)
{
    double sum = 0;
    for (int32_t t = 0; t < frame->triangle_count; t++) {
        const int32_t *c = frame->triangles[t];
        const double(*x)[3] = (const double(*)[3])frame->positions;
        if (c[0] == v || c[1] == v || c[2] == v)
            sum += pel_vec3_triangle_area(x[c[0]], x[c[1]], x[c[2]]) / 3;
    }
    return sum;
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
        assert_near(values_of(frame, "stress")[i], virials[v] / (2 * thirds_at(frame, i)), 1e-15);
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
    /* twice, because a stress is computed in place */
    for (int round = 0; round < 2; round++)
        assert_int_equal(pel_run_surface_read(&surface, sim, NULL), PEL_OK);
    assert_int_equal(pel_run_surface_write(&surface, &scene->output, "fields.vtp", NULL), PEL_OK);
    assert_int_equal(pel_vtp_read("fields.vtp", &frame, NULL, NULL), PEL_OK);
    assert_int_equal(frame->field_count, PEL_FIELD_COUNT + 1);
    for (int f = 0; f < PEL_FIELD_COUNT; f++) {
        assert_int_equal(pel_mesh_field(frame, pel_field_at(f)->name)->component_count,
                         pel_field_at(f)->component_count);
        assert_int_equal(pel_field_find(pel_field_at(f)->name), f);
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

/* a body with every kind of energy: at each vertex they add up, and over all vertices each is that of the body */
static void test_energies(void **unused)
{
    (void)unused;
    static const char shell[] =
        "version: 1\n"
        "bodies:\n"
        "  - { name: skin, mesh: { shape: geodesic-sphere, frequency: 4, radius: 0.1 }, springs: { stiffness: 3 },\n"
        "      volumetric: { stiffness: 2 }, membrane: { preset: rubber }, bending: { model: hinge },\n"
        "      anisotropy: { mode: strain, energy: stvk }, pressure: { inside: 5000 } }\n"
        "solver: { method: xpbd, dt: 0.005 }\n"
        "duration: 1\n"
        "output: { precision: double, fields: [energy, spring_energy, volumetric_energy, membrane_energy,\n"
        "    bending_energy, fibre_energy] }\n";
    static const char *const names[5] = {"spring_energy", "volumetric_energy", "membrane_energy", "bending_energy",
                                         "fibre_energy"};
    pel_scene *scene = load_text(shell);
    pel_model *model;
    pel_sim *sim = make_sim(scene, &model);
    pel_run_surface surface;
    pel_mesh *frame;
    pel_sim_measures measures;
    assert_int_equal(pel_run_surface_create(sim, &scene->output, &surface, NULL), PEL_OK);
    for (int step = 0; step < 10; step++)
        assert_int_equal(pel_sim_step(sim, NULL), PEL_OK);
    assert_int_equal(pel_run_surface_read(&surface, sim, NULL), PEL_OK);
    assert_int_equal(pel_run_surface_write(&surface, &scene->output, "energies.vtp", NULL), PEL_OK);
    assert_int_equal(pel_vtp_read("energies.vtp", &frame, NULL, NULL), PEL_OK);
    pel_sim_measure(sim, &measures);
    const double whole[5] = {measures.spring_energy, measures.volumetric_energy, measures.membrane_energy,
                             measures.bending_energy, measures.fibre_energy};
    double sums[5] = {0};
    for (int32_t v = 0; v < frame->vertex_count; v++) {
        double sum = 0;
        for (int e = 0; e < 5; e++) {
            sum += values_of(frame, names[e])[v];
            sums[e] += values_of(frame, names[e])[v];
        }
        assert_near(values_of(frame, "energy")[v], sum, 1e-12 * measures.elastic_energy);
    }
    for (int e = 0; e < 5; e++) {
        assert_true(whole[e] > 0);
        assert_near(sums[e] / whole[e], 1, sizeof(pel_real) == 8 ? 1e-9 : 1e-4);
    }
    pel_mesh_destroy(frame);
    remove("energies.vtp");
    pel_run_surface_destroy(&surface);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_scene_destroy(scene);
}

/* a vector field of the mesh on a body that refines: finer vertices have the values of mesh_vertices and mesh_weights;
   one that is not refined keeps its values, and one without the field has zeros */
static void test_mesh_field_on_finer_vertices(void **unused)
{
    (void)unused;
    static const char refined[] =
        "version: 1\n"
        "bodies:\n"
        "  - { name: plain, mesh: { shape: grid, nx: 2, ny: 2, translate: [9, 0, 0] } }\n"
        "  - { name: fine, mesh: { file: places.ply }, refine: { levels: 2, everywhere: true } }\n"
        "duration: 1\n"
        "output: { precision: double, fields: [place] }\n";
    pel_mesh *ball, *frame;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    shape.frequency = 2;
    assert_int_equal(pel_shape_create(&shape, &ball, NULL), PEL_OK);
    assert_int_equal(pel_mesh_add_field(ball, "place", 3, ball->positions[0], NULL), PEL_OK);
    assert_int_equal(pel_mesh_write("places.ply", PEL_FORMAT_PLY, ball, NULL, NULL), PEL_OK);
    pel_scene *scene = load_text(refined);
    pel_model *model;
    pel_sim *sim = make_sim(scene, &model);
    pel_run_surface surface;
    assert_int_equal(pel_run_surface_create(sim, &scene->output, &surface, NULL), PEL_OK);
    assert_int_equal(pel_run_surface_read(&surface, sim, NULL), PEL_OK);
    assert_int_equal(pel_run_surface_write(&surface, &scene->output, "places.vtp", NULL), PEL_OK);
    assert_int_equal(pel_vtp_read("places.vtp", &frame, NULL, NULL), PEL_OK);
    assert_int_equal(frame->vertex_count, 9 + 10 * 64 + 2);
    const double *corners = values_of(frame, "mesh_vertices"), *weights = values_of(frame, "mesh_weights"),
                 *places = values_of(frame, "place");
    for (int32_t v = 0; v < frame->vertex_count; v++)
        for (int c = 0; c < 3; c++) {
            double expected = 0;
            for (int k = 0; v >= 9 && k < 3; k++)
                expected += weights[3 * v + k] * ball->positions[(int32_t)corners[3 * v + k]][c];
            if (v >= 9 && v < 9 + ball->vertex_count)
                assert_near(places[3 * v + c], ball->positions[v - 9][c], 0);
            assert_near(places[3 * v + c], expected, 1e-15);
        }
    pel_mesh_destroy(frame);
    pel_mesh_destroy(ball);
    remove("places.ply");
    remove("places.vtp");
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
    pel_run_surface_destroy(&surface);
    names[1] = "main_curvature";
    assert_int_equal(pel_run_surface_create(sim, &output, &surface, &error), PEL_BAD_SCENE);
    assert_string_equal(error.remedy, "did you mean 'mean_curvature'?");
    pel_run_surface_destroy(&surface);
    assert_int_equal(pel_field_find("mood"), -1);
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
        cmocka_unit_test(test_energies),
        cmocka_unit_test(test_mesh_field_on_finer_vertices),
        cmocka_unit_test(test_other_fields),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
