/* What is known of the surfaces of a simulation for those who look at its fields; made when somebody looks. */
#ifndef PEL_SIM_OBSERVE_FIELD_H
#define PEL_SIM_OBSERVE_FIELD_H

#include "pellicle/observe.h"

typedef struct pel_observer pel_observer;

void pel_observer_destroy(pel_observer *observer);

#endif
