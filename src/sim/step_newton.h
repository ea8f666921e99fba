/* Newton's method inside of the minimisation of sim/descent.h: what the methods static and implicit share. */
#ifndef PEL_SIM_STEP_NEWTON_H
#define PEL_SIM_STEP_NEWTON_H

#include "sim/descent.h"
#include "solve/newton.h"

struct pel_sim_newton {
    pel_newton *newton;
    double *unknowns; /* (unknown_count) of the present state: positions, and the xi of edges */
    double *target;   /* (unknown_count) of fixed ones */
    double *loads;    /* (unknown_count) N */
    uint8_t *fixed;   /* (unknown_count) */
    pel_record *position, *force;     /* (vertex_count) what constraints see of unknowns, and answer */
    pel_newton_terms terms;
    double *point_stiffness;          /* (vertex_count) of inertia and drag; null in statics */
    double (*points)[3];              /* (vertex_count) */
    double *anchor_stiffness;         /* (vertex_count) */
    bool keeps_factor;
    pel_newton_result result;         /* of the last run */
    int64_t factors, products;        /* of the step */
    bool is_unstable;                 /* the balance of the last run is no minimum */
};

/* Unknowns, matrix and room, after sim->descent was made. PEL_OUT_OF_MEMORY, PEL_BAD_ARGUMENT. */
pel_status pel_sim_newton_create(pel_sim *sim, bool is_dynamic, pel_error *error);
void pel_sim_newton_destroy(pel_sim *sim);

/* What pel_descent_run does, by Newton's method. PEL_OUT_OF_MEMORY. */
pel_status pel_sim_newton_minimise(pel_descent_context *context, const pel_descent_problem *problem,
                                   pel_descent_result *result, pel_error *error);

#endif
