/* Position-based dynamics: pbd as in paper B (energies as constraints), pbd-distance (edge lengths) and xpbd.

   A substep of length h predicts from velocity, forces and springs to the rest positions, projects, and derives the
   velocity from the displacement. With the base y and the time tau, first order y = x, tau = h; second order (BDF2)
   y = (4 x - x') / 3, tau = 2 h / 3 with x' one substep before and velocities alike:

       x* = y + tau u + tau^2 w f,      u = v or (4 v - v') / 3
       v  = (x - y) / tau               after the sweeps

   The first one of second order, which has no past, is the trapezoidal rule for positions and the implicit one for
   velocities: y = x + h v / 2, tau = h / sqrt(2), u = v / sqrt(2), and v = (x - y) / (h / 2) after the sweeps, so that
   a fall under any constant force is exact from the first substep on. Where a contact acts the past of its bodies is
   made anew from the velocity that it leaves, and their substeps are of first order. (Velocities from three positions
   and x* = x + h v, as often done, are not consistent: a free fall gets twice its acceleration.)

   Volumetric springs k' and drag d of a vertex are quadratic in its own position: they are taken up exactly by a mass
   that is larger by tau d + tau^2 k', with x* drawn to the rest place; no constraint is needed for them. So is the drag
   of the solver in second order; in first order it is the factor exp(-drag h) on velocities.

   Sweeps go body by body over springs, triangles, hinges and fibres, then over the contacts; batch/batches.h has the
   order. Those of xpbd keep the angular momentum of free bodies (spin.h). */
#ifndef PEL_SOLVE_PROJECT_H
#define PEL_SOLVE_PROJECT_H

#include "base/pool.h"
#include "batch/batches.h"
#include "model/boundary.h"
#include "model/shell.h"
#include "model/state.h"
#include "pellicle/solver.h"
#include "solve/spin.h"
#include "sweep/contact.h"

/* Drag and volumetric spring of a vertex in a substep, as shares of its mass: tau d w and tau^2 k' w. */
typedef struct pel_restraint {
    pel_real drag, spring;
    pel_real share; /* of the inverse mass that is left */
    pel_real along; /* share of the velocity along the spring that its damping takes */
} pel_restraint;

/* of a body in a substep: first order, second order, and the first of second order; see above */
typedef enum pel_substep_order { PEL_ORDER_PLAIN, PEL_ORDER_PAST, PEL_ORDER_START, PEL_ORDER_COUNT } pel_substep_order;

typedef struct pel_projector {
    const pel_model *model;
    pel_batches *batches; /* not owned */
    pel_solver_def solver;
    bool is_plain;                               /* runs the plain kernels: for tests and benchmarks */
    bool is_held;                                /* a vertex has drag or a volumetric spring */
    bool has_past;                               /* any body is of second order in the present substep */
    double substep, tau;                         /* s; of the present substep: the longest tau of a body */
    double whole_dt, whole_substep;              /* s, of a step that is not in parts */
    pel_record *base;                            /* (vertex_count) y of the substep */
    pel_spin *spin;                              /* of xpbd */
    pel_restraint *restraints;                   /* (vertex_count) where is_held */
    bool are_held_known;                         /* the restraints are those of held_orders */
    pel_record *older_position, *older_velocity; /* (vertex_count) second order: x' and v' of the next substep */
    uint8_t *orders, *held_orders;               /* (body_count) pel_substep_order: of the substep, of restraints */
    uint8_t *is_pressed;                         /* (body_count) set by the owner: of first order in the substep */
    uint8_t *touches, *touched;                  /* (body_count) second order: in the substep, and in the step so far */
    pel_record *reaction;                        /* (vertex_count) see pel_projector_record_reactions; null = none */
    uint8_t *is_fixed;                           /* (vertex_count) pinned or held; null without reactions */
    const pel_record *air;                       /* (vertex_count) set by the owner: drag [N s/m] as fourth number */
    const uint8_t *is_asleep;                    /* (body_count) set by the owner: bodies that stay; null = none */
    pel_pool *pool;                              /* set by the owner; null = one thread */
} pel_projector;

/* For batches of the solver's method, which outlive the projector. iterations and substeps have to be above 0. Errors:
   PEL_OUT_OF_MEMORY. */
pel_status pel_projector_create(pel_batches *batches, const pel_solver_def *solver, pel_projector **projector,
                                pel_error *error);
void pel_projector_destroy(pel_projector *projector);

/* Changes the substeps of the steps to come, between two steps. state: its history (second order) is brought to the new
   substep by the parabola through it; null leaves it alone. */
void pel_projector_set_substeps(pel_projector *projector, pel_state *state, int32_t substeps);
/* The same with another length of the step [s], for a part of one: there corrections of pbd are smaller by the square
   of the ratio of its substep to the whole one, for they act as a stiffness of mass / substep^2. So a body is as stiff
   in parts as in whole steps, and what holds it feels the same force. */
void pel_projector_set_time(pel_projector *projector, pel_state *state, double dt, int32_t substeps);

/* From now on substeps record the force [N] that the body exerts on what holds each vertex that is pinned or held:
   the multipliers of its constraints and the forces given, summed over substeps (pel_projector_reaction gives the
   mean). PEL_OUT_OF_MEMORY. */
pel_status pel_projector_record_reactions(pel_projector *projector, pel_error *error);
/* After other vertices are held than before, or other elements are there: is_held (vertex_count), null = none. */
void pel_projector_hold(pel_projector *projector, const uint8_t *is_held);

/* Before the substeps of a step: keyed numbers at a time, and directions that follow the state. */
void pel_projector_begin(pel_projector *projector, const pel_state *state, double time);

/* where a substep stands in its step; one may be both */
typedef enum pel_substep_place {
    PEL_SUBSTEP_BETWEEN = 0,
    PEL_SUBSTEP_FIRST = 1,
    PEL_SUBSTEP_LAST = 2
} pel_substep_place;

/* Before the forces of a substep: the order of each body, plain where is_pressed. */
void pel_project_choose_orders(pel_projector *projector, const pel_state *state, pel_substep_place place);
/* One substep from state->position and velocity (first) or from the end of the one before, in three parts: predict
   writes position_next, sweeps move it, finish measures velocities (velocity_next, valid after the last substep).
   force (vertex_count): at the start of the substep; left as 0. */
void pel_project_predict(pel_projector *projector, pel_state *state, pel_record *force, const pel_boundary *boundary,
                         pel_substep_place place);
/* One sweep over the constraints of all bodies, contacts excluded. */
void pel_project_sweep(const pel_projector *projector, pel_record *positions);
/* contacts (list_count, each nullable): those that acted in this substep. */
void pel_project_finish(pel_projector *projector, pel_state *state, const pel_contact_list *const *contacts,
                        int list_count, const pel_boundary *boundary, pel_substep_place place);
/* Positions at the start of the present substep (vertex_count). */
const pel_record *pel_project_substep_start(const pel_projector *projector);
/* Restarts the history of a body at the present state. */
void pel_projector_restart(const pel_projector *projector, pel_state *state, int32_t body);

/* The share of the last step's corrections by PEL_FIBRE_NORMAL that their bound cut; false if there are none. */
bool pel_projector_limited(const pel_projector *projector, double *share);

/* After an accepted step: stores its history in the state. */
void pel_projector_accept(pel_projector *projector, pel_state *state);

/* ---- project_body.c ---- */

/* Before the substeps of a step: numbers of its batches at a time. */
/* solver: dt and substeps of a whole step */
void pel_project_body_begin(pel_batches *batches, int32_t body, const pel_solver_def *solver, const pel_state *state,
                            double time);
typedef struct pel_project_time {
    double tau;               /* s, that compliances are over */
    double share;             /* of each correction of pbd */
    double ratio;             /* of the substep to a whole step */
    int32_t iterations;       /* sweeps of a substep */
    double substep;           /* s, whole */
    const pel_record *before; /* (vertex_count) positions at its start */
} pel_project_time;

void pel_project_body_set_time(const pel_body *body, pel_body_batches *own, const double *factors,
                               const pel_project_time *time);
/* Marks the blocks with a vertex that is fixed: there reactions are recorded. */
void pel_project_body_mark_fixed(pel_body_batches *own, const uint8_t *is_fixed);

/* ---- project_cave.c ---- */

/* Before the substeps of a step: how far each corner goes in a projection. dt and substeps of the solver are those of
   the whole step, so that a body goes in as fast in parts. */
void pel_project_cave_begin(const pel_batch *batch, const pel_shell *shell, const pel_state *state,
                            const pel_solver_def *solver);

/* ---- project_wide.c, project_plain.c ---- */

/* projects the blocks begin .. end - 1 of a batch in their order */
typedef void pel_batch_sweep(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions);

/* passes of a strain limit in a sweep */
enum { PEL_LIMIT_PASSES = 6 };

/* a fibre that is so much shorter than at rest drives its triangle inward by the strength of the region in a step */
#define PEL_CAVE_STRAIN 0.05

/* the kernels for all lanes at once, and the plain ones lane by lane: the same bits; null for a pressure */
extern pel_batch_sweep *const pel_project_wide[PEL_CONSTRAINT_COUNT];
extern pel_batch_sweep *const pel_project_plain[PEL_CONSTRAINT_COUNT];

#endif
