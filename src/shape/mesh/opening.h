/* Opening a surface along edges: vertices on them are doubled, so that the triangles on both sides part. Nothing moves,
   triangles keep their numbers and winding, vertices keep their numbers, and new vertices (twins) come last. */
#ifndef PEL_MESH_OPENING_H
#define PEL_MESH_OPENING_H

#include "pellicle/topology.h"

typedef struct pel_opening {
    int32_t vertex_count;    /* afterwards */
    int32_t (*triangles)[3]; /* (triangle_count of the mesh) */
    int32_t *parents;        /* (vertex_count) the vertex that a twin was split from; of other vertices themselves */
    int32_t edge_count;      /* edges that were opened */
} pel_opening;

/* Opens the edges with marks (edge_count of the topology) other than 0; those on the boundary stay as they are. The
   triangles around a vertex that hang together across unmarked edges form a sector. The sector with the lowest triangle
   keeps the vertex, the others get twins, in the order of vertices and of the turn around them: so the result depends
   only on the set of edges. An edge opens where an end of it gets a twin. PEL_OUT_OF_MEMORY. Free with
   pel_opening_clear, also on failure. */
pel_status pel_opening_find(const pel_topology *topology, const uint8_t *marks, pel_opening *opening, pel_error *error);
void pel_opening_clear(pel_opening *opening);

/* The edge between two vertices, -1 if there is none. */
int32_t pel_topology_edge_between(const pel_topology *topology, int32_t a, int32_t b);

#endif
