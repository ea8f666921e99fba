/* The 1 to 4 split of a topology in closed form: no search, no hashing.
   Vertices of the coarse level keep their numbers, edge e gets vertex vertex_count + e. Half-edges of child i at corner
   v_i of triangle t, with m_i the new vertex between v_i and v_(i+1):

              v2                       child i     (v_i m_i), (m_i m_(i-1)), (m_(i-1) v_i)      number 4 t + i
             /  \                      middle      (m_i m_(i+1))                                number 4 t + 3
           m2 -- m1
          /  \  /  \
        v0 -- m0 -- v1                                                                                       */
#ifndef PEL_SUBDIVIDE_SPLIT_H
#define PEL_SUBDIVIDE_SPLIT_H

#include "pellicle/topology.h"

/* counts of a level; 64 bits, so that levels which are too large can be refused with their numbers */
typedef struct pel_level_size {
    int64_t vertex_count, edge_count, triangle_count;
} pel_level_size;

pel_level_size pel_level_size_of(const pel_topology *topology);
pel_level_size pel_level_size_split(pel_level_size coarse);
/* true when all half-edges and vertices can be numbered by 32 bits */
bool pel_level_size_fits(pel_level_size size);
/* bytes of the arrays of a pel_topology of this size */
size_t pel_level_size_topology_bytes(pel_level_size size);

/* the topology of the next level; the same arrays that pel_topology_create makes of its triangles */
pel_status pel_topology_split(const pel_topology *coarse, pel_topology **fine, pel_error *error);

/* the triangles alone: (4 triangle_count x 3) */
void pel_topology_split_triangles(const pel_topology *coarse, int32_t (*triangles)[3]);

#endif
