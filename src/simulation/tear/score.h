/* What a simulation counts of its tools while a tear is led. */
#ifndef PEL_TEAR_SCORE_H
#define PEL_TEAR_SCORE_H

#include "stage/stage.h"

/* After a step: adds it to the sums, if a tool leads a tear. PEL_OUT_OF_MEMORY. */
pel_status pel_score_add(pel_sim *sim, pel_error *error);

#endif
