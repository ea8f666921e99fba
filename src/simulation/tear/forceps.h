/* Forceps that lead a tear around an axis. */
#ifndef PEL_TEAR_FORCEPS_H
#define PEL_TEAR_FORCEPS_H

#include "stage/stage.h"

/* Before a step: where the tools that lead a tear go in it, and what they grasp anew. */
void pel_forceps_lead(pel_sim *sim);

#endif
