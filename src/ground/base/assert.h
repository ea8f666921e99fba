/* Assertions of what the code itself guarantees: indices, orders, what functions ask of their callers. What users give
   is refused with a pel_error instead. Debug builds and those with sanitizers have them (PELLICLE_CHECKS in
   cmake/flags.cmake); in others the conditions are compiled and never evaluated.

   PEL_ASSERT is for conditions of constant time; PEL_ASSERT_WHOLE for functions pel_x_is_valid that read a whole
   structure, at the end of what makes or changes it. These may allocate: what they allocate in between does not count
   where tests count allocations, and without memory they return true. */
#ifndef PEL_BASE_ASSERT_H
#define PEL_BASE_ASSERT_H

#include <stdbool.h>

/* 0 = none, 1 = PEL_ASSERT, 2 = whole structures too */
#ifndef PEL_CHECKS
#define PEL_CHECKS 0
#endif

/* Prints the condition and its place, and aborts. */
_Noreturn void pel_assert_fail(const char *condition, const char *file, int line);

/* Around the check of a whole structure; the second returns `is_valid`. */
void pel_check_begin(void);
bool pel_check_end(bool is_valid);
/* true in between, in this thread */
bool pel_check_is_running(void);

#define PEL_ASSERT_NOT(condition) ((void)sizeof((condition) ? 1 : 0))
#define PEL_ASSERT_NOW(condition, text) ((condition) ? (void)0 : pel_assert_fail(text, __FILE__, __LINE__))

#if PEL_CHECKS >= 1
#define PEL_ASSERT(condition) PEL_ASSERT_NOW(condition, #condition)
#else
#define PEL_ASSERT(condition) PEL_ASSERT_NOT(condition)
#endif

#if PEL_CHECKS >= 2
#define PEL_ASSERT_WHOLE(condition) PEL_ASSERT_NOW((pel_check_begin(), pel_check_end(condition)), #condition)
#else
#define PEL_ASSERT_WHOLE(condition) PEL_ASSERT_NOT(condition)
#endif

/* 0 <= index < count */
#define PEL_ASSERT_INDEX(index, count) PEL_ASSERT((index) >= 0 && (index) < (count))

#endif
