/* The surface of a body for its users: rows of vertices, triangles, levels. */
#ifndef PEL_STAGE_SURFACE_VIEW_H
#define PEL_STAGE_SURFACE_VIEW_H

#include "stage/stage.h"

/* Rows of the getters for a body that refines, made when asked for after an event. */
struct pel_surface_rows {
    int64_t revision;            /* of the surface: events so far */
    int64_t made_revision;       /* of the rows */
    int32_t *vertices;           /* (vertices of the finest level) the vertex of each row */
    int32_t *row_of_vertex;      /* (the same) */
    pel_front_triangle *surface; /* (triangles of the finest level) */
};

/* After the active model. PEL_OUT_OF_MEMORY. */
pel_status pel_surface_rows_create(pel_sim *sim, pel_error *error);
void pel_surface_rows_destroy(pel_sim *sim);

/* The rows of a body's arrays: vertex i of the mesh is row i, finer ones follow in the order of the forest. */
int32_t pel_output_vertex(const pel_sim *sim, int32_t body, int32_t v);
int32_t pel_output_count(const pel_sim *sim, int32_t body);
int32_t pel_output_model_index(const pel_sim *sim, int32_t body, int32_t row);
/* events of refinement so far; cuts make the simulation anew */
int64_t pel_surface_event_count(const pel_sim *sim, int32_t body);
/* row of each vertex of the forest that is active; null = rows are the vertices of the mesh */
const int32_t *pel_output_numbers(const pel_sim *sim, int32_t body);
/* the triangles of the surface in an order that depends on the surface alone, for sums; null = triangles of the mesh in
   their order */
const pel_front_triangle *pel_surface_in_order(const pel_sim *sim, int32_t body);
/* vertices of the model at the i-th triangle of a body, in an order that depends on the surface alone too */
const int32_t *pel_surface_corners(const pel_sim *sim, int32_t body, int32_t i);

#endif
