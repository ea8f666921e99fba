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

/* "body 'ball'" or "tool 'plate'" */
void pel_contacts_name_group(const pel_sim *sim, int32_t group, char *text, size_t size);

#endif
