/* Parallel loops: OpenMP when the compiler has it, plain loops otherwise.
   Work is cut into chunks whose bounds depend on the count alone, never on the number of threads; a sum goes chunk by
   chunk and the chunks are added in order. So results have the same bits for any thread count. */
#ifndef PEL_BASE_PARALLEL_H
#define PEL_BASE_PARALLEL_H

#ifdef _OPENMP
#include <omp.h>
#define PEL_PRAGMA(text) _Pragma(#text)
/* for loop over independent iterations, split evenly over `threads` */
#define PEL_PARALLEL_FOR(threads) PEL_PRAGMA(omp parallel for schedule(static) num_threads(threads) if ((threads) > 1))
/* the same with a reduction clause whose result does not depend on order: max, bitwise or */
#define PEL_PARALLEL_FOR_REDUCE(threads, clause)                                                                       \
    PEL_PRAGMA(omp parallel for schedule(static) num_threads(threads) if ((threads) > 1) reduction(clause))
#else
#define PEL_PARALLEL_FOR(threads) (void)(threads);
#define PEL_PARALLEL_FOR_REDUCE(threads, clause) (void)(threads);
#endif

#endif
