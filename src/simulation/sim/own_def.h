/* The def of a simulation. */
#ifndef PEL_SIM_OWN_DEF_H
#define PEL_SIM_OWN_DEF_H

#include "def/copy.h"
#include "stage/stage.h"

/* Copies the arrays of a def, except meshes. PEL_OUT_OF_MEMORY. */
pel_status pel_sim_def_copy(pel_copies *copies, pel_sim_def *def, pel_error *error);
/* The fingerprint of the present defs. */
void pel_sim_take_fingerprint(pel_sim *sim);

#endif
