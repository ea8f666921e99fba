/* Gusts: their root mean square, no sources, seeds, and that the wind carries them. */
#include "check.h"

#include "boundary/gusts.h"

#include <math.h>

static const double still[3] = {0, 0, 0};

static void flow_at(const pel_gusts *gusts, const double wind[3], double x, double y, double z, double time,
                    double flow[3])
{
    const double at[3] = {x, y, z};
    for (int i = 0; i < 3; i++)
        flow[i] = 0;
    pel_gusts_add(gusts, wind, at, time, 1, flow);
}

/* the mean square of each component over 20 fields is that of the def within 5 %, and the mean vanishes */
static void test_size(void **unused)
{
    (void)unused;
    enum { FIELDS = 20, POINTS = 2000 };
    double square[3] = {0, 0, 0}, mean[3] = {0, 0, 0};
    uint64_t random = 1;
    for (int seed = 0; seed < FIELDS; seed++) {
        pel_gusts gusts;
        pel_gusts_make(&(pel_gust_def){.speed = 2, .length = 0.5, .seed = seed}, &gusts);
        for (int i = 0; i < POINTS; i++) {
            double x[3], flow[3];
            for (int k = 0; k < 3; k++) {
                random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
                x[k] = 20 * (double)(random >> 11) / 9007199254740992.0;
            }
            flow_at(&gusts, still, x[0], x[1], x[2], 0.3, flow);
            for (int k = 0; k < 3; k++) {
                square[k] += flow[k] * flow[k] / (FIELDS * POINTS);
                mean[k] += flow[k] / (FIELDS * POINTS);
            }
        }
    }
    for (int k = 0; k < 3; k++) {
        assert_near(sqrt(square[k]), 2, 0.1);
        assert_near(mean[k], 0, 0.05);
    }
}

static void test_no_sources(void **unused)
{
    (void)unused;
    const double h = 1e-4;
    pel_gusts gusts;
    pel_gusts_make(&(pel_gust_def){.speed = 1, .length = 1, .seed = 7}, &gusts);
    for (int i = 0; i < 50; i++) {
        double x[3] = {0.37 * i, -0.11 * i, 0.05 * i * i}, sum = 0, size = 0;
        for (int k = 0; k < 3; k++) {
            double low[3] = {x[0], x[1], x[2]}, high[3] = {x[0], x[1], x[2]}, before[3], after[3];
            low[k] -= h;
            high[k] += h;
            flow_at(&gusts, still, low[0], low[1], low[2], 2, before);
            flow_at(&gusts, still, high[0], high[1], high[2], 2, after);
            sum += (after[k] - before[k]) / (2 * h);
            size += fabs(after[k] - before[k]) / (2 * h);
        }
        assert_near(sum, 0, 1e-5 * (1 + size));
    }
}

static void test_seed_and_wind(void **unused)
{
    (void)unused;
    const double wind[3] = {3, -1, 0.5};
    pel_gusts gusts, same, other, none;
    double a[3], b[3];
    pel_gusts_make(&(pel_gust_def){.speed = 1, .length = 1, .seed = 7}, &gusts);
    pel_gusts_make(&(pel_gust_def){.speed = 1, .length = 1, .seed = 7}, &same);
    pel_gusts_make(&(pel_gust_def){.speed = 1, .length = 1, .seed = 8}, &other);
    pel_gusts_make(&(pel_gust_def){.speed = 0}, &none);
    assert_int_equal(none.count, 0);
    flow_at(&gusts, wind, 1, 2, 3, 4, a);
    flow_at(&same, wind, 1, 2, 3, 4, b);
    assert_memory_equal(a, b, sizeof a);
    flow_at(&other, wind, 1, 2, 3, 4, b);
    assert_true(fabs(a[0] - b[0]) > 1e-3);
    /* seen from the wind, the gusts at a time are those of still air */
    flow_at(&gusts, still, 1 - 4 * wind[0], 2 - 4 * wind[1], 3 - 4 * wind[2], 4, b);
    for (int k = 0; k < 3; k++)
        assert_near(a[k], b[k], 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_size),
        cmocka_unit_test(test_no_sources),
        cmocka_unit_test(test_seed_and_wind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
