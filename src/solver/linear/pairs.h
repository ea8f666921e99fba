/* What a minimisation learnt of the curvature: pairs of steps and changes of the gradient, and the two loops of L-BFGS
   over them (Nocedal, Wright 2006, algorithm 7.4). Between the loops stands the caller's first guess of the inverse
   Hessian:

       d = -gradient,  pel_pairs_begin(d),  d = guess d,  pel_pairs_end(d)   */
#ifndef PEL_LINEAR_PAIRS_H
#define PEL_LINEAR_PAIRS_H

#include "pellicle/error.h"

#include <stddef.h>

/* most pairs of one list */
enum { PEL_PAIR_LIMIT = 8 };

typedef struct pel_pairs {
    int32_t limit, count, newest;
    double *steps, *changes;                 /* (limit x most size) */
    double inverse_products[PEL_PAIR_LIMIT]; /* of each pair */
    double factors[PEL_PAIR_LIMIT];          /* between the loops */
} pel_pairs;

/* For vectors of at most `size` numbers. PEL_OUT_OF_MEMORY. */
pel_status pel_pairs_create(pel_pairs *pairs, int32_t limit, size_t size, pel_error *error);
void pel_pairs_release(pel_pairs *pairs);
void pel_pairs_forget(pel_pairs *pairs);
/* The pair of two points and their gradients (size), unless the energy curves downward between them: that would spoil
   the direction. */
void pel_pairs_keep(pel_pairs *pairs, size_t size, const double *const points[2], const double *const gradients[2]);
/* the loops; the scale of the identity that fits the newest pair, 0 without pairs */
void pel_pairs_begin(pel_pairs *pairs, size_t size, double *d);
void pel_pairs_end(pel_pairs *pairs, size_t size, double *d);
double pel_pairs_scale(const pel_pairs *pairs, size_t size);

/* sum of products */
static inline double pel_pairs_dot(size_t size, const double *a, const double *b)
{
    double sum = 0;
    for (size_t i = 0; i < size; i++)
        sum += a[i] * b[i];
    return sum;
}

#endif
