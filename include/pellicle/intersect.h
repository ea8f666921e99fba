/* Pellicle: exact test for self-intersections of a mesh, without tolerances. */
#ifndef PELLICLE_INTERSECT_H
#define PELLICLE_INTERSECT_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Two elements of one surface, by number. */
typedef struct pel_pair {
    int32_t first, second;
} pel_pair;

/* Finds the pairs of triangles with a common point beyond their shared corners (see pel_triangles_intersect_beyond:
   touching counts; a triangle without area intersects each of its neighbours, and a duplicate triangle its original).
   The mesh may be open, non-manifold or in several pieces. Triangles with a bad index, a repeated vertex or a vertex
   that is not finite are ignored.

   count       receives the exact number of all pairs; 0 = the surface has no self-intersections
   pairs       (pair_limit) receives at most pair_limit of them, first < second, in ascending order; may be null if
               pair_limit is 0
   The work is bounded: PEL_BAD_MESH, with the vertex that has the most triangles, if the boxes of more than 4,000,000
   plus 100 pairs per triangle overlap, for example around a vertex of thousands of triangles. PEL_OUT_OF_MEMORY,
   PEL_BAD_ARGUMENT (counts below 0, or more than 2^31 / 7 triangles). On failure *count is 0. */
PEL_API pel_status pel_mesh_self_intersections(const pel_mesh *mesh, pel_pair *pairs, int32_t pair_limit,
                                               int64_t *count, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
