/* The two springs of paper A, a slice at a time.

   Structural spring (eq. A-3), on vertex i from vertex j, d = x_j - x_i, R its rest length:
       g = k (|d| - R) d / |d| = (k - k R/|d|) d
   At |d| = 0 the direction is undefined; the tiny number under the root makes the force zero there instead of NaN, and
   changes no other length.

   Virtual volumetric spring (eq. A-4) of rest length zero, from a vertex to its own rest position, e = x - x_rest:
       g = -[k' |e| + k'_d (v.e)/|e|] e/|e| = -k' e - k'_d (v.e)/|e|^2 e
   In this form the elastic part has no singularity; the damping part is guarded in the same way: zero at e = 0. */
#ifndef PEL_MEASURE_SPRING_H
#define PEL_MEASURE_SPRING_H

#include "base/wide.h"

typedef struct pel_wide3 {
    pel_wide x, y, z;
} pel_wide3;

static inline pel_wide pel_wide3_dot(pel_wide3 a, pel_wide3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* |d|, never zero */
static inline pel_wide pel_spring_length(pel_wide3 d)
{
    return pel_wide_sqrt(pel_wide3_dot(d, d) + pel_wide_splat(PEL_REAL_TINY));
}

/* factor c of the force c d; product: stiffness x rest length */
static inline pel_wide pel_spring_scale(pel_wide length, pel_wide stiffness, pel_wide product)
{
    return stiffness - product / length;
}

/* elastic energy k (|d| - R)^2 / 2 */
static inline pel_wide pel_spring_energy(pel_wide length, pel_wide rest_length, pel_wide stiffness)
{
    pel_wide stretch = length - rest_length;
    return pel_wide_splat((pel_real)0.5) * stiffness * stretch * stretch;
}

/* factor c of the damping force -c e of a volumetric spring: k'_d (v.e)/|e|^2 */
static inline pel_wide pel_volumetric_damping(pel_wide3 offset, pel_wide3 velocity, pel_wide damping)
{
    pel_wide square = pel_wide3_dot(offset, offset) + pel_wide_splat(PEL_REAL_TINY);
    return damping * (pel_wide3_dot(velocity, offset) / square);
}

#endif
