/* Area and volume of triangles in plain arrays. */
#include "math/vec3.h"
#include "pellicle/measure.h"

static const double *corner_of(const double *positions, const int32_t *triangles, int32_t t, int corner)
{
    return positions + 3 * (size_t)triangles[3 * (size_t)t + (size_t)corner];
}

double pel_surface_area(const double *positions, const int32_t *triangles, int32_t triangle_count)
{
    if (positions == NULL || triangles == NULL)
        return 0;
    double area = 0;
    for (int32_t t = 0; t < triangle_count; t++)
        area += pel_vec3_triangle_area(corner_of(positions, triangles, t, 0), corner_of(positions, triangles, t, 1),
                                       corner_of(positions, triangles, t, 2));
    return area;
}

double pel_surface_volume(const double *positions, const int32_t *triangles, int32_t triangle_count,
                          const double origin[3])
{
    if (positions == NULL || triangles == NULL)
        return 0;
    double volume = 0;
    for (int32_t t = 0; t < triangle_count; t++)
        volume += pel_vec3_cone_volume(origin != NULL ? origin : corner_of(positions, triangles, 0, 0),
                                       corner_of(positions, triangles, t, 0), corner_of(positions, triangles, t, 1),
                                       corner_of(positions, triangles, t, 2));
    return volume;
}

double pel_surface_volume_gradient(const double *positions, int32_t vertex_count, const int32_t *triangles,
                                   int32_t triangle_count, const double origin[3], double *gradient)
{
    if (positions == NULL || triangles == NULL || gradient == NULL || vertex_count < 0)
        return 0;
    for (size_t i = 0; i < 3 * (size_t)vertex_count; i++)
        gradient[i] = 0;
    for (int32_t t = 0; t < triangle_count; t++) {
        const double *point = origin != NULL ? origin : corner_of(positions, triangles, 0, 0);
        double x[3][3], product[3];
        for (int i = 0; i < 3; i++)
            pel_vec3_subtract(corner_of(positions, triangles, t, i), point, x[i]);
        for (int i = 0; i < 3; i++) {
            double *sum = gradient + 3 * (size_t)triangles[3 * (size_t)t + (size_t)i];
            pel_vec3_cross(x[(i + 1) % 3], x[(i + 2) % 3], product);
            pel_vec3_along(sum, 1.0 / 6, product, sum);
        }
    }
    return pel_surface_volume(positions, triangles, triangle_count, origin);
}
