/* Restitution: how bodies and tools part after a collision. */
#ifndef PEL_TOUCH_RESTITUTION_H
#define PEL_TOUCH_RESTITUTION_H

#include "stage/stage.h"

/* After contacts. PEL_BAD_ARGUMENT for a number out of range or a method without velocities, PEL_OUT_OF_MEMORY. */
pel_status pel_restitution_create(pel_sim *sim, pel_error *error);
/* After a step that is accepted. */
void pel_restitution_apply(pel_sim *sim);

#endif
