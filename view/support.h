/* Shared by the files of this folder: memory, names, time. The view includes include/pellicle only, like any external
   program. */
#ifndef PELLICLE_VIEW_SUPPORT_H
#define PELLICLE_VIEW_SUPPORT_H

#include "pellicle/error.h"

/* count zeroed elements of size bytes; null when out of memory or too large; free with `free` */
void *view_allocate(size_t count, size_t size);

bool view_ends_with(const char *text, const char *ending);

#endif
