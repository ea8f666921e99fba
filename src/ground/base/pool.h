/* Threads for the loops of one simulation.

   A loop is cut into chunks whose bounds depend on the count alone; the thread that takes a chunk does not matter, and
   each chunk writes to its own place. So results have the same bits for any number of threads.

   The calling thread works too and never waits for a helper that has not begun: if a helper is scheduled milliseconds
   late, on a busy machine, the caller does all chunks itself. (OpenMP's barriers were tried: with another job on the
   second core a step of 100 us took 15 ms.) Helpers spin for some microseconds after a loop and then sleep. */
#ifndef PEL_BASE_POOL_H
#define PEL_BASE_POOL_H

#include "pellicle/base.h"

typedef struct pel_pool pel_pool;

/* threads that a def may ask for */
enum { PEL_THREADS_MOST = 1024 };

/* the work of one chunk; called from any thread, for different chunks at the same time */
typedef void pel_chunk_function(void *context, int32_t chunk);

/* thread_count - 1 helpers; 1 or less gives none. PEL_OUT_OF_MEMORY when threads cannot be had. */
pel_status pel_pool_create(int thread_count, pel_pool **pool, pel_error *error);
void pel_pool_destroy(pel_pool *pool);

/* Runs all chunks and returns when they are done. A null pool, or a single chunk, runs in the calling thread. */
void pel_pool_run(pel_pool *pool, int32_t chunk_count, pel_chunk_function *function, void *context);

/* Asks `wanted` between chunks, in the thread that calls pel_pool_run, until it returns false: the pool is stopped from
   then on. Loops still run all of their chunks: a long computation looks for itself and ends with PEL_STOPPED. Null
   asks nobody; either way the pool is not stopped after the call. The patience of the thread that calls pel_pool_run
   (base/patience.h) stops it too. */
void pel_pool_watch(pel_pool *pool, bool (*wanted)(void *user), void *user);
/* Callable from any thread; a null pool is stopped when the thread has no patience left. */
bool pel_pool_is_stopped(const pel_pool *pool);
/* For chunks that take long, and loops without a pool: asks as well, in the thread that called pel_pool_watch. */
bool pel_pool_is_stopped_now(pel_pool *pool);
/* PEL_STOPPED for a pool that is stopped, else PEL_OK. */
pel_status pel_pool_check(const pel_pool *pool, pel_error *error);

#endif
