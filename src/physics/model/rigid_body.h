/* Rigid bodies of a model: checks of their defs, their shape, and masses of their vertices with the same center. */
#ifndef PEL_MODEL_RIGID_BODY_H
#define PEL_MODEL_RIGID_BODY_H

#include "pellicle/model.h"
#include "rigid/rigid.h"

/* Refuses numbers out of range, and parts that a rigid body cannot have. PEL_BAD_ARGUMENT. */
pel_status pel_rigid_body_check(const pel_body_def *def, int32_t body, pel_error *error);
/* Numbers of a deformable body, which a rigid one does not read, become 0. */
void pel_rigid_body_stiffen(pel_body_def *def);
/* The shape of the body, and masses of its vertices in place of areas (mesh vertex_count) [kg]; volume [m3]: 0 = its
   mesh is open or flat. PEL_BAD_ARGUMENT, PEL_OUT_OF_MEMORY; free with pel_free. */
pel_status pel_rigid_body_create(const pel_body_def *def, double volume, double *areas, pel_rigid_shape **shape,
                                 pel_error *error);

#endif
