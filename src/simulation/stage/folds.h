/* Plastic folds of hinges that yield (measure/fold.h). They slip at the end of each part of a step, or of each substep,
   in state->folds_next, and are the state's once the part is accepted. */
#ifndef PEL_STAGE_FOLDS_H
#define PEL_STAGE_FOLDS_H

#include "stage/stage.h"

/* Before a part: the folds of the state. Also after a snapshot. */
void pel_folds_begin(pel_sim *sim);
/* Lets them slip at some positions, and adds the work to sim->fold_loss. */
void pel_folds_follow(pel_sim *sim, const pel_record *position);
/* They become the state's. */
void pel_folds_accept(pel_sim *sim);

#endif
