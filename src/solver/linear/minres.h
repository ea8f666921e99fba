/* The minimal residual method for symmetric systems that may be indefinite (Paige and Saunders 1975; with a positive
   definite preconditioner: Elman, Silvester, Wathen, Finite Elements and Fast Iterative Solvers, section 4.1). */
#ifndef PEL_LINEAR_MINRES_H
#define PEL_LINEAR_MINRES_H

#include "linear/pcg.h"

/* Scratch of a solve; one thread at a time uses it. */
typedef struct pel_minres pel_minres;
pel_status pel_minres_create(int32_t unknown_count, pel_minres **minres, pel_error *error);
void pel_minres_destroy(pel_minres *minres);

/* Solves A x = right from x = 0 with what the def says, its start apart; `precondition` is needed, and has to be the
   same symmetric positive definite matrix in each call, to the tolerance. The tolerance is on the residual in the
   metric of the preconditioner. PEL_PCG_CONVERGED, _LIMIT or _BROKEN; curvature and direction are not found. */
pel_pcg_result pel_minres_solve(pel_minres *minres, const pel_pcg_def *def, pel_pool *pool, const double *right,
                                double *solution);

#endif
