/* Cache for the fields of a simulation, created on the first access. */
#ifndef PEL_OBSERVE_OBSERVE_FIELD_H
#define PEL_OBSERVE_OBSERVE_FIELD_H

#include "pellicle/observe.h"

typedef struct pel_observer pel_observer;

void pel_observer_destroy(pel_observer *observer);

#endif
