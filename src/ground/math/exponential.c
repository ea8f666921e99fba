/* exp(x) = 2^k (1 + p): k = rint(x / ln 2), p the Taylor series of the rest r, |r| <= ln 2 / 2, to r^14 (2^-60).
   log(x) = e ln 2 + log m with m in [sqrt(1/2), sqrt(2)): log m = 2 artanh(s), s = (m - 1) / (m + 1), |s| < 0.172, by
   its series to s^29. Four terms of that are pairs, the others doubles: 2^-70 relative to the logarithm, so that pow,
   the exponential of a product of up to 745, is off by 2^-60. */
#include "math/functions.h"

#include "math/pair.h"

#include <stdbool.h>

/* high has 32 bits: its products with exponents are exact */
static const double LN2_HIGH = 0x1.62e42fee00000p-1, LN2_LOW = 0x1.a39ef35793c76p-33;
static const double LARGEST = 710, LEAST = -746;

/* p and k; x within LEAST .. LARGEST */
static pel_pair exp_part(pel_pair x, int *exponent)
{
    static const double c[] = {1.0 / 2,         1.0 / 6,          1.0 / 24,         1.0 / 120,     1.0 / 720,
                               1.0 / 5040,      1.0 / 40320,      1.0 / 362880,     1.0 / 3628800, 1.0 / 39916800,
                               1.0 / 479001600, 1.0 / 6227020800, 1.0 / 87178291200};
    double k = rint(x.high * 0x1.71547652b82fep+0), sum = 0;
    pel_pair r = pel_pair_sum(x.high - k * LN2_HIGH, -k * LN2_LOW);
    r = pel_pair_quick_sum(r.high, r.low + x.low);
    for (int i = (int)(sizeof c / sizeof *c) - 1; i >= 0; i--)
        sum = sum * r.high + c[i];
    *exponent = (int)k;
    return pel_pair_quick_sum(r.high, (r.low + r.low * r.high) + r.high * r.high * sum);
}

static double exp_of(pel_pair x)
{
    int exponent;
    if (x.high > LARGEST)
        return (double)INFINITY;
    if (x.high < LEAST)
        return 0;
    pel_pair part = exp_part(x, &exponent), sum = pel_pair_quick_sum(1, part.high);
    return ldexp(sum.high + (sum.low + part.low), exponent);
}

double pel_exp(double x)
{
    return isnan(x) ? x : exp_of((pel_pair){x, 0});
}

/* the series, for |x| < 0.05: the next term is below 2^-59 of x */
static double small_tanh(double x)
{
    double z = x * x;
    double tail = 2.0 / 15 + z * (-17.0 / 315 + z * (62.0 / 2835 + z * (-1382.0 / 155925)));
    return x + x * z * (-1.0 / 3 + z * tail);
}

double pel_tanh(double x)
{
    const double one = 22; /* beyond it the result is 1 */
    if (fabs(x) < 0.05)
        return fabs(x) < 0x1p-27 ? x : small_tanh(x);
    double size = fabs(x);
    int exponent;
    if (isnan(x) || size > one)
        return isnan(x) ? x : copysign(1, x);
    /* exp(2 x) - 1 over itself plus 2 */
    pel_pair part = exp_part((pel_pair){2 * size, 0}, &exponent);
    double scale = ldexp(1, exponent);
    part = (pel_pair){scale * part.high, scale * part.low};
    part = pel_pair_add((pel_pair){scale - 1, 0}, part);
    const pel_pair quotient = pel_pair_divide(part, pel_pair_add((pel_pair){2, 0}, part));
    return copysign(quotient.high, x);
}

/* log m and e, for finite x > 0 */
static pel_pair log_part(double x, int *exponent)
{
    static const pel_pair third = {0x1.5555555555555p-2, 0x1.5555555555555p-56};
    static const pel_pair fifth = {0x1.999999999999ap-3, -0x1.999999999999ap-57};
    static const pel_pair seventh = {0x1.2492492492492p-3, 0x1.2492492492492p-57};
    double m = frexp(x, exponent), tail = 0;
    if (m < 0x1.6a09e667f3bcdp-1) {
        m *= 2;
        *exponent -= 1;
    }
    pel_pair s = pel_pair_divide((pel_pair){m - 1, 0}, pel_pair_sum(m, 1)), z = pel_pair_multiply(s, s);
    for (int i = 29; i >= 9; i -= 2)
        tail = tail * z.high + 1.0 / i;
    pel_pair sum = pel_pair_add(seventh, pel_pair_multiply(z, (pel_pair){tail, 0}));
    sum = pel_pair_add(fifth, pel_pair_multiply(z, sum));
    sum = pel_pair_add(third, pel_pair_multiply(z, sum));
    sum = pel_pair_multiply(z, sum);
    sum = pel_pair_add(s, pel_pair_multiply(s, sum));
    return (pel_pair){2 * sum.high, 2 * sum.low};
}

static pel_pair log_of(double x)
{
    int exponent;
    pel_pair part = log_part(x, &exponent), whole = pel_pair_sum(exponent * LN2_HIGH, exponent * LN2_LOW);
    return pel_pair_add(whole, part);
}

/* whether a logarithm of x is finite, else its value */
static bool has_log(double x, double *value)
{
    *value = x == 0 ? -(double)INFINITY : x > 0 ? x : (double)NAN;
    return x > 0 && !isinf(x);
}

double pel_ln(double x)
{
    double value;
    return has_log(x, &value) ? log_of(x).high : value;
}

double pel_log2(double x)
{
    static const pel_pair inverse_ln2 = {0x1.71547652b82fep+0, 0x1.777d0ffda0d24p-56};
    double value;
    int exponent;
    if (!has_log(x, &value))
        return value;
    pel_pair part = pel_pair_multiply(log_part(x, &exponent), inverse_ln2);
    return pel_pair_add((pel_pair){exponent, 0}, part).high;
}

double pel_pow(double x, double y)
{
    double edge = (double)INFINITY;
    if (y == 0 || x == 1)
        return 1;
    if (!(x >= 0) || isnan(y))
        return (double)NAN;
    if (x == 0 || isinf(x))
        return (x == 0) == (y > 0) ? 0 : edge;
    pel_pair logarithm = log_of(x);
    double product = logarithm.high * y;
    if (!(product >= LEAST && product <= LARGEST))
        return product > 0 ? edge : 0;
    return exp_of(pel_pair_multiply(logarithm, (pel_pair){y, 0}));
}

double pel_hypot(double x, double y)
{
    double a = fabs(x), b = fabs(y), large = a > b ? a : b, small = a > b ? b : a, scale = 1;
    if (isinf(a) || isinf(b))
        return (double)INFINITY;
    if (isnan(a) || isnan(b))
        return a + b;
    if (small <= 0x1p-30 * large)
        return large;
    if (large > 0x1p450 || large < 0x1p-400)
        scale = large > 1 ? 0x1p-600 : 0x1p600;
    large *= scale;
    small *= scale;
    return pel_pair_sqrt(pel_pair_add(pel_pair_product(large, large), pel_pair_product(small, small))).high / scale;
}
