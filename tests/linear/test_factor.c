/* Factors against dense solutions, in float and double, with any number of threads; matrices that have none. */
#include "system.h"

#include "base/hash.h"
#include "base/memory.h"
#include "linear/factor.h"
#include "linear/factor_plan.h"

static pel_factor_plan *plan_of(const pel_matrix *m, const test_system *s, bool has_places)
{
    pel_factor_plan *plan;
    const double(*places)[3] = has_places ? (const double(*)[3])s->places : NULL;
    assert_int_equal(pel_factor_plan_create(m, places, &plan, NULL), PEL_OK);
    return plan;
}

/* products of reduced vectors are those of a right side with a solution: of a full one and of one entry */
static void check_reduced(pel_factor *factor, const double *right, const double *solution, int32_t n, double tolerance)
{
    double *one = calloc((size_t)n, sizeof *one), *reduced[2];
    one[n / 2] = 1;
    for (int k = 0; k < 2; k++) {
        reduced[k] = malloc((size_t)n * sizeof *reduced[k]);
        pel_factor_reduce(factor, NULL, k == 0 ? right : one, reduced[k]);
    }
    double product = 0, square[2] = {0, 0};
    for (int32_t i = 0; i < n; i++) {
        product += reduced[0][i] * reduced[1][i];
        for (int k = 0; k < 2; k++)
            square[k] += reduced[k][i] * reduced[k][i];
    }
    assert_near(product, solution[n / 2], tolerance * sqrt(square[0] * square[1]));
    for (int k = 0; k < 2; k++)
        free(reduced[k]);
    free(one);
}

/* solves with both precisions against the dense solution */
static void check_system(const test_system *s, double shift, bool has_places, random_state *random)
{
    int32_t n = s->unknown_count;
    pel_matrix *m = test_matrix(s, shift, NULL);
    pel_factor_plan *plan = plan_of(m, s, has_places);
    double *dense = test_dense(s, shift), *right = test_vector(n, random), *x = test_vector(n, random);
    double *expected = malloc((size_t)n * sizeof *expected), largest = 0;
    memcpy(expected, right, (size_t)n * sizeof *right);
    test_dense_solve(dense, n, expected);
    for (int32_t i = 0; i < n; i++)
        largest = fmax(largest, fabs(expected[i]));
    for (int precision = PEL_FACTOR_FLOAT; precision <= PEL_FACTOR_DOUBLE; precision++) {
        pel_factor *factor;
        assert_int_equal(pel_factor_create(plan, (pel_factor_precision)precision, &factor, NULL), PEL_OK);
        pel_factor_result result = pel_factor_compute(factor, m, 0, NULL);
        assert_true(result.positive_definite && result.node == -1 && result.component == -1);
        assert_true(result.pivot > 0 && result.pivot <= 1);
        pel_factor_solve(factor, NULL, right, x);
        assert_true(test_residual(m, right, x) < (precision == PEL_FACTOR_FLOAT ? 1e-5 : 1e-12));
        for (int32_t i = 0; i < n; i++)
            assert_near(x[i], expected[i], (precision == PEL_FACTOR_FLOAT ? 1e-4 : 1e-11) * largest);
        check_reduced(factor, right, expected, n, precision == PEL_FACTOR_FLOAT ? 1e-4 : 1e-11);
        pel_factor_destroy(factor);
    }
    pel_factor_plan_destroy(plan);
    pel_matrix_destroy(m);
    free(dense);
    free(right);
    free(x);
    free(expected);
}

static void test_random_systems(void **unused)
{
    (void)unused;
    random_state random = {1};
    for (int round = 0; round < ROUNDS(40, 4); round++) {
        int32_t nodes = (int32_t)random_integer(&random, 1, 120);
        test_system s = test_random_system(nodes, (int32_t)random_integer(&random, 0, 4 * nodes), &random);
        check_system(&s, 2, round % 2 == 0, &random);
        test_system_release(&s);
    }
}

/* every node with every other: one large front, several blocks of pivots, all pieces of shared fronts */
static void test_dense_system(void **unused)
{
    (void)unused;
    random_state random = {2};
    int32_t nodes = ROUNDS(160, 50);
    test_system s = test_system_make(nodes, nodes * nodes, -3, &random);
    for (int32_t i = 0; i < nodes; i++)
        for (int32_t j = 0; j < i; j++)
            test_add_element(&s, (int32_t[]){i, j}, 2, 0);
    test_fill_blocks(&s, &random);
    check_system(&s, 10, true, &random);
    test_system_release(&s);
}

/* a grid of many fronts: same bits with any number of threads, GCC and Clang, AVX2 and none; no allocation, residual;
 * the right side in place */
static void test_threads(void **unused)
{
    (void)unused;
    random_state random = {3};
    const uint64_t bits[] = {0x68fc67d6bcbe36a4u, 0x1e7787ede58a5bffu};
    test_system s = test_grid_system(ROUNDS(70, 30), -3, &random);
    pel_matrix *m = test_matrix(&s, 1, NULL);
    pel_factor_plan *plan = plan_of(m, &s, true);
    assert_true(plan->task_count > 4 && plan->upper_count > 4);
    size_t bytes = (size_t)s.unknown_count * sizeof(double);
    double *right = test_vector(s.unknown_count, &random), *x[3] = {malloc(bytes), malloc(bytes), malloc(bytes)};
    for (int precision = PEL_FACTOR_FLOAT; precision <= PEL_FACTOR_DOUBLE; precision++) {
        for (int k = 0; k < 3; k++) {
            pel_pool *pool;
            pel_factor *factor;
            assert_int_equal(pel_pool_create(1 << k, &pool, NULL), PEL_OK);
            assert_int_equal(pel_factor_create(plan, (pel_factor_precision)precision, &factor, NULL), PEL_OK);
            assert_true(pel_factor_compute(factor, m, 0, pool).positive_definite);
            memcpy(x[k], right, bytes);
            failing_malloc_begin(0);
            pel_factor_compute(factor, m, 0, pool);
            pel_factor_solve(factor, pool, x[k], x[k]);
            assert_int_equal(failing_malloc_end().calls, 0);
            pel_factor_destroy(factor);
            pel_pool_destroy(pool);
        }
        assert_memory_equal(x[0], x[1], bytes);
        assert_memory_equal(x[0], x[2], bytes);
        uint64_t hash = pel_hash_bytes(PEL_HASH_START, x[0], bytes);
        assert_true(is_slow() || hash == bits[precision]);
        assert_true(test_residual(m, right, x[0]) < (precision == PEL_FACTOR_FLOAT ? 1e-5 : 1e-12));
    }
    pel_factor_plan_destroy(plan);
    pel_matrix_destroy(m);
    test_system_release(&s);
    free(right);
    for (int k = 0; k < 3; k++)
        free(x[k]);
}

/* float holds stiffness and forces of any unit, also of units that differ from unknown to unknown */
static void test_units(void **unused)
{
    (void)unused;
    random_state random = {4};
    test_system s = test_random_system(40, 150, &random);
    double *unit = test_vector(s.unknown_count, &random);
    for (int32_t i = 0; i < s.unknown_count; i++)
        unit[i] = pow(10, random_between(&random, -30, 30));
    for (int32_t e = 0; e < s.element_count; e++) {
        int32_t size = test_element_size(&s, e), unknowns[PEL_ELEMENT_SIZE_LIMIT], count = 0;
        for (int32_t i = s.start[e]; i < s.start[e + 1]; i++)
            for (int32_t a = 0; a < test_node_size(&s, s.nodes[i]); a++)
                unknowns[count++] = s.first_unknown[s.nodes[i]] + a;
        for (int32_t i = 0; i < size; i++)
            for (int32_t j = 0; j < size; j++)
                s.blocks[e * BLOCK_ROOM + i * size + j] *= unit[unknowns[i]] * unit[unknowns[j]];
    }
    pel_matrix *m = test_matrix(&s, 0, NULL);
    double *squares = test_vector(s.unknown_count, &random), *right = test_vector(s.unknown_count, &random);
    double *exact = test_vector(s.unknown_count, &random), *x = test_vector(s.unknown_count, &random);
    for (int32_t i = 0; i < s.unknown_count; i++) {
        squares[i] = unit[i] * unit[i];
        exact[i] /= unit[i];
    }
    pel_matrix_add_diagonal(m, 1, squares);
    pel_matrix_multiply(m, NULL, exact, right);
    pel_factor_plan *plan = plan_of(m, &s, false);
    pel_factor *factor;
    assert_int_equal(pel_factor_create(plan, PEL_FACTOR_FLOAT, &factor, NULL), PEL_OK);
    assert_true(pel_factor_compute(factor, m, 0, NULL).positive_definite);
    pel_factor_solve(factor, NULL, right, x);
    for (int32_t i = 0; i < s.unknown_count; i++)
        assert_near(x[i] * unit[i], exact[i] * unit[i], 1e-3);
    /* no right side */
    memset(right, 0, (size_t)s.unknown_count * sizeof *right);
    pel_factor_solve(factor, NULL, right, x);
    for (int32_t i = 0; i < s.unknown_count; i++)
        assert_true(x[i] == 0);
    pel_factor_destroy(factor);
    pel_factor_plan_destroy(plan);
    pel_matrix_destroy(m);
    test_system_release(&s);
    free(unit);
    free(squares);
    free(right);
    free(exact);
    free(x);
}

/* the first pivot that is not positive, by elimination of the dense matrix in the order of the plan; -1 = none */
static int32_t first_bad_pivot(const double *dense, int32_t n, const pel_factor_plan *plan)
{
    double *a = malloc((size_t)n * (size_t)n * sizeof *a);
    const int32_t *u = plan->front_unknown;
    int32_t bad = -1;
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j < n; j++)
            a[i * n + j] = dense[u[i] * n + u[j]];
    for (int32_t k = 0; k < n && bad < 0; k++) {
        if (!(a[k * n + k] > 0))
            bad = k;
        for (int32_t i = k + 1; i < n; i++)
            for (int32_t j = k + 1; j < n && bad < 0; j++)
                a[i * n + j] -= a[i * n + k] * a[k * n + j] / a[k * n + k];
    }
    free(a);
    return bad < 0 ? -1 : u[bad];
}

/* a matrix that is not positive definite is refused at the pivot where elimination fails, by any number of threads */
static void test_indefinite(void **unused)
{
    (void)unused;
    random_state random = {5};
    int refused = 0;
    for (int round = 0; round < ROUNDS(20, 3); round++) {
        test_system s = test_random_system(60, 200, &random);
        double shift = random_between(&random, -1.5, 0.5);
        pel_matrix *m = test_matrix(&s, shift, NULL);
        pel_factor_plan *plan = plan_of(m, &s, round % 2 == 0);
        double *dense = test_dense(&s, shift);
        bool has_bad_diagonal = false;
        for (int32_t i = 0; i < s.unknown_count; i++)
            has_bad_diagonal = has_bad_diagonal || !(dense[i * (s.unknown_count + 1)] > 0);
        int32_t bad = first_bad_pivot(dense, s.unknown_count, plan);
        for (int threads = 1; threads <= 4 && !has_bad_diagonal; threads *= 2) {
            pel_pool *pool;
            pel_factor *factor;
            assert_int_equal(pel_pool_create(threads, &pool, NULL), PEL_OK);
            assert_int_equal(pel_factor_create(plan, PEL_FACTOR_DOUBLE, &factor, NULL), PEL_OK);
            pel_factor_result result = pel_factor_compute(factor, m, 0, pool);
            assert_int_equal(result.positive_definite, bad < 0);
            if (bad >= 0) {
                assert_int_equal(s.first_unknown[result.node] + result.component, bad);
                assert_true(result.pivot <= 1e-15);
                /* a shift above the deficit gives a factor */
                assert_true(pel_factor_compute(factor, m, 100, pool).positive_definite);
            }
            pel_factor_destroy(factor);
            pel_pool_destroy(pool);
        }
        refused += bad >= 0 && !has_bad_diagonal;
        free(dense);
        pel_factor_plan_destroy(plan);
        pel_matrix_destroy(m);
        test_system_release(&s);
    }
    assert_true(refused >= ROUNDS(5, 1));
}

/* takes most of the diagonal of a node away, in both matrices */
static void weaken(pel_matrix *m, double *dense, int32_t node)
{
    double *entry = &m->values[m->block_start[pel_matrix_block(m, node, node)]];
    dense[m->first_unknown[node] * (m->unknown_count + 1)] -= 0.999 * *entry;
    *entry *= 0.001;
}

/* pivots that fail in an upper front and in a task that comes later in the order: the first one is told */
static void test_indefinite_above(void **unused)
{
    (void)unused;
    random_state random = {9};
    test_system s = test_grid_system(24, -1, &random);
    pel_matrix *m = test_matrix(&s, 0.1, NULL);
    pel_factor_plan *plan = plan_of(m, &s, true);
    pel_factor *factor;
    double *dense = test_dense(&s, 0.1);
    int32_t upper = plan->upper[0], later = -1;
    for (int32_t t = 0; t < plan->task_count; t++)
        later = plan->tasks[t].first_front > upper ? plan->tasks[t].last_front - 1 : later;
    assert_true(later > upper);
    weaken(m, dense, plan->order[plan->fronts[upper].first_node]);
    weaken(m, dense, plan->order[plan->fronts[later].first_node]);
    int32_t bad = first_bad_pivot(dense, s.unknown_count, plan);
    assert_true(bad >= 0);
    int32_t place = 0;
    while (plan->front_unknown[place] != bad)
        place++;
    assert_in_range(place, plan->fronts[upper].first_pivot, plan->fronts[upper + 1].first_pivot - 1);
    assert_int_equal(pel_factor_create(plan, PEL_FACTOR_DOUBLE, &factor, NULL), PEL_OK);
    pel_factor_result result = pel_factor_compute(factor, m, 0, NULL);
    assert_false(result.positive_definite);
    assert_int_equal(s.first_unknown[result.node] + result.component, bad);
    free(dense);
    pel_factor_destroy(factor);
    pel_factor_plan_destroy(plan);
    pel_matrix_destroy(m);
    test_system_release(&s);
}

/* A chain of springs without a support is singular: its last pivot is rounding, of one sign or the other. One support
   makes it regular. NaN and an empty row are named. */
static void test_singular(void **unused)
{
    (void)unused;
    random_state random = {6};
    enum { COUNT = 200 };
    test_system s = test_system_make(COUNT, COUNT, -1, &random);
    for (int32_t i = 0; i + 1 < COUNT; i++) {
        test_add_element(&s, (int32_t[]){i, i + 1}, 2, 0);
        const double spring[4] = {1.7, -1.7, -1.7, 1.7};
        memcpy(&s.blocks[i * BLOCK_ROOM], spring, sizeof spring);
    }
    pel_matrix *m = test_matrix(&s, 0, NULL);
    pel_factor_plan *plan = plan_of(m, &s, false);
    for (int precision = PEL_FACTOR_FLOAT; precision <= PEL_FACTOR_DOUBLE; precision++) {
        pel_factor *factor;
        assert_int_equal(pel_factor_create(plan, (pel_factor_precision)precision, &factor, NULL), PEL_OK);
        pel_matrix_assemble(m, NULL, test_copy_blocks, &s);
        pel_factor_result result = pel_factor_compute(factor, m, 0, NULL);
        assert_true(result.pivot < (precision == PEL_FACTOR_FLOAT ? 1e-5 : 1e-13));
        assert_true(result.positive_definite || result.node == plan->order[COUNT - 1]);
        assert_true(pel_factor_compute(factor, m, 1e-4, NULL).positive_definite);
        double *diagonal = &m->values[m->block_start[pel_matrix_block(m, 77, 77)]], kept = *diagonal;
        *diagonal += 1;
        result = pel_factor_compute(factor, m, 0, NULL);
        assert_true(result.positive_definite && result.pivot > 1e-4);
        m->values[m->block_start[pel_matrix_block(m, 50, 51)]] = (double)NAN;
        m->values[m->block_start[pel_matrix_block(m, 51, 50)]] = (double)NAN;
        result = pel_factor_compute(factor, m, 0, NULL);
        assert_false(result.positive_definite);
        assert_in_range(result.node, 50, 51);
        *diagonal = 0;
        result = pel_factor_compute(factor, m, 0, NULL);
        assert_false(result.positive_definite);
        assert_int_equal(result.node, 77);
        *diagonal = kept;
        pel_factor_destroy(factor);
    }
    pel_factor_plan_destroy(plan);
    pel_matrix_destroy(m);
    test_system_release(&s);
}

/* the plan counts what a symbolic elimination of its own order gives, plus the zeros that it chose to hold */
static void test_plan(void **unused)
{
    (void)unused;
    random_state random = {7};
    test_system s = test_grid_system(40, -1, &random);
    pel_matrix *m = test_matrix(&s, 1, NULL);
    pel_factor_plan *plan = plan_of(m, &s, true);
    int32_t n = s.node_count;
    bool *filled = calloc((size_t)n * (size_t)n, sizeof *filled);
    int32_t *position = calloc((size_t)n, sizeof *position);
    for (int32_t i = 0; i < n; i++)
        position[plan->order[i]] = i;
    for (int32_t i = 0; i < n; i++)
        for (int32_t block = m->row_start[i]; block < m->row_start[i + 1]; block++)
            filled[position[i] * n + position[m->column[block]]] = true;
    int64_t entries = 0, held = 0;
    double operations = 0;
    for (int32_t k = 0; k < n; k++) {
        int64_t count = 0;
        for (int32_t i = k + 1; i < n; i++) {
            count += filled[i * n + k];
            for (int32_t j = k + 1; j < n && filled[i * n + k]; j++)
                filled[i * n + j] |= filled[j * n + k];
        }
        entries += count + 1;
        operations += (double)(count * count + 2 * count);
    }
    for (int32_t f = 0; f < plan->front_count; f++) {
        int64_t w = plan->fronts[f].pivot_count, r = plan->fronts[f].border_count;
        held += w * (w + 1) / 2 + w * r;
    }
    pel_factor_cost cost = pel_factor_plan_cost(plan);
    assert_true(held >= entries && held < 2 * entries);
    assert_true(cost.entries >= held && cost.operations > 0.9 * operations);
    /* update matrices leave when they are added */
    int64_t all_updates = 0;
    for (int32_t f = 0; f < plan->front_count; f++)
        all_updates += (int64_t)pel_front_update_stride(&plan->fronts[f]) * plan->fronts[f].border_count;
    assert_true(100 * plan->work_count < 87 * all_updates);
    assert_true(cost.bytes[PEL_FACTOR_FLOAT] > 4 * (size_t)cost.entries);
    assert_true(cost.bytes[PEL_FACTOR_DOUBLE] > 8 * (size_t)cost.entries);
    free(filled);
    free(position);
    pel_factor_plan_destroy(plan);
    pel_matrix_destroy(m);
    test_system_release(&s);
}

static pel_status create_factor(const void *data, pel_error *error)
{
    const pel_matrix *m = data;
    pel_factor_plan *plan;
    pel_factor *factor = NULL;
    pel_status status = pel_factor_plan_create(m, NULL, &plan, error);
    assert_true((plan == NULL) == (status != PEL_OK));
    if (status == PEL_OK) {
        status = pel_factor_create(plan, PEL_FACTOR_FLOAT, &factor, error);
        assert_true((factor == NULL) == (status != PEL_OK));
    }
    pel_factor_destroy(factor);
    pel_factor_plan_destroy(plan);
    return status;
}

/* said with its size before anything is allocated */
static void test_too_large(void **unused)
{
    (void)unused;
    random_state random = {3};
    test_system s = test_random_system(10, 20, &random);
    pel_matrix *m = test_matrix(&s, 2, NULL);
    pel_factor_plan *plan = plan_of(m, &s, false);
    pel_factor *factor;
    pel_error error;
    assert_true(pel_memory_limit() > 1e6);
    plan->cost.bytes[PEL_FACTOR_DOUBLE] = 2000000000000000;
    assert_int_equal(pel_factor_create(plan, PEL_FACTOR_DOUBLE, &factor, &error), PEL_OUT_OF_MEMORY);
    assert_null(factor);
    assert_non_null(strstr(error.what, "needs 2e+06 GB; "));
    assert_int_equal(pel_factor_create(plan, PEL_FACTOR_FLOAT, &factor, &error), PEL_OK);
    pel_factor_destroy(factor);
    pel_factor_plan_destroy(plan);
    pel_matrix_destroy(m);
    test_system_release(&s);
}

static void test_allocation_failure(void **unused)
{
    (void)unused;
    random_state random = {8};
    test_system s = test_random_system(80, 200, &random);
    pel_matrix *m = test_matrix(&s, 1, NULL);
    assert_true(for_every_allocation_failure(create_factor, m) > 15);
    pel_matrix_destroy(m);
    test_system_release(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_systems),   cmocka_unit_test(test_dense_system),
        cmocka_unit_test(test_threads),          cmocka_unit_test(test_units),
        cmocka_unit_test(test_indefinite),       cmocka_unit_test(test_singular),
        cmocka_unit_test(test_indefinite_above), cmocka_unit_test(test_plan),
        cmocka_unit_test(test_too_large),        cmocka_unit_test(test_allocation_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
