/* What every test file needs: cmocka with its prerequisites, and comparisons of doubles. */
#ifndef PEL_TESTS_CHECK_H
#define PEL_TESTS_CHECK_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

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
