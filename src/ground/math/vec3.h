/* Vectors of three doubles, for any pel_real. A result may alias an argument, except for the cross product. */
#ifndef PEL_MATH_VEC3_H
#define PEL_MATH_VEC3_H

#include <math.h>

static inline void pel_vec3_set(double a[3], double x, double y, double z)
{
    a[0] = x;
    a[1] = y;
    a[2] = z;
}

static inline void pel_vec3_copy(const double a[3], double copy[3])
{
    pel_vec3_set(copy, a[0], a[1], a[2]);
}

static inline void pel_vec3_add(const double a[3], const double b[3], double sum[3])
{
    pel_vec3_set(sum, a[0] + b[0], a[1] + b[1], a[2] + b[2]);
}

static inline void pel_vec3_subtract(const double a[3], const double b[3], double difference[3])
{
    pel_vec3_set(difference, a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

static inline void pel_vec3_scale(const double a[3], double scale, double scaled[3])
{
    pel_vec3_set(scaled, scale * a[0], scale * a[1], scale * a[2]);
}

/* a + scale * b */
static inline void pel_vec3_along(const double a[3], double scale, const double b[3], double sum[3])
{
    pel_vec3_set(sum, a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2]);
}

static inline double pel_vec3_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void pel_vec3_cross(const double a[3], const double b[3], double product[3])
{
    product[0] = a[1] * b[2] - a[2] * b[1];
    product[1] = a[2] * b[0] - a[0] * b[2];
    product[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double pel_vec3_squared_length(const double a[3])
{
    return pel_vec3_dot(a, a);
}

static inline double pel_vec3_length(const double a[3])
{
    return sqrt(pel_vec3_dot(a, a));
}

static inline double pel_vec3_distance(const double a[3], const double b[3])
{
    double difference[3];
    pel_vec3_subtract(a, b, difference);
    return pel_vec3_length(difference);
}

/* scales to length 1 and returns the length that was; a null vector stays null */
static inline double pel_vec3_normalize(double a[3])
{
    double length = pel_vec3_length(a);
    if (length > 0)
        pel_vec3_scale(a, 1 / length, a);
    return length;
}

/* (b - a) x (c - a): twice the area of the triangle along its normal */
static inline void pel_vec3_triangle_normal(const double a[3], const double b[3], const double c[3], double normal[3])
{
    double ab[3], ac[3];
    pel_vec3_subtract(b, a, ab);
    pel_vec3_subtract(c, a, ac);
    pel_vec3_cross(ab, ac, normal);
}

static inline double pel_vec3_triangle_area(const double a[3], const double b[3], const double c[3])
{
    double normal[3];
    pel_vec3_triangle_normal(a, b, c, normal);
    return pel_vec3_length(normal) / 2;
}

/* volume of the tetrahedron of a point and a triangle, positive if the point is behind the triangle */
static inline double pel_vec3_cone_volume(const double origin[3], const double a[3], const double b[3],
                                          const double c[3])
{
    double oa[3], ob[3], oc[3], product[3];
    pel_vec3_subtract(a, origin, oa);
    pel_vec3_subtract(b, origin, ob);
    pel_vec3_subtract(c, origin, oc);
    pel_vec3_cross(ob, oc, product);
    return pel_vec3_dot(oa, product) / 6;
}

#endif
