/* Pellicle: derivatives of a simulation with respect to its parameters. */
#ifndef PELLICLE_SIM_ADJOINT_H
#define PELLICLE_SIM_ADJOINT_H

#include "sim_step.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Derivatives of a function f of the positions with respect to one body's material. Those for young, thickness and
   poisson include bending if its stiffness is automatic. */
typedef struct pel_adjoint_material {
    double young, thickness; /* for a factor, 1 at present, on the whole body: df/dE = young / E for a uniform E; of
                                orthotropic membranes a factor on young, weft and shear together */
    double poisson;          /* for the ratio */
    double bending;          /* for a factor on the flexural rigidity only */
    double pressure;         /* for a factor on the pressure */
    double volume;           /* for a factor on Young's modulus of the tetrahedra of a filled body */
} pel_adjoint_material;

/* Inputs and results of pel_sim_adjoint; initialise with zeros. Arrays of vertices: body after body, vertices of their
 * meshes. */
typedef struct pel_adjoint {
    const double *positions; /* (vertices x 3) df/dx [1/m] at the present state */
    /* results, nullable */
    double *forces;                  /* (vertices x 3) for a force on each vertex, 1/N; 0 where held */
    double *rest_positions;          /* (vertices x 3) for rest positions, 1/m, of membranes and mid-edge bending; with
                                        constant masses and vertex forces, also of loads in total (which follow areas:
                                        a simulation that is made anew shares them anew); held vertices move along */
    double *loads;                   /* (load_count of the def) for a factor, 1 at present, on each load */
    double *gravity;                 /* (3) for gravity, s2/m */
    pel_adjoint_material *materials; /* (body_count) */
} pel_adjoint;

/* Derivatives of a function of the positions with respect to parameters of the model, from one linear system with the
   matrix of the present state (adjoint method: Strang, Computational Science and Engineering, section 8.7).
   PEL_METHOD_STATIC: of the equilibrium, which must have converged; free bodies are fixed at three of their vertices.
   PEL_METHOD_IMPLICIT: of the end of the last step for a constant state at its start, not along time.

   Without tools and contact; pressure with a potential. PEL_BAD_ARGUMENT for unsupported features, if the state is no
   stable equilibrium, and under the method implicit before the first step after the start or pel_sim_load;
   PEL_OUT_OF_MEMORY. Does not change the simulation. */
PEL_API pel_status pel_sim_adjoint(pel_sim *sim, const pel_adjoint *def, pel_error *error);

/* A state of a sequence of steps, and the derivatives of a function with respect to it. */
typedef struct pel_adjoint_point {
    int64_t step;                         /* number within the sequence, from 1 */
    const double *positions, *velocities; /* (vertices x 3) m, m/s after it; vertices as in pel_adjoint */
    double *by_positions, *by_velocities; /* (vertices x 3) derivatives of the function [1/m, s/m]; default: 0
                                           */
} pel_adjoint_point;

/* Inputs and results of pel_sim_adjoint_steps; initialise with zeros. */
typedef struct pel_adjoint_steps {
    int64_t step_count;
    /* Called with the state after the last step or, if is_running, after each step from the last to the first.
       Returning false ends with PEL_STOPPED. */
    bool (*gradient)(void *user, const pel_adjoint_point *point);
    void *user;
    bool is_running;     /* the function depends on all steps */
    pel_adjoint results; /* `positions` is not read; derivatives are summed over all steps */
    /* (vertices x 3) for the initial state [1/m, s/m]; 0 where held. Nullable. Derivatives for rest positions assume a
       constant initial state: for bodies that start at rest add the two. */
    double *start_positions, *start_velocities;
} pel_adjoint_steps;

/* Takes step_count steps of PEL_METHOD_IMPLICIT and computes the derivatives of a function of them
   (src/simulation/gradient/adjoint_steps.c has the equations). The steps are solved to rounding, so they differ
   slightly from those of pel_sim_step. The simulation ends after the steps, or at their start on failure. Takes the
   time of three to five times as many steps, and memory for 2 sqrt(step_count) snapshots.

   PEL_BAD_ARGUMENT as pel_sim_adjoint, and for refinement, damping of volumetric springs, fibres along principal
   directions, moments on edges, a budget, and steps that do not converge. PEL_STOPPED by the gradient;
   PEL_OUT_OF_MEMORY. Masses and drag are constant. */
PEL_API pel_status pel_sim_adjoint_steps(pel_sim *sim, const pel_adjoint_steps *def, pel_error *error);

/* Takes a step of sim and, beside it, one of each of `beside` (count): simulations of the same bodies that differ by
   small changes of numbers and have taken the same steps. They are solved by chord iterations with the matrix of sim at
   the end of its step: two or three solutions per step instead of the factorizations of Newton's method
   (src/solver/newton/beside.c). To get the derivative of a reading with respect to a number along the steps, use
   two simulations, in which the number is slightly smaller and slightly larger, and divide the difference of the
   reading by the difference of the number. For PEL_METHOD_STATIC (including arc length) and PEL_METHOD_IMPLICIT,
   without tools, contact, refinement, analyses and a time budget. The call fails if a step does not converge; the
   simulations may then be at different steps. PEL_BAD_ARGUMENT for unsupported features, for simulations that do not
   match, and for changes that are too large; PEL_OUT_OF_MEMORY; errors of pel_sim_step. */
PEL_API pel_status pel_sim_step_beside(pel_sim *sim, pel_sim *const *beside, int32_t count, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
