/* Intersections at the start. */
#ifndef PEL_TOUCH_TANGLE_H
#define PEL_TOUCH_TANGLE_H

#include "stage/stage.h"

/* Refuses intersections found at the start, and tools inside of bodies. PEL_BAD_ARGUMENT. */
pel_status pel_contacts_refuse_tangles(const pel_sim *sim, pel_error *error);

#endif
