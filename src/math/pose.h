/* Rotations as unit quaternions (x, y, z, w). */
#ifndef PEL_MATH_POSE_H
#define PEL_MATH_POSE_H

#include "math/vec3.h"

/* rotated (3) = q v q^-1; may be v itself */
static inline void pel_rotate(const double q[4], const double v[3], double rotated[3])
{
    double t[3], u[3];
    pel_vec3_cross(q, v, t);
    pel_vec3_scale(t, 2, t);
    pel_vec3_cross(q, t, u);
    for (int i = 0; i < 3; i++)
        rotated[i] = v[i] + q[3] * t[i] + u[i];
}

static inline void pel_rotate_back(const double q[4], const double v[3], double rotated[3])
{
    const double inverse[4] = {-q[0], -q[1], -q[2], q[3]};
    pel_rotate(inverse, v, rotated);
}

/* product (4) = a b: first b, then a; may be either of them */
static inline void pel_rotation_product(const double a[4], const double b[4], double product[4])
{
    const double w = a[3] * b[3] - pel_vec3_dot(a, b);
    double v[3];
    pel_vec3_cross(a, b, v);
    for (int i = 0; i < 3; i++)
        product[i] = a[3] * b[i] + b[3] * a[i] + v[i];
    product[3] = w;
}

/* quaternion of a rotation vector: axis times angle [rad], of any length */
static inline void pel_rotation_exp(const double vector[3], double q[4])
{
    double angle = pel_vec3_length(vector), scale = angle > 0 ? sin(0.5 * angle) / angle : 0.5;
    pel_vec3_scale(vector, scale, q);
    q[3] = cos(0.5 * angle);
}

/* Rotation vector [rad] from a to b. Its angle is known up to whole turns: of all that lead from a to b the one nearest
   to `expected` is taken, so a null vector gives the shorter arc. */
static inline void pel_rotation_between(const double a[4], const double b[4], const double expected[3],
                                        double vector[3])
{
    const double full = 6.283185307179586476925, back[4] = {-a[0], -a[1], -a[2], a[3]};
    double q[4], axis[3];
    pel_rotation_product(b, back, q);
    double sine = pel_vec3_length(q), angle = 2 * atan2(sine, q[3]), length = pel_vec3_length(expected);
    if (sine > 1e-12)
        pel_vec3_scale(q, 1 / sine, axis);
    else if (length > 0)
        pel_vec3_scale(expected, 1 / length, axis); /* whole turns, about any axis */
    else
        pel_vec3_set(axis, 0, 0, 0);
    pel_vec3_scale(axis, angle + full * rint((pel_vec3_dot(expected, axis) - angle) / full), vector);
}

/* rotated (4) = q turned by share times a rotation vector; may be q itself */
static inline void pel_rotation_turn(const double q[4], const double vector[3], double share, double rotated[4])
{
    double part[3], turn[4];
    pel_vec3_scale(vector, share, part);
    pel_rotation_exp(part, turn);
    pel_rotation_product(turn, q, rotated);
    double length = sqrt(pel_vec3_dot(rotated, rotated) + rotated[3] * rotated[3]);
    for (int i = 0; i < 4; i++)
        rotated[i] /= length;
}

#endif
