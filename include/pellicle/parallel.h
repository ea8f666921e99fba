/* Pellicle: threads, and the yardstick of memory bandwidth that benchmarks stand beside. */
#ifndef PELLICLE_PARALLEL_H
#define PELLICLE_PARALLEL_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Threads that a simulation uses when its thread_count is 0; 1 when the library was built without OpenMP. */
int pel_thread_limit(void);

/* a[i] = b[i] + 3 c[i] for count doubles (STREAM triad, McCalpin), split over thread_count threads. */
void pel_triad(double *a, const double *b, const double *c, size_t count, int thread_count);

#ifdef __cplusplus
}
#endif
#endif
