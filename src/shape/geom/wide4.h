/* Four doubles side by side, with GCC and Clang vector types: + - * / work as they are, on any target. Minimum, maximum
   and square root use AVX or the vectors of WebAssembly where the compiler targets them; the other form gives the same
   bits. */
#ifndef PEL_GEOM_WIDE4_H
#define PEL_GEOM_WIDE4_H

#include "base/halves.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#ifdef __AVX__
#include <immintrin.h>
#endif

enum { WIDE4_WIDTH = 4 };

/* for kernels that are instantiated with constant arguments */
#define WIDE4_INLINE static inline __attribute__((always_inline))

typedef double wide4 __attribute__((vector_size(32)));
typedef int64_t wide4_mask __attribute__((vector_size(32)));
typedef double wide2 __attribute__((vector_size(16)));

/* a where the mask is set, b elsewhere; a lane of the mask is all ones or all zeros */
WIDE4_INLINE wide4 wide4_select(wide4_mask mask, wide4 a, wide4 b)
{
#ifdef __AVX__
    return (wide4)_mm256_blendv_pd((__m256d)b, (__m256d)a, (__m256d)mask);
#else
    return (wide4)((mask & (wide4_mask)a) | (~mask & (wide4_mask)b));
#endif
}

WIDE4_INLINE bool wide4_all(wide4_mask mask)
{
#ifdef __AVX__
    return _mm256_movemask_pd((__m256d)mask) == 15;
#elif defined(PEL_HALVES)
    return pel_halves_all((pel_halves)mask);
#else
    return (mask[0] & mask[1] & mask[2] & mask[3]) != 0;
#endif
}

WIDE4_INLINE wide4 wide4_set(double value)
{
    return (wide4){value, value, value, value};
}

WIDE4_INLINE wide4 wide4_abs(wide4 a)
{
    const wide4_mask magnitude = {INT64_MAX, INT64_MAX, INT64_MAX, INT64_MAX};
    return (wide4)((wide4_mask)a & magnitude);
}

/* a < b ? a : b, so b when either is NaN */
WIDE4_INLINE wide4 wide4_min(wide4 a, wide4 b)
{
#ifdef __AVX__
    return (wide4)_mm256_min_pd((__m256d)a, (__m256d)b);
#elif defined(PEL_HALVES)
    return pel_halves_min(a, b);
#else
    return wide4_select(a < b, a, b);
#endif
}

/* a > b ? a : b, so b when either is NaN */
WIDE4_INLINE wide4 wide4_max(wide4 a, wide4 b)
{
#ifdef __AVX__
    return (wide4)_mm256_max_pd((__m256d)a, (__m256d)b);
#elif defined(PEL_HALVES)
    return pel_halves_max(a, b);
#else
    return wide4_select(a > b, a, b);
#endif
}

WIDE4_INLINE wide4 wide4_sqrt(wide4 a)
{
#ifdef __AVX__
    return (wide4)_mm256_sqrt_pd((__m256d)a);
#elif defined(PEL_HALVES)
    return pel_halves_sqrt(a);
#else
    return (wide4){sqrt(a[0]), sqrt(a[1]), sqrt(a[2]), sqrt(a[3])};
#endif
}

WIDE4_INLINE wide2 wide2_load(const double *values)
{
    wide2 pair;
    memcpy(&pair, values, sizeof pair);
    return pair;
}

/* the points (3) at four addresses, one a lane; reads nothing after them */
WIDE4_INLINE void wide4_load_points(const double *const points[4], wide4 xyz[3])
{
    wide2 p0 = wide2_load(points[0]), p1 = wide2_load(points[1]);
    wide2 p2 = wide2_load(points[2]), p3 = wide2_load(points[3]);
    wide4 p02 = __builtin_shufflevector(p0, p2, 0, 1, 2, 3);
    wide4 p13 = __builtin_shufflevector(p1, p3, 0, 1, 2, 3);
    xyz[0] = __builtin_shufflevector(p02, p13, 0, 4, 2, 6);
    xyz[1] = __builtin_shufflevector(p02, p13, 1, 5, 3, 7);
    xyz[2] = (wide4){points[0][2], points[1][2], points[2][2], points[3][2]};
}

#endif
