/* Methods as steppers: one table row each, one file for each family. The step (sim.c) is the same for all of them; the
   step, loads, contact and the ledger use the traits of a method's row. No code outside the files of the methods checks
   which method runs. */
#ifndef PEL_STAGE_STEPPER_H
#define PEL_STAGE_STEPPER_H

#include "force/tangent.h"
#include "pellicle/sim_reading.h"
#include "solve/step.h"

typedef struct pel_stepper {
    /* traits */
    bool has_velocity;  /* velocities are a part of the state */
    bool is_explicit;   /* forces at the start of the step kick the velocities */
    bool has_substeps;  /* contacts, solids, ties and grasps act in substeps; not explicit: elements are constraints
                           there */
    bool is_compliant;  /* of these: constraints have the compliance of the material, and substeps are automatic */
    bool weighs;        /* of these: the weight of bending follows the volume where it is automatic */
    bool damps;         /* rates of strain have the damping of the material */
    bool limits_strain; /* of these: a bound of stretch is a constraint */
    bool divides;       /* repeats an unsolved step in parts; projection does so with contact */
    bool is_at_end;     /* loads and keyed numbers have their values of the end of the step */
    bool moves_tools;   /* tools and held vertices move inside the step, else after it */
    bool bounds_motion; /* the step finds the longest edge itself */
    bool seeks_rest;    /* a step finds the state of rest of a whole load step: refinement settles before it */
    bool turns_edges;   /* rotations of edges are unknowns (law/bending_model.h) */
    bool minimises;     /* a step is a minimisation, which may take long */
    bool relaxes;       /* approaches rest over many steps: solver.alpha and velocity */
    bool descends;      /* by L-BFGS or gradient descent: solver.descent */
    bool is_static;     /* each step is an equilibrium: it has analyses, paths and solver.steps */
    bool moves_rigid;   /* moves rigid bodies */
    bool has_budget;    /* a step may end at a wall time: solver.budget */
    bool has_lengths;   /* knows lengths of edges alone: other energies have no effect */
    bool can_refill;    /* create only checks and chooses numbers where no body refines: it may be repeated */

    /* Data of the method, after model, state and shells; fills automatic numbers of the solver. */
    pel_status (*create)(pel_sim *sim, pel_error *error);
    /* when loads, tools and contacts are there as well; nullable */
    pel_status (*check_start)(pel_sim *sim, pel_error *error);
    /* New positions and velocities from those at the start of the step. Errors of pel_contacts_find. */
    pel_status (*step)(pel_sim *sim, pel_step_result *result, pel_error *error);
    /* readings of tools if the method itself keeps bodies out of them; nullable */
    void (*read_tools)(pel_sim *sim);
    /* marks contacts besides tools and the list of contacts; nullable */
    void (*mark_contacts)(const pel_sim *sim);
    /* The tangent with its unknowns at the present positions, the edges of mid-edge bending where they bend least; null
       without such edges; nullable */
    pel_tangent *(*settle_edges)(const pel_sim *sim, const double **unknowns);
    /* after the surface has changed; nullable */
    void (*follow_surface)(pel_sim *sim);
    /* after the velocities of a body have changed between steps; nullable */
    void (*restart)(pel_sim *sim, int32_t body);
    /* whether an accepted step, after `times` of the same one, is taken once more from where it ended; nullable */
    bool (*repeats)(pel_sim *sim, int times);
    /* called when the length of parts of a step changes: to sim->step.dt, from `before` [s]; nullable */
    void (*set_time)(pel_sim *sim, double before);
    /* load of supports: the force on a vertex that the last step has kept fixed; nullable: forces of the elements */
    void (*get_held_force)(const pel_sim *sim, int32_t v, double force[3]);
    /* Allocates these forces and those of read_grips; nullable. PEL_OUT_OF_MEMORY. */
    pel_status (*record_held)(pel_sim *sim, pel_error *error);
    /* after the vertices that tools hold have changed; nullable */
    void (*follow_held)(pel_sim *sim);
    /* the forces of held vertices on tools, after contacts were transferred to them; nullable */
    void (*read_grips)(pel_sim *sim);
    /* Sets the substeps of later steps, and restarts if the state was loaded; nullable. */
    void (*set_substeps)(pel_sim *sim, int32_t count, bool is_loaded);
    /* solver reading of the last accepted step; null = nothing is solved */
    void (*get_solver)(const pel_sim *sim, pel_solver_reading *reading);
    /* after a step that is accepted; nullable */
    void (*accept)(pel_sim *sim);
    /* the remedy for a step that diverged */
    void (*advise)(const pel_sim *sim, pel_error *error);
    /* the remedy for a run whose energy does not balance; null = a smaller time step */
    const char *energy_remedy;
} pel_stepper;

/* the rows, each in the file of its method */
#define PEL_STEPPER(METHOD, name, word) extern const pel_stepper pel_step_##name##_kind;
PEL_METHODS(PEL_STEPPER)
#undef PEL_STEPPER
extern const pel_stepper pel_step_explicit_rigid_kind;

/* The row of a method that pel_sim_create let pass. */
const pel_stepper *pel_stepper_of(pel_method method);

/* The same for a model: with rigid bodies the explicit method solves contacts, ties and joints on predicted positions.
 */
const pel_stepper *pel_stepper_for(pel_method method, const pel_model *model);

/* The row of the method with that word, null if there is none. */
const pel_stepper *pel_stepper_find(const char *word);

/* pbd has weights in place of a material */
static inline bool pel_stepper_knows_material(const pel_stepper *stepper)
{
    return !stepper->has_substeps || stepper->is_compliant || stepper->is_explicit;
}

#endif
