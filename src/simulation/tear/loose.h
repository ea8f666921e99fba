/* Pieces that cuts and tears have parted from a body, and that nothing holds. */
#ifndef PEL_TEAR_LOOSE_H
#define PEL_TEAR_LOOSE_H

#include "stage/stage.h"

/* Finds them in the bodies of a static method, which has no balance for them: sim->loose. Where contact, a filling, or
   a tool that presses or grasps may hold them, and in bodies that nothing holds at all, none is found.
   PEL_OUT_OF_MEMORY. */
pel_status pel_loose_find(pel_sim *sim, pel_error *error);
/* Fixes them where they are. */
void pel_loose_fix(const pel_sim *sim, const double *unknowns, uint8_t *fixed, double *target);
/* a body that has any; -1 = none */
int32_t pel_loose_body(const pel_sim *sim);

#endif
