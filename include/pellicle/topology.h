/* Pellicle: half-edges of a triangle mesh as a corner table (paper A, section 3.4, without pointers).
   Half-edge h = 3 t + i runs from corner i of triangle t to corner i + 1; next and previous are arithmetic. */
#ifndef PELLICLE_TOPOLOGY_H
#define PELLICLE_TOPOLOGY_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Immutable after creation. A query of neighbours takes constant time per visited element. */
typedef struct pel_topology {
    int32_t vertex_count, triangle_count, edge_count;
    int32_t boundary_edge_count;
    int32_t (*triangles)[3];    /* (triangle_count x 3), a copy */
    int32_t *twin;              /* (3 triangle_count) opposite half-edge, -1 on the boundary */
    int32_t *corner_of_vertex;  /* (vertex_count) an outgoing half-edge; -1 = isolated. On the boundary it is the one
                                   from which pel_half_edge_turn visits all outgoing half-edges of the vertex */
    int32_t *edge_of_half_edge; /* (3 triangle_count) */
    int32_t *half_edge_of_edge; /* (edge_count) the lower of its half-edges; edges are numbered by it */
} pel_topology;

/* Builds the table in linear time. Refuses (PEL_BAD_MESH with edge or vertex) meshes that are not oriented manifolds
   with boundary: an edge in more than two triangles, two triangles with opposite winding, a vertex whose triangles do
   not form one fan, a triangle with a repeated vertex. Free with pel_topology_destroy. */
PEL_API pel_status pel_topology_create(const pel_mesh *mesh, pel_topology **topology, pel_error *error);
PEL_API void pel_topology_destroy(pel_topology *topology);

static inline int32_t pel_half_edge_next(int32_t h)
{
    return h % 3 == 2 ? h - 2 : h + 1;
}
static inline int32_t pel_half_edge_previous(int32_t h)
{
    return h % 3 == 0 ? h + 2 : h - 1;
}
static inline int32_t pel_half_edge_origin(const pel_topology *topology, int32_t h)
{
    const int32_t *origin = topology->triangles[0];
    return origin[h];
}
static inline int32_t pel_half_edge_target(const pel_topology *topology, int32_t h)
{
    return pel_half_edge_origin(topology, pel_half_edge_next(h));
}
/* The next outgoing half-edge around the same origin, counter-clockwise; -1 after the boundary. */
static inline int32_t pel_half_edge_turn(const pel_topology *topology, int32_t h)
{
    return topology->twin[pel_half_edge_previous(h)];
}

#ifdef __cplusplus
}
#endif
#endif
