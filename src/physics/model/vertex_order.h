/* Vertex order for locality. */
#ifndef PEL_MODEL_VERTEX_ORDER_H
#define PEL_MODEL_VERTEX_ORDER_H

#include "pellicle/topology.h"

/* Fills order (vertex_count): order[i] = mesh vertex at place i. Breadth-first over the edges from an end of each
   component, then sorted by valence within windows, so that the vertices of a slice have nearly equal valence. valence
   (vertex_count), of edges of the surface, is filled as well. filled: a mesh whose tetrahedra have edges too; nullable.
   Linear time. PEL_OUT_OF_MEMORY. */
pel_status pel_vertex_order_vertices(const pel_topology *topology, const pel_mesh *filled, int32_t *order,
                                     int32_t *valence, pel_error *error);

#endif
