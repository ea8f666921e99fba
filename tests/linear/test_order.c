/* Orders are permutations that keep factors sparse, on grids, on graphs in pieces, and on graphs that have no order. */
#include "system.h"

#include "linear/order.h"

static void check_permutation(const int32_t *order, int32_t count)
{
    bool *seen = calloc((size_t)count, sizeof *seen);
    for (int32_t i = 0; i < count; i++) {
        assert_in_range(order[i], 0, count - 1);
        assert_false(seen[order[i]]);
        seen[order[i]] = true;
    }
    free(seen);
}

/* entries of the factor, by elimination of a dense table */
static int64_t fill_of(const pel_matrix *m, const int32_t *order)
{
    int32_t n = m->node_count;
    bool *filled = calloc((size_t)n * (size_t)n, sizeof *filled);
    int32_t *position = calloc((size_t)n, sizeof *position);
    int64_t entries = n;
    for (int32_t i = 0; i < n; i++)
        position[order[i]] = i;
    for (int32_t i = 0; i < n; i++)
        for (int32_t block = m->row_start[i]; block < m->row_start[i + 1]; block++)
            filled[position[i] * n + position[m->column[block]]] = true;
    for (int32_t k = 0; k < n; k++)
        for (int32_t i = k + 1; i < n; i++) {
            entries += filled[i * n + k];
            for (int32_t j = k + 1; j < n && filled[i * n + k]; j++)
                filled[i * n + j] |= filled[j * n + k];
        }
    free(filled);
    free(position);
    return entries;
}

static int64_t fill_by_places(const test_system *s, const pel_matrix *m, bool has_places)
{
    int32_t *order = calloc((size_t)m->node_count, sizeof *order),
            *again = calloc((size_t)m->node_count, sizeof *again);
    const double(*places)[3] = has_places ? (const double(*)[3])s->places : NULL;
    assert_int_equal(pel_vertex_order_nodes(m, places, order, NULL), PEL_OK);
    assert_int_equal(pel_vertex_order_nodes(m, places, again, NULL), PEL_OK);
    assert_memory_equal(order, again, (size_t)m->node_count * sizeof *order);
    check_permutation(order, m->node_count);
    int64_t fill = fill_of(m, order);
    free(order);
    free(again);
    return fill;
}

/* A grid of 45 x 45 nodes under nine-point sparsity: METIS 5.1 gives 46,938 entries, the natural order 93,105. */
static void test_grid(void **unused)
{
    (void)unused;
    random_state random = {1};
    test_system s = test_grid_system(45, -1, &random);
    pel_matrix *m = test_matrix(&s, 1, NULL);
    int32_t natural[45 * 45];
    for (int32_t i = 0; i < 45 * 45; i++)
        natural[i] = i;
    int64_t worst = fill_of(m, natural), by_places = fill_by_places(&s, m, true),
            by_graph = fill_by_places(&s, m, false);
    assert_int_equal(worst, 93105);
    assert_in_range(by_places, 1, 46938);
    assert_in_range(by_graph, 1, 1.3 * 46938);
    pel_matrix_destroy(m);
    test_system_release(&s);
}

static void test_odd_graphs(void **unused)
{
    (void)unused;
    random_state random = {2};
    for (int round = 0; round < ROUNDS(12, 3); round++) {
        /* many pieces, places without meaning, or all in one place */
        test_system s = test_random_system(300, round % 3 == 0 ? 60 : 500, &random);
        if (round % 2 == 0)
            memset(s.places, 0, 300 * sizeof *s.places);
        pel_matrix *m = test_matrix(&s, 1, NULL);
        fill_by_places(&s, m, true);
        fill_by_places(&s, m, false);
        pel_matrix_destroy(m);
        test_system_release(&s);
    }
    /* a star: its hub comes last, so that nothing fills in */
    test_system star = test_system_make(200, 200, -1, &random);
    for (int32_t i = 1; i < 200; i++)
        test_add_element(&star, (int32_t[]){0, i}, 2, 0);
    pel_matrix *m = test_matrix(&star, 1, NULL);
    assert_int_equal(fill_by_places(&star, m, true), 399);
    assert_int_equal(fill_by_places(&star, m, false), 399);
    pel_matrix_destroy(m);
    test_system_release(&star);
}

static pel_status create_order(const void *data, pel_error *error)
{
    int32_t order[80];
    return pel_vertex_order_nodes(data, NULL, order, error);
}

static void test_allocation_failure(void **unused)
{
    (void)unused;
    random_state random = {3};
    test_system s = test_random_system(80, 100, &random);
    pel_matrix *m = test_matrix(&s, 1, NULL);
    assert_int_equal(for_every_allocation_failure(create_order, m), 3);
    pel_matrix_destroy(m);
    test_system_release(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid),
        cmocka_unit_test(test_odd_graphs),
        cmocka_unit_test(test_allocation_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
