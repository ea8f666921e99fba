/* Names that a user typed, and UTF-8. pel_nearest_name (pellicle/base.h) finds the known one that was meant. */
#ifndef PEL_BASE_TEXT_H
#define PEL_BASE_TEXT_H

#include "pellicle/base.h"

/* How many letters must be inserted, deleted, replaced or swapped with their neighbour to get from a to b (optimal
   string alignment); upper and lower case, '-' and '_' count as equal. Names beyond 63 letters are cut there. */
size_t pel_edit_distance(const char *a, const char *b);

bool pel_is_among(const char *name, const char *const *names, size_t count);

/* The first of the names that has this one as a part between hyphens: geodesic-sphere for sphere; null if there is
 * none. */
const char *pel_longer_name(const char *name, const char *const *names, size_t count);

/* Bytes of the UTF-8 character at text (`size` bytes may be read); 0 if it is invalid (overlong forms, surrogates and
   numbers too large are invalid). */
size_t pel_utf8_length(const char *text, size_t size);

#endif
