/* Pellicle: threads. */
#ifndef PELLICLE_PARALLEL_H
#define PELLICLE_PARALLEL_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Number of threads of a simulation whose thread_count is 0: the processors of this machine. */
PEL_API int pel_thread_limit(void);

#ifdef __cplusplus
}
#endif
#endif
