/* Systems of random elements over nodes of mixed sizes, and the same systems as dense matrices. */
#ifndef PEL_TESTS_LINEAR_SYSTEM_H
#define PEL_TESTS_LINEAR_SYSTEM_H

#include "check.h"
#include "failing_malloc.h"
#include "linear/matrix.h"
#include "random.h"

#include <stdlib.h>

typedef struct test_system {
    int32_t node_count, element_count, unknown_count;
    uint8_t *node_size, *kind;
    int32_t *start, *nodes;
    int32_t *first_unknown;
    double (*places)[3];
    double *blocks; /* 24 x 24 numbers for each element, the first d x d used */
} test_system;

enum { BLOCK_ROOM = PEL_ELEMENT_SIZE_LIMIT * PEL_ELEMENT_SIZE_LIMIT };

static inline void test_system_release(test_system *s)
{
    free(s->node_size);
    free(s->kind);
    free(s->start);
    free(s->nodes);
    free(s->first_unknown);
    free(s->places);
    free(s->blocks);
}

static inline int32_t test_node_size(const test_system *s, int32_t node)
{
    return s->first_unknown[node + 1] - s->first_unknown[node];
}

static inline int32_t test_element_size(const test_system *s, int32_t e)
{
    int32_t size = 0;
    for (int32_t i = s->start[e]; i < s->start[e + 1]; i++)
        size += test_node_size(s, s->nodes[i]);
    return size;
}

/* positive semi-definite blocks: sums of two random squares */
static inline void test_fill_blocks(test_system *s, random_state *random)
{
    for (int32_t e = 0; e < s->element_count; e++) {
        int32_t size = test_element_size(s, e);
        double *block = &s->blocks[e * BLOCK_ROOM];
        memset(block, 0, BLOCK_ROOM * sizeof *block);
        for (int k = 0; k < 2; k++) {
            double v[PEL_ELEMENT_SIZE_LIMIT];
            for (int32_t i = 0; i < size; i++)
                v[i] = random_between(random, -1.7, 1.7);
            for (int32_t i = 0; i < size; i++)
                for (int32_t j = 0; j < size; j++)
                    block[i * size + j] += v[i] * v[j];
        }
    }
}

/* Room for a system; nodes have random sizes 1 .. largest (largest < 0: all -largest). Elements are added by
   test_add_element, then test_fill_blocks. */
static inline test_system test_system_make(int32_t node_count, int32_t element_room, int largest, random_state *random)
{
    test_system s = {.node_count = node_count};
    s.node_size = calloc((size_t)node_count, 1);
    s.kind = calloc((size_t)element_room, 1);
    s.start = calloc((size_t)element_room + 1, sizeof *s.start);
    s.nodes = calloc(8 * (size_t)element_room, sizeof *s.nodes);
    s.first_unknown = calloc((size_t)node_count + 1, sizeof *s.first_unknown);
    s.places = calloc((size_t)node_count, sizeof *s.places);
    s.blocks = calloc((size_t)element_room * BLOCK_ROOM, sizeof *s.blocks);
    for (int32_t i = 0; i < node_count; i++) {
        s.node_size[i] = (uint8_t)(largest < 0 ? -largest : random_integer(random, 1, largest));
        s.first_unknown[i + 1] = s.first_unknown[i] + s.node_size[i];
        for (int k = 0; k < 3; k++)
            s.places[i][k] = random_between(random, -1, 1);
    }
    s.unknown_count = s.first_unknown[node_count];
    return s;
}

static inline void test_add_element(test_system *s, const int32_t *nodes, int32_t count, int kind)
{
    int32_t e = s->element_count++, start = s->start[e];
    memcpy(&s->nodes[start], nodes, (size_t)count * sizeof *nodes);
    s->start[e + 1] = start + count;
    s->kind[e] = (uint8_t)kind;
}

/* elements of 2 to 4 neighbours along a random walk over nodes: sparse, with a few far links */
static inline test_system test_random_system(int32_t node_count, int32_t element_count, random_state *random)
{
    test_system s = test_system_make(node_count, element_count, 6, random);
    for (int32_t e = 0; e < element_count; e++) {
        int32_t nodes[4], count = (int32_t)random_integer(random, 1, 4);
        int32_t at = (int32_t)random_integer(random, 0, node_count - 1);
        for (int32_t i = 0; i < count; i++) {
            nodes[i] = at;
            at = (at + (int32_t)random_integer(random, 1, random_integer(random, 0, 30) == 0 ? node_count : 3)) %
                 node_count;
        }
        test_add_element(&s, nodes, count, (int)random_integer(random, 0, 1));
    }
    test_fill_blocks(&s, random);
    return s;
}

/* a square grid of cells of four nodes, one above the other where `height` bends it */
static inline test_system test_grid_system(int32_t side, int size, random_state *random)
{
    test_system s = test_system_make(side * side, side * side, size, random);
    for (int32_t i = 0; i < side * side; i++) {
        s.places[i][0] = i % side;
        s.places[i][1] = i / side;
        s.places[i][2] = 0;
        if (i % side < side - 1 && i / side < side - 1)
            test_add_element(&s, (int32_t[]){i, i + 1, i + side, i + side + 1}, 4, 0);
    }
    test_fill_blocks(&s, random);
    return s;
}

static inline pel_matrix_def test_def(const test_system *s)
{
    return (pel_matrix_def){s->node_count, s->node_size, s->element_count, s->start, s->nodes, s->kind, 0, NULL};
}

/* a pel_matrix_function; checks that a group is of one kind and size and shares no node */
static inline void test_copy_blocks(void *context, const int32_t *elements, int32_t count, double *blocks)
{
    const test_system *s = context;
    int32_t size = test_element_size(s, elements[0]);
    assert_in_range(count, 1, PEL_MATRIX_GROUP);
    for (int32_t i = 0; i < count; i++) {
        assert_int_equal(test_element_size(s, elements[i]), size);
        assert_int_equal(s->kind[elements[i]], s->kind[elements[0]]);
        memcpy(&blocks[i * size * size], &s->blocks[elements[i] * BLOCK_ROOM], (size_t)(size * size) * sizeof *blocks);
    }
}

/* the assembled matrix plus `shift` on the diagonal */
static inline pel_matrix *test_matrix(const test_system *s, double shift, pel_pool *pool)
{
    pel_matrix *m;
    pel_matrix_def def = test_def(s);
    assert_int_equal(pel_matrix_create(&def, &m, NULL), PEL_OK);
    pel_matrix_assemble(m, pool, test_copy_blocks, (void *)(uintptr_t)s);
    pel_matrix_add_diagonal(m, shift, NULL);
    return m;
}

/* dense (unknown_count x unknown_count); the caller frees it */
static inline double *test_dense(const test_system *s, double shift)
{
    int32_t n = s->unknown_count;
    double *dense = calloc((size_t)n * (size_t)n, sizeof *dense);
    for (int32_t e = 0; e < s->element_count; e++) {
        int32_t size = test_element_size(s, e), unknowns[PEL_ELEMENT_SIZE_LIMIT], count = 0;
        for (int32_t i = s->start[e]; i < s->start[e + 1]; i++)
            for (int32_t u = s->first_unknown[s->nodes[i]]; u < s->first_unknown[s->nodes[i] + 1]; u++)
                unknowns[count++] = u;
        for (int32_t i = 0; i < size; i++)
            for (int32_t j = 0; j < size; j++)
                dense[unknowns[i] * n + unknowns[j]] += s->blocks[e * BLOCK_ROOM + i * size + j];
    }
    for (int32_t i = 0; i < n; i++)
        dense[i * (n + 1)] += shift;
    return dense;
}

static inline void test_dense_multiply(const double *dense, int32_t n, const double *x, double *y)
{
    for (int32_t i = 0; i < n; i++) {
        y[i] = 0;
        for (int32_t j = 0; j < n; j++)
            y[i] += dense[i * n + j] * x[j];
    }
}

/* Gauss with pivoting; destroys both, b becomes the solution */
static inline void test_dense_solve(double *a, int32_t n, double *b)
{
    for (int32_t k = 0; k < n; k++) {
        int32_t best = k;
        for (int32_t i = k; i < n; i++)
            best = fabs(a[i * n + k]) > fabs(a[best * n + k]) ? i : best;
        for (int32_t j = 0; j < n; j++) {
            double swapped = a[k * n + j];
            a[k * n + j] = a[best * n + j];
            a[best * n + j] = swapped;
        }
        double swapped = b[k];
        b[k] = b[best];
        b[best] = swapped;
        for (int32_t i = k + 1; i < n; i++) {
            double factor = a[i * n + k] / a[k * n + k];
            for (int32_t j = k; j < n && factor != 0; j++)
                a[i * n + j] -= factor * a[k * n + j];
            b[i] -= factor * b[k];
        }
    }
    for (int32_t i = n - 1; i >= 0; i--) {
        for (int32_t j = i + 1; j < n; j++)
            b[i] -= a[i * n + j] * b[j];
        b[i] /= a[i * n + i];
    }
}

static inline double *test_vector(int32_t count, random_state *random)
{
    double *x = calloc((size_t)count, sizeof *x);
    for (int32_t i = 0; i < count; i++)
        x[i] = random_between(random, -1.7, 1.7);
    return x;
}

/* |b - A x| / |b| */
static inline double test_residual(const pel_matrix *m, const double *b, const double *x)
{
    double *product = calloc((size_t)m->unknown_count, sizeof *product), error = 0, size = 0;
    pel_matrix_multiply(m, NULL, x, product);
    for (int32_t i = 0; i < m->unknown_count; i++) {
        error += (b[i] - product[i]) * (b[i] - product[i]);
        size += b[i] * b[i];
    }
    free(product);
    return sqrt(error / size);
}

#endif
