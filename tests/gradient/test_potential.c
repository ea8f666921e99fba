#include "failing_malloc.h"
#include "pellicle/potential.h"
#include "pellicle/sim_forces.h"
#include "random.h"
#include "sim/fixture.h"
#include "stage/stage.h"

#include <string.h>

typedef struct made {
    pel_mesh *mesh;
    pel_model *model;
    pel_sim *sim;
    double *x, *way; /* (3 vertex_count) a deformed state, and a direction */
    size_t count;    /* 3 vertex_count */
} made;

static pel_body_def shell_with_gas(const pel_mesh *mesh, pel_bending_model bending)
{
    pel_body_def body = ball_body(mesh);
    body.shell.membrane.on = true;
    body.shell.membrane.young.value = 500;
    body.shell.membrane.poisson = 0.3;
    body.shell.membrane.thickness.value = 0.01;
    body.shell.bending.model = bending;
    body.shell.pressure.kind = PEL_PRESSURE_GAS;
    body.shell.pressure.value = 3;
    return body;
}

static made make(pel_bending_model bending, pel_method method)
{
    made m = {.mesh = make_sphere(3)};
    pel_body_def body = shell_with_gas(m.mesh, bending);
    m.model = make_model(&body);
    pel_load_def load = pel_load_def_default();
    load.force[0] = 2;
    pel_sim_def def = lone_sim(m.model, method, 0.001);
    def.loads = &load;
    def.load_count = 1;
    m.sim = make_sim(&def);
    m.count = 3 * (size_t)m.mesh->vertex_count;
    m.x = malloc(m.count * sizeof *m.x);
    m.way = malloc(m.count * sizeof *m.way);
    random_state random = {5};
    for (size_t i = 0; i < m.count; i++) {
        m.x[i] = (1 + 0.1 * (double)(i % 3)) * m.mesh->positions[i / 3][i % 3] + random_between(&random, -0.02, 0.02);
        m.way[i] = random_between(&random, -1, 1);
    }
    return m;
}

static void destroy(made *m)
{
    free(m->x);
    free(m->way);
    pel_sim_destroy(m->sim);
    pel_model_destroy(m->model);
    pel_mesh_destroy(m->mesh);
}

static double dot(const double *a, const double *b, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += a[i] * b[i];
    return sum;
}

/* the state plus a share of the way */
static double *moved(const made *m, double share)
{
    double *x = malloc(m->count * sizeof *x);
    for (size_t i = 0; i < m->count; i++)
        x[i] = m->x[i] + share * m->way[i];
    return x;
}

static double evaluate(pel_potential *potential, const made *m, double share, double *gradient)
{
    double energy, *x = moved(m, share);
    assert_int_equal(pel_potential_evaluate(potential, x, &energy, gradient, NULL), PEL_OK);
    free(x);
    return energy;
}

/* rounding of energies of some joules, and of masses and rest lengths in float, which derivatives do not see */
#define STEP 1e-5
#define TOLERANCE 1e-7

static void test_gradient(void **unused)
{
    (void)unused;
    const pel_bending_model bendings[] = {PEL_BENDING_HINGE, PEL_BENDING_ISOMETRIC_REST, PEL_BENDING_MIDEDGE};
    for (size_t b = 0; b < sizeof bendings / sizeof *bendings; b++) {
        made m = make(bendings[b], bendings[b] == PEL_BENDING_MIDEDGE ? PEL_METHOD_STATIC : PEL_METHOD_XPBD);
        pel_potential *potential;
        assert_int_equal(pel_potential_create(m.sim, &potential, NULL), PEL_OK);
        assert_int_equal(pel_potential_vertex_count(potential), m.mesh->vertex_count);
        double *gradient = malloc(m.count * sizeof *gradient);
        evaluate(potential, &m, 0, gradient);
        double expected = (evaluate(potential, &m, STEP, NULL) - evaluate(potential, &m, -STEP, NULL)) / (2 * STEP);
        assert_near(dot(gradient, m.way, m.count) / expected, 1, TOLERANCE);
        free(gradient);
        pel_potential_destroy(potential);
        destroy(&m);
    }
}

/* the product of the Hessian, outer products included, with the way */
static void multiply(const pel_hessian *h, const double *way, double *product)
{
    for (int32_t r = 0; r < h->row_count; r++) {
        product[r] = 0;
        for (int32_t i = h->row_start[r]; i < h->row_start[r + 1]; i++) {
            assert_true(i == h->row_start[r] || h->columns[i] > h->columns[i - 1]);
            product[r] += h->values[i] * way[h->columns[i]];
        }
    }
    for (int32_t p = 0; p < h->rank_one_count; p++) {
        const double *g = h->volume_gradients + (size_t)p * (size_t)h->row_count;
        double scale = h->coefficients[p] * dot(g, way, (size_t)h->row_count);
        for (int32_t r = 0; r < h->row_count; r++)
            product[r] += scale * g[r];
    }
}

static void test_hessian(void **unused)
{
    (void)unused;
    made m = make(PEL_BENDING_HINGE, PEL_METHOD_XPBD);
    pel_potential *potential;
    pel_hessian *hessian;
    assert_int_equal(pel_potential_create(m.sim, &potential, NULL), PEL_OK);
    assert_int_equal(pel_potential_hessian(potential, m.x, &hessian, NULL), PEL_OK);
    assert_int_equal(hessian->row_count, (int)m.count);
    assert_int_equal(hessian->rank_one_count, 1);
    double *product = malloc(m.count * sizeof *product), *after = malloc(m.count * sizeof *after);
    double *before = malloc(m.count * sizeof *before), largest = 0, wrong = 0;
    multiply(hessian, m.way, product);
    evaluate(potential, &m, STEP, after);
    evaluate(potential, &m, -STEP, before);
    for (size_t i = 0; i < m.count; i++) {
        largest = fmax(largest, fabs(product[i]));
        wrong = fmax(wrong, fabs(product[i] - (after[i] - before[i]) / (2 * STEP)));
    }
    assert_true(wrong < TOLERANCE * largest);
    free(product);
    free(after);
    free(before);
    pel_hessian_destroy(hessian);
    pel_potential_destroy(potential);
    destroy(&m);
}

/* bodies at rest: the same terms as in the forces of the simulation */
static void test_forces(void **unused)
{
    (void)unused;
    made m = make(PEL_BENDING_HINGE, PEL_METHOD_XPBD);
    pel_potential *potential;
    assert_int_equal(pel_sim_set_positions(m.sim, 0, m.x, NULL), PEL_OK);
    pel_sim_get_positions(m.sim, 0, m.x);
    assert_int_equal(pel_potential_create(m.sim, &potential, NULL), PEL_OK);
    double *gradient = malloc(m.count * sizeof *gradient), *forces = malloc(m.count * sizeof *forces), largest = 0;
    evaluate(potential, &m, 0, gradient);
    pel_sim_get_forces(m.sim, 0, forces);
    for (size_t i = 0; i < m.count; i++)
        largest = fmax(largest, fabs(forces[i]));
    for (size_t i = 0; i < m.count; i++)
        assert_near(gradient[i], -forces[i], IN_FLOAT(1e-11, 1e-4) * largest);
    free(gradient);
    free(forces);
    pel_potential_destroy(potential);
    destroy(&m);
}

static void test_refusals(void **unused)
{
    (void)unused;
    made m = make(PEL_BENDING_MIDEDGE, PEL_METHOD_STATIC);
    pel_potential *potential;
    pel_hessian *hessian;
    pel_error error;
    double energy;
    assert_int_equal(pel_potential_create(m.sim, &potential, NULL), PEL_OK);
    assert_int_equal(pel_potential_hessian(potential, m.x, &hessian, &error), PEL_BAD_ARGUMENT);
    assert_null(hessian);
    assert_non_null(strstr(error.what, "edges"));
    m.x[7] = (double)NAN;
    assert_int_equal(pel_potential_evaluate(potential, m.x, &energy, NULL, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(error.element, 2);
    pel_potential_destroy(potential);
    destroy(&m);

    pel_mesh *mesh = make_sphere(2);
    pel_body_def body = ball_body(mesh);
    body.refine.levels = 1;
    pel_model *model = make_model(&body);
    pel_sim_def def = lone_sim(model, PEL_METHOD_QUASI_STATIC, 0.01);
    pel_sim *sim = make_sim(&def);
    assert_int_equal(pel_potential_create(sim, &potential, &error), PEL_BAD_ARGUMENT);
    assert_null(potential);
    pel_sim_destroy(sim);
    pel_model_destroy(model);
    pel_mesh_destroy(mesh);
}

static pel_status create_and_use(const void *data, pel_error *error)
{
    const made *m = data;
    pel_potential *potential;
    pel_hessian *hessian;
    pel_status status = pel_potential_create(m->sim, &potential, error);
    if (status != PEL_OK)
        return status;
    status = pel_potential_hessian(potential, m->x, &hessian, error);
    pel_hessian_destroy(hessian);
    pel_potential_destroy(potential);
    return status;
}

static void test_allocations(void **unused)
{
    (void)unused;
    made m = make(PEL_BENDING_HINGE, PEL_METHOD_XPBD);
    for_every_allocation_failure(create_and_use, &m);
    destroy(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_gradient), cmocka_unit_test(test_hessian),
                                       cmocka_unit_test(test_forces), cmocka_unit_test(test_refusals),
                                       cmocka_unit_test(test_allocations)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
