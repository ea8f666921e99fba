/* The factor that many steps of `implicit` share: that of a positive matrix in an earlier one, which is made again at
   the same place after a snapshot was loaded. */
#ifndef PEL_MINIMISE_PREPARED_H
#define PEL_MINIMISE_PREPARED_H

#include "minimise/step_newton.h"

/* where the factor was made */
struct pel_newton_base {
    bool is_due;    /* in snapshots, like all but the last three: the next step makes another one */
    double rate;    /* 1/s, of the springs that inertia is */
    pel_span span;  /* of loads */
    uint64_t fixed; /* hash of the fixed unknowns, and of what yielded */
    pel_newton_wear wear;
    double *unknowns;                       /* (unknown_count) */
    double (*factors)[PEL_PARAMETER_COUNT]; /* (body_count) of keyed parameters */
    double (*radial)[4];                    /* (vertex_count) damping along volumetric springs; null = none */
    bool is_made;                           /* by this simulation, since a snapshot was loaded */
    double *point_stiffness;                /* (vertex_count) N/m, scratch */
    int64_t begin;                          /* the solver's work when the run began, scratch */
};

/* PEL_OUT_OF_MEMORY. */
pel_status pel_sim_prepared_create(pel_sim *sim, pel_error *error);
void pel_sim_prepared_destroy(pel_sim *sim);
/* Before the first run of a step, at its start: the factor for the problem.
   PEL_OUT_OF_MEMORY. */
pel_status pel_sim_prepared_begin(pel_sim *sim, const pel_newton_problem *problem, pel_error *error);
/* After a run that may have made another factor. */
void pel_sim_prepared_take(pel_sim *sim, const pel_newton_problem *problem);
/* What snapshots contain of it. */
void pel_sim_prepared_transfer(pel_cursor *at, const pel_sim *sim);

#endif
