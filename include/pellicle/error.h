/* Pellicle: filling a pel_error, in functions that return a pel_status: those of this library, of the program, and your
   own. Every function accepts a null error, so a failure takes one line:
       return pel_fail(error, PEL_BAD_MESH, "triangle %d has no area", t);
   Texts that are too long are truncated. */
#ifndef PELLICLE_ERROR_H
#define PELLICLE_ERROR_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define PEL_PRINTF(format_index, first) __attribute__((format(printf, format_index, first)))
#else
#define PEL_PRINTF(format_index, first)
#endif

/* Clears the error, sets status and the `what` sentence; returns the status. */
PEL_API pel_status pel_fail(pel_error *error, pel_status status, const char *what_format, ...) PEL_PRINTF(3, 4);

/* pel_fail with a remedy, a sentence that is taken as it is; the second form also names the element with the problem.
 */
PEL_API pel_status pel_refuse(pel_error *error, pel_status status, const char *remedy, const char *what_format, ...)
    PEL_PRINTF(4, 5);
PEL_API pel_status pel_refuse_element(pel_error *error, pel_status status, const char *kind, int64_t element,
                                      const char *remedy, const char *what_format, ...) PEL_PRINTF(6, 7);

/* "out of memory" with the usual remedy; returns PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_fail_memory(pel_error *error);

/* Add to an error that was just filled: a remedy with numbers or names; the element with the problem; the file (null
   omits it) with line and column (0 = none), or with an offset in bytes. */
PEL_API void pel_fail_remedy(pel_error *error, const char *format, ...) PEL_PRINTF(2, 3);
PEL_API void pel_fail_element(pel_error *error, const char *kind, int64_t element);
PEL_API void pel_fail_place(pel_error *error, const char *file, int32_t line, int32_t column);
PEL_API void pel_fail_offset(pel_error *error, const char *file, int64_t byte_offset);

/* Writes one formatted line to a log, which may be null. */
PEL_API void pel_log_line(const pel_log *log, const char *format, ...) PEL_PRINTF(2, 3);

#ifdef __cplusplus
}
#endif
#endif
