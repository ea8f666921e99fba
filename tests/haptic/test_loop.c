/* What the thread of the haptic loop books, and its quantiles, against the list of all latencies. */
#include "check.h"

#include "haptic/loop.h"
#include "random.h"

#include <stdlib.h>

enum { BIN = 10000, COUNT = 4096, LAST = PEL_HAPTIC_LATENCY_BINS - 1 };

static int compare(const void *a, const void *b)
{
    int64_t first = *(const int64_t *)a, second = *(const int64_t *)b;
    return (first > second) - (first < second);
}

/* each bin from its lower end on; the last one takes all that is later */
static void test_bins(void **unused)
{
    (void)unused;
    for (int bin = 0; bin < PEL_HAPTIC_LATENCY_BINS + 3; bin++)
        for (int i = 0; i < 2; i++) {
            pel_haptic_latency latency = {.most = 1e-9};
            int64_t late = (int64_t)BIN * bin + (i == 0 ? 0 : BIN - 1);
            pel_loop_book(&latency, late);
            for (int k = 0; k < PEL_HAPTIC_LATENCY_BINS; k++)
                assert_int_equal(latency.bins[k], k == (bin < LAST ? bin : LAST));
            assert_int_equal(latency.count, 1);
            assert_int_equal(latency.missed_count, 0);
            assert_near(latency.most, late > 1 ? 1e-9 * (double)late : 1e-9, 1e-18);
        }
}

/* the upper end of the bin in which the sorted latencies reach a share */
static void test_quantiles(void **unused)
{
    (void)unused;
    static int64_t all[COUNT];
    pel_haptic_latency latency = {0};
    random_state random = {47};
    assert_near(pel_haptic_latency_quantile(&latency, 0.5), 0, 0);
    assert_near(pel_haptic_latency_quantile(NULL, 0.5), 0, 0);
    for (int i = 0; i < COUNT; i++) {
        double share = random_between(&random, 0, 1);
        all[i] = (int64_t)(share * share * share * 1.3e6);
        pel_loop_book(&latency, all[i]);
    }
    qsort(all, COUNT, sizeof *all, compare);
    for (int i = 1; i <= COUNT; i++) {
        int64_t bin = all[i - 1] / BIN;
        double end = bin < LAST ? 1e-9 * (double)((bin + 1) * BIN) : 1, most = 1e-9 * (double)all[COUNT - 1];
        assert_near(pel_haptic_latency_quantile(&latency, (double)i / COUNT), end < most ? end : most, 1e-15);
    }
    assert_true(latency.bins[LAST] > 100 && latency.bins[LAST - 1] > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bins), cmocka_unit_test(test_quantiles)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
