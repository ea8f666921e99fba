/* The smaller and the larger of two numbers, as fmin and fmax of the C library, which compilers call as functions: they
   took most of the time of loops over all triangles. A NaN vanishes: the result is the other number (b == b: b is
   none). Of zeros of both signs it is b, on every machine. */
#ifndef PEL_MATH_EXTREMES_H
#define PEL_MATH_EXTREMES_H

static inline double pel_min(double a, double b)
{
    double least = a < b ? a : b;
    return b == b ? least : a;
}

static inline double pel_max(double a, double b)
{
    double most = a > b ? a : b;
    return b == b ? most : a;
}

#endif
