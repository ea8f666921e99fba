/* Rigid part of the motion of a body, from its momentum and angular momentum. */
#ifndef PEL_STAGE_RIGID_MOTION_H
#define PEL_STAGE_RIGID_MOTION_H

#include "stage/stage.h"

typedef struct pel_rigid_motion {
    bool is_free; /* else nothing but zeros: pins or tools hold the body */
    double inverse_mass, center[3], velocity[3], spin[3];
    double momentum[3];           /* angular, about the center */
    double inverse_inertia[3][3]; /* zeros for a body on a line */
} pel_rigid_motion;

pel_rigid_motion pel_rigid_motion_of(const pel_sim *sim, int32_t body, const pel_record *position,
                                     const pel_record *velocity);
/* y = m x */
void pel_rigid_apply(const double m[3][3], const double x[3], double y[3]);

#endif
