/* The simplest preconditioner: inverses of the diagonal blocks. */
#ifndef PEL_LINEAR_JACOBI_H
#define PEL_LINEAR_JACOBI_H

#include "linear/matrix.h"

typedef struct pel_jacobi pel_jacobi;
pel_status pel_jacobi_create(const pel_matrix *matrix, pel_jacobi **jacobi, pel_error *error);
void pel_jacobi_destroy(pel_jacobi *jacobi);
/* Inverts the diagonal blocks of a matrix of the same pattern. False when one is not positive definite: that node then
   takes the absolute values of its diagonal instead (1 for 0). Allocates nothing. */
bool pel_jacobi_compute(pel_jacobi *jacobi, const pel_matrix *matrix);
/* a pel_preconditioner */
void pel_jacobi_apply(void *jacobi, pel_pool *pool, const double *x, double *y);

#endif
