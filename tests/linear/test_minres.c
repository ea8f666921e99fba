/* Minimal residuals on matrices that are indefinite, with a factor of a shifted one as preconditioner. */
#include "system.h"

#include "linear/factor.h"
#include "linear/jacobi.h"
#include "linear/minres.h"

typedef struct fixture {
    test_system s;
    pel_matrix *m;
    pel_minres *minres;
    double *right, *x;
} fixture;

static fixture make_fixture(test_system s, double shift, random_state *random)
{
    fixture f = {.s = s, .m = test_matrix(&s, shift, NULL)};
    f.right = test_vector(s.unknown_count, random);
    f.x = test_vector(s.unknown_count, random);
    assert_int_equal(pel_minres_create(s.unknown_count, &f.minres, NULL), PEL_OK);
    return f;
}

static void release_fixture(fixture *f)
{
    pel_matrix_destroy(f->m);
    pel_minres_destroy(f->minres);
    test_system_release(&f->s);
    free(f->right);
    free(f->x);
}

/* y += -amount x: makes some eigenvalues negative */
static void lower(void *context, pel_pool *pool, const double *x, double *y)
{
    const double *amount = context;
    (void)pool;
    for (int i = 0; i < (int)amount[1]; i++)
        y[i] -= amount[0] * x[i];
}

static void test_indefinite(void **unused)
{
    (void)unused;
    random_state random = {11};
    for (int round = 0; round < 4; round++) {
        fixture f = make_fixture(test_grid_system(8, 3, &random), 1e-3, &random);
        pel_factor_plan *plan;
        pel_factor *factor;
        assert_int_equal(pel_factor_plan_create(f.m, NULL, &plan, NULL), PEL_OK);
        assert_int_equal(pel_factor_create(plan, PEL_FACTOR_DOUBLE, &factor, NULL), PEL_OK);
        assert_true(pel_factor_compute(factor, f.m, 0, NULL).positive_definite);
        double amount[2] = {0.05 * (1 + round), f.s.unknown_count};
        pel_pcg_def def = {.matrix = f.m,
                           .add_product = lower,
                           .added = amount,
                           .precondition = pel_factor_solve,
                           .preconditioner = factor,
                           .tolerance = 1e-11,
                           .iterations = 400};
        failing_malloc_begin(0);
        pel_pcg_result result = pel_minres_solve(f.minres, &def, NULL, f.right, f.x);
        assert_int_equal(failing_malloc_end().calls, 0);
        assert_int_equal(result.end, PEL_PCG_CONVERGED);
        double *y = calloc((size_t)f.s.unknown_count, sizeof *y), error = 0, size = 0;
        pel_matrix_multiply(f.m, NULL, f.x, y);
        lower(amount, NULL, f.x, y);
        for (int32_t i = 0; i < f.s.unknown_count; i++) {
            error += (f.right[i] - y[i]) * (f.right[i] - y[i]);
            size += f.right[i] * f.right[i];
        }
        assert_true(sqrt(error / size) < 1e-7);
        free(y);
        pel_factor_destroy(factor);
        pel_factor_plan_destroy(plan);
        release_fixture(&f);
    }
}

/* a right side of 0, and iterations used up */
static void test_ends(void **unused)
{
    (void)unused;
    random_state random = {12};
    fixture f = make_fixture(test_grid_system(6, 3, &random), 1e-3, &random);
    pel_jacobi *jacobi;
    assert_int_equal(pel_jacobi_create(f.m, &jacobi, NULL), PEL_OK);
    assert_true(pel_jacobi_compute(jacobi, f.m));
    pel_pcg_def def = {
        .matrix = f.m, .precondition = pel_jacobi_apply, .preconditioner = jacobi, .tolerance = 1e-12, .iterations = 2};
    assert_int_equal(pel_minres_solve(f.minres, &def, NULL, f.right, f.x).end, PEL_PCG_LIMIT);
    memset(f.right, 0, (size_t)f.s.unknown_count * sizeof *f.right);
    assert_int_equal(pel_minres_solve(f.minres, &def, NULL, f.right, f.x).end, PEL_PCG_CONVERGED);
    for (int32_t i = 0; i < f.s.unknown_count; i++)
        assert_true(f.x[i] == 0);
    pel_jacobi_destroy(jacobi);
    release_fixture(&f);
}

static pel_status create(const void *data, pel_error *error)
{
    const int32_t *count = data;
    pel_minres *minres;
    pel_status status = pel_minres_create(*count, &minres, error);
    if (status == PEL_OK)
        pel_minres_destroy(minres);
    return status;
}

static void test_allocation(void **unused)
{
    (void)unused;
    const int32_t count = 10;
    assert_int_equal(for_every_allocation_failure(create, &count), 9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_indefinite),
        cmocka_unit_test(test_ends),
        cmocka_unit_test(test_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
