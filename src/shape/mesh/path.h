/* A path over a surface along edges: vertices near it move onto it, so no triangle is divided. */
#ifndef PEL_MESH_PATH_H
#define PEL_MESH_PATH_H

#include "pellicle/topology.h"

typedef struct pel_path_trace {
    int32_t *vertices; /* (count) joined by edges; of a path that is shut the first is the last as well */
    int32_t count;
    double least_angle;   /* rad, of the triangles at vertices that were moved; pi without any */
    int32_t failed_point; /* on failure: the point of the path that was being approached */
} pel_path_trace;

/* Moves vertices of the mesh onto straight lines between points (point_count >= 2, all apart) and names them in order.
   Vertices with marks (vertex_count) stay where they are: those of other paths; new ones are marked. Vertices on the
   border move along straight borders only. Each step goes half the edges of the mesh ahead and half its own, to the
   neighbour that leaves the best smallest angle around it; where all would leave angles below 12 degrees, the path
   follows the edge that is nearest to it as it is. PEL_BAD_ARGUMENT if a point is farther above or below the
   surface than twice the mean edge at the vertex nearest to it, the first one is farther from that, the path leaves the
   surface or meets itself; the mesh may have moved then. PEL_OUT_OF_MEMORY. Free the vertices with pel_free. */
pel_status pel_path_trace_points(pel_mesh *mesh, const pel_topology *topology, const double (*points)[3],
                                 int32_t point_count, uint8_t *marks, pel_path_trace *trace, pel_error *error);

/* One step of such a path from a vertex into a direction (unit): the neighbour that it leads to, which is marked; -1 if
   no edge leads that way. PEL_OUT_OF_MEMORY. */
pel_status pel_path_step(pel_mesh *mesh, const pel_topology *topology, int32_t tip, const double direction[3],
                         uint8_t *marks, int32_t *vertex, pel_error *error);

#endif
