/* Mean radius of curvature and mean length of the edges of a part of a mesh. */
#ifndef PEL_FIELD_RADIUS_H
#define PEL_FIELD_RADIUS_H

#include "pellicle/topology.h"

/* Of the triangles of `mesh`, whose topology is given, with their centres within `reach` of a point (infinity: of all).
   Steiner's formula for the integral of the mean curvature of a polyhedron, the sum over edges of length times angle
   over 2, here without sign; a sphere gives its radius, a cylinder twice its radius. HUGE_VAL where it is flat; edge 0
   where there is no triangle. */
void pel_mesh_mean_radius(const pel_mesh *mesh, const pel_topology *topology, const double point[3], double reach,
                          double *radius, double *edge);

#endif
