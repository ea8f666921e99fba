/* Position-based dynamics: pbd as in paper B (energies as constraints), pbd-distance (edge lengths) and xpbd.

   A substep of length h predicts from velocity, forces and springs to the rest places, projects, and takes the velocity
   from the way that was gone. With the base y and the time tau, first order y = x, tau = h; second order (BDF2)
   y = (4 x - x') / 3, tau = 2 h / 3 with x' one substep before and velocities alike:

       x* = y + tau u + tau^2 w f,      u = v or (4 v - v') / 3
       v  = (x - y) / tau               after the sweeps

   A substep without a past, the first one, is of first order; where a contact acts the past is made anew from the
   velocity that it leaves. (Velocities from three positions and x* = x + h v, as often done, are not consistent: a free
   fall gets twice its acceleration.)

   Volumetric springs k' and drag d of a vertex are quadratic in its own position: they are taken up exactly by a mass
   that is larger by tau d + tau^2 k', with x* drawn to the rest place; no constraint is needed for them. So is the drag
   of the solver in second order; in first order it is the factor exp(-drag h) on velocities.

   Sweeps go body by body over springs, triangles, hinges and fibres, then over the contacts. The constraints of a body
   stand in bundles that share no vertex: pieces of the surface, then the seams between neighbouring pieces, even and
   odd ones, then the few that touch other pairs of pieces. Bundles of a phase may run at once; the order within a
   bundle is fixed, and so are the bits. */
#ifndef PEL_SOLVE_PROJECT_H
#define PEL_SOLVE_PROJECT_H

#include "base/pool.h"
#include "model/boundary.h"
#include "model/contact.h"
#include "model/shell.h"
#include "model/state.h"
#include "pellicle/sim.h"
#include "solve/project_batch.h"

/* all that a body's sweeps need */
typedef struct pel_project_body {
    struct pel_build_scratch *scratch; /* kept when the body refines, else null */
    int32_t piece_count;               /* bundles: pieces, seams (piece_count - 1), the rest */
    int32_t *piece_of_place;           /* (places of the body) */
    int32_t batch_count;               /* in the order of the sweep */
    pel_batch *batches;
    uint8_t *is_on; /* (batch_count) 0 = has no effect at present */
    double *areas;  /* (places of the body) m2 at rest, of the triangles around; null unless a region caves in */
    int32_t first_place;
    pel_batch *pressure; /* of the consistent form; else null */
} pel_project_body;

typedef struct pel_bundle {
    int32_t body, number;
} pel_bundle;

enum { PEL_PHASE_COUNT = 4 };

typedef struct pel_projector {
    const pel_model *model;
    pel_solver_def solver;
    bool is_plain;                               /* runs the plain kernels: for tests and benchmarks */
    bool is_held;                                /* a vertex has drag or a volumetric spring of its own */
    double substep, tau;                         /* s; tau of the present substep */
    pel_project_body *bodies;                    /* (model body_count) */
    pel_bundle *bundles;                         /* by phase */
    int32_t phase_begin[PEL_PHASE_COUNT + 1];    /* in bundles */
    pel_record *base;                            /* (vertex_count) y of the substep */
    pel_record *older_position, *older_velocity; /* (vertex_count) second order: x' and v' of the next substep */
    uint8_t *touches;                            /* (body_count) second order: scratch */
    pel_record *reaction;                        /* (vertex_count) see pel_projector_record_reactions; null = none */
    uint8_t *is_fixed;                           /* (vertex_count) pinned or held; null without reactions */
    pel_pool *pool;                              /* set by the owner; null = one thread */
} pel_projector;

/* Lays out the constraints of all bodies for the solver's method. iterations and substeps have to be above 0. Errors:
   PEL_OUT_OF_MEMORY. */
pel_status pel_projector_create(const pel_model *model, const pel_solver_def *solver, pel_projector **projector,
                                pel_error *error);
void pel_projector_destroy(pel_projector *projector);

/* Changes the substeps of the steps to come, between two steps. state: its history (second order) is brought to the new
   substep by the parabola through it; null leaves it alone. */
void pel_projector_set_substeps(pel_projector *projector, pel_state *state, int32_t substeps);
/* The same with another length of the step [s]. */
void pel_projector_set_time(pel_projector *projector, pel_state *state, double dt, int32_t substeps);

/* After the surface of a body that refines has changed. */
void pel_projector_follow(pel_projector *projector, int32_t body);

/* From now on substeps record the force [N] that the body exerts on what holds each vertex that is pinned or held: the
   multipliers of its constraints and the forces given, summed over substeps (pel_projector_reaction gives the mean).
   PEL_OUT_OF_MEMORY. */
pel_status pel_projector_record_reactions(pel_projector *projector, pel_error *error);
/* After other vertices are held than before: is_held (vertex_count), null = none. */
void pel_projector_hold(pel_projector *projector, const uint8_t *is_held);

/* Before the substeps of a step: keyed numbers at a time, and directions that follow the state. */
void pel_projector_begin(pel_projector *projector, const pel_state *state, double time);

/* Adds the forces of all pressures in the consistent form at a time to force (vertex_count). */
void pel_projector_add_pressure(pel_projector *projector, const pel_record *positions, double time, pel_record *force);

/* where a substep stands in its step; one may be both */
typedef enum pel_substep_place {
    PEL_SUBSTEP_BETWEEN = 0,
    PEL_SUBSTEP_FIRST = 1,
    PEL_SUBSTEP_LAST = 2
} pel_substep_place;

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

/* After a step that is accepted: what the next one has to know of this one goes to the state. */
void pel_projector_accept(pel_projector *projector, pel_state *state);

/* ---- project_body.c ---- */

/* Constraints and bundles of a body. PEL_OUT_OF_MEMORY. */
pel_status pel_project_body_create(const pel_model *model, int32_t body, const pel_solver_def *solver,
                                   pel_project_body *made, pel_error *error);
void pel_project_body_destroy(pel_project_body *body);
/* After the surface of a body that refines has changed: lays out its constraints anew, without allocation. */
void pel_project_body_follow(const pel_model *model, int32_t body, const pel_solver_def *solver,
                             pel_project_body *made);
/* Before the substeps of a step: numbers of its batches at a time. */
void pel_project_body_begin(pel_project_body *own, const pel_model *model, int32_t body, const pel_solver_def *solver,
                            const pel_state *state, double time);
/* the time that compliances are over */
void pel_project_body_set_time(pel_project_body *own, const double *factors, double tau);
/* Marks the blocks with a vertex that is fixed: there reactions are recorded. */
void pel_project_body_mark_fixed(pel_project_body *own, const uint8_t *is_fixed);

/* ---- project_cave.c ---- */

/* Areas around the vertices of a body with a region that caves in, for its present surface. */
void pel_project_cave_measure(pel_project_body *own, const pel_shell *shell, int32_t first_place, int32_t place_count);
/* Weight and shares of the i-th constraint of such a region. */
void pel_project_cave_fill(const pel_project_body *own, const pel_shell *shell, const pel_batch *batch, int32_t i);
/* Before the substeps of a step: how far each corner goes in a projection. */
void pel_project_cave_begin(const pel_batch *batch, const pel_shell *shell, const pel_state *state,
                            const pel_solver_def *solver);

/* ---- project_build.c ---- */

/* constraints to be laid out: vertices (count x arity) in the order of their numbers */
typedef struct pel_constraint_source {
    const int32_t *vertices;
    int32_t count;
} pel_constraint_source;

typedef struct pel_build_scratch {
    int32_t *vertices;               /* (4 x count_limit) room for a list of constraints */
    int32_t *origins;                /* (count_limit) */
    int32_t *order, *sorted, *color; /* (count_limit) */
    int32_t *counts;                 /* (place or constraint number + 2, whichever is more) */
    uint64_t *masks;                 /* (model vertex_count) colours taken at a vertex */
    int32_t *bundles;                /* (bundle_count + 1) */
    int32_t count_limit;
} pel_build_scratch;

pel_status pel_build_scratch_create(pel_build_scratch *scratch, const pel_model *model, int32_t count_limit,
                                    int32_t bundle_count, pel_error *error);
void pel_build_scratch_destroy(pel_build_scratch *scratch);

/* Room for `capacity` blocks in `bundle_count` bundles of a batch, of which arity and counts are set. */
pel_status pel_batch_reserve(pel_batch *batch, int32_t capacity, int32_t bundle_count, bool with_multipliers,
                             pel_error *error);

/* Blocks that suffice for count_limit constraints on any surface on which no vertex has more than `most` of them. */
int32_t pel_batch_bound(const pel_batch *batch, int32_t count_limit, int32_t bundle_count, int32_t most);

/* Fills bundles and blocks of a batch, of which kind, arity and counts are set, from scratch->vertices (count x arity);
   sources are scratch->origins. Makes room first when there is none. The numbers are left to the caller. */
pel_status pel_batch_build(pel_batch *batch, const pel_project_body *body, int32_t first_place, int32_t place_count,
                           int32_t count, bool with_multipliers, pel_build_scratch *scratch, pel_error *error);
void pel_batch_destroy(pel_batch *batch);

#endif
