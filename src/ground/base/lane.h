/* The scalar type of laws, measures and constraint kernels, which are written once and included once for each type:
     by default     lanes: as many pel_real as fit 256 bits, 8 float or 4 double
     PEL_LANE_SCALAR  plain pel_real: the oracle of the wide kernels
     PEL_LANE_DOUBLE  plain double for any pel_real: the public functions
   A source defines one of the two names, or none, before its first include. Every operation is exact IEEE arithmetic
   per lane in a fixed order: wide, plain, GCC, Clang, with and without AVX2 give the same bits.

   Records {x, y, z, w} of a block of particles are loaded whole and transposed in registers; hardware gathers are 3.5
   times slower (docs/performance.md). */
#ifndef PEL_BASE_LANE_H
#define PEL_BASE_LANE_H

#include "base/wide.h"

#include <stdbool.h>
#include <string.h>

/* for kernels that are copied for each kind, with its flags as constants */
#define PEL_INLINE static inline __attribute__((always_inline))

#ifdef PEL_SINGLE
#define PEL_REAL_EPSILON 1.1920929e-7f
#else
#define PEL_REAL_EPSILON 2.220446049250313e-16
#endif

#if defined(PEL_LANE_DOUBLE) && !defined(PEL_LANE_SCALAR)
#define PEL_LANE_SCALAR
#endif

/* the number in a lane, and an integer of its size */
#if defined(PEL_SINGLE) && !defined(PEL_LANE_DOUBLE)
#define PEL_LANE_SINGLE
typedef float pel_lane_number;
typedef int32_t pel_lane_integer;
#else
typedef double pel_lane_number;
typedef int64_t pel_lane_integer;
#endif

/* a constant in all lanes */
#define PEL_CONSTANT(a) pel_lane_splat((pel_lane_number)(a))

#ifdef PEL_LANE_SCALAR

typedef pel_lane_number pel_lane;
typedef pel_lane_integer pel_lane_mask; /* 0 or -1 */

static inline pel_lane pel_lane_splat(pel_lane_number a)
{
    return a;
}
static inline int32_t pel_lane_passes(int32_t lane_count)
{
    return lane_count;
}
static inline pel_lane pel_lane_load(const pel_lane_number *numbers, int32_t lane)
{
    return numbers[lane];
}
static inline void pel_lane_store(pel_lane_number *numbers, int32_t lane, pel_lane a)
{
    numbers[lane] = a;
}
static inline pel_lane_mask pel_lane_above(pel_lane a, pel_lane b)
{
    return a > b ? -1 : 0;
}
static inline pel_lane pel_lane_sqrt(pel_lane a)
{
#ifdef PEL_LANE_SINGLE
    return sqrtf(a);
#else
    return sqrt(a);
#endif
}

#else

typedef pel_real pel_lane __attribute__((vector_size(32), may_alias));
typedef pel_lane_integer pel_lane_mask __attribute__((vector_size(32), may_alias));

static inline pel_lane pel_lane_splat(pel_real a)
{
#ifdef PEL_SINGLE
    return (pel_lane){a, a, a, a, a, a, a, a};
#else
    return (pel_lane){a, a, a, a};
#endif
}
/* all lanes at once: unused ones repeat a used one */
static inline int32_t pel_lane_passes(int32_t lane_count)
{
    (void)lane_count;
    return 1;
}
static inline pel_lane pel_lane_load(const pel_real *numbers, int32_t lane)
{
    (void)lane;
    return *(const pel_lane *)numbers;
}
static inline void pel_lane_store(pel_real *numbers, int32_t lane, pel_lane a)
{
    (void)lane;
    *(pel_lane *)numbers = a;
}
static inline pel_lane_mask pel_lane_above(pel_lane a, pel_lane b)
{
    return a > b;
}
static inline pel_lane pel_lane_sqrt(pel_lane a)
{
    return pel_wide_sqrt(a);
}

#endif

/* ---- selection ---- */

static inline pel_lane_mask pel_lane_bits(pel_lane a)
{
    pel_lane_mask bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}

static inline pel_lane pel_lane_from_bits(pel_lane_mask bits)
{
    pel_lane a;
    memcpy(&a, &bits, sizeof a);
    return a;
}

/* a where the mask is set, else 0 */
static inline pel_lane pel_lane_where(pel_lane_mask mask, pel_lane a)
{
    return pel_lane_from_bits(pel_lane_bits(a) & mask);
}

static inline pel_lane pel_lane_select(pel_lane_mask mask, pel_lane a, pel_lane b)
{
#if !defined(PEL_LANE_SCALAR) && defined(PEL_SINGLE) && defined(__AVX__)
    return (pel_lane)_mm256_blendv_ps((__m256)b, (__m256)a, (__m256)mask);
#elif !defined(PEL_LANE_SCALAR) && !defined(PEL_SINGLE) && defined(__AVX__)
    return (pel_lane)_mm256_blendv_pd((__m256d)b, (__m256d)a, (__m256d)mask);
#else
    return pel_lane_from_bits((pel_lane_bits(a) & mask) | (pel_lane_bits(b) & ~mask));
#endif
}

/* true when the mask is set in all lanes */
static inline bool pel_lane_all(pel_lane_mask mask)
{
#ifdef PEL_LANE_SCALAR
    return mask != 0;
#else
    return pel_wide_all(mask);
#endif
}

/* a / b, 0 where b is not above 0 */
static inline pel_lane pel_lane_quotient(pel_lane a, pel_lane b)
{
    return pel_lane_where(pel_lane_above(b, pel_lane_splat(0)), a / b);
}

/* b where either is NaN */
static inline pel_lane pel_lane_max(pel_lane a, pel_lane b)
{
#ifdef PEL_LANE_SCALAR
    return a > b ? a : b;
#else
    return pel_wide_max(a, b);
#endif
}

static inline pel_lane pel_lane_min(pel_lane a, pel_lane b)
{
    return pel_lane_select(pel_lane_above(b, a), a, b);
}

static inline pel_lane pel_lane_abs(pel_lane a)
{
    return pel_lane_max(a, -a);
}

/* ---- functions ---- */

/* sum of c[i] z^i for count <= 16: pairs, pairs of pairs and so on, so that few operations wait for each other. The
   terms stay in registers only where the compiler unrolls these loops. */
PEL_INLINE pel_lane pel_lane_polynomial(const pel_lane_number *c, int count, pel_lane z)
{
    pel_lane term[16], power = z;
#pragma GCC unroll 16
    for (int i = 0; i < 16; i++)
        term[i] = pel_lane_splat(i < count ? c[i] : 0);
#pragma GCC unroll 4
    for (int step = 1; step < 16; step *= 2) {
#pragma GCC unroll 8
        for (int i = 0; i < 16; i += 2 * step)
            if (i + step < count)
                term[i] = term[i] + power * term[i + step];
        /* a power that no term needs could be denormal, which is slow */
        if (2 * step < count)
            power = power * power;
    }
    return term[0];
}

/* t^2 for a polynomial that begins with 1: bounded below where that changes no bit, so that no power is denormal */
static inline pel_lane pel_lane_normal_square(pel_lane t)
{
#ifdef PEL_LANE_SINGLE
    return pel_lane_max(t * t, pel_lane_splat(4e-9f));
#else
    return pel_lane_max(t * t, pel_lane_splat(1e-30));
#endif
}

/* Angle of (x, y) in (-pi, pi]; 0 for (0, 0). The quotient of the smaller by the larger is reduced by pi/4 to at most
   tan(pi/8), where a Chebyshev fit of atan(t)/t in t^2 has an error of 5e-20 (float: 2e-11). If no lane needs the
   reduction it is skipped, which changes no bit. */
static inline pel_lane pel_lane_atan2(pel_lane y, pel_lane x)
{
    const pel_lane eighth_tangent = PEL_CONSTANT(0.41421356237309504880), zero = pel_lane_splat(0);
    const pel_lane quarter_turn = PEL_CONSTANT(0.78539816339744830962);
#ifdef PEL_LANE_SINGLE
    static const pel_lane_number c[] = {1.0f,        -0.33333332f,  0.19999883f, -0.14281588f,
                                        0.11040489f, -0.084561928f, 0.047073481f};
#else
    static const pel_lane_number c[] = {1.0,
                                        -0.33333333333333324206,
                                        0.19999999999997013892,
                                        -0.14285714285329708164,
                                        0.11111111085322108759,
                                        -0.090909080590311910269,
                                        0.076922810999377432501,
                                        -0.066662052599765261879,
                                        0.058768340046141606641,
                                        -0.052173125740615910016,
                                        0.044995007289840320092,
                                        -0.033387824501211951519,
                                        0.015113765096600924669};
#endif
    const int count = (int)(sizeof c / sizeof *c);
    pel_lane ay = pel_lane_abs(y);
    if (pel_lane_all(pel_lane_above(eighth_tangent * x, ay))) {
        pel_lane t = y / x;
        return zero + t * pel_lane_polynomial(c, count, pel_lane_normal_square(t));
    }
    pel_lane ax = pel_lane_abs(x), less = pel_lane_min(ax, ay), greater = pel_lane_max(ax, ay);
    pel_lane_mask beyond = pel_lane_above(less, eighth_tangent * greater);
    pel_lane top = less - pel_lane_where(beyond, greater), bottom = greater + pel_lane_where(beyond, less);
    pel_lane t = pel_lane_where(pel_lane_above(greater, zero), top / bottom);
    pel_lane angle =
        pel_lane_where(beyond, quarter_turn) + t * pel_lane_polynomial(c, count, pel_lane_normal_square(t));
    angle = pel_lane_select(pel_lane_above(ay, ax), quarter_turn + quarter_turn - angle, angle);
    angle = pel_lane_select(pel_lane_above(zero, x), PEL_CONSTANT(3.14159265358979323846) - angle, angle);
    return pel_lane_select(pel_lane_above(zero, y), -angle, angle);
}

/* ln(1 + x) for 1 + x > 0 and normal: 1 + x = 2^e m with m in [1/sqrt 2, sqrt 2), ln m = 2 artanh((m - 1) / (m + 1));
   a small x keeps all its digits */
static inline pel_lane pel_lane_log1p(pel_lane x)
{
    const pel_lane one = pel_lane_splat(1);
#ifdef PEL_LANE_SINGLE
    const int mantissa = 23;
    const pel_lane_integer offset = 0x3f3504f3; /* bits of sqrt(1/2) */
    static const pel_lane_number c[] = {2.0f, 0.66666665f, 0.40000385f, 0.28535051f, 0.23616359f};
#else
    const int mantissa = 52;
    const pel_lane_integer offset = 0x3fe6a09e667f3bcd;
    static const pel_lane_number c[] = {2.0,
                                        0.66666666666666658387,
                                        0.40000000000007493931,
                                        0.28571428568819126944,
                                        0.22222222676929540265,
                                        0.18181773738016305815,
                                        0.15387160926134079899,
                                        0.13248763083460115888,
                                        0.13262103674021809098};
#endif
    const pel_lane_integer fraction = ((pel_lane_integer)1 << mantissa) - 1;
    pel_lane_mask bits = pel_lane_bits(one + x) - offset, exponent = bits >> mantissa;
    pel_lane m = pel_lane_from_bits(pel_lane_bits(one + x) - (bits & ~fraction));
    pel_lane e = pel_lane_splat(0);
#ifdef PEL_LANE_SCALAR
    e = (pel_lane)exponent;
#else
    e = __builtin_convertvector(exponent, pel_lane);
#endif
    pel_lane_mask shifted = pel_lane_above(pel_lane_abs(e), PEL_CONSTANT(0.5));
    pel_lane above = pel_lane_select(shifted, m - one, x), s = above / (one + one + above);
    pel_lane z = pel_lane_normal_square(s);
    pel_lane sum = pel_lane_polynomial(c, (int)(sizeof c / sizeof *c), z);
    return e * PEL_CONSTANT(0.69314718055994530942) + s * sum;
}

/* exp(x) - 1 for |x| <= 80: x = n ln 2 + r with |r| <= ln 2 / 2, then 2^n (exp(r) - 1) + (2^n - 1) by a Taylor series;
   a small x keeps all its digits. Adding 1.5 times 2^(digits - 1) rounds to an integer, in the lowest bits. */
static inline pel_lane pel_lane_expm1(pel_lane x)
{
#ifdef PEL_LANE_SINGLE
    const int mantissa = 23;
    const pel_lane_integer bias = 127;
    const pel_lane shift = pel_lane_splat(12582912.0f), high = pel_lane_splat(0.693145752f),
                   low = pel_lane_splat(1.42860677e-6f);
    static const pel_lane_number c[] = {1.0f,           0.5f,           0.166666667f,  0.0416666667f,
                                        8.33333333e-3f, 1.38888889e-3f, 1.98412698e-4f};
#else
    const int mantissa = 52;
    const pel_lane_integer bias = 1023;
    const pel_lane shift = pel_lane_splat(6755399441055744.0), high = pel_lane_splat(0.69314718036912381649),
                   low = pel_lane_splat(1.90821492927058770002e-10);
    static const pel_lane_number c[] = {
        1.0,         1.0 / 2,      1.0 / 6,       1.0 / 24,       1.0 / 120,       1.0 / 720,       1.0 / 5040,
        1.0 / 40320, 1.0 / 362880, 1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800};
#endif
    const pel_lane one = pel_lane_splat(1);
    pel_lane shifted = x * PEL_CONSTANT(1.44269504088896340736) + shift, n = shifted - shift;
    pel_lane r = (x - n * high) - n * low;
    pel_lane scale = pel_lane_from_bits((pel_lane_bits(shifted) - pel_lane_bits(shift) + bias) << mantissa);
    pel_lane part = r * pel_lane_polynomial(c, (int)(sizeof c / sizeof *c), r);
    return scale * part + (scale - one);
}

/* ---- three components ---- */

typedef struct pel_lane3 {
    pel_lane x, y, z;
} pel_lane3;

static inline pel_lane3 pel_lane3_add(pel_lane3 a, pel_lane3 b)
{
    return (pel_lane3){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline pel_lane3 pel_lane3_subtract(pel_lane3 a, pel_lane3 b)
{
    return (pel_lane3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline pel_lane3 pel_lane3_scale(pel_lane3 a, pel_lane scale)
{
    return (pel_lane3){a.x * scale, a.y * scale, a.z * scale};
}
/* s a + t b */
static inline pel_lane3 pel_lane3_combine(pel_lane s, pel_lane3 a, pel_lane t, pel_lane3 b)
{
    return (pel_lane3){s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z};
}
static inline pel_lane pel_lane3_dot(pel_lane3 a, pel_lane3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline pel_lane3 pel_lane3_cross(pel_lane3 a, pel_lane3 b)
{
    return (pel_lane3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* ---- particles ---- */

typedef struct pel_particle {
    pel_lane3 at;
    pel_lane fourth; /* inverse mass */
} pel_particle;

#ifndef PEL_LANE_DOUBLE

/* pel_particle_move adds a way to the records of a block, which are read before any is written: lanes may repeat. Where
   p, which was loaded from them, is given, float takes the positions from there: fewer operations, but more registers.
 */

#ifdef PEL_LANE_SCALAR

static inline void pel_lane3_store(pel_record *records, pel_lane3 a)
{
    *records = (pel_record){a.x, a.y, a.z, 0};
}
static inline pel_particle pel_particle_load(const pel_record *records, const int32_t *steps, int32_t lane)
{
    const pel_record r = pel_record_get(records, steps[lane]);
    return (pel_particle){{r[0], r[1], r[2]}, r[3]};
}
static inline void pel_particle_move(pel_record *records, const int32_t *steps, int32_t lane, const pel_particle *p,
                                     pel_lane3 way)
{
    (void)p;
    pel_record r = pel_record_get(records, steps[lane]);
    pel_record_set(records, steps[lane], r + (pel_record){way.x, way.y, way.z, 0});
}

#else

/* a block of records side by side, the fourth number 0 */
static inline void pel_lane3_store(pel_record *records, pel_lane3 v)
{
    pel_wide_store(records, v.x, v.y, v.z, pel_wide_splat(0));
}
#ifdef PEL_SINGLE

static inline pel_particle pel_particle_load(const pel_record *records, const int32_t *steps, int32_t lane)
{
    (void)lane;
    pel_wide a = pel_wide_row(pel_record_get(records, steps[0]), pel_record_get(records, steps[4]));
    pel_wide b = pel_wide_row(pel_record_get(records, steps[1]), pel_record_get(records, steps[5]));
    pel_wide c = pel_wide_row(pel_record_get(records, steps[2]), pel_record_get(records, steps[6]));
    pel_wide d = pel_wide_row(pel_record_get(records, steps[3]), pel_record_get(records, steps[7]));
    pel_wide_transpose(&a, &b, &c, &d);
    return (pel_particle){{a, b, c}, d};
}
static inline void pel_particle_move(pel_record *records, const int32_t *steps, int32_t lane, const pel_particle *p,
                                     pel_lane3 way)
{
    (void)lane;
    pel_record moved[PEL_BLOCK];
    if (p != NULL)
        pel_wide_store(moved, p->at.x + way.x, p->at.y + way.y, p->at.z + way.z, p->fourth);
    else
        pel_wide_store(moved, way.x, way.y, way.z, pel_wide_splat(0));
    for (int i = 0; p == NULL && i < PEL_BLOCK; i++)
        moved[i] += pel_record_get(records, steps[i]);
    for (int i = 0; i < PEL_BLOCK; i++)
        pel_record_set(records, steps[i], moved[i]);
}

#else

static inline pel_particle pel_particle_load(const pel_record *records, const int32_t *steps, int32_t lane)
{
    (void)lane;
    pel_wide a = pel_record_get(records, steps[0]), b = pel_record_get(records, steps[1]),
             c = pel_record_get(records, steps[2]), d = pel_record_get(records, steps[3]);
    pel_wide_transpose(&a, &b, &c, &d);
    return (pel_particle){{a, b, c}, d};
}
static inline void pel_particle_move(pel_record *records, const int32_t *steps, int32_t lane, const pel_particle *p,
                                     pel_lane3 way)
{
    (void)lane;
    (void)p;
    pel_wide a = way.x, b = way.y, c = way.z, d = pel_wide_splat(0);
    pel_wide_transpose(&a, &b, &c, &d);
    a += pel_record_get(records, steps[0]);
    b += pel_record_get(records, steps[1]);
    c += pel_record_get(records, steps[2]);
    d += pel_record_get(records, steps[3]);
    pel_record_set(records, steps[0], a);
    pel_record_set(records, steps[1], b);
    pel_record_set(records, steps[2], c);
    pel_record_set(records, steps[3], d);
}

#endif
#endif
#endif /* particles */
#endif
