/* Wide scalars of the simulation: four pel_real lanes, written with the vector extensions that GCC and Clang share, so
   that one source compiles for any target; without vector instructions the compiler splits the lanes. Every operation
   is exact IEEE arithmetic per lane in a fixed order: the same bits with and without AVX2. Tried and lost: hardware
   gathers (3.5 times slower than record loads and transposes on Zen 4). */
#ifndef PEL_BASE_WIDE_H
#define PEL_BASE_WIDE_H

#include "pellicle/base.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

enum { PEL_WIDTH = 4 };
/* lanes of a block of constraints (lane.h): 256 bits */
enum { PEL_BLOCK = 32 / (int)sizeof(pel_real) };

#ifdef PEL_SINGLE
typedef float pel_wide __attribute__((vector_size(16)));
typedef int32_t pel_wide_mask __attribute__((vector_size(16)));
#define PEL_REAL_TINY 1e-37f /* added to squared lengths: changes nothing but zero */
#define pel_sqrt sqrtf
#else
typedef double pel_wide __attribute__((vector_size(32)));
typedef int64_t pel_wide_mask __attribute__((vector_size(32)));
#define PEL_REAL_TINY 1e-300
#define pel_sqrt sqrt
#endif

/* what the hot arrays hold: a vector and one more number, aligned to its size */
typedef pel_wide pel_record;

/* Where records lie is kept in steps of 8 bytes: an address scales by 8 for nothing, and not by the size of a record.
 */
enum { PEL_STEP = (int)sizeof(pel_record) / 8 };

static inline pel_record pel_record_get(const pel_record *records, int32_t step)
{
    return *(const pel_record *)(const void *)((const char *)records + (ptrdiff_t)step * 8);
}
static inline void pel_record_set(pel_record *records, int32_t step, pel_record record)
{
    *(pel_record *)(void *)((char *)records + (ptrdiff_t)step * 8) = record;
}

static inline pel_wide pel_wide_splat(pel_real a)
{
    return (pel_wide){a, a, a, a};
}

static inline pel_wide pel_wide_sqrt(pel_wide a)
{
#if defined(PEL_SINGLE) && defined(__SSE2__)
    return _mm_sqrt_ps(a);
#elif !defined(PEL_SINGLE) && defined(__AVX__)
    return _mm256_sqrt_pd(a);
#else
    return (pel_wide){pel_sqrt(a[0]), pel_sqrt(a[1]), pel_sqrt(a[2]), pel_sqrt(a[3])};
#endif
}

/* lane-wise larger of two; b where a is NaN */
static inline pel_wide pel_wide_max(pel_wide a, pel_wide b)
{
#if defined(PEL_SINGLE) && defined(__SSE2__)
    return _mm_max_ps(a, b);
#elif !defined(PEL_SINGLE) && defined(__AVX__)
    return _mm256_max_pd(a, b);
#else
    return (pel_wide){a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1], a[2] > b[2] ? a[2] : b[2],
                      a[3] > b[3] ? a[3] : b[3]};
#endif
}

static inline pel_real pel_wide_largest(pel_wide a)
{
    pel_real low = a[0] > a[1] ? a[0] : a[1], high = a[2] > a[3] ? a[2] : a[3];
    return low > high ? low : high;
}

/* rows to columns: four records in, their x, y, z and fourth numbers out (and back) */
static inline void pel_wide_transpose(pel_wide *a, pel_wide *b, pel_wide *c, pel_wide *d)
{
    pel_wide ab_low = __builtin_shufflevector(*a, *b, 0, 4, 2, 6),
             ab_high = __builtin_shufflevector(*a, *b, 1, 5, 3, 7);
    pel_wide cd_low = __builtin_shufflevector(*c, *d, 0, 4, 2, 6),
             cd_high = __builtin_shufflevector(*c, *d, 1, 5, 3, 7);
    *a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
    *b = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
    *c = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
    *d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

#endif
