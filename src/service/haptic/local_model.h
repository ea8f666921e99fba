/* The local model of the surface at a tool: planes taken from the last step of a simulation. */
#ifndef PEL_HAPTIC_LOCAL_MODEL_H
#define PEL_HAPTIC_LOCAL_MODEL_H

#include "haptic/proxy.h"

/* Stiffness of the surface, learned from pairs of steps: sums with a fading memory of the least squares fit
   change of force = -stiffness * change of depth. */
typedef struct pel_surface_estimate {
    double stiffness;    /* N/m, at present */
    double least, most;  /* N/m, bounds */
    double force_change; /* N m, sum of changes of force times changes of depth */
    double depth_change; /* m2, sum of squares */
} pel_surface_estimate;

/* Takes the model of a tool from the last step. last: the model taken before, for the estimate; null = none. */
void pel_local_model_take(pel_sim *sim, int32_t tool, double reach, const pel_local_model *last,
                          pel_surface_estimate *estimate, pel_local_model *model);

#endif
