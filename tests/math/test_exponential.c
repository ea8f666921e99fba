#include "math/functions.h"

#include "ulps.h"

#define TRIALS ROUNDS(200000, 2000)
/* error stated in the sources, in ulp; the interface promises 1 */
#define EXP_BOUND 0.8
#define LOG_BOUND 0.51
#define TANH_BOUND 0.8

static void test_exp_and_log(void **unused)
{
    (void)unused;
    random_state random = {1};
    ulps_worst exps = {0}, logs = {0}, log2s = {0}, tanhs = {0};
    for (int i = 0; i < TRIALS; i++) {
        double x = i % 2 == 0 ? random_between(&random, -750, 715) : any_double(&random, -60, 4);
        ulps_take(&exps, pel_exp(x), expl((long double)x), x, 0);
        x = i % 2 == 0 ? any_double(&random, -60, 5) : random_between(&random, -23, 23);
        ulps_take(&tanhs, pel_tanh(x), tanhl((long double)x), x, 0);
        x = i % 2 == 0 ? fabs(any_double(&random, -1070, 1024)) : 1 + any_double(&random, -52, -1);
        ulps_take(&logs, pel_ln(x), logl((long double)x), x, 0);
        ulps_take(&log2s, pel_log2(x), log2l((long double)x), x, 0);
    }
    ulps_check("exp", &exps, EXP_BOUND);
    ulps_check("log", &logs, LOG_BOUND);
    ulps_check("log2", &log2s, LOG_BOUND);
    ulps_check("tanh", &tanhs, TANH_BOUND);
}

static void test_pow_and_hypot(void **unused)
{
    (void)unused;
    random_state random = {2};
    ulps_worst pows = {0}, hypots = {0};
    for (int i = 0; i < TRIALS; i++) {
        double x = i % 2 == 0 ? fabs(any_double(&random, -1070, 1024)) : 1 + any_double(&random, -30, -1);
        /* results of all sizes */
        double y = random_between(&random, -745, 710) / log(x);
        y = i % 3 == 0 ? random_between(&random, -4, 4) : y;
        ulps_take(&pows, pel_pow(x, y), powl((long double)x, (long double)y), x, y);
        x = any_double(&random, -1070, 1023);
        y = any_double(&random, -1070, 1023);
        if (i % 2 == 0)
            y = ldexp(x, (int)random_integer(&random, -60, 0)) * random_between(&random, -1, 1);
        ulps_take(&hypots, pel_hypot(x, y), hypotl((long double)x, (long double)y), x, y);
    }
    ulps_check("pow", &pows, EXP_BOUND);
    ulps_check("hypot", &hypots, EXP_BOUND);
}

static void test_edges_of_exponentials(void **unused)
{
    (void)unused;
    const double edge = (double)INFINITY, none = (double)NAN;
    assert_same(pel_exp(0), 1);
    assert_same(pel_exp(-edge), 0);
    assert_same(pel_exp(edge), edge);
    assert_same(pel_exp(709.78271289338397), exp(709.78271289338397));
    assert_same(pel_exp(709.78271289338409), edge);
    assert_same(pel_exp(-745.13321910194110), 0x1p-1074);
    assert_same(pel_exp(-746), 0);
    assert_same(pel_exp(none), none);
    assert_same(pel_tanh(-0.0), -0.0);
    assert_same(pel_tanh(-edge), -1);
    assert_same(pel_tanh(22.5), 1);
    assert_same(pel_tanh(0x1p-1074), 0x1p-1074);
    assert_same(pel_tanh(none), none);
    assert_same(pel_ln(1), 0);
    assert_same(pel_ln(0), -edge);
    assert_same(pel_ln(-1), none);
    assert_same(pel_ln(edge), edge);
    assert_same(pel_ln(none), none);
    for (int e = -1074; e <= 1023; e++)
        assert_same(pel_log2(ldexp(1, e)), e);
    assert_same(pel_log2(-1), none);
}

static void test_edges_of_pow_and_hypot(void **unused)
{
    (void)unused;
    const double edge = (double)INFINITY, none = (double)NAN;
    const double x[] = {0, 0.5, 1, 2, edge, none}, y[] = {-edge, -1e300, -2.5, -1, 0, 1, 2.5, 1e300, edge, none};
    for (size_t i = 0; i < sizeof x / sizeof *x; i++)
        for (size_t j = 0; j < sizeof y / sizeof *y; j++)
            assert_same(pel_pow(x[i], y[j]), pow(x[i], y[j]));
    assert_same(pel_pow(-2, 3), none);
    assert_same(pel_pow(3, 4), 81);
    assert_same(pel_pow(2, -1074), 0x1p-1074);
    assert_same(pel_pow(2, 1023), 0x1p1023);
    assert_same(pel_pow(1.5, 1e-320), 1);
    assert_same(pel_hypot(3, -4), 5);
    assert_same(pel_hypot(0, -0.0), 0);
    assert_same(pel_hypot(1e308, 1e308), hypot(1e308, 1e308));
    assert_same(pel_hypot(1.5e308, 1.5e308), edge);
    assert_same(pel_hypot(0x1p-1074, 0x1p-1074), 0x1p-1074);
    assert_same(pel_hypot(3e-320, 4e-320), 5e-320);
    assert_same(pel_hypot(none, -edge), edge);
    assert_same(pel_hypot(none, 1), none);
    assert_same(pel_hypot(1, none), none);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exp_and_log),
        cmocka_unit_test(test_pow_and_hypot),
        cmocka_unit_test(test_edges_of_exponentials),
        cmocka_unit_test(test_edges_of_pow_and_hypot),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
