/* One thread that does jobs in order while the caller continues. The caller describes each job in one of its slots; a
   slot belongs to the thread from pel_worker_give until its job is done. */
#ifndef PEL_BASE_WORKER_H
#define PEL_BASE_WORKER_H

#include "pellicle/base.h"

typedef struct pel_worker pel_worker;

/* the job described in a slot; called in the worker's thread */
typedef void pel_worker_function(void *context, int32_t slot);

/* slot_count >= 1 jobs can be under way. PEL_OUT_OF_MEMORY when the thread cannot be had. */
pel_status pel_worker_create(int32_t slot_count, pel_worker_function *function, void *context, pel_worker **worker,
                             pel_error *error);
/* after all jobs are done; null is fine */
void pel_worker_destroy(pel_worker *worker);

/* The slot of the next job, 0, 1, ..., slot_count - 1, 0, ...; waits until its last job is done. */
int32_t pel_worker_claim(pel_worker *worker);
/* Hands the job in the claimed slot over. */
void pel_worker_give(pel_worker *worker);
/* Returns when all jobs are done. */
void pel_worker_wait(pel_worker *worker);

#endif
