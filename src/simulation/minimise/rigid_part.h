/* Rigid bodies of the methods static and implicit: six unknowns of each (newton/rigid.c), their inertia, their momenta.
 */
#ifndef PEL_MINIMISE_RIGID_PART_H
#define PEL_MINIMISE_RIGID_PART_H

#include "newton/newton.h"
#include "stage/stage.h"

/* A scheme in time, with the unknown positions y: u = rate / dt (y - anchor), m rate / dt (u - carried) + c u = F(y).
 */
typedef struct pel_implicit_scheme {
    double rate;
    double position[2], velocity[2]; /* anchor and carried: weights of the start of the step and of another state */
    double other;                    /* when that was, in steps after the start: one step earlier, or a stage */
    const struct pel_implicit_scheme *first; /* the stage before this one, which is that other state; null = none */
    double end;                              /* x_1 = end y + (1 - end) x, v_1 = end u + (1 - end) v */
    pel_span acts;                           /* when loads act, in steps after the start of the step */
} pel_implicit_scheme;

typedef struct pel_rigid_part pel_rigid_part;

typedef struct pel_rigid_parts {
    pel_newton_rigids rigids; /* those that move */
    pel_rigid_part *items;    /* (bodies that are rigid) of the step in time */
    double *unknowns;         /* (3 vertex_count and more) m, of the solver */
    bool is_dynamic;
} pel_rigid_parts;

/* For a solver with its unknowns; nothing without rigid bodies. PEL_OUT_OF_MEMORY. */
pel_status pel_rigid_parts_create(const pel_sim *sim, double *unknowns, bool is_dynamic, pel_rigid_parts *parts,
                                  pel_error *error);
void pel_rigid_parts_destroy(pel_rigid_parts *parts);
/* Marks in `fixed` which unknowns bodies own, and which of them move; bodies that are free stay where they are (null:
   they move). Returns those that move, null for none. */
const pel_newton_rigids *pel_rigid_parts_gather(const pel_sim *sim, pel_rigid_parts *parts,
                                                bool (*is_free)(const pel_sim *sim, int32_t body), uint8_t *fixed);
/* Rows of joints for the first run of a step, with its loads (3 vertex_count) [N]; whether joints are apart after as
   many runs, so that one with their new loads has to follow. */
void pel_rigid_parts_join(pel_sim *sim, const double *loads, pel_rigid_parts *parts);
bool pel_rigid_parts_are_apart(pel_sim *sim, int runs);
/* The motion that inertia would go on with in a step or stage; positions and velocities (vertex_count) of the other
   state of the scheme. */
void pel_rigid_parts_refer(const pel_sim *sim, pel_rigid_parts *parts, const pel_implicit_scheme *scheme,
                           const pel_record *positions, const pel_record *velocities);
/* Anchor and carried velocity of a vertex, as of pel_sim_turn_refer; false where it is of no rigid body. */
bool pel_rigid_parts_anchor(const pel_sim *sim, const pel_rigid_parts *parts, int32_t v, double anchor[3],
                            double carried[3]);
/* Momenta at the end of a step in time, and velocities of vertices. */
void pel_rigid_parts_finish(const pel_sim *sim, const pel_rigid_parts *parts);
/* Where a body collided the velocities of its vertices tell that of its center. */
void pel_rigid_parts_collide(const pel_sim *sim, const pel_rigid_parts *parts,
                             bool (*collided)(const pel_sim *sim, int32_t body));
/* Bodies go a share of the way to where the unknowns have them, with the motion of that, and so do their vertices. */
void pel_rigid_parts_go(const pel_sim *sim, const pel_rigid_parts *parts, double share,
                        bool (*goes)(const pel_sim *sim, int32_t body));
/* bodies go where the unknowns have them, and the unknowns to their places */
void pel_rigid_parts_take(const pel_sim *sim, const pel_rigid_parts *parts);

#endif
