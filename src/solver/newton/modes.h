/* Modes of a model about a state: frequencies and linear buckling, by Lanczos steps with the Cholesky factor of the
   stiffness (linear/eigen.h).

       modal      K x = w^2 M x      K exact at the state, M lumped masses; edges of mid-edge bending have none
       buckling   (K + f G) x = 0    K stiffness of the material, G what the stresses and the pressure of load factor 1
                                     add: exact minus material tangent with the stresses of a linear step under the
                                     loads (Bathe, Finite Element Procedures, section 6.8.2)

   A free body has six modes of frequency 0: K is shifted by a small multiple of M. */
#ifndef PEL_NEWTON_MODES_H
#define PEL_NEWTON_MODES_H

#include "newton/newton.h"

typedef struct pel_modes pel_modes;

/* Room for `count` modes of the unknowns of newton. PEL_OUT_OF_MEMORY. */
pel_status pel_modes_create(pel_newton *newton, pel_analysis analysis, int32_t count, pel_modes **modes,
                            pel_error *error);
void pel_modes_destroy(pel_modes *modes);

/* Refuses buckling without a load: PEL_BAD_ARGUMENT. */
pel_status pel_modes_fail_unloaded(pel_error *error);

/* Finds the modes about `unknowns` (unknown_count), the lowest first: about a state of rest; of buckling about the
   state without loads, which are those of the problem. Uses time, state, force, fixed, frames
   and the matrix of the terms of it. PEL_BAD_ARGUMENT where
   the state is not stable, nothing loads the model, or it has fewer modes. Allocates nothing. */
pel_status pel_modes_solve(pel_modes *modes, const pel_newton_problem *problem, const double *unknowns,
                           pel_error *error);

/* Of the last solve: Hz, 0 for rigid motions; or the factor of the loads under which the model buckles. */
double pel_modes_value(const pel_modes *modes, int32_t number);
/* (unknown_count) largest move of a vertex 1, its largest component positive */
const double *pel_modes_vector(const pel_modes *modes, int32_t number);

/* What a force starts that acts at once: the linear displacement u = K^-1 f that it swings about. The body swings
   mainly in the modes that u consists of, at Rayleigh's quotient of it. */
typedef struct pel_modes_response {
    double frequency; /* Hz, sqrt(u.K u / u.M u) / 2 pi; 0 = the force moves the body as a whole */
    double energy;    /* J, u.K u */
    double reach;     /* m, the longest move */
} pel_modes_response;

/* Of a force (unknown_count), which is overwritten, about the state of the last solve of frequencies, with the axes of
   its problem. */
pel_modes_response pel_modes_respond(pel_modes *modes, const pel_newton_frames *frames, double *force);

#endif
