/* Builders behind pel_shape_create. Each takes a checked def and returns a new mesh. */
#ifndef PEL_PRIMITIVE_SHAPE_BUILD_H
#define PEL_PRIMITIVE_SHAPE_BUILD_H

#include "pellicle/shape.h"

/* standing: vertex 0 is the pole (0, 0, radius), the last corner the other one */
pel_status pel_shape_geodesic_sphere(int32_t frequency, double radius, bool standing, pel_mesh **mesh,
                                     pel_error *error);
pel_status pel_shape_grid(const pel_shape_def *def, pel_mesh **mesh, pel_error *error);
pel_status pel_shape_box(const pel_shape_def *def, pel_mesh **mesh, pel_error *error);
pel_status pel_shape_uv_sphere(const pel_shape_def *def, pel_mesh **mesh, pel_error *error);
pel_status pel_shape_disk(const pel_shape_def *def, pel_mesh **mesh, pel_error *error);
pel_status pel_shape_cylinder(const pel_shape_def *def, pel_mesh **mesh, pel_error *error);
pel_status pel_shape_torus(const pel_shape_def *def, pel_mesh **mesh, pel_error *error);
pel_status pel_shape_capsule(const pel_shape_def *def, pel_mesh **mesh, pel_error *error);
pel_status pel_shape_lens_capsule(const pel_shape_def *def, pel_mesh **mesh, pel_error *error);
pel_status pel_shape_blend(const pel_shape_def *def, pel_mesh **mesh, pel_error *error);

/* writes a triangle and moves on to the next */
static inline void pel_shape_put_triangle(int32_t (**next)[3], int32_t a, int32_t b, int32_t c)
{
    int32_t *triangle = **next;
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
    *next += 1;
}

/* PEL_BAD_ARGUMENT when a shape would have more triangles than half-edges can be numbered */
pel_status pel_shape_check_size(int64_t vertex_count, int64_t triangle_count, pel_error *error);

#endif
