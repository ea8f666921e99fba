/* Data of a body for all its levels of detail, computed once with the model.

   Nodal numbers (mass, damping, volumetric springs) are proportional to area. A vertex of the body's mesh with number q
   and triangles of area A around it has the density q / (sum of A); a vertex in the middle of an edge the mean of its
   ends. A triangle on level l within base triangle T has the area A_T / 4^l, half of that when it is bisected. The
   number of an active vertex is its density times the area of the triangles around it. The sum over all vertices is the
   same for every front: when a triangle with the number a + b + c is refined, a quarter of it stays at the corners, 3/8
   of a + b moves to the vertex between them, and so on. All factors are powers of two.

   Spring constants after van Gelder: k = sum of E A_t / |e|^2 over the triangles t at the edge e. E is fitted on each
   base edge, so that the base has the given stiffness; finer edges take E from the base edge they are parallel to,
   bisectors the mean of the triangle's three. For similar triangles k is the same on all levels. */
#ifndef PEL_MODEL_LEVELS_H
#define PEL_MODEL_LEVELS_H

#include "model/model.h"

/* vertex_count: of the body's mesh */
pel_status pel_refine_check(const pel_refine_def *def, int32_t body, int32_t vertex_count, pel_error *error);

/* Fills the body's detail when its def asks for refinement; its vertices have to be in the model already. */
pel_status pel_body_detail_create(const pel_body_def *def, pel_model *model, int32_t body, pel_error *error);
void pel_body_detail_destroy(pel_body_levels *detail);

/* Densities on all levels from nodal numbers: values (vertices of the finest level x component_count), whose rows of
   the base's vertices are given. */
void pel_levels_spread(const pel_body_levels *detail, int32_t component_count, double *values);

/* Completes marks (vertices of the finest level) from those of the base's vertices: a vertex between two marked ones is
   marked. */
void pel_levels_spread_marks(const pel_lod_forest *forest, uint8_t *marks);

/* The base edge to which edge k of triangle t of a level is parallel. */
int32_t pel_levels_base_edge(const pel_body_levels *detail, int32_t level, int32_t t, int k);

#endif
