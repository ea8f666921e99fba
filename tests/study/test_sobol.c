#include "check.h"

#include "study/sobol.h"

/* points 5 and 999, times 1024, from another implementation of Joe and Kuo's numbers (scipy.stats.qmc, 1.10) */
static const int known[2][PEL_SOBOL_DIMENSIONS] = {
    {896, 896, 128, 384, 896, 640, 896, 384, 384, 128, 384, 896, 896, 128, 896, 384, 896, 384, 384, 640, 640},
    {161, 931, 83, 1013, 991, 865, 879, 729, 833, 647, 23, 453, 485, 969, 851, 571, 289, 673, 695, 39, 343},
};

static void test_known_points(void **unused)
{
    (void)unused;
    for (int32_t d = 0; d < PEL_SOBOL_DIMENSIONS; d++) {
        assert_near(pel_sobol(d, 0), 0, 0);
        assert_near(pel_sobol(d, 1), 0.5, 0);
        assert_near(1024 * pel_sobol(d, 5), known[0][d], 0);
        assert_near(1024 * pel_sobol(d, 999), known[1][d], 0);
    }
}

/* the first 2^k points have one in each of 2^k intervals, in each dimension */
static void test_strata(void **unused)
{
    (void)unused;
    enum { COUNT = 1024 };
    for (int32_t d = 0; d < PEL_SOBOL_DIMENSIONS; d++) {
        char seen[COUNT] = {0};
        for (uint32_t i = 0; i < COUNT; i++)
            seen[(int)(pel_sobol(d, i) * COUNT)]++;
        for (int i = 0; i < COUNT; i++)
            assert_int_equal(seen[i], 1);
    }
}

/* Star discrepancy of the first two dimensions, over the boxes whose corners are on a grid: that of n points at random
   is about 0.5 / sqrt(n) = 0.03 here, that of the sequence some (log n)^2 / n. */
static void test_discrepancy(void **unused)
{
    (void)unused;
    enum { COUNT = 256, GRID = 64 };
    double worst = 0;
    for (int a = 1; a <= GRID; a++)
        for (int b = 1; b <= GRID; b++) {
            double width = (double)a / GRID, height = (double)b / GRID;
            int inside = 0;
            for (uint32_t i = 0; i < COUNT; i++)
                inside += pel_sobol(0, i) < width && pel_sobol(1, i) < height;
            worst = fmax(worst, fabs((double)inside / COUNT - width * height));
        }
    assert_true(worst < 0.01);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_known_points), cmocka_unit_test(test_strata),
                                       cmocka_unit_test(test_discrepancy)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
