/* One step of time of paper A's body, without loads and tools. The new positions (and velocities) are written to
   state->position_next (velocity_next), so that the present ones stay until the step is accepted. */
#ifndef PEL_SOLVE_STEP_H
#define PEL_SOLVE_STEP_H

#include "base/pool.h"
#include "model/state.h"

typedef struct pel_step {
    double dt;
    double alpha;       /* quasi-static */
    bool keep_velocity; /* quasi-static */
    double momentum;    /* quasi-static: share of the last displacement */
    bool symplectic;    /* explicit */
    pel_pool *pool;     /* null = one thread */
    double *longest;    /* (chunks of the largest body) scratch */
    double *ways;       /* (same) scratch; null = displacements are not measured */
    double bound;       /* positions farther than this from the origin count as diverged */
} pel_step;

typedef struct pel_step_result {
    double longest; /* m, longest spring at the start of the step */
    double way;     /* m, bound of the displacement of a vertex, if it is known */
    bool way_is_known;
    bool diverged; /* a new position is NaN, infinite or out of bound */
} pel_step_result;

/* x' = x + alpha F(x, v) dt^2 / m + momentum (x - x_before) (eq. A-5 without momentum), v = 0 or, kept,
   (x - x_before) / dt */
void pel_step_quasi_static(const pel_model *model, pel_state *state, const pel_step *step, pel_step_result *result);

/* forward Euler: x' = x + dt v, v' = v + dt F(x, v) / m; symplectic: v' first, then x' = x + dt v' */
void pel_step_explicit(const pel_model *model, pel_state *state, const pel_step *step, pel_step_result *result);

#endif
