#include "gradient.h"
#include "pellicle/shape.h"
#include "random.h"
#include "sim/fixture.h"
#include "stage/stage.h"

#include "pellicle/measure.h"
#include "pellicle/sim_forces.h"
#include "pellicle/sim_ledger.h"
#include "pellicle/sim_surface.h"

/* rest positions times a factor; 1e-4 for differences and 1e-9 for sums of some hundred springs come from single too */
static void stretch(pel_sim *sim, const pel_mesh *mesh, double factor)
{
    double *x = malloc(3 * sizeof *x * (size_t)mesh->vertex_count);
    for (int32_t i = 0; i < 3 * mesh->vertex_count; i++)
        x[i] = factor * mesh->positions[i / 3][i % 3];
    assert_int_equal(pel_sim_set_positions(sim, 0, x, NULL), PEL_OK);
    free(x);
}

typedef struct stretched_body {
    pel_sim *sim;
    const pel_mesh *mesh;
} stretched_body;

static double spring_energy(const void *context, const double *log_size)
{
    const stretched_body *body = context;
    pel_sim_measures measures;
    stretch(body->sim, body->mesh, exp(*log_size));
    pel_sim_measure(body->sim, &measures);
    return measures.spring_energy;
}

/* the sum is d E / d ln s, with one stiffness and with one for each vertex */
static void test_virial_theorem(void **unused)
{
    (void)unused;
    random_state random = {4};
    pel_mesh *mesh = make_sphere(6);
    double *stiffness = malloc(sizeof *stiffness * (size_t)mesh->vertex_count);
    double *virials = malloc(sizeof *virials * (size_t)mesh->vertex_count);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        stiffness[v] = random_between(&random, 1, 5);
    for (int round = 0; round < 2; round++) {
        pel_body_def body = pel_body_def_default();
        body.name = "ball";
        body.mesh = mesh;
        body.spring_stiffness.field = round == 0 ? NULL : stiffness;
        pel_sim_def def = pel_sim_def_default();
        pel_model *model = make_model(&body);
        def.model = model;
        stretched_body stretched = {make_sim(&def), mesh};
        double log_size = 0.2, sum = 0;
        double derivative = numeric_derivative(spring_energy, &stretched, &log_size, 0, 0.02);
        stretch(stretched.sim, mesh, exp(0.2));
        pel_sim_get_spring_virials(stretched.sim, 0, virials);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            sum += virials[v];
        assert_near(sum / derivative, 1, sizeof(pel_real) == sizeof(double) ? 1e-8 : 1e-3);

        stretch(stretched.sim, mesh, 1);
        pel_sim_get_spring_virials(stretched.sim, 0, virials);
        for (int32_t v = 0; v < mesh->vertex_count; v++)
            assert_near(virials[v], 0, 1e-5);
        stretch(stretched.sim, mesh, 0.9);
        pel_sim_get_spring_virials(stretched.sim, 0, virials);
        assert_true(virials[0] < 0);
        pel_sim_destroy(stretched.sim);
        pel_model_destroy(model);
    }
    free(virials);
    free(stiffness);
    pel_mesh_destroy(mesh);
}

/* a net of equilateral triangles is a membrane with the tension sqrt(3) k eps of the rest lengths, now 1 + eps as long
 */
static void test_equilateral_net(void **unused)
{
    (void)unused;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GRID);
    shape.diagonals = PEL_GRID_EQUILATERAL;
    shape.nx = shape.ny = 8;
    shape.size_x = 8;
    shape.size_y = 8 * sqrt(3) / 2;
    pel_mesh *mesh;
    pel_topology *topology;
    assert_int_equal(pel_shape_create(&shape, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    pel_body_def body = pel_body_def_default();
    body.name = "net";
    body.mesh = mesh;
    body.spring_stiffness.value = 7;
    pel_model *model = make_model(&body);
    pel_sim_def def = pel_sim_def_default();
    def.model = model;
    pel_sim *sim = make_sim(&def);
    double *x = malloc(3 * sizeof *x * (size_t)mesh->vertex_count);
    double *virials = malloc(sizeof *virials * (size_t)mesh->vertex_count);
    const double eps = 0.01;
    stretch(sim, mesh, 1 + eps);
    pel_sim_get_positions(sim, 0, x);
    pel_sim_get_spring_virials(sim, 0, virials);
    int inner = 0;
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        pel_vertex_measure measure;
        pel_vertex_measure_fill(topology, x, v, &measure);
        /* beside the half triangles of the sides the net is another one */
        if (fabs(measure.area / (1 + eps) / (1 + eps) - sqrt(3) / 2) > 1e-5)
            continue;
        inner++;
        assert_near(virials[v] / (2 * measure.area), sqrt(3) * 7 * eps / (1 + eps), 1e-4);
    }
    assert_true(inner > 40);
    free(virials);
    free(x);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_topology_destroy(topology);
    pel_mesh_destroy(mesh);
}

static double refined_energy(const void *context, const double *log_size)
{
    const stretched_body *body = context;
    static double x[3 * 5000];
    pel_sim_measures measures;
    pel_sim_get_rest_positions(body->sim, 0, x);
    for (int32_t i = 0; i < 3 * pel_sim_vertex_count(body->sim, 0); i++)
        x[i] *= exp(*log_size);
    assert_int_equal(pel_sim_set_positions(body->sim, 0, x, NULL), PEL_OK);
    pel_sim_measure(body->sim, &measures);
    return measures.spring_energy;
}

/* the same where the body is refined in places, also after some of them were given up again: every row has its number,
   and their sum is d E / d ln s */
static void test_refined(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_sphere(6);
    pel_body_def body = ball_body(mesh);
    body.refine.levels = 3;
    pel_sim_def def = pel_sim_def_default();
    pel_model *model = make_model(&body);
    def.model = model;
    stretched_body refined = {make_sim(&def), mesh};
    const int32_t asked[5][2] = {{20, 3}, {100, 2}, {250, 1}, {20, 1}, {250, 0}};
    for (int i = 0; i < 5; i++) {
        assert_int_equal(pel_sim_refine(refined.sim, 0, asked[i][0], asked[i][1], NULL), PEL_OK);
        int32_t count = pel_sim_vertex_count(refined.sim, 0);
        assert_true(count > mesh->vertex_count);
        double *virials = malloc(sizeof *virials * (size_t)count), log_size = 0.2, sum = 0;
        for (int32_t r = 0; r < count; r++)
            virials[r] = (double)NAN;
        double derivative = numeric_derivative(refined_energy, &refined, &log_size, 0, 0.02);
        refined_energy(&refined, &log_size);
        pel_sim_get_spring_virials(refined.sim, 0, virials);
        for (int32_t r = 0; r < count; r++) {
            assert_true(virials[r] > 0);
            sum += virials[r];
        }
        assert_near(sum / derivative, 1, sizeof(pel_real) == sizeof(double) ? 1e-8 : 1e-3);
        free(virials);
    }
    pel_sim_destroy(refined.sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refined),
        cmocka_unit_test(test_virial_theorem),
        cmocka_unit_test(test_equilateral_net),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
