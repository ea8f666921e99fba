/* One adjoint solution at the end of a step, shared by pel_sim_adjoint and pel_sim_adjoint_steps. */
#ifndef PEL_GRADIENT_ADJOINT_H
#define PEL_GRADIENT_ADJOINT_H

#include "minimise/step_newton.h"
#include "newton/newton.h"
#include "pellicle/sim_adjoint.h"
#include "stage/stage.h"

typedef struct pel_adjoint_work {
    pel_sim *sim;
    const pel_adjoint *def; /* its results take sums */
    pel_newton_problem problem;
    double *unknowns, *gradient, *multipliers; /* (unknown_count) */
    double *held, *rest;                       /* (unknown_count) */
    pel_tangent_derivative *bodies;            /* (body_count) */
} pel_adjoint_work;

/* The problem of the last step, x_1 = end y + (1 - end) x_0, at its solution, which becomes the unknowns of the method;
   without terms. */
void pel_adjoint_take_problem(pel_sim *sim, double end, pel_newton_problem *problem);
/* PEL_BAD_ARGUMENT if the last step has not converged. */
pel_status pel_adjoint_check_step(const pel_sim *sim, pel_error *error);
/* PEL_BAD_ARGUMENT with the name of a feature without derivatives. */
pel_status pel_adjoint_check(const pel_sim *sim, const pel_adjoint *def, pel_error *error);
/* Room, and results of 0; to be ended also on failure. PEL_OUT_OF_MEMORY. */
pel_status pel_adjoint_begin(pel_adjoint_work *work, pel_sim *sim, const pel_adjoint *def, pel_error *error);
void pel_adjoint_end(pel_adjoint_work *work);
/* Multipliers of `gradient`, which is by the unknowns y of the last step, x_1 = end y + (1 - end) x_0, and is written
   over; adds the derivatives by the numbers of the model. Errors of pel_newton_adjoint. */
pel_status pel_adjoint_solve(pel_adjoint_work *work, double end, pel_error *error);
/* The same by the unknowns of the first stage of the last step, which was taken in two. */
pel_status pel_adjoint_solve_first(pel_adjoint_work *work, const pel_implicit_scheme *first, pel_error *error);

#endif
