/* A factor, and the numeric half of it in float and in double: one source (factor_numeric.h), included for each. */
#ifndef PEL_LINEAR_FACTOR_KINDS_H
#define PEL_LINEAR_FACTOR_KINDS_H

#include "linear/factor_plan.h"

/* the pivot that failed in a task, in the order of elimination (-1 = none), and the smallest pivot */
typedef struct pel_factor_pivot {
    int32_t failed;
    double value;
} pel_factor_pivot;

/* arrays of the precision are void */
struct pel_factor {
    const pel_factor_plan *plan;
    pel_factor_precision precision;
    void *entries;            /* (entry_count) panels, with reciprocals on the diagonal */
    void *work;               /* (work_count) update matrices */
    void *border;             /* (border_count) what a forward solve hands to parents */
    void *solution;           /* (unknown_count) scaled, in the order of elimination */
    void *scratch;            /* (scratch_count) a column of a front for each task, and one for the upper fronts */
    double *scale;            /* (unknown_count) by unknown: 1 / sqrt(diagonal) */
    pel_factor_pivot *pivots; /* (task_count + 1) of each task and of the upper fronts */
};

/* factors the scaled matrix with 1 + shift on its diagonal, fills pivots */
typedef void pel_factor_compute_function(pel_factor *factor, const pel_matrix *matrix, double shift, pel_pool *pool);
/* solves by right / unit, which is near 1, and multiplies the solution by unit */
typedef void pel_factor_solve_function(pel_factor *factor, double unit, pel_pool *pool, const double *right,
                                       double *solution);

pel_factor_compute_function pel_factor_compute_float, pel_factor_compute_double;
pel_factor_solve_function pel_factor_solve_float, pel_factor_solve_double;
/* the forward half of it, in the order of elimination */
pel_factor_solve_function pel_factor_reduce_float, pel_factor_reduce_double;

#endif
