/* Sparse Cholesky factors of symmetric positive definite matrices, in float or double: multifrontal (Duff and Reid
   1983; Liu 1992), over the elimination tree of a nested dissection.

   The matrix is scaled to a diagonal of 1, so that float holds stiffness of any unit. Subtrees run as tasks, large
   fronts are shared by all threads; every sum has one order: the same bits for any number of threads.

       plan of a pattern (once)  ->  factor (float or double)  ->  compute (each matrix)  ->  solve (any number)

   Compute and solve allocate nothing. */
#ifndef PEL_LINEAR_FACTOR_H
#define PEL_LINEAR_FACTOR_H

#include "linear/matrix.h"

typedef enum pel_factor_precision { PEL_FACTOR_FLOAT, PEL_FACTOR_DOUBLE } pel_factor_precision;

/* Order, elimination tree and fronts of a pattern. Never changes; serves any number of factors and threads. */
typedef struct pel_factor_plan pel_factor_plan;

/* What a factor costs, known before it is allocated. */
typedef struct pel_factor_cost {
    int64_t entries;               /* numbers in the factor, with the zeros that relaxed supernodes hold */
    double operations;             /* multiplications and additions of one compute */
    size_t bytes[2];               /* heap of one factor, by precision */
    int32_t fronts, largest_front; /* number of fronts; unknowns of the largest */
} pel_factor_cost;

/* coordinates: see pel_vertex_order_nodes. The matrix is read for its pattern and not kept. PEL_OUT_OF_MEMORY only. */
pel_status pel_factor_plan_create(const pel_matrix *matrix, const double (*coordinates)[3], pel_factor_plan **plan,
                                  pel_error *error);
void pel_factor_plan_destroy(pel_factor_plan *plan);
pel_factor_cost pel_factor_plan_cost(const pel_factor_plan *plan);

/* A factor and its scratch; one thread at a time uses it. The plan has to live as long. */
typedef struct pel_factor pel_factor;

/* PEL_OUT_OF_MEMORY says how many bytes it needs. */
pel_status pel_factor_create(const pel_factor_plan *plan, pel_factor_precision precision, pel_factor **factor,
                             pel_error *error);
void pel_factor_destroy(pel_factor *factor);

/* How a factorization went. A matrix that is not positive definite (or holds NaN) has no factor: the first unknown in
   the order of elimination is told whose pivot, over the diagonal entry, is not above 4e-15 (double) or 1e-7 (float);
   it is the same for any number of threads. The last unknown of a part that moves freely has such a pivot, or one that
   is little above it. */
typedef struct pel_factor_result {
    bool positive_definite;
    int32_t node, component; /* of the pivot that failed, else -1 */
    double pivot;            /* the pivot over the diagonal entry of the matrix; the smallest of all on success */
} pel_factor_result;

/* A pool that is stopped ends a compute early, as one that found no factor.
   Factors matrix + shift * its diagonal; the matrix has the pattern of the plan. Shift 0 is the matrix itself; float
   may need 1e-7 near its limit of condition. On failure the factor must be computed anew before the next solve. */
pel_factor_result pel_factor_compute(pel_factor *factor, const pel_matrix *matrix, double shift, pel_pool *pool);

/* Solves by the last factor; right and solution (unknown_count) may be the same array. Relative error about the
   precision times the condition of the scaled matrix. Has the form of a pel_preconditioner. */
void pel_factor_solve(void *factor, pel_pool *pool, const double *right, double *solution);

/* The first half of a solve: the matrix is L L^T, reduced (unknown_count) = L^-1 right, in an order of its own.
   Products of reduced vectors are those of one right side and the solution of the other. Of a right side with few
   entries that are not 0 it costs a fraction of a solve. */
void pel_factor_reduce(pel_factor *factor, pel_pool *pool, const double *right, double *reduced);

#endif
