/* Intersections at the start. */
#ifndef PEL_TOUCH_TANGLE_H
#define PEL_TOUCH_TANGLE_H

#include "stage/stage.h"

/* Refuses intersections found at the start, and tools inside of bodies. PEL_BAD_ARGUMENT. */
pel_status pel_contacts_refuse_tangles(const pel_sim *sim, pel_error *error);

/* Refuses a body that starts inside of another one's tetrahedra, which have contact at their surface only, unless a tie
   joins both. PEL_BAD_ARGUMENT. */
pel_status pel_contacts_refuse_buried(const pel_sim *sim, const pel_sim_def *def, pel_error *error);

/* After a cut: refuses intersections that the simulation before it did not have, whose cut is held back then.
   PEL_BAD_ARGUMENT, and errors of pel_tangles_find. */
pel_status pel_contacts_check_lips(pel_sim *before, pel_sim *sim, pel_error *error);

/* Elements that start nearer to each other than their contact thickness: contact pushes them apart. */
typedef struct pel_start_gap {
    int64_t count;         /* pairs of elements */
    double gap, thickness; /* m, of the pair that lacks most of its thickness */
    int32_t groups[2];     /* its bodies, or body count and the number of a tool */
} pel_start_gap;

/* Looks for them at the present positions, with a search of its own: nothing of the simulation changes. Errors of
   pel_collider_detect. */
pel_status pel_contacts_find_start_gap(pel_sim *sim, pel_start_gap *gap, pel_error *error);
/* "body 'ball'" or "tool 'plate'" */
void pel_contacts_name_group(const pel_sim *sim, int32_t group, char *text, size_t size);

#endif
