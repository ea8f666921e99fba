/* Conjugate gradients in double with a preconditioner of any precision. The flexible form (Notay 2000: beta from the
   change of the residual) bears preconditioners that round in float or change a little from call to call. */
#ifndef PEL_LINEAR_PCG_H
#define PEL_LINEAR_PCG_H

#include "linear/matrix.h"

/* y = M^-1 x for a symmetric positive definite M near the matrix, both (unknown_count); pel_factor_solve and
   pel_jacobi_apply are two */
typedef void pel_preconditioner(void *context, pel_pool *pool, const double *x, double *y);

/* Scratch of a solve; one thread at a time uses it. */
typedef struct pel_pcg pel_pcg;
pel_status pel_pcg_create(int32_t unknown_count, pel_pcg **pcg, pel_error *error);
void pel_pcg_destroy(pel_pcg *pcg);

/* y += B x for a symmetric B, both (unknown_count) */
typedef void pel_added_product(void *context, pel_pool *pool, const double *x, double *y);

typedef struct pel_pcg_def {
    const pel_matrix *matrix;
    pel_added_product *add_product; /* what the system has beyond the matrix, of low rank as a rule; null = nothing */
    void *added;
    pel_preconditioner *precondition; /* null = none */
    void *preconditioner;
    double tolerance;   /* on |r| / |b| */
    int32_t iterations; /* at most */
    double midway;      /* |r| / |b| above which it ends after half of them; 0 = never */
    bool has_start;     /* solution holds a first guess; else zero */
} pel_pcg_def;

typedef enum pel_pcg_end {
    PEL_PCG_CONVERGED,
    PEL_PCG_LIMIT,      /* iterations are used up, or half of them led nowhere, or the pool is stopped; the solution is
                           the last iterate */
    PEL_PCG_INDEFINITE, /* a direction of curvature <= 0 (within rounding): the solution is the last iterate before it
                         */
    PEL_PCG_BROKEN      /* the preconditioner is not positive definite, or a number is NaN or infinite */
} pel_pcg_end;

typedef struct pel_pcg_result {
    pel_pcg_end end;
    int32_t iterations; /* products with the matrix, the one of a start apart */
    double residual;    /* |b - A x| / |b| by its recurrence */
    double curvature;   /* smallest p.A p / p.p seen: an upper bound of the least eigenvalue; 0 without iterations */
    const double *direction; /* PEL_PCG_INDEFINITE: the direction, until the next solve; else null */
} pel_pcg_result;

/* Solves A x = right, A the matrix and what is added to it, both (unknown_count). Allocates nothing; the same bits for
 * any number of threads. */
pel_pcg_result pel_pcg_solve(pel_pcg *pcg, const pel_pcg_def *def, pel_pool *pool, const double *right,
                             double *solution);

#endif
