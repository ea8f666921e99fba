#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "linear/factor_kinds.h"

#include <math.h>

void pel_factor_destroy(pel_factor *factor)
{
    if (factor == NULL)
        return;
    PEL_FREE_ALL(factor->entries, factor->work, factor->border, factor->solution, factor->scratch, factor->scale,
                 factor->pivots);
    pel_free(factor);
}

/* bytes that every machine has: the limit is not asked for */
#define SMALL 1e8

/* more than there is would end the process when it is written to */
static pel_status check_memory(const pel_factor_plan *plan, pel_factor_precision precision, pel_error *error)
{
    double needed = (double)plan->cost.bytes[precision];
    if (needed < SMALL)
        return PEL_OK;
    double limit = pel_memory_limit();
    if (needed <= limit)
        return PEL_OK;
    return pel_refuse(error, PEL_OUT_OF_MEMORY,
                      "use a coarser mesh, or the method xpbd or explicit, which need no matrix",
                      "the factor of a matrix of %d unknowns needs %.3g GB; %.3g GB are available",
                      (int)plan->unknown_count, 1e-9 * needed, 1e-9 * limit);
}

pel_status pel_factor_create(const pel_factor_plan *plan, pel_factor_precision precision, pel_factor **factor,
                             pel_error *error)
{
    *factor = NULL;
    pel_status status = check_memory(plan, precision, error);
    if (status != PEL_OK)
        return status;
    size_t number = precision == PEL_FACTOR_FLOAT ? sizeof(float) : sizeof(double);
    pel_factor *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->plan = plan;
    made->precision = precision;
    if (!PEL_ALLOCATE_ALL(
            PEL_ROOM_OF(made->entries, plan->entry_count, number), PEL_ROOM_OF(made->work, plan->work_count, number),
            PEL_ROOM_OF(made->border, plan->border_count, number),
            PEL_ROOM_OF(made->solution, plan->unknown_count, number),
            PEL_ROOM_OF(made->scratch, plan->scratch_count, number), PEL_ROOM_ALIGNED(made->scale, plan->unknown_count),
            PEL_ROOM(made->pivots, (size_t)plan->task_count + 1))) {
        pel_factor_destroy(made);
        pel_fail_memory(error);
        pel_fail_remedy(error,
                        "the factor of %d unknowns needs %.0f MB: take a coarser mesh, or the method xpbd or explicit",
                        (int)plan->unknown_count, 1e-6 * (double)plan->cost.bytes[precision]);
        return PEL_OUT_OF_MEMORY;
    }
    *factor = made;
    return PEL_OK;
}

static pel_factor_result fail_at(const pel_matrix *matrix, int32_t unknown, double pivot)
{
    int32_t low = 0, high = matrix->node_count - 1;
    while (low < high) {
        int32_t middle = low + (high - low + 1) / 2;
        if (matrix->first_unknown[middle] <= unknown)
            low = middle;
        else
            high = middle - 1;
    }
    return (pel_factor_result){false, low, unknown - matrix->first_unknown[low], pivot};
}

/* scales from the diagonal; the first unknown whose entry is not positive, or -1 */
static int32_t find_scales(pel_factor *factor, const pel_matrix *matrix, double *entry)
{
    int32_t u = 0;
    for (int32_t i = 0; i < matrix->node_count; i++) {
        int32_t size = matrix->first_unknown[i + 1] - matrix->first_unknown[i];
        const double *block = &matrix->values[matrix->block_start[pel_matrix_block(matrix, i, i)]];
        for (int32_t a = 0; a < size; a++, u++) {
            *entry = block[a * (size + 1)];
            if (!(*entry > 0 && *entry < (double)HUGE_VAL))
                return u;
            factor->scale[u] = 1 / sqrt(*entry);
        }
    }
    return -1;
}

pel_factor_result pel_factor_compute(pel_factor *factor, const pel_matrix *matrix, double shift, pel_pool *pool)
{
    double entry = 0;
    int32_t unknown = find_scales(factor, matrix, &entry);
    if (unknown >= 0)
        return fail_at(matrix, unknown, entry);
    if (factor->precision == PEL_FACTOR_FLOAT)
        pel_factor_compute_float(factor, matrix, shift, pool);
    else
        pel_factor_compute_double(factor, matrix, shift, pool);
    const pel_factor_pivot *pivots = factor->pivots;
    pel_factor_pivot all = {-1, (double)HUGE_VAL};
    for (int32_t t = 0; t <= factor->plan->task_count; t++) {
        bool is_first = pivots[t].failed >= 0 && (all.failed < 0 || pivots[t].failed < all.failed);
        if (is_first || (all.failed < 0 && pivots[t].value < all.value))
            all = pivots[t];
    }
    if (all.failed >= 0)
        return fail_at(matrix, factor->plan->front_unknown[all.failed], all.value);
    return (pel_factor_result){true, -1, -1, all.value};
}

/* a power of two near the largest entry: float holds forces of any unit, and nothing is rounded */
static double unit_of(const pel_factor *factor, const double *right)
{
    double largest = 0;
    int exponent;
    for (int32_t u = 0; u < factor->plan->unknown_count; u++) {
        double size = fabs(right[u] * factor->scale[u]);
        largest = size > largest ? size : largest;
    }
    frexp(largest, &exponent);
    return ldexp(1, exponent);
}

void pel_factor_reduce(pel_factor *factor, pel_pool *pool, const double *right, double *reduced)
{
    double unit = unit_of(factor, right);
    if (factor->precision == PEL_FACTOR_FLOAT)
        pel_factor_reduce_float(factor, unit, pool, right, reduced);
    else
        pel_factor_reduce_double(factor, unit, pool, right, reduced);
}

void pel_factor_solve(void *context, pel_pool *pool, const double *right, double *solution)
{
    PEL_ASSERT(right != NULL && solution != NULL);
    pel_factor *factor = context;
    double unit = unit_of(factor, right);
    if (factor->precision == PEL_FACTOR_FLOAT)
        pel_factor_solve_float(factor, unit, pool, right, solution);
    else
        pel_factor_solve_double(factor, unit, pool, right, solution);
}
