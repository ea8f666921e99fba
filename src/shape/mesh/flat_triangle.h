/* Triangles without area, as the check reports and the repair drops them. */
#ifndef PEL_MESH_FLAT_TRIANGLE_H
#define PEL_MESH_FLAT_TRIANGLE_H

#include "math/extremes.h"
#include "math/vec3.h"
#include "pellicle/mesh_check.h"

#include <stdbool.h>

/* height over the longest edge at or below PEL_FLAT_TRIANGLE */
static inline bool pel_area_is_flat(double twice_area, double longest_square)
{
    return !(twice_area > PEL_FLAT_TRIANGLE * longest_square);
}

/* the same for three corners, which are finite */
static inline bool pel_triangle_is_flat(const double a[3], const double b[3], const double c[3])
{
    double normal[3];
    pel_vec3_triangle_normal(a, b, c, normal);
    double ab = pel_vec3_distance(a, b), bc = pel_vec3_distance(b, c), ca = pel_vec3_distance(c, a);
    double longest = pel_max(pel_max(ab, bc), ca);
    return pel_area_is_flat(pel_vec3_length(normal), longest * longest);
}

#endif
