#include "linear/jacobi.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"

#include <math.h>
#include <string.h>

enum { NODES_PER_CHUNK = 512 };

struct pel_jacobi {
    int32_t node_count;
    const int32_t *first_unknown; /* of its own */
    int32_t *start;               /* (node_count + 1) first number of each inverse */
    double *inverses;
};

void pel_jacobi_destroy(pel_jacobi *jacobi)
{
    if (jacobi == NULL)
        return;
    PEL_FREE_ALL(jacobi->start, jacobi->inverses, jacobi);
}

pel_status pel_jacobi_create(const pel_matrix *matrix, pel_jacobi **jacobi, pel_error *error)
{
    *jacobi = NULL;
    pel_jacobi *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    size_t count = (size_t)matrix->node_count + 1;
    made->node_count = matrix->node_count;
    made->start = pel_allocate(2 * count, sizeof *made->start);
    if (made->start == NULL) {
        pel_jacobi_destroy(made);
        return pel_fail_memory(error);
    }
    memcpy(made->start + count, matrix->first_unknown, count * sizeof *made->start);
    made->first_unknown = made->start + count;
    for (int32_t i = 0; i < matrix->node_count; i++) {
        int32_t size = matrix->first_unknown[i + 1] - matrix->first_unknown[i];
        made->start[i + 1] = made->start[i] + size * size;
    }
    made->inverses = pel_allocate((size_t)made->start[matrix->node_count], sizeof *made->inverses);
    if (made->inverses == NULL) {
        pel_jacobi_destroy(made);
        return pel_fail_memory(error);
    }
    *jacobi = made;
    return PEL_OK;
}

/* inverse of a symmetric positive definite block by Gauss-Jordan; false when a pivot is not positive */
static bool invert(const double *block, int32_t size, double *inverse)
{
    double a[PEL_NODE_SIZE_LIMIT * PEL_NODE_SIZE_LIMIT];
    memcpy(a, block, (size_t)(size * size) * sizeof *a);
    for (int32_t i = 0; i < size * size; i++)
        inverse[i] = i % (size + 1) == 0;
    for (int32_t k = 0; k < size; k++) {
        double pivot = a[k * (size + 1)];
        if (!(pivot > 1e-15 * block[k * (size + 1)] && isfinite(pivot)))
            return false;
        for (int32_t i = 0; i < size; i++) {
            double factor = a[i + k * size] / pivot;
            for (int32_t j = 0; j < size && i != k; j++) {
                a[i + j * size] -= factor * a[k + j * size];
                inverse[i + j * size] -= factor * inverse[k + j * size];
            }
        }
        for (int32_t j = 0; j < size; j++) {
            a[k + j * size] /= pivot;
            inverse[k + j * size] /= pivot;
        }
    }
    return true;
}

bool pel_jacobi_compute(pel_jacobi *jacobi, const pel_matrix *matrix)
{
    bool all_definite = true;
    for (int32_t i = 0; i < jacobi->node_count; i++) {
        int32_t size = jacobi->first_unknown[i + 1] - jacobi->first_unknown[i];
        const double *block = &matrix->values[matrix->block_start[pel_matrix_block(matrix, i, i)]];
        double *inverse = &jacobi->inverses[jacobi->start[i]];
        if (invert(block, size, inverse))
            continue;
        all_definite = false;
        memset(inverse, 0, (size_t)(size * size) * sizeof *inverse);
        for (int32_t a = 0; a < size; a++) {
            double entry = fabs(block[a * (size + 1)]);
            inverse[a * (size + 1)] = entry > 0 ? 1 / entry : 1;
        }
    }
    return all_definite;
}

typedef struct application {
    const pel_jacobi *jacobi;
    const double *x;
    double *y;
} application;

static void apply_chunk(void *context, int32_t chunk)
{
    const application *a = context;
    const pel_jacobi *jacobi = a->jacobi;
    int32_t end = (chunk + 1) * NODES_PER_CHUNK;
    for (int32_t i = chunk * NODES_PER_CHUNK; i < (end < jacobi->node_count ? end : jacobi->node_count); i++) {
        int32_t first = jacobi->first_unknown[i], size = jacobi->first_unknown[i + 1] - first;
        const double *inverse = &jacobi->inverses[jacobi->start[i]];
        for (int32_t r = 0; r < size; r++) {
            double sum = 0;
            for (int32_t c = 0; c < size; c++)
                sum += inverse[r + c * size] * a->x[first + c];
            a->y[first + r] = sum;
        }
    }
}

void pel_jacobi_apply(void *context, pel_pool *pool, const double *x, double *y)
{
    const pel_jacobi *jacobi = context;
    application a = {jacobi, x, y};
    pel_pool_run(pool, (jacobi->node_count + NODES_PER_CHUNK - 1) / NODES_PER_CHUNK, apply_chunk, &a);
}
