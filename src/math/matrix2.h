/* Matrices of 2 x 2 doubles, row-major {m00, m01, m10, m11}; closed forms, no iteration. */
#ifndef PEL_MATH_MATRIX2_H
#define PEL_MATH_MATRIX2_H

#include "math/functions.h"

#include <math.h>

static inline double pel_matrix2_determinant(const double m[4])
{
    return m[0] * m[3] - m[1] * m[2];
}

/* product = a b; product may be a or b */
static inline void pel_matrix2_multiply(const double a[4], const double b[4], double product[4])
{
    const double m00 = a[0] * b[0] + a[1] * b[2], m01 = a[0] * b[1] + a[1] * b[3];
    const double m10 = a[2] * b[0] + a[3] * b[2], m11 = a[2] * b[1] + a[3] * b[3];
    product[0] = m00;
    product[1] = m01;
    product[2] = m10;
    product[3] = m11;
}

/* Square root of a symmetric positive semidefinite matrix by Cayley-Hamilton: (C + sqrt(det C) I) / trace of the root.
   The null matrix gives the null matrix. */
static inline void pel_matrix2_sqrt(const double c[4], double root[4])
{
    double root_determinant = sqrt(fmax(pel_matrix2_determinant(c), 0));
    double root_trace = sqrt(c[0] + c[3] + 2 * root_determinant);
    double inverse = root_trace > 0 ? 1 / root_trace : 0;
    root[0] = inverse * (c[0] + root_determinant);
    root[1] = inverse * c[1];
    root[2] = inverse * c[2];
    root[3] = inverse * (c[3] + root_determinant);
}

/* F = R S with a proper rotation R (det +1) and symmetric S, which is indefinite where det F < 0. Where F has no
   nearest rotation (a null matrix, a reflection) R is the identity. */
static inline void pel_matrix2_polar(const double f[4], double rotation[4], double stretch[4])
{
    double cosine = f[0] + f[3], sine = f[2] - f[1], length = pel_hypot(cosine, sine);
    cosine = length > 0 ? cosine / length : 1;
    sine = length > 0 ? sine / length : 0;
    const double transposed[4] = {cosine, sine, -sine, cosine};
    pel_matrix2_multiply(transposed, f, stretch);
    rotation[0] = rotation[3] = cosine;
    rotation[1] = -sine;
    rotation[2] = sine;
}

#endif
