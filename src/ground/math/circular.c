/* Sine and cosine: x = q pi/2 + r with |r| <= pi/4, exact in the product of x with the bits of 2/pi that matter (Payne
   and Hanek 1983), for any size of x; then Taylor series of r. Angles: with c = k/8 nearest to y/x <= 1, atan(y/x) =
   atan(c) + atan((y - c x) / (x + c y)), the second at most 1/16 and by its series. Sums of two doubles avoid
   cancellation. */
#include "math/functions.h"

#include "math/pair.h"

#include <stdbool.h>
#include <stdint.h>

static const pel_pair QUARTER_TURN = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
static const pel_pair HALF_TURN = {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};

/* ---- sine and cosine ---- */

/* words of 32 bits: of an integer below 4, a fraction, and one that rounds */
enum { FRACTION_WORDS = 5, WORDS = FRACTION_WORDS + 2 };

/* the last digits of |x| 2/pi before its binary point, and the digits after it */
static void multiply_by_inverse(double x, uint32_t words[WORDS])
{
    static const uint32_t inverse[] = {
        0xa2f9836e, 0x4e441529, 0xfc2757d1, 0xf534ddc0, 0xdb629599, 0x3c439041, 0xfe5163ab, 0xdebbc561,
        0xb7246e3a, 0x424dd2e0, 0x06492eea, 0x09d1921c, 0xfe1deb1c, 0xb129a73e, 0xe88235f5, 0x2ebb4484,
        0xe99c7026, 0xb45f7e41, 0x3991d639, 0x835339f4, 0x9c845f8b, 0xbdf9283b, 0x1ff897ff, 0xde05980f,
        0xef2f118b, 0x5a0a6d1f, 0x6d367ecf, 0x27cb09b7, 0x4f463f66, 0x9e5fea2d, 0x7527bac7, 0xebe5f17b,
        0x3d0739f7, 0x8a5292ea, 0x6bfb5fb1, 0x1f8d5d08, 0x56033046, 0xfc7b6bab, 0xf0cfbc20, 0x9af4361d};
    int exponent;
    uint64_t mantissa = (uint64_t)ldexp(frexp(fabs(x), &exponent), 53), sums[WORDS] = {0};
    /* |x| = digits 2^(32 whole), the least digit first */
    exponent -= 53;
    const int whole = (exponent + 64) / 32 - 2, shift = exponent - 32 * whole;
    const uint32_t digits[3] = {(uint32_t)(mantissa << shift), (uint32_t)(mantissa << shift >> 32),
                                shift > 0 ? (uint32_t)(mantissa >> (64 - shift)) : 0};
    for (int t = 0; t < WORDS + 2; t++) {
        const int i = whole - 1 + t;
        for (int j = 0; j < 3 && i >= 0; j++) {
            const uint64_t product = (uint64_t)digits[j] * inverse[i];
            if (t - j >= 0 && t - j < WORDS)
                sums[t - j] += product & 0xffffffff;
            if (t - j - 1 >= 0 && t - j - 1 < WORDS)
                sums[t - j - 1] += product >> 32;
        }
    }
    for (int f = WORDS - 1; f >= 0; f--) {
        words[f] = (uint32_t)sums[f];
        if (f > 0)
            sums[f - 1] += sums[f] >> 32;
    }
}

/* r and q mod 4 of |x|, finite */
static pel_pair reduce(double x, unsigned *quadrant)
{
    uint32_t words[WORDS];
    pel_pair rest = {0, 0};
    multiply_by_inverse(x, words);
    /* to the nearest */
    const bool is_over = words[1] >> 31 != 0;
    *quadrant = (words[0] + (is_over ? 1 : 0)) & 3;
    for (int f = 1; f <= FRACTION_WORDS; f++) {
        const double word = (double)(is_over ? ~words[f] : words[f]);
        const pel_pair sum = pel_pair_quick_sum(rest.high, ldexp(word, -32 * f));
        rest = (pel_pair){sum.high, rest.low + sum.low};
    }
    rest = pel_pair_multiply(pel_pair_quick_sum(rest.high, rest.low), QUARTER_TURN);
    return is_over ? (pel_pair){-rest.high, -rest.low} : rest;
}

static double sine_near_zero(pel_pair r)
{
    static const double c[] = {-1.0 / 6,
                               1.0 / 120,
                               -1.0 / 5040,
                               1.0 / 362880,
                               -1.0 / 39916800,
                               1.0 / 6227020800,
                               -1.0 / 1307674368000,
                               1.0 / 355687428096000,
                               -1.0 / 121645100408832000};
    double z = r.high * r.high, sum = 0;
    for (int i = (int)(sizeof c / sizeof *c) - 1; i >= 0; i--)
        sum = sum * z + c[i];
    return r.high + (r.low * (1 - 0.5 * z) + r.high * z * sum);
}

static double cosine_near_zero(pel_pair r)
{
    static const double c[] = {1.0 / 24,        -1.0 / 720,         1.0 / 40320,          -1.0 / 3628800,
                               1.0 / 479001600, -1.0 / 87178291200, 1.0 / 20922789888000, -1.0 / 6402373705728000};
    const pel_pair square = pel_pair_product(r.high, r.high);
    double z = square.high, sum = 0, most = 1 - 0.5 * z;
    for (int i = (int)(sizeof c / sizeof *c) - 1; i >= 0; i--)
        sum = sum * z + c[i];
    return most + (((1 - most) - 0.5 * z) + (z * z * sum - (0.5 * square.low + r.high * r.low)));
}

/* the sine of x after `ahead` quarter turns */
static double sine_ahead(double x, unsigned ahead)
{
    unsigned quadrant = 0;
    pel_pair r = {x, 0};
    if (isnan(x) || isinf(x))
        return (double)NAN;
    if (fabs(x) > 0.78539816339744828) {
        r = reduce(x, &quadrant);
        if (x < 0) {
            r = (pel_pair){-r.high, -r.low};
            quadrant = 4 - quadrant;
        }
    }
    quadrant += ahead;
    double value = quadrant & 1 ? cosine_near_zero(r) : sine_near_zero(r);
    return quadrant & 2 ? -value : value;
}

double pel_sin(double x)
{
    return x == 0 ? x : sine_ahead(x, 0);
}

double pel_cos(double x)
{
    return sine_ahead(x, 1);
}

/* ---- angles ---- */

/* atan(y / x) for 0 <= y <= x */
static pel_pair angle_below_eighth(pel_pair y, pel_pair x)
{
    static const pel_pair angles[9] = {{0, 0},
                                       {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
                                       {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                       {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
                                       {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                       {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
                                       {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                       {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
                                       {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};
    const double c = rint(8 * (y.high / x.high)) / 8;
    const pel_pair share = {c, 0}, down = {-c, 0};
    const pel_pair u =
        pel_pair_divide(pel_pair_add(y, pel_pair_multiply(down, x)), pel_pair_add(x, pel_pair_multiply(share, y)));
    double z = u.high * u.high, sum = 0;
    for (int i = 17; i >= 3; i -= 2)
        sum = sum * z + ((i & 2) != 0 ? -1.0 : 1.0) / i;
    return pel_pair_add(angles[(int)(8 * c)], pel_pair_quick_sum(u.high, u.low + u.high * z * sum));
}

/* in 0 .. pi, for y >= 0 and x that is negative or not; sizes within 2^-200 .. 2^200, or 0 */
static pel_pair angle_of(pel_pair y, pel_pair x, bool is_behind)
{
    const bool is_steep = y.high > x.high;
    pel_pair angle = is_steep ? angle_below_eighth(x, y) : angle_below_eighth(y, x);
    const pel_pair minus = {-angle.high, -angle.low};
    if (is_steep)
        angle = pel_pair_add(QUARTER_TURN, minus);
    return is_behind ? pel_pair_add(HALF_TURN, (pel_pair){-angle.high, -angle.low}) : angle;
}

double pel_atan2(double y, double x)
{
    double across = fabs(y), along = fabs(x);
    const bool is_behind = signbit(x) != 0;
    if (isnan(x) || isnan(y))
        return (double)NAN;
    if (isinf(across) || isinf(along)) {
        /* of infinities only how many there are counts */
        across = isinf(across) ? 1 : 0;
        along = isinf(along) ? 1 : 0;
    }
    if (across == 0)
        return is_behind ? copysign(HALF_TURN.high, y) : y == 0 ? y : copysign(0, y);
    int high, low;
    frexp(across, &high);
    frexp(along, &low);
    const int most = along == 0 || high > low ? high : low;
    /* angles below 2^-54 of a turn */
    if (along > 0 && low - high > 60)
        return is_behind ? copysign(HALF_TURN.high, y) : y / along;
    if (along == 0 || high - low > 60)
        return copysign(QUARTER_TURN.high, y);
    const pel_pair a = {ldexp(across, -most), 0}, b = {ldexp(along, -most), 0};
    return copysign(angle_of(a, b, is_behind).high, y);
}

double pel_acos(double x)
{
    if (!(fabs(x) <= 1))
        return (double)NAN;
    if (fabs(x) == 1)
        return x > 0 ? 0 : HALF_TURN.high;
    const pel_pair square = pel_pair_product(x, x);
    const pel_pair rest = pel_pair_add((pel_pair){1, 0}, (pel_pair){-square.high, -square.low});
    return angle_of(pel_pair_sqrt(rest), (pel_pair){fabs(x), 0}, x < 0).high;
}
