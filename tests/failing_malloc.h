/* Makes allocations fail and counts them. The linker sends every malloc, calloc, realloc, aligned_alloc and free of the
   library and of the tests (not of shared libraries) through failing_malloc.c. */
#ifndef PEL_TESTS_FAILING_MALLOC_H
#define PEL_TESTS_FAILING_MALLOC_H

#include "pellicle/base.h"

typedef struct allocation_count {
    long calls;         /* allocations asked for between begin and end */
    long failed;        /* of these, made to fail */
    long live;          /* blocks made in between and not freed */
    bool failed_shrink; /* the one that failed was a realloc that makes its block smaller */
} allocation_count;

/* Starts counting; the n-th allocation from here fails, 0 = none. */
void failing_malloc_begin(long n);
/* Stops counting and failing. */
allocation_count failing_malloc_end(void);
/* From here on a block of this size [bytes] or a larger one ends the process by SIGALRM, counted or not; 0 = none. */
void failing_malloc_ends_at(size_t size);

/* Creates something from data, asserts that the out-pointer is null when that fails, destroys it, returns the status.
 */
typedef pel_status allocation_case(const void *data, pel_error *error);

/* Runs the case with its 1st, 2nd, ... allocation failing until it passes without a failure. Asserts that each failure
   gives PEL_OUT_OF_MEMORY with its error filled (or success, after a failed realloc that was only to shrink) and leaks
   nothing. Returns the number of allocations of the case. */
long for_every_allocation_failure(allocation_case *run, const void *data);
/* of every step-th only */
long for_allocation_failures(allocation_case *run, const void *data, long step);

#endif
