/* Energy of the springs that an event of refinement changes. */
#ifndef PEL_REFINED_EVENT_ENERGY_H
#define PEL_REFINED_EVENT_ENERGY_H

#include "refined/refined_model.h"

/* Energy of the springs at some places of a body, each once, and of their volumetric springs [J]. force (by place),
   when given, gets their forces added at these places. */
double pel_event_energy(pel_refined_model *active, int32_t body, const pel_state *state, const int32_t *places,
                        int32_t count, pel_record *force);

#endif
