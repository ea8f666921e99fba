#include "pellicle/parallel.h"

#include "base/parallel.h"

int pel_thread_limit(void)
{
#ifdef _OPENMP
    return omp_get_max_threads();
#else
    return 1;
#endif
}

void pel_triad(double *a, const double *b, const double *c, size_t count, int thread_count)
{
    PEL_PARALLEL_FOR(thread_count)
    for (size_t i = 0; i < count; i++)
        a[i] = b[i] + 3 * c[i];
}
