/* Pellicle: the certificate: do triangles of a mesh cut each other? Decided exactly, for the positions as they are. */
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

/* Finds the pairs of triangles that have a point in common beyond the corners they share (see
   pel_triangles_intersect_beyond: touching counts; so does a triangle without area with each of its neighbours, and the
   same triangle twice). The mesh may be open, non-manifold or in pieces. Triangles with a bad index, a repeated vertex
   or a vertex that is not finite take no part.

   count       receives the number of all pairs, exactly; 0 = the surface is free of self-intersections
   pairs       (pair_limit) receives up to pair_limit of them, first < second, in rising order; nullable when 0
   The work is bounded: PEL_BAD_MESH, with the vertex of the most triangles, when the boxes of more than 100 pairs a
   triangle and 4,000,000 others overlap, as around a vertex of thousands of triangles. PEL_OUT_OF_MEMORY,
   PEL_BAD_ARGUMENT (counts below 0, or more than 2^31 / 7 triangles); *count is 0 then. */
PEL_API pel_status pel_mesh_self_intersections(const pel_mesh *mesh, pel_pair *pairs, int32_t pair_limit,
                                               int64_t *count, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
