/* The tree over all surfaces that rays are cast at. */
#ifndef PEL_OBSERVE_PICK_H
#define PEL_OBSERVE_PICK_H

#include "pellicle/live.h"

typedef struct pel_picker pel_picker;

void pel_picker_destroy(pel_picker *picker);

#endif
