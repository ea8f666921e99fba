#ifndef PEL_BVH_INTERSECT_H
#define PEL_BVH_INTERSECT_H

#include "pellicle/intersect.h"

/* Whether a triangle before `split` (1 .. triangle_count) and one from it on have a common point beyond common corners,
   as pel_mesh_self_intersections finds them, in less time. PEL_OUT_OF_MEMORY; PEL_BAD_MESH where too many boxes
   overlap. */
pel_status pel_mesh_parts_intersect(const pel_mesh *mesh, int32_t split, bool *found);

/* Whether a triangle that has changed (triangle_count, 1 = it has) and any other one have such a common point: all that
   can be new where no triangles intersected before. Its time is that of passing over the triangles, for few changed
   ones. PEL_OUT_OF_MEMORY. */
pel_status pel_mesh_changed_intersect(const pel_mesh *mesh, const uint8_t *changed, bool *found);

#endif
