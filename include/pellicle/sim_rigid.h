/* Pellicle: rigid bodies of a simulation (pel_rigid_def in pellicle/model.h). */
#ifndef PELLICLE_SIM_RIGID_H
#define PELLICLE_SIM_RIGID_H

#include "sim_step.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Place and motion of a rigid body, of its center of mass. */
typedef struct pel_rigid_reading {
    double mass;                 /* kg */
    double center[3];            /* m */
    double rotation[4];          /* unit quaternion (x, y, z, w) from the rest shape to now */
    double velocity[3], spin[3]; /* m/s, rad/s */
    double momentum[3];          /* N s */
    double angular_momentum[3];  /* N m s, about the center */
    double kinetic_energy;       /* J */
} pel_rigid_reading;

/* Reads the state of a rigid body after the last step; false, and nothing is written, for a body that deforms or does
   not exist. */
PEL_API bool pel_sim_get_rigid(const pel_sim *sim, int32_t body, pel_rigid_reading *reading);

#ifdef __cplusplus
}
#endif
#endif
