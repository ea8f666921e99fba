/* Filling a pel_error. All functions accept a null error and return the status, so that a failure is one line:
       return pel_fail(error, PEL_BAD_MESH, "triangle has no area", ...); */
#ifndef PEL_BASE_STATUS_H
#define PEL_BASE_STATUS_H

#include "pellicle/base.h"

#if defined(__GNUC__)
#define PEL_PRINTF(format_index, first) __attribute__((format(printf, format_index, first)))
#else
#define PEL_PRINTF(format_index, first)
#endif

/* clears the error, sets status and the `what` sentence */
pel_status pel_fail(pel_error *error, pel_status status, const char *what_format, ...) PEL_PRINTF(3, 4);
/* "out of memory" with the usual remedy */
pel_status pel_fail_memory(pel_error *error);
/* additions to an error that was just filled; each returns the error's status (PEL_OK when error is null) */
void pel_fail_remedy(pel_error *error, const char *format, ...) PEL_PRINTF(2, 3);
void pel_fail_element(pel_error *error, const char *kind, int64_t element);
void pel_fail_place(pel_error *error, const char *file, int32_t line, int32_t column);
void pel_fail_offset(pel_error *error, const char *file, int64_t byte_offset);

/* one formatted line to a log that may be null */
void pel_log_line(const pel_log *log, const char *format, ...) PEL_PRINTF(2, 3);

#endif
