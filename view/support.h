/* What the files of this folder share: errors, memory, names. The view sees include/pellicle only, as any program
   outside would. */
#ifndef PELLICLE_VIEW_SUPPORT_H
#define PELLICLE_VIEW_SUPPORT_H

#include "pellicle/base.h"

#if defined(__GNUC__)
#define VIEW_PRINTF(format_index, first) __attribute__((format(printf, format_index, first)))
#else
#define VIEW_PRINTF(format_index, first)
#endif

/* clears the error (nullable), sets status, file (nullable) and the `what` sentence; returns the status */
pel_status view_fail(pel_error *error, pel_status status, const char *file, const char *format, ...) VIEW_PRINTF(4, 5);
pel_status view_fail_memory(pel_error *error);
/* adds the remedy to an error that was just filled */
void view_remedy(pel_error *error, const char *format, ...) VIEW_PRINTF(2, 3);
/* one line to a log that may be null */
void view_note(const pel_log *log, const char *format, ...) VIEW_PRINTF(2, 3);

/* count zeroed elements of size bytes; null when out of memory or too large; free with `free` */
void *view_allocate(size_t count, size_t size);

bool view_ends_with(const char *text, const char *ending);
/* seconds of a steady clock */
double view_clock(void);

#endif
