/* Thin plates by Ritz's method with Legendre polynomials: reference numbers of `pellicle reproduce validation`. */
#ifndef PAPERS_OWN_RITZ_H
#define PAPERS_OWN_RITZ_H

#include <stdbool.h>

/* A plate of length 1 along x and some width along y, of stiffness D = 1. */
typedef struct ritz_plate {
    double width, poisson;
    bool is_clamped; /* at x = 0; else free all around */
    bool buckles;    /* under a shear force 1 in its plane at x = 1 (clamped); else vibrates, with mass 1 per area */
} ritz_plate;

/* The lowest `count` eigenvalues above 0, ascending: squares of angular frequencies, or the forces under which it
   buckles. False when memory runs out. */
bool ritz_solve(const ritz_plate *plate, int count, double *values);

#endif
