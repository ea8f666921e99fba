/* One corner of a triangle, seen from its vertex: the contributions that are summed to measures at the vertex.

                   c
                  / \        u = b - a, w = c - a, o = c - b, normal = u x w = twice the area along the unit normal
              w  /   \  o
                /     \
               a ----- b
                   u

   Mixed area (Meyer et al. 2003, section 3.3). In a triangle that is not obtuse the part nearer to a than to b or c is
       (|u|^2 cot(angle at c) + |w|^2 cot(angle at b)) / 8,    cot = dot / |normal|,
   in an obtuse one a gets half of the area when it is the obtuse corner, else a quarter.

   Mean curvature. The cotangent sum (cot alpha + cot beta)(x_i - x_j) / 2 around a vertex is the gradient of the area;
   the part of one triangle is unit normal x o / 2. In this form nothing grows without bound in thin triangles. */
#ifndef PEL_MEASURE_CORNER_H
#define PEL_MEASURE_CORNER_H

#include "base/assert.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "mesh/flat_triangle.h"
#include "pellicle/topology.h"

typedef struct pel_corner {
    double u[3], w[3], o[3], normal[3];
    double u_square, w_square, twice_area;
    bool flat;
} pel_corner;

static inline pel_corner pel_corner_load(const pel_topology *topology, const double *positions, int32_t h)
{
    PEL_ASSERT_INDEX(h, 3 * topology->triangle_count);
    const int32_t *triangle = topology->triangles[h / 3];
    const double *a = positions + 3 * (size_t)triangle[h % 3];
    const double *b = positions + 3 * (size_t)triangle[(h + 1) % 3];
    const double *c = positions + 3 * (size_t)triangle[(h + 2) % 3];
    pel_corner corner;
    pel_vec3_subtract(b, a, corner.u);
    pel_vec3_subtract(c, a, corner.w);
    pel_vec3_subtract(c, b, corner.o);
    pel_vec3_cross(corner.u, corner.w, corner.normal);
    corner.twice_area = pel_vec3_length(corner.normal);
    corner.u_square = pel_vec3_squared_length(corner.u);
    corner.w_square = pel_vec3_squared_length(corner.w);
    double o_square = pel_vec3_squared_length(corner.o);
    corner.flat = pel_area_is_flat(corner.twice_area, pel_max(pel_max(corner.u_square, corner.w_square), o_square));
    return corner;
}

/* the part of the triangle's area that belongs to the vertex */
static inline double pel_corner_mixed_area(const pel_corner *corner)
{
    double here = pel_vec3_dot(corner->u, corner->w);
    double at_b = -pel_vec3_dot(corner->u, corner->o), at_c = pel_vec3_dot(corner->w, corner->o);
    if (corner->flat)
        return corner->twice_area / 6;
    if (here < 0)
        return corner->twice_area / 4;
    if (at_b < 0 || at_c < 0)
        return corner->twice_area / 8;
    return (corner->u_square * at_c + corner->w_square * at_b) / (8 * corner->twice_area);
}

/* the three angles of any triangle sum to pi, those of one whose corners coincide too */
static inline double pel_corner_angle(const pel_corner *corner)
{
    const double pi = 3.14159265358979323846;
    bool no_u = !(corner->u_square > 0), no_w = !(corner->w_square > 0);
    if (no_u || no_w)
        return no_u && no_w ? pi / 3 : pi / 2;
    return pel_atan2(corner->twice_area, pel_vec3_dot(corner->u, corner->w));
}

/* adds the gradient of the triangle's area when the vertex moves */
static inline void pel_corner_add_area_gradient(const pel_corner *corner, double gradient[3])
{
    double turned[3];
    if (corner->flat)
        return;
    pel_vec3_cross(corner->normal, corner->o, turned);
    pel_vec3_along(gradient, 0.5 / corner->twice_area, turned, gradient);
}

/* adds the unit normal times the angle */
static inline void pel_corner_add_angle_normal(const pel_corner *corner, double angle, double normal[3])
{
    if (!corner->flat)
        pel_vec3_along(normal, angle / corner->twice_area, corner->normal, normal);
}

/* the corners of a vertex in counter-clockwise order: for (h = first; h >= 0; h = next) */
static inline int32_t pel_corner_first(const pel_topology *topology, int32_t v)
{
    PEL_ASSERT_INDEX(v, topology->vertex_count);
    return topology->corner_of_vertex[v];
}

static inline int32_t pel_corner_next(const pel_topology *topology, int32_t v, int32_t h)
{
    PEL_ASSERT_INDEX(v, topology->vertex_count);
    PEL_ASSERT_INDEX(h, 3 * topology->triangle_count);
    int32_t next = pel_half_edge_turn(topology, h);
    return next == topology->corner_of_vertex[v] ? -1 : next;
}

/* where a fan is open, it begins with the half-edge that has no twin */
static inline bool pel_vertex_is_boundary(const pel_topology *topology, int32_t v)
{
    PEL_ASSERT_INDEX(v, topology->vertex_count);
    int32_t first = topology->corner_of_vertex[v];
    return first < 0 || topology->twin[first] < 0;
}

#endif
