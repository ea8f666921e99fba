/* Conjugate gradients with each preconditioner; matrices that are not positive definite; blocks of the diagonal. */
#include "system.h"

#include "linear/factor.h"
#include "linear/jacobi.h"
#include "linear/pcg.h"

typedef struct fixture {
    test_system s;
    pel_matrix *m;
    pel_pcg *pcg;
    double *right, *x;
} fixture;

static fixture make_fixture(test_system s, double shift, random_state *random)
{
    fixture f = {.s = s, .m = test_matrix(&s, shift, NULL)};
    f.right = test_vector(s.unknown_count, random);
    f.x = test_vector(s.unknown_count, random);
    assert_int_equal(pel_pcg_create(s.unknown_count, &f.pcg, NULL), PEL_OK);
    return f;
}

static void release_fixture(fixture *f)
{
    pel_matrix_destroy(f->m);
    pel_pcg_destroy(f->pcg);
    test_system_release(&f->s);
    free(f->right);
    free(f->x);
}

/* solves, and checks the residual of the result */
static pel_pcg_result solve(fixture *f, pel_preconditioner *precondition, void *context, double tolerance)
{
    pel_pcg_def def = {.matrix = f->m,
                       .precondition = precondition,
                       .preconditioner = context,
                       .tolerance = tolerance,
                       .iterations = 1000};
    failing_malloc_begin(0);
    pel_pcg_result result = pel_pcg_solve(f->pcg, &def, NULL, f->right, f->x);
    assert_int_equal(failing_malloc_end().calls, 0);
    if (result.end == PEL_PCG_CONVERGED) {
        assert_true(result.residual <= tolerance);
        assert_near(test_residual(f->m, f->right, f->x), result.residual, 1e-12);
    }
    return result;
}

static pel_factor *factor_of(const pel_matrix *m, pel_factor_plan **plan, pel_factor_precision precision)
{
    pel_factor *factor;
    assert_int_equal(pel_factor_plan_create(m, NULL, plan, NULL), PEL_OK);
    assert_int_equal(pel_factor_create(*plan, precision, &factor, NULL), PEL_OK);
    assert_true(pel_factor_compute(factor, m, 0, NULL).positive_definite);
    return factor;
}

static void test_preconditioners(void **unused)
{
    (void)unused;
    random_state random = {1};
    fixture f = make_fixture(test_grid_system(20, 4, &random), 0.01, &random);
    /* stiffness of very different size from node to node */
    double *stiff = test_vector(f.s.unknown_count, &random);
    for (int32_t i = 0; i < f.s.unknown_count; i++)
        stiff[i] = pow(10, fabs(stiff[i]));
    pel_matrix_add_diagonal(f.m, 1, stiff);
    pel_jacobi *jacobi;
    assert_int_equal(pel_jacobi_create(f.m, &jacobi, NULL), PEL_OK);
    assert_true(pel_jacobi_compute(jacobi, f.m));
    pel_pcg_result plain = solve(&f, NULL, NULL, 1e-8), blocks = solve(&f, pel_jacobi_apply, jacobi, 1e-8);
    assert_int_equal(plain.end, PEL_PCG_CONVERGED);
    assert_int_equal(blocks.end, PEL_PCG_CONVERGED);
    assert_true(blocks.iterations < plain.iterations);
    /* the smallest curvature bounds the least eigenvalue, which is the shift or above */
    assert_true(plain.curvature >= 0.01);

    pel_factor_plan *plan;
    pel_factor *factor = factor_of(f.m, &plan, PEL_FACTOR_FLOAT);
    pel_pcg_result present = solve(&f, pel_factor_solve, factor, 1e-10);
    assert_int_equal(present.end, PEL_PCG_CONVERGED);
    assert_in_range(present.iterations, 1, 5);
    /* an old factor: stiffness has changed by up to 30 % */
    for (int32_t e = 0; e < f.s.element_count; e++) {
        double factor_of_element = random_between(&random, 0.7, 1.3);
        for (int32_t i = 0; i < BLOCK_ROOM; i++)
            f.s.blocks[e * BLOCK_ROOM + i] *= factor_of_element;
    }
    pel_matrix_assemble(f.m, NULL, test_copy_blocks, &f.s);
    pel_matrix_add_diagonal(f.m, 1, stiff);
    pel_pcg_result old = solve(&f, pel_factor_solve, factor, 1e-10);
    assert_int_equal(old.end, PEL_PCG_CONVERGED);
    assert_in_range(old.iterations, present.iterations + 1, 30);
    pel_factor_destroy(factor);
    pel_factor_plan_destroy(plan);
    pel_jacobi_destroy(jacobi);
    free(stiff);
    release_fixture(&f);
}

/* start, limit, and a right side of zero */
static void test_ends(void **unused)
{
    (void)unused;
    random_state random = {2};
    fixture f = make_fixture(test_random_system(80, 300, &random), 0.5, &random);
    pel_pcg_def def = {
        .matrix = f.m, .precondition = NULL, .preconditioner = NULL, .tolerance = 1e-9, .iterations = 1000};
    pel_pcg_result cold = pel_pcg_solve(f.pcg, &def, NULL, f.right, f.x);
    assert_int_equal(cold.end, PEL_PCG_CONVERGED);
    def.has_start = true;
    assert_int_equal(pel_pcg_solve(f.pcg, &def, NULL, f.right, f.x).iterations, 0);
    f.x[3] += 1e-3;
    pel_pcg_result warm = pel_pcg_solve(f.pcg, &def, NULL, f.right, f.x);
    assert_int_equal(warm.end, PEL_PCG_CONVERGED);
    assert_true(warm.iterations > 0 && warm.iterations < cold.iterations);
    def.has_start = false;
    def.iterations = 3;
    pel_pcg_result cut = pel_pcg_solve(f.pcg, &def, NULL, f.right, f.x);
    assert_int_equal(cut.end, PEL_PCG_LIMIT);
    assert_int_equal(cut.iterations, 3);
    assert_near(test_residual(f.m, f.right, f.x), cut.residual, 1e-12);
    /* too slow for its limit: half of the iterations */
    def.iterations = 6;
    def.midway = 0.9 * cut.residual;
    pel_pcg_result slow = pel_pcg_solve(f.pcg, &def, NULL, f.right, f.x);
    assert_true(slow.end == PEL_PCG_LIMIT && slow.iterations == 3 && slow.residual == cut.residual);
    def.midway = 1.1 * cut.residual;
    assert_int_equal(pel_pcg_solve(f.pcg, &def, NULL, f.right, f.x).iterations, 6);
    def.midway = 0;
    f.right[0] = (double)NAN;
    assert_int_equal(pel_pcg_solve(f.pcg, &def, NULL, f.right, f.x).end, PEL_PCG_BROKEN);
    memset(f.right, 0, (size_t)f.s.unknown_count * sizeof *f.right);
    pel_pcg_result zero = pel_pcg_solve(f.pcg, &def, NULL, f.right, f.x);
    assert_int_equal(zero.end, PEL_PCG_CONVERGED);
    assert_true(zero.residual == 0 && f.x[0] == 0);
    release_fixture(&f);
}

static void negate(void *context, pel_pool *pool, const double *x, double *y)
{
    (void)pool;
    for (int32_t i = 0; i < *(const int32_t *)context; i++)
        y[i] = -x[i];
}

/* an indefinite matrix: the direction that is handed back has the curvature that is told */
static void test_indefinite(void **unused)
{
    (void)unused;
    random_state random = {3};
    fixture f = make_fixture(test_random_system(80, 100, &random), -0.5, &random);
    pel_pcg_def def = {
        .matrix = f.m, .precondition = NULL, .preconditioner = NULL, .tolerance = 1e-9, .iterations = 1000};
    pel_pcg_result result = pel_pcg_solve(f.pcg, &def, NULL, f.right, f.x);
    assert_int_equal(result.end, PEL_PCG_INDEFINITE);
    assert_non_null(result.direction);
    double *product = test_vector(f.s.unknown_count, &random), curvature = 0, size = 0;
    pel_matrix_multiply(f.m, NULL, result.direction, product);
    for (int32_t i = 0; i < f.s.unknown_count; i++) {
        curvature += result.direction[i] * product[i];
        size += result.direction[i] * result.direction[i];
    }
    assert_true(curvature <= 0);
    assert_near(curvature / size, result.curvature, 1e-9);
    /* a preconditioner that is not positive */
    def.precondition = negate;
    def.preconditioner = &f.s.unknown_count;
    assert_int_equal(pel_pcg_solve(f.pcg, &def, NULL, f.right, f.x).end, PEL_PCG_BROKEN);
    free(product);
    release_fixture(&f);
}

/* same bits with any number of threads */
static void test_threads(void **unused)
{
    (void)unused;
    random_state random = {4};
    fixture f = make_fixture(test_grid_system(60, 3, &random), 0.1, &random);
    pel_jacobi *jacobi;
    assert_int_equal(pel_jacobi_create(f.m, &jacobi, NULL), PEL_OK);
    assert_true(pel_jacobi_compute(jacobi, f.m));
    assert_int_equal(solve(&f, pel_jacobi_apply, jacobi, 1e-6).end, PEL_PCG_CONVERGED);
    double *first = f.x;
    f.x = test_vector(f.s.unknown_count, &random);
    for (int threads = 2; threads <= 4; threads *= 2) {
        pel_pool *pool;
        assert_int_equal(pel_pool_create(threads, &pool, NULL), PEL_OK);
        pel_pcg_def def = {.matrix = f.m,
                           .precondition = pel_jacobi_apply,
                           .preconditioner = jacobi,
                           .tolerance = 1e-6,
                           .iterations = 1000};
        pel_pcg_solve(f.pcg, &def, pool, f.right, f.x);
        assert_memory_equal(f.x, first, (size_t)f.s.unknown_count * sizeof *first);
        pel_pool_destroy(pool);
    }
    free(first);
    pel_jacobi_destroy(jacobi);
    release_fixture(&f);
}

/* blocks without coupling: Jacobi is the inverse, and nodes without a positive definite block take their diagonal */
static void test_jacobi(void **unused)
{
    (void)unused;
    random_state random = {5};
    test_system s = test_system_make(12, 40, 6, &random);
    for (int32_t i = 0; i < 40; i++)
        test_add_element(&s, (int32_t[]){i % 12}, 1, 0);
    test_fill_blocks(&s, &random);
    fixture f = make_fixture(s, 1, &random);
    pel_jacobi *jacobi;
    assert_int_equal(pel_jacobi_create(f.m, &jacobi, NULL), PEL_OK);
    assert_true(pel_jacobi_compute(jacobi, f.m));
    pel_jacobi_apply(jacobi, NULL, f.right, f.x);
    assert_true(test_residual(f.m, f.right, f.x) < 1e-12);
    int32_t first = s.first_unknown[7], size = test_node_size(&s, 7);
    double *block = &f.m->values[f.m->block_start[pel_matrix_block(f.m, 7, 7)]];
    /* by the diagonal where a block is not definite; by nothing where that is 0 */
    for (int32_t i = 0; i < size * size; i++)
        block[i] = i % (size + 1) == 0 ? -4 : 0;
    block[0] = 0;
    assert_false(pel_jacobi_compute(jacobi, f.m));
    pel_jacobi_apply(jacobi, NULL, f.right, f.x);
    for (int32_t a = 0; a < size; a++)
        assert_near(f.x[first + a], f.right[first + a] / (a == 0 ? 1 : 4), 1e-15);
    pel_jacobi_destroy(jacobi);
    release_fixture(&f);
}

static pel_status create_pcg(const void *data, pel_error *error)
{
    pel_pcg *pcg;
    pel_jacobi *jacobi = NULL;
    pel_status status = pel_pcg_create(5000, &pcg, error);
    assert_true((pcg == NULL) == (status != PEL_OK));
    if (status == PEL_OK) {
        status = pel_jacobi_create(data, &jacobi, error);
        assert_true((jacobi == NULL) == (status != PEL_OK));
    }
    pel_jacobi_destroy(jacobi);
    pel_pcg_destroy(pcg);
    return status;
}

static void test_allocation_failure(void **unused)
{
    (void)unused;
    random_state random = {6};
    fixture f = make_fixture(test_random_system(8, 10, &random), 1, &random);
    assert_int_equal(for_every_allocation_failure(create_pcg, f.m), 6);
    release_fixture(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_preconditioners), cmocka_unit_test(test_ends),
        cmocka_unit_test(test_indefinite),      cmocka_unit_test(test_threads),
        cmocka_unit_test(test_jacobi),          cmocka_unit_test(test_allocation_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
