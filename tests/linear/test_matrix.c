/* Patterns, sums of elements, products and fixed unknowns, against dense matrices. */
#include "system.h"

static double entry_of(const pel_matrix *m, int32_t row_node, int32_t a, int32_t column_node, int32_t b)
{
    int32_t block = pel_matrix_block(m, row_node, column_node);
    int32_t size = m->first_unknown[row_node + 1] - m->first_unknown[row_node];
    return block < 0 ? 0 : m->values[m->block_start[block] + a + size * b];
}

static void check_entries(const test_system *s, const pel_matrix *m, const double *dense)
{
    for (int32_t i = 0; i < s->node_count; i++)
        for (int32_t j = 0; j < s->node_count; j++)
            for (int32_t a = 0; a < test_node_size(s, i); a++)
                for (int32_t b = 0; b < test_node_size(s, j); b++)
                    assert_near(entry_of(m, i, a, j, b),
                                dense[(s->first_unknown[i] + a) * s->unknown_count + s->first_unknown[j] + b], 1e-10);
}

static void test_sums_of_elements(void **unused)
{
    (void)unused;
    random_state random = {1};
    for (int round = 0; round < ROUNDS(20, 3); round++) {
        int32_t nodes = (int32_t)random_integer(&random, 1, 60);
        test_system s = test_random_system(nodes, (int32_t)random_integer(&random, 0, 150), &random);
        pel_matrix *m = test_matrix(&s, 0.5, NULL);
        double *dense = test_dense(&s, 0.5), *x = test_vector(s.unknown_count, &random);
        double *y = test_vector(s.unknown_count, &random), *expected = test_vector(s.unknown_count, &random);
        check_entries(&s, m, dense);
        pel_matrix_multiply(m, NULL, x, y);
        test_dense_multiply(dense, s.unknown_count, x, expected);
        for (int32_t i = 0; i < s.unknown_count; i++)
            assert_near(y[i], expected[i], 1e-9);
        /* a second assembly starts from zero */
        pel_matrix_assemble(m, NULL, test_copy_blocks, &s);
        pel_matrix_add_diagonal(m, 0.5, NULL);
        check_entries(&s, m, dense);
        pel_matrix_destroy(m);
        test_system_release(&s);
        free(dense);
        free(x);
        free(y);
        free(expected);
    }
}

/* pieces that run concurrently share no node, and each element runs once, even if a node has thousands */
static void test_colors(void **unused)
{
    (void)unused;
    random_state random = {2};
    enum { COUNT = 10000 };
    test_system s = test_system_make(COUNT, COUNT, 3, &random);
    for (int32_t e = 0; e + 1 < COUNT; e++)
        test_add_element(&s, (int32_t[]){e % 2 == 0 ? 0 : e, e + 1}, 2, e % 3);
    test_fill_blocks(&s, &random);
    pel_matrix *m = test_matrix(&s, 0, NULL);
    int *runs = calloc(COUNT, sizeof *runs), *last_piece = calloc(COUNT, sizeof *last_piece);
    assert_true(m->color_count > 64 && m->color_count < m->piece_count);
    assert_int_equal(m->color_start[0], 0);
    assert_int_equal(m->color_start[m->color_count], m->piece_count);
    for (int32_t color = 0; color < m->color_count; color++) {
        assert_true(m->color_start[color] < m->color_start[color + 1]);
        for (int32_t piece = m->color_start[color]; piece < m->color_start[color + 1]; piece++) {
            int32_t end = m->group_start[m->piece_start[piece + 1]];
            for (int32_t i = m->group_start[m->piece_start[piece]]; i < end; i++) {
                runs[m->ordered[i]]++;
                for (int32_t k = s.start[m->ordered[i]]; k < s.start[m->ordered[i] + 1]; k++) {
                    /* pieces are named from 1: a node was last seen in this one, or in a color before */
                    int32_t *last = &last_piece[s.nodes[k]];
                    assert_true(*last == piece + 1 || *last <= m->color_start[color]);
                    *last = piece + 1;
                }
            }
        }
    }
    for (int32_t e = 0; e + 1 < COUNT; e++)
        assert_int_equal(runs[e], 1);
    free(runs);
    free(last_piece);
    pel_matrix_destroy(m);
    test_system_release(&s);
}

/* the solution with fixed unknowns is that of the dense system with these columns moved to the right side */
static void test_fixed_unknowns(void **unused)
{
    (void)unused;
    random_state random = {3};
    for (int round = 0; round < ROUNDS(10, 2); round++) {
        test_system s = test_random_system(25, 70, &random);
        int32_t n = s.unknown_count;
        pel_matrix *m = test_matrix(&s, 0.1, NULL);
        double *dense = test_dense(&s, 0.1), *right = test_vector(n, &random), *value = test_vector(n, &random);
        double *expected = malloc((size_t)n * sizeof *expected);
        uint8_t *fixed = calloc((size_t)n, 1);
        memcpy(expected, right, (size_t)n * sizeof *right);
        for (int32_t i = 0; i < n; i++)
            fixed[i] = random_integer(&random, 0, 3) == 0;
        pel_matrix_fix(m, NULL, fixed, value, right);
        for (int32_t i = 0; i < n; i++)
            for (int32_t j = 0; j < n && fixed[i]; j++)
                dense[i * n + j] = i == j;
        for (int32_t i = 0; i < n; i++)
            expected[i] = fixed[i] ? value[i] : expected[i];
        test_dense_solve(dense, n, expected);
        assert_true(test_residual(m, right, expected) < 1e-11);
        free(dense);
        /* the matrix is still symmetric, up to the order of sums where a node comes twice in an element */
        for (int32_t i = 0; i < s.node_count; i++)
            for (int32_t block = m->row_start[i]; block < m->row_start[i + 1]; block++)
                for (int32_t a = 0; a < test_node_size(&s, i); a++)
                    for (int32_t b = 0; b < test_node_size(&s, m->column[block]); b++) {
                        int32_t j = m->column[block], row = s.first_unknown[i] + a, column = s.first_unknown[j] + b;
                        double entry = entry_of(m, i, a, j, b);
                        assert_near(entry, entry_of(m, j, b, i, a), 1e-12 * fabs(entry));
                        assert_true(row == column ? entry > 0 : entry == 0 || !(fixed[row] || fixed[column]));
                    }
        pel_matrix_destroy(m);
        test_system_release(&s);
        free(right);
        free(value);
        free(expected);
        free(fixed);
    }
}

/* same bits with any number of threads, and no allocation */
static void test_threads(void **unused)
{
    (void)unused;
    random_state random = {4};
    test_system s = test_grid_system(60, 3, &random);
    pel_matrix *first = test_matrix(&s, 0, NULL);
    double *x = test_vector(s.unknown_count, &random), *y = test_vector(s.unknown_count, &random);
    double *z = test_vector(s.unknown_count, &random);
    pel_matrix_multiply(first, NULL, x, y);
    for (int threads = 2; threads <= 4; threads *= 2) {
        pel_pool *pool;
        assert_int_equal(pel_pool_create(threads, &pool, NULL), PEL_OK);
        pel_matrix *m = test_matrix(&s, 0, pool);
        failing_malloc_begin(0);
        pel_matrix_assemble(m, pool, test_copy_blocks, &s);
        pel_matrix_multiply(m, pool, x, z);
        assert_int_equal(failing_malloc_end().calls, 0);
        size_t bytes = (size_t)first->block_start[first->block_count] * sizeof *first->values;
        assert_memory_equal(m->values, first->values, bytes);
        assert_memory_equal(z, y, (size_t)s.unknown_count * sizeof *y);
        pel_matrix_destroy(m);
        pel_pool_destroy(pool);
    }
    pel_matrix_destroy(first);
    test_system_release(&s);
    free(x);
    free(y);
    free(z);
}

/* A: y = A x turns the unknowns of a node onto the rows of its axes */
static void turn_vector(const test_system *s, const int32_t *frame, const double (*axes)[3][3], const double *x,
                        double *y)
{
    for (int32_t i = 0; i < s->node_count; i++)
        for (int k = 0; k < test_node_size(s, i); k++) {
            const double *given = x + s->first_unknown[i];
            double sum = 0;
            for (int l = 0; frame[i] >= 0 && l < 3; l++)
                sum += axes[frame[i]][k][l] * given[l];
            y[s->first_unknown[i] + k] = frame[i] >= 0 ? sum : given[k];
        }
}

/* turned unknowns are the turned product: (A K A^T) A x = A (K x), in several chunks with and without a pool */
static void test_turned(void **unused)
{
    (void)unused;
    enum { FRAMES = 7 };
    random_state random = {12};
    double axes[FRAMES][3][3];
    for (int f = 0; f < FRAMES; f++)
        random_rotation(&random, axes[f][0]);
    test_system s = test_grid_system(25, -3, &random);
    int32_t *frame = malloc((size_t)s.node_count * sizeof *frame), n = s.unknown_count;
    for (int32_t i = 0; i < s.node_count; i++)
        frame[i] = (int32_t)random_integer(&random, -3, FRAMES - 1);
    double *x = test_vector(n, &random), *turned = test_vector(n, &random), *product = test_vector(n, &random);
    double *expected = test_vector(n, &random), largest = 0;
    pel_pool *pools[2] = {NULL, NULL};
    assert_int_equal(pel_pool_create(2, &pools[1], NULL), PEL_OK);
    for (int p = 0; p < 2; p++) {
        pel_matrix *m = test_matrix(&s, 0.1, NULL);
        pel_matrix_multiply(m, NULL, x, product);
        turn_vector(&s, frame, (const double(*)[3][3])axes, product, expected);
        pel_matrix_turn(m, pools[p], frame, (const double(*)[3][3])axes);
        turn_vector(&s, frame, (const double(*)[3][3])axes, x, turned);
        pel_matrix_multiply(m, NULL, turned, product);
        for (int32_t i = 0; i < n; i++)
            largest = fmax(largest, fabs(expected[i]));
        for (int32_t i = 0; i < n; i++)
            assert_near(product[i], expected[i], 1e-13 * largest);
        pel_matrix_destroy(m);
    }
    pel_pool_destroy(pools[1]);
    test_system_release(&s);
    free(frame);
    free(x);
    free(turned);
    free(product);
    free(expected);
}

static void check_refused(const pel_matrix_def *def, const char *kind, int64_t element)
{
    pel_matrix *m = (pel_matrix *)(uintptr_t)1;
    pel_error error;
    assert_int_equal(pel_matrix_create(def, &m, &error), PEL_BAD_ARGUMENT);
    assert_null(m);
    if (kind != NULL)
        assert_string_equal(error.element_kind, kind);
    assert_int_equal(error.element, element);
}

/* a fixed unknown that nothing holds gets a diagonal of 1, so that the matrix has a factor */
static void test_fixed_alone(void **unused)
{
    (void)unused;
    const int32_t start[] = {0, 1}, nodes[] = {0};
    const uint8_t fixed[] = {0, 0, 0, 1, 1, 0};
    pel_matrix *m;
    assert_int_equal(pel_matrix_create(&(pel_matrix_def){2, NULL, 1, start, nodes, NULL, 0, NULL}, &m, NULL), PEL_OK);
    const double diagonal[] = {2, 2, 2, 0, -3, 5};
    pel_matrix_add_diagonal(m, 1, diagonal);
    pel_matrix_fix(m, NULL, fixed, NULL, NULL);
    const double expected[] = {2, 2, 2, 1, 1, 5};
    for (int32_t u = 0; u < 6; u++)
        assert_true(entry_of(m, u / 3, u % 3, u / 3, u % 3) == expected[u]);
    pel_matrix_destroy(m);
}

/* couplings give blocks to all pairs of their nodes, once, with zeros that the caller fills; sums stay */
static void test_couplings(void **unused)
{
    (void)unused;
    random_state random = {7};
    enum { COUNT = 40, COUPLINGS = 30 };
    test_system s = test_random_system(COUNT, 60, &random);
    int32_t couplings[COUPLINGS][4];
    for (int c = 0; c < COUPLINGS; c++)
        for (int i = 0; i < 4; i++)
            couplings[c][i] = c % 3 == 0 && i > 1 ? couplings[c][0] : (int32_t)random_integer(&random, 0, COUNT - 1);
    pel_matrix_def def = test_def(&s);
    pel_matrix *plain, *coupled;
    assert_int_equal(pel_matrix_create(&def, &plain, NULL), PEL_OK);
    def.coupling_count = COUPLINGS;
    def.couplings = (const int32_t(*)[4])couplings;
    assert_int_equal(pel_matrix_create(&def, &coupled, NULL), PEL_OK);
    bool expected[COUNT][COUNT] = {{false}};
    for (int c = 0; c < COUPLINGS; c++)
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++)
                expected[couplings[c][i]][couplings[c][j]] = true;
    int32_t more = 0;
    for (int32_t i = 0; i < COUNT; i++)
        for (int32_t j = 0; j < COUNT; j++) {
            bool had = pel_matrix_block(plain, i, j) >= 0;
            assert_true((pel_matrix_block(coupled, i, j) >= 0) == (had || expected[i][j]));
            more += !had && expected[i][j];
        }
    assert_true(more > 0);
    assert_int_equal(coupled->block_count, plain->block_count + more);
    pel_matrix_assemble(coupled, NULL, test_copy_blocks, &s);
    double *dense = test_dense(&s, 0);
    check_entries(&s, coupled, dense);
    couplings[3][2] = COUNT;
    check_refused(&def, "coupling", 3);
    free(dense);
    pel_matrix_destroy(plain);
    pel_matrix_destroy(coupled);
    test_system_release(&s);
}

static void test_bad_input(void **unused)
{
    (void)unused;
    const int32_t start[] = {0, 2, 4}, nodes[] = {0, 1, 1, 3}, turned[] = {0, 3, 2};
    const uint8_t sizes[] = {3, 0, 3, 3}, large[] = {3, 7, 3, 3};
    check_refused(&(pel_matrix_def){3, NULL, 2, start, nodes, NULL, 0, NULL}, "element", 1);
    check_refused(&(pel_matrix_def){4, sizes, 2, start, nodes, NULL, 0, NULL}, "node", 1);
    check_refused(&(pel_matrix_def){4, large, 2, start, nodes, NULL, 0, NULL}, "node", 1);
    check_refused(&(pel_matrix_def){4, NULL, 2, turned, nodes, NULL, 0, NULL}, "element", 1);
    check_refused(&(pel_matrix_def){0, NULL, 0, start, nodes, NULL, 0, NULL}, NULL, -1);
    const int32_t one[] = {0, 13}, thirteen[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    check_refused(&(pel_matrix_def){13, NULL, 1, one, thirteen, NULL, 0, NULL}, "element", 0);
}

static pel_status create_matrix(const void *data, pel_error *error)
{
    pel_matrix *m;
    pel_matrix_def def = test_def(data);
    pel_status status = pel_matrix_create(&def, &m, error);
    assert_true((m == NULL) == (status != PEL_OK));
    pel_matrix_destroy(m);
    return status;
}

static void test_allocation_failure(void **unused)
{
    (void)unused;
    random_state random = {5};
    test_system s = test_random_system(10, 20, &random);
    assert_true(for_every_allocation_failure(create_matrix, &s) > 10);
    test_system_release(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sums_of_elements),
        cmocka_unit_test(test_colors),
        cmocka_unit_test(test_fixed_unknowns),
        cmocka_unit_test(test_fixed_alone),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_couplings),
        cmocka_unit_test(test_turned),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_allocation_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
