/* Fields of mechanics of one body: on its triangles, and smoothed to its vertices. */
#ifndef PEL_OBSERVE_FIELD_MECHANICS_H
#define PEL_OBSERVE_FIELD_MECHANICS_H

#include "pellicle/sim_forces.h"

/* A triangle or the mean of the triangles around a vertex, with unit normals at rest and at present. */
typedef struct pel_field_mechanics {
    pel_triangle_mechanics numbers;
    double rest_normal[3], normal[3];
} pel_field_mechanics;

/* Adds the normals (triangle_count x 3 corners, positions of the rows) to numbers that pel_sim_get_mechanics gave. */
void pel_field_mechanics_of(const pel_triangle_mechanics *numbers, const int32_t *triangles, int32_t triangle_count,
                            const double *rest, const double *positions, pel_field_mechanics *made);

/* Means over the triangles at each vertex, weighted by area: at rest for strain, the second Piola-Kirchhoff stress and
   energies, present for all else. */
void pel_field_mechanics_smooth(const pel_field_mechanics *made, const int32_t *triangles, int32_t triangle_count,
                                int32_t vertex_count, pel_field_mechanics *smooth);

/* The numbers of a field (component_count of the table) from PEL_FIELD_STRAIN on. */
void pel_field_mechanics_put(const pel_field_mechanics *at, int32_t field, double *values);

#endif
