/* Steps beside another simulation. */
#ifndef PEL_GRADIENT_STEP_BESIDE_H
#define PEL_GRADIENT_STEP_BESIDE_H

#include "stage/stage.h"

/* Features that pel_sim_step_beside refuses: PEL_BAD_ARGUMENT. */
pel_status pel_sim_check_beside(const pel_sim *sim, pel_sim *const *beside, int32_t count, pel_error *error);

#endif
