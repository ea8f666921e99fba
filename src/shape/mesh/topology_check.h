/* The whole of a half-edge table, checked. */
#ifndef PEL_MESH_TOPOLOGY_CHECK_H
#define PEL_MESH_TOPOLOGY_CHECK_H

#include "pellicle/topology.h"

/* Whether all arrays hold what pellicle/topology.h says of them: a manifold with boundary whose triangles have three
   vertices each, twins that run back, edges numbered by the lower of their half-edges, fans that reach every triangle
   of their vertex. Linear time, no allocation. */
bool pel_topology_is_valid(const pel_topology *topology);

#endif
