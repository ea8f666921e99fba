/* Pellicle: the method of a simulation and its numbers. */
#ifndef PELLICLE_SOLVER_H
#define PELLICLE_SOLVER_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The methods: enumerator, name of the row in src/simulation, name in scene files. To add a method, add its row and a
   line here.
   QUASI_STATIC  x += alpha F dt^2 / m (paper A, eq. A-5)
   EXPLICIT      Euler's method on m a = F (paper A's baseline); the symplectic form is leapfrog
   PBD           paper B: each energy is a constraint, solved by `iterations` Gauss-Seidel sweeps
   PBD_DISTANCE  position-based dynamics on edge lengths only
   XPBD          extended position-based dynamics, strain form, `substeps` of one iteration each
   DESCENT       energy minimisation step by step, under tools and contacts: L-BFGS or gradient descent
   STATIC        static equilibria by Newton's method, under tools and contacts
   IMPLICIT      m a = F at the end of a step (BDF2, implicit midpoint), by Newton's method */
#define PEL_METHODS(ROW)                                                                                               \
    ROW(QUASI_STATIC, quasi_static, "quasi-static")                                                                    \
    ROW(EXPLICIT, explicit, "explicit")                                                                                \
    ROW(PBD, pbd, "pbd")                                                                                               \
    ROW(PBD_DISTANCE, pbd_distance, "pbd-distance")                                                                    \
    ROW(XPBD, xpbd, "xpbd")                                                                                            \
    ROW(DESCENT, descent, "descent")                                                                                   \
    ROW(STATIC, static, "static")                                                                                      \
    ROW(IMPLICIT, implicit, "implicit")

typedef enum pel_method { /* PEL_METHOD_QUASI_STATIC and so on */
#define PEL_METHOD_ENUMERATOR(METHOD, name, word) PEL_METHOD_##METHOD,
                          PEL_METHODS(PEL_METHOD_ENUMERATOR)
#undef PEL_METHOD_ENUMERATOR
} pel_method;

#define PEL_METHOD_ONE(METHOD, name, word) +1
enum { PEL_METHOD_COUNT = 0 PEL_METHODS(PEL_METHOD_ONE) }; /* number of methods */
#undef PEL_METHOD_ONE

/* A choice; PEL_AUTO leaves it to the library. */
typedef enum pel_choice { PEL_AUTO = -1, PEL_NO = 0, PEL_YES = 1 } pel_choice;

/* static: analysis of the equilibrium */
typedef enum pel_analysis {
    PEL_ANALYSIS_NONE,
    PEL_ANALYSIS_MODAL,   /* step n shows the mode of the n-th lowest frequency around the loaded state */
    PEL_ANALYSIS_BUCKLING /* step n shows the mode of the n-th lowest common factor of the loads that buckles the body
                             by linear theory */
} pel_analysis;

/* static: sequence of the loads */
typedef enum pel_path {
    PEL_PATH_TIME,      /* the loads at the time of each step */
    PEL_PATH_ARC_LENGTH /* one factor, starting at 0, multiplies loads, gravity and prescribed pressure. Each step
                           advances by an arc length along the equilibrium path, also where the factor decreases (limit
                           points). The path ends when the factor reaches 1. For loads without keys, tools and contact
                         */
} pel_path;

/* static, path by arc length: where another path crosses (a bifurcation), beyond which this one is unstable */
typedef enum pel_branch {
    PEL_BRANCH_SAME,  /* goes on as it came */
    PEL_BRANCH_LOWEST /* leaves along the lowest mode of the tangent, to the minimum of the energy beside it under the
                         same loads, and goes on from there */
} pel_branch;

typedef struct pel_solver_def {
    pel_method method;
    double dt;          /* s, one step */
    double alpha;       /* quasi-static: step size; 0 = a stable value for this mesh */
    bool keep_velocity; /* quasi-static: F(x, v) with v = (x_t - x_(t-1)) / dt; false: v = 0 (damping has no effect) */
    double momentum;    /* quasi-static: share of the last displacement that a step adds, 0 to below 1: heavy-ball steps
                           (Polyak 1964), which come to rest in fewer steps by about (1 + m) / (1 - m). Not for bodies
                           that refine */
    bool symplectic;    /* explicit: v first, then x with the new v; false: forward Euler as in the paper */
    int32_t iterations; /* pbd, xpbd, descent: iterations per step or substep; 0 = 5, 1 and 500. descent with tools or
                           contact: per round, with up to 12 rounds per step; 0 = 50 */
    int32_t substeps; /* pbd, xpbd: substeps of a step. 0 = 1 for pbd; for xpbd the number that keeps stretch within 1 %
                         of the material's, updated during the run (pel_sim_softness) */
    int32_t max_substeps;    /* xpbd: maximum of automatic substeps; 0 = 200 */
    pel_choice second_order; /* xpbd: second order in time (BDF2) of bodies that nothing touches. PEL_AUTO: but for
                                those with a gas or a target volume */
    double drag;             /* 1/s: velocities fall by exp(-drag t); pbd, xpbd, explicit */
    bool gradient_only;      /* descent: plain gradient descent (paper B's comparison) instead of L-BFGS */
    pel_analysis analysis;   /* static; modes ignore tools and contact */
    pel_path path;           /* static, without an analysis */
    double arc_length;       /* m, of a step of a path at most: root of the mean square of the displacements; 0 = 5 % of
                                the largest body */
    pel_branch branch;       /* of a path by arc length */
    int32_t mode_count;      /* of an analysis: number of modes, 1 to 1000 */
    double budget; /* s, static and implicit: a step ends after the linear solve in progress at this time, with the best
                      state so far (pel_solver_reading has the residual); results depend on the machine. 0 = none */
} pel_solver_def;

#ifdef __cplusplus
}
#endif
#endif
