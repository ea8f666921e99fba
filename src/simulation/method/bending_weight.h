/* Weights of bending that follow the volume. */
#ifndef PEL_METHOD_BENDING_WEIGHT_H
#define PEL_METHOD_BENDING_WEIGHT_H

#include "stage/stage.h"

/* the weights at the start */
void pel_bending_weights_start(pel_sim *sim);
/* Brings the automatic ones after the volumes of a step that was accepted. */
void pel_bending_weights_follow(pel_sim *sim);

#endif
