/* Boxes along the axes, in float, always rounded outward: a box contains its feature, so that features with disjoint
   boxes are disjoint. Float halves the memory and doubles the lanes; coordinates are taken relative to an origin in
   double before they are rounded (pel_frame), so that distance from the world's origin costs no resolution. */
#ifndef PEL_BVH_BOX_H
#define PEL_BVH_BOX_H

#include "pellicle/base.h"

#include <float.h>
#include <math.h>
#if defined(__SSE2__)
#include <immintrin.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif

/* x, y, z and 0 */
typedef float pel_corner __attribute__((vector_size(16)));

typedef struct pel_box {
    pel_corner low, high;
} pel_box;

/* eight boxes, lane by lane; an empty lane overlaps nothing */
enum { PEL_LANES = 8 };
typedef float pel_box8 __attribute__((vector_size(32)));
typedef int32_t pel_box8_mask __attribute__((vector_size(32)));

typedef struct pel_box_group {
    pel_box8 low[3], high[3];
} pel_box_group;

static inline pel_corner pel_corner_min(pel_corner a, pel_corner b)
{
#if defined(__SSE2__)
    return _mm_min_ps(a, b);
#elif defined(__wasm_simd128__)
    return (pel_corner)wasm_f32x4_pmin((v128_t)b, (v128_t)a);
#else
    return (pel_corner){a[0] < b[0] ? a[0] : b[0], a[1] < b[1] ? a[1] : b[1], a[2] < b[2] ? a[2] : b[2], 0};
#endif
}

static inline pel_corner pel_corner_max(pel_corner a, pel_corner b)
{
#if defined(__SSE2__)
    return _mm_max_ps(a, b);
#elif defined(__wasm_simd128__)
    return (pel_corner)wasm_f32x4_pmax((v128_t)b, (v128_t)a);
#else
    return (pel_corner){a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1], a[2] > b[2] ? a[2] : b[2], 0};
#endif
}

/* every coordinate of a is at most that of b */
static inline bool pel_corner_below(pel_corner a, pel_corner b)
{
#if defined(__SSE2__)
    return _mm_movemask_ps(_mm_cmple_ps(a, b)) == 15;
#elif defined(__wasm_simd128__)
    return wasm_i32x4_all_true(wasm_f32x4_le((v128_t)a, (v128_t)b));
#else
    return a[0] <= b[0] && a[1] <= b[1] && a[2] <= b[2];
#endif
}

/* overlaps nothing, and joined with another box gives that box */
static inline pel_box pel_box_empty(void)
{
    const float infinite = HUGE_VALF;
    return (pel_box){{infinite, infinite, infinite, 0}, {-infinite, -infinite, -infinite, 0}};
}

static inline pel_box pel_box_join(pel_box a, pel_box b)
{
    return (pel_box){pel_corner_min(a.low, b.low), pel_corner_max(a.high, b.high)};
}

/* touching counts */
static inline bool pel_box_overlaps(const pel_box *a, const pel_box *b)
{
#if defined(__SSE2__)
    __m128 both = _mm_and_ps(_mm_cmple_ps(a->low, b->high), _mm_cmple_ps(b->low, a->high));
    return _mm_movemask_ps(both) == 15;
#else
    return pel_corner_below(a->low, b->high) && pel_corner_below(b->low, a->high);
#endif
}

static inline bool pel_box_contains(const pel_box *outer, const pel_box *inner)
{
    return pel_corner_below(outer->low, inner->low) && pel_corner_below(inner->high, outer->high);
}

/* half the surface; 0 for an empty box */
static inline double pel_box_area(const pel_box *box)
{
    double x = (double)box->high[0] - (double)box->low[0], y = (double)box->high[1] - (double)box->low[1];
    double z = (double)box->high[2] - (double)box->low[2];
    return x >= 0 ? x * y + y * z + z * x : 0;
}

static inline pel_box8 pel_box8_splat(float x)
{
    return (pel_box8){x, x, x, x, x, x, x, x};
}

static inline pel_box pel_box_group_get(const pel_box_group *group, int lane)
{
    return (pel_box){{group->low[0][lane], group->low[1][lane], group->low[2][lane], 0},
                     {group->high[0][lane], group->high[1][lane], group->high[2][lane], 0}};
}

static inline void pel_box_group_set(pel_box_group *group, int lane, pel_box box)
{
    for (int k = 0; k < 3; k++) {
        group->low[k][lane] = box.low[k];
        group->high[k][lane] = box.high[k];
    }
}

/* bit i: lane i is set */
static inline unsigned pel_box8_bits(pel_box8_mask mask)
{
#if defined(__AVX__)
    return (unsigned)_mm256_movemask_ps((__m256)mask);
#elif defined(__wasm_simd128__)
    return wasm_i32x4_bitmask((v128_t)__builtin_shufflevector(mask, mask, 0, 1, 2, 3)) |
           wasm_i32x4_bitmask((v128_t)__builtin_shufflevector(mask, mask, 4, 5, 6, 7)) << 4;
#else
    unsigned bits = 0;
    for (int lane = 0; lane < PEL_LANES; lane++)
        bits |= (unsigned)(mask[lane] & 1) << lane;
    return bits;
#endif
}

static inline pel_box8_mask pel_box8_equal(pel_box8_mask lanes, int32_t x)
{
    return (pel_box8_mask)(lanes == (pel_box8_mask){x, x, x, x, x, x, x, x});
}

/* lanes that overlap the box with these corners */
static inline pel_box8_mask pel_box_group_overlaps(const pel_box_group *group, const float low[3], const float high[3])
{
    pel_box8_mask hit = (pel_box8_mask)(group->low[0] <= pel_box8_splat(high[0]));
    hit &= (pel_box8_mask)(group->high[0] >= pel_box8_splat(low[0]));
    for (int k = 1; k < 3; k++) {
        hit &= (pel_box8_mask)(group->low[k] <= pel_box8_splat(high[k]));
        hit &= (pel_box8_mask)(group->high[k] >= pel_box8_splat(low[k]));
    }
    return hit;
}

#endif
