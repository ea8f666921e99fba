/* The active model: a copy of the model whose arrays follow the fronts of the bodies that refine.

   The loops over springs run over the same arrays whether a body refines or not. A model without refinement is used
   directly: this file affects neither its speed nor its bits. Otherwise a simulation works on a copy with room to grow:

   - The vertices of a body's mesh keep their slices and their order. Slices for the finer vertices follow; a new vertex
     takes the lowest free place, a removed vertex leaves a hole without mass or springs, like padding. So a vertex
     never moves to another place (tools may hold it), and the loops run to the last place in use.
   - The springs of a slice have room for any front: a vertex has at most one bisector in each triangle around it, that
     is twice its own number of neighbours, and twelve for a new vertex. Only the slots between slot_begin and slot_end
     are read.
   - An event rewrites the rows of the vertices whose triangles changed, from the front and the rest positions alone: a
     row does not depend on the history of the front. Springs of a row are ordered by edge number, which on the base is
     their order in the plain model: a body that has not refined yet gives the bits of the plain body.
   - Triangles have fixed numbers (pel_surface_number), so that tools can name them over events.

   An event costs what changes, and allocates nothing. Tried and rejected: moving the last vertex into a hole keeps the
   slices dense, but every list of places that a tool or a load holds would have to follow. */
#ifndef PEL_REFINED_REFINED_MODEL_H
#define PEL_REFINED_REFINED_MODEL_H

#include "model/levels.h"
#include "model/state.h"
#include "refined/shell_front.h"

/* The quasi-static method moves a vertex by factor F / m. On a finer level m falls by 4 and k stays, so that one such
   step is unstable there: those vertices are fine, and solve/relax.h moves them instead. */
typedef struct pel_relaxation {
    double factor; /* alpha dt^2; 0 = another method, no vertex is fine */
    double limit;  /* a vertex off the base is fine where factor x (its stiffness and drag) / m is larger */
    double dt;
    bool keep_velocity;
} pel_relaxation;

typedef struct pel_refined_body {
    pel_front *front;       /* null = does not refine */
    int32_t *model_index;   /* (vertices of the finest level) place in the model's order, -1 = not active */
    int32_t fine_begin;     /* first place of finer vertices */
    int32_t fine_limit;     /* and past the last possible one */
    int32_t fine_end;       /* past the last one in use */
    uint64_t *used;         /* a bit for each place from fine_begin */
    int32_t lowest_free;    /* no place below it is free, counted from fine_begin */
    int32_t triangle_limit; /* a front with more triangles has no room */
    pel_shell_front *shell; /* null = no shell */
} pel_refined_body;

typedef struct pel_refined_model {
    pel_model model;
    const pel_model *given;
    pel_refined_body *bodies;
    pel_relaxation relaxation;
    /* by place */
    int32_t *valence;    /* springs in its row */
    double *areas;       /* of the triangles around, three times its share [m2]; bodies that refine only */
    uint8_t *is_base;    /* 1 = all these triangles are of the base, or the place is not in use */
    uint8_t *is_fine;    /* 1 = one step of relaxation is unstable here; the state's inverse mass is then 0 */
    double *rates;       /* of fine vertices: bound of the eigenvalues of K / m in its row [1/s2] */
    double (*change)[3]; /* scratch: change of momentum */
    uint8_t *is_dirty;
    /* of the last event */
    int32_t *dirty;    /* active vertices (numbers of the forest) whose triangles changed */
    int32_t *released; /* places that were given up */
    int32_t dirty_count, released_count;
    double event_energy;         /* of the springs that it changed, before [J] */
    int32_t *event_places;       /* (vertex_count) scratch */
    pel_record *event_direction; /* (vertex_count) scratch */
    pel_front_corner *fan;       /* scratch of a row */
    struct pel_row_spring *row;
    struct pel_row_triangle *around;
    int32_t fan_limit;
    uint8_t *fine_counts, *mixed_counts; /* (slice_count) vertices in a slice that are fine, or off the base */
    int64_t revision;                    /* counts what changed the rows or the fine vertices */
} pel_refined_model;

/* True when any body refines. */
bool pel_model_refines(const pel_model *model);

/* The active model on its base. Errors: PEL_OUT_OF_MEMORY; PEL_BAD_ARGUMENT when a budget is too small. */
pel_status pel_refined_create(const pel_model *given, pel_refined_model **active, pel_error *error);
void pel_refined_destroy(pel_refined_model *active);

/* Commits a body's front, which has to be closed with at most triangle_limit triangles, and brings the model and the
   state after it. */
void pel_refined_commit(pel_refined_model *active, int32_t body, pel_state *state);

/* Writes the rows of all vertices again, after places were set from outside. */
void pel_refined_rebuild(pel_refined_model *active, int32_t body, pel_state *state);

/* Makes a closed and committed front take given places (a snapshot's); state is set by the caller afterwards. False,
   and nothing done, when the places do not fit the front. */
bool pel_refined_set_places(pel_refined_model *active, int32_t body, const int32_t *vertex_of_place);

/* ---- refine_transfer.c: positions and velocities over an event ---- */

/* positions of new vertices, at rest; ascending, so that the ends of their edges come first */
void pel_refine_transfer_positions(const pel_refined_model *active, int32_t body, pel_state *state);
/* gathers the momentum of what changed and gives it to what came; before rows are rebuilt */
void pel_refine_transfer_gather(pel_refined_model *active, int32_t body, const pel_state *state);
/* adds the changes to the velocities; after rows are rebuilt */
void pel_refine_transfer_apply(pel_refined_model *active, int32_t body, pel_state *state);

#endif
