/* Largest eigenvalues of an operator A that is symmetric in a metric N: x . N A y = y . N A x. A block Lanczos method
   with full reorthogonalization and thick restarts (Wu and Simon 2000): the basis grows by the residuals of Ritz
   vectors, and shrinks to these when it is full. Frequencies and buckling factors are the inverse of such eigenvalues
   (newton/modes.h). Deterministic. */
#ifndef PEL_LINEAR_EIGEN_H
#define PEL_LINEAR_EIGEN_H

#include "base/pool.h"
#include "pellicle/error.h"

#include <stdbool.h>
#include <stdint.h>

/* y = A x or N x, both (unknown_count) and different */
typedef void pel_eigen_product(void *context, const double *x, double *y);

typedef struct pel_eigen pel_eigen;

/* Room for `wanted` eigenvectors of unknown_count. PEL_OUT_OF_MEMORY, with the size. */
pel_status pel_eigen_create(int32_t unknown_count, int32_t wanted, pel_eigen **eigen, pel_error *error);
void pel_eigen_destroy(pel_eigen *eigen);

typedef struct pel_eigen_def {
    pel_eigen_product *apply, *metric;
    void *context;
    double tolerance;     /* on |A x - value x| / |value|, in the metric */
    int32_t iterations;   /* at most, of a block each */
    const pel_pool *pool; /* that of the products: the solve ends early where it is stopped; nullable */
} pel_eigen_def;

typedef struct pel_eigen_result {
    int32_t count;      /* eigenvalues that converged, the largest ones; at most `wanted` */
    int32_t products;   /* with A */
    int32_t iterations; /* blocks */
} pel_eigen_result;

/* The largest eigenvalues in descending order. Fewer than wanted converge where the operator has a lower rank, or the
   iterations are used up. Allocates nothing. */
pel_eigen_result pel_eigen_solve(pel_eigen *eigen, const pel_eigen_def *def);

/* of the last solve; vectors (unknown_count) have the length 1 in the metric */
double pel_eigen_value(const pel_eigen *eigen, int32_t number);
const double *pel_eigen_vector(const pel_eigen *eigen, int32_t number);

/* All eigenvalues of a symmetric matrix (count x count), by Jacobi's rotations, in descending order; vectors (count x
   count): a row each. Destroys the matrix. */
void pel_eigen_dense(int32_t count, double *matrix, double *values, double *vectors);

#endif
