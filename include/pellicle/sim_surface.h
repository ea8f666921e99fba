/* Pellicle: the present surface of a simulated body, which refinement changes. */
#ifndef PELLICLE_SIM_SURFACE_H
#define PELLICLE_SIM_SURFACE_H

#include "sim_step.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The present surface of a body. Without refinement these are the counts and triangles of its mesh. */
PEL_API int32_t pel_sim_vertex_count(const pel_sim *sim, int32_t body);
PEL_API int32_t pel_sim_triangle_count(const pel_sim *sim, int32_t body);
/* true if the body has levels of detail */
PEL_API bool pel_sim_refines(const pel_sim *sim, int32_t body);
/* (triangle_count x 3) rows of the corners; in the order of the mesh, refined triangles replaced by their children */
PEL_API void pel_sim_get_triangles(const pel_sim *sim, int32_t body, int32_t *triangles);
/* (vertex_count x 3) rest position of each row */
PEL_API void pel_sim_get_rest_positions(const pel_sim *sim, int32_t body, double *positions);
/* (vertex_count) level of detail on which the vertex appears, 0 = of the mesh */
PEL_API void pel_sim_get_levels(const pel_sim *sim, int32_t body, int32_t *levels);
/* Place of each row in the body's mesh: triangle (vertex_count) and barycentric weights (vertex_count x 3). */
PEL_API void pel_sim_get_mesh_places(const pel_sim *sim, int32_t body, int32_t *triangles, double *weights);
/* (vertex_count) kg */
PEL_API void pel_sim_get_masses(const pel_sim *sim, int32_t body, double *masses);
/* Number of events that changed a body's surface; counts and triangles change only with it. */
PEL_API int64_t pel_sim_surface_revision(const pel_sim *sim, int32_t body);

/* Requests a minimum level for the `rings` (of the body's refine def) around a vertex of the mesh, regardless of the
   criterion; level 0 cancels the request. PEL_BAD_ARGUMENT for a body without refinement, for a vertex or level that
   does not exist, and if it would exceed the budget (nothing changes). Allocates nothing. */
PEL_API pel_status pel_sim_refine(pel_sim *sim, int32_t body, int32_t vertex, int32_t level, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
