/* Growth of membranes (pel_membrane_def, rest_keys): keeps their shape without stress in the flows of
   state->plastic_next (plastic.h), and books the work in sim->growth_work and growth_size. */
#ifndef PEL_STAGE_GROWTH_H
#define PEL_STAGE_GROWTH_H

#include "stage/stage.h"

/* Call at the start of a part of a step, after pel_plastic_begin. Sets the shape for the whole part: that at the end of
   the part for equilibria, in its middle for implicit steps in time, at its start for the other methods. */
void pel_growth_begin(pel_sim *sim);
/* Sets the shape at a share of the part (1: its end). Returns false if nothing grows in this part. */
bool pel_growth_follow(pel_sim *sim, double share);
/* Call at the end, with the new positions in state->position_next and before pel_plastic_follow. */
void pel_growth_end(pel_sim *sim);

#endif
