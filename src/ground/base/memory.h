/* Allocation: the only place that calls malloc. Sizes are checked for overflow. Arrays are zeroed; aligned arrays
   start on a cache line. All fail when the thread is to stop (base/patience.h). Tests make the n-th call fail by
   wrapping malloc, calloc, realloc and aligned_alloc. */
#ifndef PEL_BASE_MEMORY_H
#define PEL_BASE_MEMORY_H

#include <stddef.h>

/* count zeroed elements of size bytes; null when out of memory or when count * size overflows; count 0 gives non-null
 */
void *pel_allocate(size_t count, size_t size);
/* the same on a 64-byte boundary */
void *pel_allocate_aligned(size_t count, size_t size);
/* grows or shrinks; on failure null and the old block stays; new bytes are not zeroed */
void *pel_reallocate(void *block, size_t count, size_t size);
/* frees a block of any of the above; null is fine */
void pel_free(void *block);
/* copy of a string, or null */
char *pel_copy_string(const char *text);

/* Bytes of the last block that this thread did not get since it asked here; 0 if it got all. */
size_t pel_memory_refused(void);

/* Bytes that this process may use: the memory of the machine, or a lower limit of its group or resources; HUGE_VAL if
   the system does not tell. */
double pel_memory_limit(void);

/* Makes room for `needed` elements of `size` bytes in a growing array: doubles *capacity. False when out of memory. */
int pel_reserve(void **array, size_t *capacity, size_t needed, size_t size);

#endif
