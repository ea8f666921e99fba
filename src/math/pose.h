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

/* rotation between a (s = 0) and b (s = 1) along the shorter arc at constant speed */
static inline void pel_slerp(const double a[4], const double b[4], double s, double result[4])
{
    double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    double sign = cosine < 0 ? -1 : 1, angle = acos(fmin(fabs(cosine), 1)), p = 1 - s, q = s;
    if (angle > 1e-6) {
        p = sin((1 - s) * angle) / sin(angle);
        q = sin(s * angle) / sin(angle);
    }
    double square = 0;
    for (int i = 0; i < 4; i++) {
        result[i] = p * a[i] + sign * q * b[i];
        square += result[i] * result[i];
    }
    for (int i = 0; i < 4; i++)
        result[i] /= sqrt(square);
}

#endif
