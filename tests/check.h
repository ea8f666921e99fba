/* Common to all test files: cmocka with its prerequisites, and comparisons of doubles. */
#ifndef PEL_TESTS_CHECK_H
#define PEL_TESTS_CHECK_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* whether each step takes some times longer: under a sanitizer, or without optimization */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__OPTIMIZE__)
enum { IS_SLOW = 1 };
#elif defined(__has_feature)
enum { IS_SLOW = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) };
#else
enum { IS_SLOW = 0 };
#endif

/* whether to skip long tests: in slow builds, unless PELLICLE_ALL is in the environment (make nightly) */
static inline bool is_slow(void)
{
    return IS_SLOW && getenv("PELLICLE_ALL") == NULL;
}

/* rounds of a loop; slow builds check each operation, not many results, so a few are enough there */
#define ROUNDS(full, few) (is_slow() ? (few) : (full))

/* for tests of accuracy alone, whose code shorter tests run too */
#define skip_if_slow()                                                                                                 \
    do {                                                                                                               \
        if (is_slow())                                                                                                 \
            skip();                                                                                                    \
    } while (0)

/* |actual - expected| <= tolerance, printing the three numbers when not */
#define assert_near(actual, expected, tolerance)                                                                       \
    do {                                                                                                               \
        double check_actual = (actual), check_expected = (expected), check_tolerance = (tolerance);                    \
        if (!(fabs(check_actual - check_expected) <= check_tolerance)) {                                               \
            print_error("%s is %.17g, expected %.17g within %g (off by %g)\n", #actual, check_actual, check_expected,  \
                        check_tolerance, check_actual - check_expected);                                               \
            fail();                                                                                                    \
        }                                                                                                              \
    } while (0)

#endif
