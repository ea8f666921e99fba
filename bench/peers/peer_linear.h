/* Sparse factors of other libraries over the same matrix. */
#ifndef PEL_BENCH_PEER_LINEAR_H
#define PEL_BENCH_PEER_LINEAR_H

#include "linear/matrix.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What a peer took: its analysis once, the least of some factorizations and solves [s], and |b - A x| / |b|. */
typedef struct peer_times {
    const char *name;
    double analyze, factor, solve, residual;
} peer_times;

/* Times every peer in double, one after the other; returns their number (at most 4). */
int peer_linear(const pel_matrix *matrix, const double *right, double (*seconds)(void), int repeats,
                peer_times times[4]);

#ifdef __cplusplus
}
#endif

#endif
