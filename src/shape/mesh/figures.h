/* Lengths, areas, volumes, qualities and valences for pel_mesh_check. */
#ifndef PEL_MESH_FIGURES_H
#define PEL_MESH_FIGURES_H

#include "mesh/edge_table.h"
#include "pellicle/mesh_check.h"

/* not_finite (vertex_count), component_of_triangle (triangle_count, -1 = takes no part). Fills the geometric figures of
   the report and of its components. PEL_OK or PEL_OUT_OF_MEMORY. */
pel_status pel_figures_fill(const pel_mesh *mesh, const uint8_t *not_finite, const int32_t *component_of_triangle,
                            const pel_edge_table *edges, pel_mesh_report *report);

/* widens a box by that of the mesh */
void pel_mesh_add_box(const pel_mesh *mesh, double low[3], double high[3]);

/* diagonal of the bounding box [units of the mesh] */
double pel_mesh_diagonal(const pel_mesh *mesh);

/* diagonal above which a body is probably given in millimetres [m] */
#define PEL_LARGE_BODY 20.0

#endif
