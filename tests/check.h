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

/* How much a test does. With PELLICLE_ALL in the environment (make nightly) it does all, in every build. `make test`
   and .ci/run leave out what takes long, so that no program takes more than 3 s of processor time (tools/test-times).
   Slow builds check each operation, not many results, so a few rounds are enough there. */
static inline bool is_all(void)
{
    return getenv("PELLICLE_ALL") != NULL;
}

static inline bool is_slow(void)
{
    return IS_SLOW && !is_all();
}

/* a number, mostly of rounds or of cells: that of make nightly, and that of all other runs */
#define LONG(all, usual) (is_all() ? (all) : (usual))

/* likewise: the full one, and a smaller one in slow builds */
#define ROUNDS(full, few) (is_slow() ? (few) : (full))

/* tools/test-summary counts the tests that say so apart from those for which something is missing */
#define skip_if(is_left_out)                                                                                           \
    do {                                                                                                               \
        if (is_left_out) {                                                                                             \
            print_message("long: in make nightly\n");                                                                  \
            skip();                                                                                                    \
        }                                                                                                              \
    } while (0)

/* for tests of accuracy alone, whose code shorter tests run too: too long in slow builds, and in all builds */
#define skip_if_slow() skip_if(is_slow())
#define skip_if_long() skip_if(!is_all())

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
