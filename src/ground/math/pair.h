/* Numbers as unevaluated sums high + low of two doubles, some 104 bits (Dekker 1971; Knuth, TAOCP vol. 2, 4.2.2).
   Products need magnitudes within 2^-480 .. 2^480. */
#ifndef PEL_MATH_PAIR_H
#define PEL_MATH_PAIR_H

#include <math.h>

typedef struct pel_pair {
    double high, low;
} pel_pair;

/* exact a + b for |a| >= |b| or a = 0 */
static inline pel_pair pel_pair_quick_sum(double a, double b)
{
    double sum = a + b;
    return (pel_pair){sum, b - (sum - a)};
}

/* exact a + b */
static inline pel_pair pel_pair_sum(double a, double b)
{
    double sum = a + b, part = sum - a;
    return (pel_pair){sum, (a - (sum - part)) + (b - part)};
}

/* exact a b; the factors are split into halves of 26 bits, because fma is a call where the processor has none */
static inline pel_pair pel_pair_product(double a, double b)
{
    const double split = 134217729; /* 2^27 + 1 */
    double sa = split * a, sb = split * b, product = a * b;
    double a_high = sa - (sa - a), a_low = a - a_high, b_high = sb - (sb - b), b_low = b - b_high;
    return (pel_pair){product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

static inline pel_pair pel_pair_add(pel_pair a, pel_pair b)
{
    pel_pair sum = pel_pair_sum(a.high, b.high);
    return pel_pair_quick_sum(sum.high, sum.low + (a.low + b.low));
}

static inline pel_pair pel_pair_multiply(pel_pair a, pel_pair b)
{
    pel_pair product = pel_pair_product(a.high, b.high);
    return pel_pair_quick_sum(product.high, product.low + (a.high * b.low + a.low * b.high));
}

static inline pel_pair pel_pair_divide(pel_pair a, pel_pair b)
{
    double quotient = a.high / b.high;
    pel_pair product = pel_pair_product(quotient, b.high);
    double rest = ((a.high - product.high) - product.low) + (a.low - quotient * b.low);
    return pel_pair_quick_sum(quotient, rest / b.high);
}

/* of a pair above 0 */
static inline pel_pair pel_pair_sqrt(pel_pair a)
{
    double root = sqrt(a.high);
    pel_pair square = pel_pair_product(root, root);
    return pel_pair_quick_sum(root, (((a.high - square.high) - square.low) + a.low) / (2 * root));
}

#endif
