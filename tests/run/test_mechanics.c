/* Fields of mechanics against closed forms: sphere under pressure, strip in tension, plate bent alike in all
   directions; tensors that turn with the body; the same numbers on triangles. */
#include "check.h"

#include "pellicle/bending.h"
#include "pellicle/measure.h"
#include "pellicle/mesh_io.h"
#include "pellicle/results.h"
#include "pellicle/sim_forces.h"
#include "pellicle/sim_ledger.h"
#include "pellicle/sim_surface.h"
#include "results/surface.h"

#include <stdlib.h>

enum { IS_SINGLE = sizeof(pel_real) == 4 };

typedef struct run {
    pel_scene *scene;
    pel_model *model;
    pel_sim *sim;
    pel_mesh *frame;
} run;

static void start(const char *text, run *made)
{
    pel_error error;
    char message[1000];
    if (pel_scene_parse("test.yaml", text, strlen(text), NULL, 0, NULL, &made->scene, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, message, sizeof message));
    assert_int_equal(pel_model_create(&made->scene->model, &made->model, NULL), PEL_OK);
    made->scene->sim.model = made->model;
    if (pel_sim_create(&made->scene->sim, &made->sim, &error) != PEL_OK)
        fail_msg("%s", pel_error_text(&error, message, sizeof message));
}

static void step(const run *made, int count)
{
    pel_error error;
    char message[1000];
    for (int i = 0; i < count; i++)
        if (pel_sim_step(made->sim, &error) != PEL_OK)
            fail_msg("%s", pel_error_text(&error, message, sizeof message));
}

static void read_frame(run *made)
{
    pel_run_surface surface;
    assert_int_equal(pel_run_surface_create(made->sim, &made->scene->output, &surface, NULL), PEL_OK);
    assert_int_equal(pel_run_surface_read(&surface, made->sim, NULL), PEL_OK);
    assert_int_equal(pel_run_surface_write(&surface, &made->scene->output, "mechanics.vtp", NULL), PEL_OK);
    pel_run_surface_destroy(&surface);
    assert_int_equal(pel_vtp_read("mechanics.vtp", &made->frame, NULL, NULL), PEL_OK);
    remove("mechanics.vtp");
}

static void finish(run *made)
{
    pel_mesh_destroy(made->frame);
    pel_sim_destroy(made->sim);
    pel_model_destroy(made->model);
    pel_scene_destroy(made->scene);
}

static const double *values_at(const run *made, const char *name, int32_t v)
{
    const pel_field *field = pel_mesh_field(made->frame, name);
    assert_non_null(field);
    return field->values + (size_t)v * (size_t)field->component_count;
}

#define ALL_FIELDS                                                                                                     \
    "output: { precision: double, fields: [stress, strain, piola_stress, cauchy_stress, membrane_force,\n"             \
    "    bending_moment, principal_strain, principal_stress, principal_direction, von_mises_top, von_mises_bottom,\n"  \
    "    membrane_energy_density, bending_energy_density, fibre_energy_density] }\n"

/* a sphere of radius 1 under 10 Pa: tension p R / 2, also where five triangles meet */
static void test_sphere(void **unused)
{
    (void)unused;
    run made = {0};
    start("version: 1\n"
          "bodies:\n"
          "  - name: ball\n"
          "    mesh: { shape: geodesic-sphere, frequency: 8 }\n"
          "    membrane: { young: 1.0e6, poisson: 0.3, thickness: 0.01 }\n"
          "    bending: { model: midedge }\n"
          "    pressure: { inside: 10 }\n"
          "solver: { method: static }\n"
          "duration: 1\n" ALL_FIELDS,
          &made);
    step(&made, 1);
    read_frame(&made);
    const double tension = 5, stress = tension / 0.01;
    for (int32_t v = 0; v < made.frame->vertex_count; v++) {
        assert_near(*values_at(&made, "stress", v) / tension, 1, 0.05);
        const double *force = values_at(&made, "membrane_force", v);
        assert_near((force[0] + force[1] + force[2]) / (2 * tension), 1, 0.05);
        for (int side = 0; side < 2; side++) {
            assert_near(values_at(&made, "principal_stress", v)[side] / stress, 1, 0.06);
            assert_near(values_at(&made, "principal_strain", v)[side] / (0.7 * stress / 1e6), 1,
                        sizeof(pel_real) == 8 ? 0.06 : 0.07);
        }
        assert_near(*values_at(&made, "von_mises_top", v) / stress, 1, 0.1);
        assert_near(*values_at(&made, "membrane_energy_density", v) / (0.7 * tension * tension / 1e4), 1, 0.1);
        assert_true(*values_at(&made, "fibre_energy_density", v) == 0);
    }
    finish(&made);
}

/* a strip that is pulled to the stretch 1.2 along a slanting axis, held there by its coordinates */
static void test_strip(void **unused)
{
    (void)unused;
    run made = {0};
    start("version: 1\n"
          "bodies:\n"
          "  - name: strip\n"
          "    mesh: { shape: grid, nx: 4, ny: 4 }\n"
          "    membrane: { material: neo-hookean, young: 1.0e6, poisson: 0.5, thickness: 0.02 }\n"
          "    bending: { model: hinge }\n"
          "solver: { method: static }\n"
          "duration: 1\n" ALL_FIELDS,
          &made);
    /* x' = Q diag(l, 1 / sqrt l) x: uniaxial tension of an incompressible sheet, its thickness h / sqrt l; Q turns */
    const double l = 1.2, s = 1 / sqrt(l), along[3] = {0.6, 0, 0.8}, across[3] = {0, 1, 0};
    int32_t count = pel_sim_vertex_count(made.sim, 0);
    double *x = malloc(sizeof *x * 3 * (size_t)count);
    pel_sim_get_rest_positions(made.sim, 0, x);
    for (int32_t v = 0; v < count; v++) {
        double a = l * x[3 * v], b = s * x[3 * v + 1];
        for (int c = 0; c < 3; c++)
            x[3 * v + c] = a * along[c] + b * across[c];
    }
    assert_int_equal(pel_sim_set_positions(made.sim, 0, x, NULL), PEL_OK);
    read_frame(&made);
    const double cauchy = 1e6 / 3 * (l * l - 1 / l), tolerance = IS_SINGLE ? 2e-4 : 1e-10;
    static const int at[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
    for (int32_t v = 0; v < made.frame->vertex_count; v++) {
        for (int k = 0; k < 6; k++) {
            double expected = along[at[k][0]] * along[at[k][1]];
            assert_near(values_at(&made, "cauchy_stress", v)[k] / cauchy, expected, tolerance);
            assert_near(values_at(&made, "membrane_force", v)[k] / (cauchy * 0.02 * s), expected, tolerance);
        }
        /* S = F^-1 (J3 sigma) F^-T with J3 = 1; strain along the axes at rest */
        assert_near(values_at(&made, "piola_stress", v)[0] / (cauchy / (l * l)), 1, tolerance);
        assert_near(values_at(&made, "strain", v)[0], (l * l - 1) / 2, tolerance);
        assert_near(values_at(&made, "strain", v)[1], (s * s - 1) / 2, tolerance);
        assert_near(values_at(&made, "principal_strain", v)[0], (l * l - 1) / 2, tolerance);
        assert_near(values_at(&made, "principal_stress", v)[0] / cauchy, 1, tolerance);
        assert_near(values_at(&made, "principal_stress", v)[1] / cauchy, 0, tolerance);
        const double *direction = values_at(&made, "principal_direction", v);
        assert_near(fabs(direction[0] * along[0] + direction[2] * along[2]), 1, tolerance);
        assert_near(*values_at(&made, "von_mises_top", v) / cauchy, 1, IS_SINGLE ? 2e-3 : 1e-10);
        assert_near(*values_at(&made, "von_mises_bottom", v) / cauchy, 1, IS_SINGLE ? 2e-3 : 1e-10);
        assert_near(*values_at(&made, "stress", v) / (cauchy * 0.02 * s / 2), 1, tolerance);
    }
    free(x);
    finish(&made);
}

/* The moments in the middle of a plate that is given the deflection -(a x^2 + b y^2) / 2. */
static void bend_plate(const char *model, double a, double b, double moment[3], double mises[2], double *energy)
{
    run made = {0};
    char text[1000];
    snprintf(text, sizeof text,
             "version: 1\n"
             "bodies:\n"
             "  - name: plate\n"
             "    mesh: { shape: grid, nx: 24, ny: 24 }\n"
             "    membrane: { young: 1.0e9, poisson: 0.3, thickness: 0.01 }\n"
             "    bending: { model: %s }\n"
             "solver: { method: static }\n"
             "duration: 1\n" ALL_FIELDS,
             model);
    start(text, &made);
    int32_t count = pel_sim_vertex_count(made.sim, 0), middle = 0;
    double *x = malloc(sizeof *x * 3 * (size_t)count), sum = 0;
    pel_triangle_mechanics *triangles = malloc(sizeof *triangles * (size_t)pel_sim_triangle_count(made.sim, 0));
    pel_sim_get_rest_positions(made.sim, 0, x);
    for (int32_t v = 0; v < count; v++) {
        if (fabs(x[3 * v]) + fabs(x[3 * v + 1]) < fabs(x[3 * middle]) + fabs(x[3 * middle + 1]))
            middle = v;
        x[3 * v + 2] -= 0.5 * (a * x[3 * v] * x[3 * v] + b * x[3 * v + 1] * x[3 * v + 1]);
    }
    assert_near(x[3 * middle], 0, 1e-6);
    assert_int_equal(pel_sim_set_positions(made.sim, 0, x, NULL), PEL_OK);
    read_frame(&made);
    const double *m = values_at(&made, "bending_moment", middle);
    moment[0] = m[0];
    moment[1] = m[1];
    moment[2] = m[3];
    mises[0] = *values_at(&made, "von_mises_top", middle);
    mises[1] = *values_at(&made, "von_mises_bottom", middle);
    /* the density adds up to the energy that the simulation has */
    pel_sim_measures measures;
    pel_sim_measure(made.sim, &measures);
    pel_sim_get_mechanics(made.sim, 0, triangles);
    for (int32_t t = 0; t < pel_sim_triangle_count(made.sim, 0); t++)
        sum += triangles[t].bending_energy * triangles[t].rest_area;
    assert_near(sum / measures.bending_energy, 1, IS_SINGLE ? 1e-4 : 1e-9);
    *energy = *values_at(&made, "bending_energy_density", middle);
    free(triangles);
    free(x);
    finish(&made);
}

/* M = D kappa (1 + nu) in spherical bending, D kappa and nu D kappa in cylindrical; outer side stretched */
static void test_plate(void **unused)
{
    (void)unused;
    const double d = pel_bending_stiffness(1e9, 0.3, 0.01), kappa = IS_SINGLE ? 1e-2 : 1e-4;
    double moment[3], mises[2], energy;
    bend_plate("midedge", kappa, kappa, moment, mises, &energy);
    assert_near(moment[0] / (d * kappa * 1.3), 1, IS_SINGLE ? 0.01 : 1e-6);
    assert_near(moment[1] / (d * kappa * 1.3), 1, 0.01);
    assert_near(energy / (d * kappa * kappa * 1.3), 1, IS_SINGLE ? 0.02 : 1e-6);
    if (!IS_SINGLE)
        for (int side = 0; side < 2; side++)
            assert_near(mises[side] / (6 * d * kappa * 1.3 / 1e-4), 1, 0.01);
    assert_near(moment[2] / (d * kappa), 0, 0.01);
    bend_plate("midedge", kappa, 0, moment, mises, &energy);
    assert_near(moment[0] / (d * kappa), 1, 0.01);
    assert_near(moment[1] / (0.3 * d * kappa), 1, 0.01);
}

/* hinges of right triangles in rows carry D kappa along x, without Poisson's ratio */
static void test_hinges(void **unused)
{
    (void)unused;
    const double d = pel_bending_stiffness(1e9, 0.3, 0.01), kappa = IS_SINGLE ? 1e-2 : 1e-4;
    double moment[3], mises[2], energy, isometric[3];
    bend_plate("hinge", kappa, 0, moment, mises, &energy);
    assert_near(energy / (d * kappa * kappa / 2), 1, 0.02);
    /* work: M : kappa is twice the energy */
    assert_near(moment[0] * kappa / (2 * energy), 1, 0.02);
    bend_plate("isometric", kappa, 0, isometric, mises, &energy);
    assert_near(isometric[0] / moment[0], 1, 1e-3);
    assert_near(isometric[1] - moment[1], 0, 1e-3 * moment[0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),
        cmocka_unit_test(test_strip),
        cmocka_unit_test(test_plate),
        cmocka_unit_test(test_hinges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
