/* Two features that move during a step, as their difference.

   The points of the one feature minus the points of the other form, at time t, the flat piece
       F(t, s, u) = offset(t) + s edge1(t) + u edge2(t),   s, u >= 0,
   with s + u <= 1 for vertex 0 against face 1,2,3  (offset = p0 - p1, edge1 = p1 - p2, edge2 = p1 - p3)
   and  s, u <= 1  for edge 0,1 against edge 2,3     (offset = p0 - p2, edge1 = p1 - p0, edge2 = p2 - p3).
   The features come within a distance d when |F| <= d somewhere: both kinds are one problem from here on.

   Two proofs of freedom, with u = 2^-53 and m1, m2, m3 the largest coordinates of edge1, edge2, offset:

   1. Coplanarity (Tang, Manocha, Tong 2010). y(t) = (edge1 x edge2) . offset is a cubic; |F| <= d implies
      |y| <= d |n(t)| with n = edge1 x edge2. When all Bernstein coefficients of y lie beyond that on one side, the step
   is free. Rounding, for the coefficients times 3: differences are formed first, so they carry one relative error u
   each; a coordinate of n has error <= 8u m1 m2, the sum of two cross products <= 20u m1 m2, a dot product with the
   latter
      <= 108u m1 m2 m3, a coefficient <= 216u m1 m2 m3; three further de Casteljau levels on values <= 18 m1 m2 m3 add
      9u x 18 = 162u. CCD_CUBIC_ERROR = 768u covers the sum of 378u twice.
   2. Separating axis. F stays in the convex hull of its corners at both ends of the time interval. A direction d with
      d . corner > error |d|_1 + min_separation |d|_2 for all corners proves freedom, however d was found. A coordinate
   of a corner has error <= 6u (m1 + m2 + m3) (difference u, interpolation in t 3u, two sums 2u), the dot product adds
   3u: CCD_CORNER_ERROR = 16u covers the sum of 9u.

   Underflow is covered by the tiny constants, overflow and NaN make the bounds NaN or infinite, and nothing compares as
   greater than those. */
#ifndef PEL_GEOM_CCD_PAIR_H
#define PEL_GEOM_CCD_PAIR_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

#include "geom/wide4.h"

#if defined(__FAST_MATH__) || FLT_EVAL_METHOD != 0
#error "the proofs of freedom need plain IEEE doubles: no -ffast-math, no extended precision"
#endif

#define CCD_CUBIC_ERROR (384 * DBL_EPSILON)
#define CCD_NORMAL_ERROR (16 * DBL_EPSILON)
#define CCD_CORNER_ERROR (8 * DBL_EPSILON)
#define CCD_ROUND_UP (1 + 16 * DBL_EPSILON)
#define CCD_TINY 0x1p-1000
#define CCD_TINY_PRODUCT 0x1p-960
#define CCD_TINY_NORMAL 0x1p-530

/* more prove hardly more: 4 leave 11.4 % of random pairs, 14 leave 10.4 %, of which 7.4 % hit */
enum { CCD_DESCENT_STEPS = 4 };

#define CCD_INLINE static inline
#define REAL double
#define NAME(function) function
#define real_set(value) ((double)(value))
#define real_abs fabs
#define real_sqrt sqrt
#define real_if_less(a, b, less, other) ((a) < (b) ? (less) : (other))
static inline double real_min(double a, double b)
{
    return a < b ? a : b;
}
static inline double real_max(double a, double b)
{
    return a > b ? a : b;
}
#include "geom/ccd_kernel.h"
#undef CCD_INLINE
#undef REAL
#undef NAME
#undef real_set
#undef real_abs
#undef real_sqrt
#undef real_if_less

#define CCD_INLINE WIDE4_INLINE
#define REAL wide4
#define NAME(function) wide_##function
#define real_set wide4_set
#define real_abs wide4_abs
#define real_sqrt wide4_sqrt
#define real_min wide4_min
#define real_max wide4_max
#define real_if_less(a, b, less, other) wide4_select((a) < (b), less, other)
#include "geom/ccd_kernel.h"
#undef CCD_INLINE
#undef REAL
#undef NAME
#undef real_set
#undef real_abs
#undef real_sqrt
#undef real_if_less
#undef real_min
#undef real_max

#endif
