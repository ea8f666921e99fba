/* Matrices of 2 x 2 doubles, row-major {m00, m01, m10, m11}. */
#ifndef PEL_MATH_MATRIX2_H
#define PEL_MATH_MATRIX2_H

#include "math/functions.h"

/* The proper rotation R (det +1) nearest to F, in closed form: R^T F is symmetric. Where there is no nearest one (a
   null matrix, a reflection) R is the identity. */
static inline void pel_matrix2_rotation(const double f[4], double rotation[4])
{
    double cosine = f[0] + f[3], sine = f[2] - f[1], length = pel_hypot(cosine, sine);
    cosine = length > 0 ? cosine / length : 1;
    sine = length > 0 ? sine / length : 0;
    rotation[0] = rotation[3] = cosine;
    rotation[1] = -sine;
    rotation[2] = sine;
}

#endif
