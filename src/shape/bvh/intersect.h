#ifndef PEL_BVH_INTERSECT_H
#define PEL_BVH_INTERSECT_H

#include "pellicle/intersect.h"

/* Whether a triangle before `split` (1 .. triangle_count) and one from it on have a common point beyond common corners,
   as pel_mesh_self_intersections finds them, in less time. PEL_OUT_OF_MEMORY; PEL_BAD_MESH where too many boxes
   overlap. */
pel_status pel_mesh_parts_intersect(const pel_mesh *mesh, int32_t split, bool *found);

#endif
