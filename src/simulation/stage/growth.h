/* What grows (pel_membrane_def, rest_keys): its shape without stress at each time, in the flows of state->plastic_next
   (plastic.h), and the work of growth, sim->growth_work and growth_size. */
#ifndef PEL_STAGE_GROWTH_H
#define PEL_STAGE_GROWTH_H

#include "stage/stage.h"

/* At the start of a part of a step, after pel_plastic_begin: the shape at its end for methods whose forces are those of
   the end, else that at its start. */
void pel_growth_begin(pel_sim *sim);
/* The shape at a share of the part: 1 at its end. */
void pel_growth_follow(pel_sim *sim, double share);
/* At the end, with the new positions in the state, before pel_plastic_follow. */
void pel_growth_end(pel_sim *sim);

#endif
