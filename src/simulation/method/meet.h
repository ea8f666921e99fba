/* What acts between bodies, tools and the world in a substep, on predicted positions: contacts, the solids of tools,
   attachments and stitches, joints. Shared by methods with constraints and by the explicit one with rigid bodies. */
#ifndef PEL_METHOD_MEET_H
#define PEL_METHOD_MEET_H

#include "stage/stage.h"

/* one substep */
typedef struct pel_meeting {
    double end;              /* s, its end */
    double length, tau;      /* s; the time that compliances are over */
    const pel_record *start; /* (vertex_count) positions at its start */
} pel_meeting;

/* At the start of a step: searches what may touch in it; what wakes by it is searched anew. Errors of
   pel_contacts_find. */
pel_status pel_meet_find(pel_sim *sim, bool has_pairs, pel_error *error);
/* Takes the loads of the step before, for substeps of a length [s]. */
void pel_meet_recall(pel_sim *sim, double length);
/* At the predicted positions: multipliers, the kept loads. */
void pel_meet_begin(pel_sim *sim, const pel_meeting *meeting);
/* Sweeps over ties, then over joints and contacts until their loads hardly change. */
void pel_meet_sweep(pel_sim *sim, const pel_meeting *meeting);
/* Sums the loads of a substep; those of ties on vertices that do not move into reaction (vertex_count; null = none). */
void pel_meet_tally(pel_sim *sim, const pel_meeting *meeting, pel_record *reaction);
/* After the last substep: forces of contacts, and the loads for the next step. */
void pel_meet_end(pel_sim *sim);

/* Marks bodies (body_count) of contacts that carry loads from the substep before. */
void pel_meet_mark_pressed(const pel_sim *sim, uint8_t *bodies);
/* And those that pairs, or ties between any, connect with marked ones. */
void pel_meet_spread(const pel_sim *sim, uint8_t *bodies);
/* contacts of pairs and of solids in the substeps; null = none */
void pel_meet_lists(const pel_sim *sim, pel_contact_list *lists[2]);

#endif
