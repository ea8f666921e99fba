/* Vectors of three doubles, whatever pel_real is. */
#ifndef PEL_GEOM_VECTOR3_H
#define PEL_GEOM_VECTOR3_H

static inline void vector3_subtract(const double a[3], const double b[3], double difference[3])
{
    difference[0] = a[0] - b[0];
    difference[1] = a[1] - b[1];
    difference[2] = a[2] - b[2];
}

static inline double vector3_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void vector3_cross(const double a[3], const double b[3], double product[3])
{
    product[0] = a[1] * b[2] - a[2] * b[1];
    product[1] = a[2] * b[0] - a[0] * b[2];
    product[2] = a[0] * b[1] - a[1] * b[0];
}

/* a + scale * direction */
static inline void vector3_along(const double a[3], double scale, const double direction[3], double point[3])
{
    point[0] = a[0] + scale * direction[0];
    point[1] = a[1] + scale * direction[1];
    point[2] = a[2] + scale * direction[2];
}

#endif
