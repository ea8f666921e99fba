/* Names that a user typed: the nearest known one for an error's remedy. */
#ifndef PEL_BASE_TEXT_H
#define PEL_BASE_TEXT_H

#include <stddef.h>

/* How many letters must be inserted, deleted, replaced or swapped with their neighbour to get from a to b (optimal
   string alignment); upper and lower case, '-' and '_' count as equal. Names beyond 63 letters are cut there. */
size_t pel_edit_distance(const char *a, const char *b);

/* The name (of count) with the smallest edit distance to `name`, the first of several. Null when none is near: when
   more than a third of the letters, and more than two, would have to change. */
const char *pel_nearest_name(const char *name, const char *const *names, size_t count);

#endif
