/* Which points are inside a surface or near it, in time that does not grow with the whole surface: a tree over its
   triangles is asked for those about a point, and for those that a ray from it may cross. */
#ifndef PEL_BVH_MESH_QUERY_H
#define PEL_BVH_MESH_QUERY_H

#include "pellicle/mesh.h"

typedef struct pel_mesh_query pel_mesh_query;

/* Copies the parts it needs of a mesh with at least one triangle. PEL_OUT_OF_MEMORY. */
pel_status pel_mesh_query_create(const pel_mesh *mesh, pel_mesh_query **query, pel_error *error);
void pel_mesh_query_destroy(pel_mesh_query *query);

/* True when every edge has as many triangles in one sense as in the other, so that the mesh has an inside. */
bool pel_mesh_query_is_closed(const pel_mesh_query *query);

/* How often a closed mesh winds about a point: 1 inside, -1 inside of one that is turned inside out, 0 outside. Of an
   open mesh 0. */
int32_t pel_mesh_query_winding(pel_mesh_query *query, const double point[3]);

/* True when the point is inside a closed mesh, or at most `reach` [m] from the surface. Allocates nothing. */
bool pel_mesh_query_reaches(pel_mesh_query *query, const double point[3], double reach);

/* The point of the surface nearest to a point; false if none is within `reach` [m]. Allocates nothing. */
bool pel_mesh_query_nearest(pel_mesh_query *query, const double point[3], double reach, double nearest[3]);

#endif
