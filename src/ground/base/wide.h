/* Wide scalars of the simulation: as many pel_real as fit 256 bits, written with the vector extensions that GCC and
   Clang share, so that one source compiles for any target; without vector instructions the compiler splits the lanes.
   Every operation is exact IEEE arithmetic per lane in a fixed order: the same bits with and without AVX2. Tried and
   lost: hardware gathers (3.5 times slower than record loads and transposes on Zen 4). */
#ifndef PEL_BASE_WIDE_H
#define PEL_BASE_WIDE_H

#include "base/halves.h"
#include "pellicle/base.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

/* vertices of a slice: lanes of a pel_wide */
enum { PEL_WIDTH = 32 / (int)sizeof(pel_real) };
/* constraints of a block (lane.h) */
enum { PEL_BLOCK = PEL_WIDTH };

typedef pel_real pel_wide __attribute__((vector_size(32)));
/* element of the hot arrays: a vector and a fourth number, aligned to its size */
typedef pel_real pel_record __attribute__((vector_size(4 * sizeof(pel_real))));

#ifdef PEL_SINGLE
typedef int32_t pel_wide_mask __attribute__((vector_size(32)));
#define PEL_REAL_TINY 1e-37f /* added to squared lengths: changes nothing but zero */
#define pel_sqrt sqrtf
#else
typedef int64_t pel_wide_mask __attribute__((vector_size(32)));
#define PEL_REAL_TINY 1e-300
#define pel_sqrt sqrt
#endif

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

static inline pel_record pel_record_with(pel_record record, pel_real fourth)
{
    const pel_record other = {fourth, fourth, fourth, fourth};
    return __builtin_shufflevector(record, other, 0, 1, 2, 7);
}

/* larger of two by component; b where a is NaN */
static inline pel_record pel_record_max(pel_record a, pel_record b)
{
#if defined(PEL_SINGLE) && defined(__SSE2__)
    return _mm_max_ps(a, b);
#elif !defined(PEL_SINGLE) && defined(__AVX__)
    return _mm256_max_pd(a, b);
#elif defined(PEL_HALVES) && !defined(PEL_SINGLE)
    return pel_halves_max(a, b);
#else
    return (pel_record){a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1], a[2] > b[2] ? a[2] : b[2],
                        a[3] > b[3] ? a[3] : b[3]};
#endif
}

/* smaller of two by component; b where a is NaN */
static inline pel_record pel_record_min(pel_record a, pel_record b)
{
    return -pel_record_max(-a, -b);
}

/* true when a is above b in one of the three components of the vectors */
static inline bool pel_record_exceeds(pel_record a, pel_record b)
{
#if defined(PEL_SINGLE) && defined(__SSE2__)
    return (_mm_movemask_ps((__m128)(a > b)) & 7) != 0;
#elif !defined(PEL_SINGLE) && defined(__AVX__)
    return (_mm256_movemask_pd((__m256d)(a > b)) & 7) != 0;
#else
    return a[0] > b[0] || a[1] > b[1] || a[2] > b[2];
#endif
}

static inline pel_wide pel_wide_splat(pel_real a)
{
#ifdef PEL_SINGLE
    return (pel_wide){a, a, a, a, a, a, a, a};
#else
    return (pel_wide){a, a, a, a};
#endif
}

static inline pel_wide pel_wide_sqrt(pel_wide a)
{
#if defined(PEL_SINGLE) && defined(__AVX__)
    return _mm256_sqrt_ps(a);
#elif defined(__AVX__)
    return _mm256_sqrt_pd(a);
#elif defined(PEL_HALVES) && !defined(PEL_SINGLE)
    return pel_halves_sqrt(a);
#else
    for (int i = 0; i < PEL_WIDTH; i++)
        a[i] = pel_sqrt(a[i]);
    return a;
#endif
}

/* lane-wise larger of two; b where a is NaN */
static inline pel_wide pel_wide_max(pel_wide a, pel_wide b)
{
#if defined(PEL_SINGLE) && defined(__AVX__)
    return _mm256_max_ps(a, b);
#elif defined(__AVX__)
    return _mm256_max_pd(a, b);
#elif defined(PEL_HALVES) && !defined(PEL_SINGLE)
    return pel_halves_max(a, b);
#else
    for (int i = 0; i < PEL_WIDTH; i++)
        a[i] = a[i] > b[i] ? a[i] : b[i];
    return a;
#endif
}

static inline pel_real pel_wide_largest(pel_wide a)
{
    pel_real largest = a[0];
    for (int i = 1; i < PEL_WIDTH; i++)
        largest = a[i] > largest ? a[i] : largest;
    return largest;
}

/* sum of the lanes, in their order */
static inline double pel_wide_sum(pel_wide a)
{
    double sum = 0;
    for (int i = 0; i < PEL_WIDTH; i++)
        sum += (double)a[i];
    return sum;
}

/* true when the mask is set in all lanes */
static inline bool pel_wide_all(pel_wide_mask mask)
{
#if defined(PEL_SINGLE) && defined(__AVX__)
    return _mm256_movemask_ps((__m256)mask) == 255;
#elif defined(__AVX__)
    return _mm256_movemask_pd((__m256d)mask) == 15;
#elif defined(PEL_HALVES) && !defined(PEL_SINGLE)
    return pel_halves_all((pel_halves)mask);
#else
    bool all = true;
    for (int i = 0; i < PEL_WIDTH; i++)
        all &= mask[i] != 0;
    return all;
#endif
}

/* Rows to columns and back. Four rows hold the records of PEL_WIDTH vertices: row i is record i, followed in float by
   record i + 4. The columns are the x, y, z and fourth numbers, a lane a vertex. */
#ifdef PEL_SINGLE

static inline pel_wide pel_wide_row(pel_record low, pel_record high)
{
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
static inline pel_record pel_wide_low(pel_wide row)
{
    return __builtin_shufflevector(row, row, 0, 1, 2, 3);
}
static inline pel_record pel_wide_high(pel_wide row)
{
    return __builtin_shufflevector(row, row, 4, 5, 6, 7);
}
static inline void pel_wide_transpose(pel_wide *a, pel_wide *b, pel_wide *c, pel_wide *d)
{
    pel_wide ab_low = __builtin_shufflevector(*a, *b, 0, 8, 1, 9, 4, 12, 5, 13);
    pel_wide ab_high = __builtin_shufflevector(*a, *b, 2, 10, 3, 11, 6, 14, 7, 15);
    pel_wide cd_low = __builtin_shufflevector(*c, *d, 0, 8, 1, 9, 4, 12, 5, 13);
    pel_wide cd_high = __builtin_shufflevector(*c, *d, 2, 10, 3, 11, 6, 14, 7, 15);
    *a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 8, 9, 4, 5, 12, 13);
    *b = __builtin_shufflevector(ab_low, cd_low, 2, 3, 10, 11, 6, 7, 14, 15);
    *c = __builtin_shufflevector(ab_high, cd_high, 0, 1, 8, 9, 4, 5, 12, 13);
    *d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 10, 11, 6, 7, 14, 15);
}

#else

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

/* Columns of four records from `records` on, in float of eight. Four variables, not an array: compilers copy arrays in
   halves, and a load of the whole waits for both (1.3 times slower sweeps). */
static inline void pel_wide_load(const pel_record *records, pel_wide *a, pel_wide *b, pel_wide *c, pel_wide *d)
{
#ifdef PEL_SINGLE
    *a = pel_wide_row(records[0], records[4]);
    *b = pel_wide_row(records[1], records[5]);
    *c = pel_wide_row(records[2], records[6]);
    *d = pel_wide_row(records[3], records[7]);
#else
    *a = records[0];
    *b = records[1];
    *c = records[2];
    *d = records[3];
#endif
    pel_wide_transpose(a, b, c, d);
}

/* the same of records anywhere, by index */
static inline void pel_wide_gather(const pel_record *records, const int32_t *at, pel_wide *a, pel_wide *b, pel_wide *c,
                                   pel_wide *d)
{
#ifdef PEL_SINGLE
    *a = pel_wide_row(records[at[0]], records[at[4]]);
    *b = pel_wide_row(records[at[1]], records[at[5]]);
    *c = pel_wide_row(records[at[2]], records[at[6]]);
    *d = pel_wide_row(records[at[3]], records[at[7]]);
#else
    *a = records[at[0]];
    *b = records[at[1]];
    *c = records[at[2]];
    *d = records[at[3]];
#endif
    pel_wide_transpose(a, b, c, d);
}

static inline void pel_wide_store(pel_record *records, pel_wide a, pel_wide b, pel_wide c, pel_wide d)
{
    pel_wide_transpose(&a, &b, &c, &d);
#ifdef PEL_SINGLE
    records[4] = pel_wide_high(a);
    records[5] = pel_wide_high(b);
    records[6] = pel_wide_high(c);
    records[7] = pel_wide_high(d);
    records[0] = pel_wide_low(a);
    records[1] = pel_wide_low(b);
    records[2] = pel_wide_low(c);
    records[3] = pel_wide_low(d);
#else
    records[0] = a;
    records[1] = b;
    records[2] = c;
    records[3] = d;
#endif
}

#endif
