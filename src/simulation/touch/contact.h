/* Contact in a simulation: the link between its state, tools and steppers and the set of contacts (contact/set.h). */
#ifndef PEL_TOUCH_CONTACT_H
#define PEL_TOUCH_CONTACT_H

#include "contact/set.h"
#include "stage/stage.h"
#include "touch/thickness.h"

/* A pair of groups that collides (restitution.c). */
typedef struct pel_collision_state {
    uint8_t is_on;
    int32_t idle_steps;      /* since the pair pressed last */
    double approach;         /* m/s, maximum over the collision, at the contact */
    double normal[3];        /* unit, from the higher group to the lower one */
    double point[3];         /* m */
    double contact_distance; /* m, of the centers along the normal while they touched */
    double risen;            /* m, beyond that */
} pel_collision_state;

typedef struct pel_sleep pel_sleep; /* (sleep.c) */

/* State of contact in addition to the set. */
struct pel_touch {
    pel_contact_def def;
    int64_t *revisions;          /* (body_count) of the surface in the set */
    pel_thickness_limit *limits; /* (body_count) */
    pel_contact **supports;      /* (2 vertex_count) scratch, see sweep/backing.h */
    int32_t *origins; /* (vertex_count) of each vertex the one that it was before cuts; null = nothing is cut */
    bool is_loaded;   /* memory of the collider and revisions are of a snapshot, the surface of the set is not yet */
    bool has_stepped_back; /* vertices, in this part: the guard */
    bool is_carried;       /* pairs and revisions are of another simulation, the surface of the set is not yet */
    double found_at;       /* share of the step at which the pairs were found; 1 = nothing is to be found in it */
    double found_until;    /* share of the step up to which they serve */
    bool is_same;          /* they are those of an earlier step, which serve while all is near its home */
    void *before_event;    /* (event_size) snapshot, of models that refine; else null */
    size_t event_size, event_room;
    size_t event_least;              /* of one without lists (sim/snapshot.h) */
    pel_sleep *sleep;                /* null = nothing sleeps */
    pel_collision_state *collisions; /* (pairs of contact_forces) null = no restitution */
};

/* Null contacts when they are not enabled; after pel_lips_find_origins. Errors as for pel_sim_create. */
pel_status pel_contacts_create(pel_sim *sim, const pel_contact_def *def, pel_error *error);
void pel_contacts_destroy(pel_sim *sim);
/* Points at both ends of the step: present and next positions, poses before the step and present ones. */
void pel_contacts_place(pel_sim *sim);
/* Points at the start alone: present positions and poses. */
void pel_contacts_place_start(pel_sim *sim);
/* After refinement or a snapshot: the set takes the present surface, with the points at the start. */
pel_status pel_contacts_update_surface(pel_sim *sim, pel_error *error);
/* Whether the pairs of the set are of the present surface. */
bool pel_contacts_are_of_present(const pel_sim *sim);
/* Before the solver of a method with contacts in its loop: finds pairs that may touch in this step, and all pairs
   nearer than `least` [m], except with tools. */
pel_status pel_contacts_find(pel_sim *sim, double least, pel_error *error);
/* Before a substep that begins after a share of the step: searches the pairs again if a vertex is where it was not
   expected, or if they serve no longer. now (vertex_count): present positions; base: those one substep before. Loads
   are kept. */
pel_status pel_contacts_follow(pel_sim *sim, const pel_record *now, const pel_record *base, double share,
                               pel_error *error);
/* After the last substep: margin and horizon of the next searches. */
void pel_contacts_end_search(const pel_sim *sim, const pel_record *now);
/* After the substeps: kept loads of what is asleep are forces of the step. */
void pel_contacts_tally_asleep(pel_sim *sim);
/* Between steps: contacts of these groups carry nothing any more, nor does a tool's with a body. */
void pel_contacts_forget_loads(pel_sim *sim, int32_t a, int32_t b);
/* During a minimisation: adds pairs too close on the way to the new positions, and finds the conflicts. */
pel_status pel_contacts_find_on_way(pel_sim *sim, pel_error *error);
/* At the start of a substep of this length [s], after pel_tools_place. */
void pel_contacts_begin_substep(pel_sim *sim, double substep);
/* Contacts at position_next where they need a look: see pel_contact_set_refresh. */
void pel_contacts_refresh(pel_sim *sim, const pel_record *start, bool is_first);
/* After the sweeps of a substep: its loads are forces of the step, as soon as contacts change or pel_contacts_tell is
   called. rate: see pel_contact_take. */
void pel_contacts_tally(pel_sim *sim, double rate);
/* After the last substep */
void pel_contacts_tell(pel_sim *sim);
/* After the solver: tools, contacts and guard bring position_next, velocity_next and the tools to the end of the
   step. On failure the state and the poses of the tools are those before the step. */
pel_status pel_contacts_apply(pel_sim *sim, double time, const pel_step_result *result, pel_error *error);
/* Before the step: updates the surface after refinement, and the tangled pairs after a snapshot. */
pel_status pel_contacts_begin_step(pel_sim *sim, pel_error *error);

#endif
