/* Functions against those of long double: errors in units in the last place, over random and edge arguments. */
#ifndef PEL_TESTS_ULPS_H
#define PEL_TESTS_ULPS_H

#include "check.h"
#include "random.h"

#include <float.h>

/* |value - exact| over the distance of doubles at the exact value */
static inline double ulps_between(double value, long double exact)
{
    int exponent;
    if (isnan(value) || isnan((double)exact))
        return isnan(value) && isnan((double)exact) ? 0 : (double)INFINITY;
    if (isinf(value) || isinf((double)exact))
        return (long double)value == (long double)(double)exact ? 0 : (double)INFINITY;
    frexpl(exact, &exponent);
    exponent = exponent > -1021 ? exponent : -1021;
    return (double)(fabsl((long double)value - exact) / ldexpl(1, exponent - 53));
}

/* a double of any size and sign */
static inline double any_double(random_state *random, int least, int most)
{
    double size = ldexp(random_between(random, 0.5, 1), (int)random_integer(random, least, most));
    return random_bits(random) & 1 ? -size : size;
}

typedef struct ulps_worst {
    double error, x, y;
} ulps_worst;

static inline void ulps_take(ulps_worst *worst, double value, long double exact, double x, double y)
{
    double error = ulps_between(value, exact);
    if (error > worst->error)
        *worst = (ulps_worst){error, x, y};
}

/* signs of zeros are compared as well */
#define assert_same(value, expected)                                                                                   \
    do {                                                                                                               \
        double same_value = (value), same_expected = (expected);                                                       \
        if (!((isnan(same_value) && isnan(same_expected)) ||                                                           \
              (same_value == same_expected && signbit(same_value) == signbit(same_expected)))) {                       \
            print_error("%s is %.17g, expected %.17g\n", #value, same_value, same_expected);                           \
            fail();                                                                                                    \
        }                                                                                                              \
    } while (0)

static inline void ulps_check(const char *name, const ulps_worst *worst, double most)
{
    if (worst->error > most)
        print_error("%s(%.17g, %.17g) is off by %.4f ulp\n", name, worst->x, worst->y, worst->error);
    assert_true(worst->error <= most);
}

#endif
