#include "math/functions.h"

#include "ulps.h"

#define TRIALS ROUNDS(200000, 2000)
/* error of the series, in ulp; the interface promises 1 */
#define SINE_BOUND 0.8
#define ANGLE_BOUND 0.51

static void test_sine_and_cosine(void **unused)
{
    (void)unused;
    random_state random = {1};
    ulps_worst sines = {0}, cosines = {0};
    for (int i = 0; i < TRIALS; i++) {
        double x = any_double(&random, -40, i % 2 == 0 ? 8 : 1024);
        if (i % 4 == 0) /* near multiples of a quarter turn */
            x = 1.5707963267948966 * (double)random_integer(&random, -1000000, 1000000) + any_double(&random, -40, -2);
        ulps_take(&sines, pel_sin(x), sinl((long double)x), x, 0);
        ulps_take(&cosines, pel_cos(x), cosl((long double)x), x, 0);
    }
    ulps_check("sin", &sines, SINE_BOUND);
    ulps_check("cos", &cosines, SINE_BOUND);
}

/* the double nearest to a multiple of pi/2 (Muller, Handbook of Floating-Point Arithmetic, section 10.2) */
static void test_argument_that_cancels_most(void **unused)
{
    (void)unused;
    const double x = ldexp(6381956970095103.0, 797);
    assert_true(ulps_between(pel_cos(x), cosl((long double)x)) <= SINE_BOUND);
    assert_same(pel_cos(x), -4.68716592425462761112e-19);
    assert_same(pel_sin(x), 1);
    assert_same(pel_cos(-x), pel_cos(x));
    assert_same(pel_sin(-x), -1);
}

static void test_angles(void **unused)
{
    (void)unused;
    random_state random = {2};
    ulps_worst angles = {0}, cosines = {0};
    for (int i = 0; i < TRIALS; i++) {
        double x = any_double(&random, -1070, 1024), y = any_double(&random, -1070, 1024);
        if (i % 2 == 0)
            y = ldexp(x, (int)random_integer(&random, -70, 70)) * random_between(&random, -1, 1);
        if (isinf(y))
            continue;
        ulps_take(&angles, pel_atan2(y, x), atan2l((long double)y, (long double)x), y, x);
        x = i % 2 == 0 ? random_between(&random, -1, 1) : copysign(1, x) * (1 - fabs(any_double(&random, -53, 0)));
        ulps_take(&cosines, pel_acos(x), acosl((long double)x), x, 0);
    }
    ulps_check("atan2", &angles, ANGLE_BOUND);
    ulps_check("acos", &cosines, ANGLE_BOUND);
}

static void test_edges_of_angles(void **unused)
{
    (void)unused;
    const double edge = (double)INFINITY, none = (double)NAN;
    const double values[] = {0, -0.0, 1, -1, 1e-310, -1e-310, 1.7e308, -1.7e308, edge, -edge, none};
    enum { COUNT = sizeof values / sizeof *values };
    for (int i = 0; i < COUNT; i++)
        for (int j = 0; j < COUNT; j++)
            assert_same(pel_atan2(values[i], values[j]), atan2(values[i], values[j]));
    assert_same(pel_acos(1), 0);
    assert_same(pel_acos(-1), 3.14159265358979312);
    assert_same(pel_acos(0), 1.57079632679489656);
    assert_same(pel_acos(1.0000000000000002), none);
    assert_same(pel_acos(none), none);
    assert_same(pel_sin(-0.0), -0.0);
    assert_same(pel_cos(0), 1);
    assert_same(pel_sin(0x1p-1074), 0x1p-1074);
    assert_same(pel_sin(edge), none);
    assert_same(pel_cos(none), none);
}

static uint64_t add_bits(uint64_t hash, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (hash ^ bits) * 1099511628211u;
}

/* one hash for GCC, Clang and WebAssembly, with and without optimization */
static void test_same_bits(void **unused)
{
    (void)unused;
    random_state random = {9};
    uint64_t hash = 1469598103934665603u;
    for (int i = 0; i < 10000; i++) {
        double x = random_between(&random, -1000, 1000), y = random_between(&random, -20, 20);
        double z = random_between(&random, 0, 50);
        const double values[] = {pel_sin(x),  pel_cos(x),    pel_exp(y),      pel_ln(z),       pel_log2(z),
                                 pel_tanh(y), pel_pow(z, y), pel_hypot(x, y), pel_atan2(x, y), pel_acos(y / 20)};
        for (size_t k = 0; k < sizeof values / sizeof *values; k++)
            hash = add_bits(hash, values[k]);
    }
    assert_int_equal(hash, 0x3862f0ad0356da91);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sine_and_cosine), cmocka_unit_test(test_argument_that_cancels_most),
        cmocka_unit_test(test_angles),          cmocka_unit_test(test_edges_of_angles),
        cmocka_unit_test(test_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
