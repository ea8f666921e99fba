#include "check.h"

#include <pellicle/base.h>

#include <stdlib.h>
#include <time.h>

/* the clock that was read last, and what it says */
static clockid_t asked;
static struct timespec told;

/* takes the place of the C library's */
int clock_gettime(clockid_t clock, struct timespec *now)
{
    asked = clock;
    *now = told;
    return 0;
}

/* Setting the time of the system moves neither of the clocks. */
static void test_which_clock(void **unused)
{
    (void)unused;
    asked = CLOCK_REALTIME;
    pel_seconds();
    assert_int_equal(asked, CLOCK_MONOTONIC);
    pel_thread_seconds();
    assert_int_equal(asked, CLOCK_THREAD_CPUTIME_ID);
}

static void test_seconds(void **unused)
{
    (void)unused;
    told = (struct timespec){.tv_sec = 1234567, .tv_nsec = 250000000};
    assert_true(pel_seconds() == 1234567.25);
    told = (struct timespec){.tv_nsec = 500000000};
    assert_true(pel_thread_seconds() == 0.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_which_clock),
        cmocka_unit_test(test_seconds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
