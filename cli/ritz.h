/* Thin plates by Ritz's method with Legendre polynomials: reference numbers of `pellicle reproduce validation`. */
#ifndef PELLICLE_CLI_RITZ_H
#define PELLICLE_CLI_RITZ_H

#include <stdbool.h>

/* A plate of length 1 along x and some width along y, of stiffness D = 1. */
typedef struct cli_ritz_plate {
    double width, poisson;
    bool is_clamped; /* at x = 0; else free all around */
    bool buckles;    /* under a shear force 1 in its plane at x = 1 (clamped); else vibrates, with mass 1 per area */
} cli_ritz_plate;

/* The lowest `count` eigenvalues above 0, ascending: squares of angular frequencies, or the forces under which it
   buckles. False when memory runs out. */
bool cli_ritz_solve(const cli_ritz_plate *plate, int count, double *values);

#endif
