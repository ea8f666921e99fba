/* What sheets that yield or grow remember (measure/plastic.h). It slips at the end of each part of a step, or of each
   substep, in state->plastic_next, and is the state's once the part is accepted. */
#ifndef PEL_STAGE_PLASTIC_H
#define PEL_STAGE_PLASTIC_H

#include "stage/stage.h"

/* Before a part: that of the state. Also after a snapshot. */
void pel_plastic_begin(pel_sim *sim);
/* Lets it slip at some positions, and adds the work to sim->plastic_loss. */
void pel_plastic_follow(pel_sim *sim, const pel_record *position);
/* Continues a hash by it, as the part in progress has it: what a matrix depends on. */
uint64_t pel_plastic_hash(const pel_sim *sim, uint64_t hash);
/* It becomes the state's. */
void pel_plastic_accept(pel_sim *sim);

#endif
