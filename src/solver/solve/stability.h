/* Stability limits of the explicit and the quasi-static method on a given model (theory: paper A's parameters). */
#ifndef PEL_SOLVE_STABILITY_H
#define PEL_SOLVE_STABILITY_H

#include "solve/step.h"

/* Largest numbers per unit mass over all vertices, keyed parameters at their largest. */
typedef struct pel_stability {
    double stiffness_bound; /* Gershgorin bound of the largest eigenvalue of K/m: (2 sum k + k') / m [1/s2] */
    double stiffness;       /* that eigenvalue at rest by power iteration; the bound until pel_stability_refine */
    double drag;            /* d / m [1/s] */
    double radial_drag;     /* (d + d') / m [1/s]: what a motion along a volumetric spring feels */
} pel_stability;

void pel_stability_bound(const pel_model *model, pel_stability *stability);

/* Finds stability->stiffness to about 0.1 % (from above) by power iteration; takes up to some hundred sweeps over the
   model. PEL_OUT_OF_MEMORY. */
pel_status pel_stability_refine(const pel_model *model, pel_stability *stability, pel_error *error);

/* Largest stable alpha for a step, with stiffness either the bound or refined:
       v = 0:        alpha dt^2 K/m < 2
       v kept:       alpha dt (d + d')/m < 1  and  alpha (dt^2 K/m + 2 dt (d + d')/m) < 2 */
double pel_stability_alpha(const pel_stability *stability, double stiffness, double dt, bool keep_velocity);

/* Largest stable dt of the explicit method:
       symplectic:   dt^2 K/m + 2 dt (d + d')/m < 4
       forward:      every oscillating mode needs dt < (d/m) / (K/m), every creeping one dt < 2 / its rate */
double pel_stability_dt(const pel_stability *stability, double stiffness, bool symplectic);

#endif
