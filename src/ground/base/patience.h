/* Lets a thread give up long work that nobody waits for any more.

   While a thread has no patience left, each of its allocations fails and pel_fail_memory says PEL_STOPPED: all code
   that unwinds when memory is short stops as well, and leaves as it was what it was to change. Loops that allocate
   nothing and may take more than a tenth of a second ask by themselves. */
#ifndef PEL_BASE_PATIENCE_H
#define PEL_BASE_PATIENCE_H

#include <stdbool.h>

/* From now on `wanted` is asked in this thread, often: it must be fast. Once it has said no, it is not asked again. */
void pel_patience_begin(bool (*wanted)(void *user), void *user);
/* Nothing is given up any more. True if something was. */
bool pel_patience_end(void);
/* Whether the thread is to give up. */
bool pel_patience_is_lost(void);

#endif
