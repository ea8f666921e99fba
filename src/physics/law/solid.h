/* Laws of filled bodies as rows of numbers. With the signed singular values s of F (the product has the sign of J),
   S1 = s1 + s2 + s3, S2 = |F|^2, S4 = |F^T F|^2, every law is

       psi / E = a1 (S1 - 3) + a2 (S2 - 3) + b2/2 (S2 - 3)^2 + a4 (S4 - 3) + c (J - 1) + k/2 (J - 1)^2,

   so stress and second derivative are the same few operations for all (measure/tetra.h). */
#ifndef PEL_LAW_SOLID_H
#define PEL_LAW_SOLID_H

#include "pellicle/volume.h"

typedef struct pel_solid_law {
    pel_volume_kind kind;
    double a1, a2, b2, a4, c, k; /* for a Young's modulus of 1 */
    double shape_k;              /* the part of k that goes with the terms without J (measure/tetra_lanes.h) */
} pel_solid_law;

/* Numbers of a material whose young is 1. */
pel_solid_law pel_solid_law_of(pel_volume_kind kind, double poisson, double mooney_ratio);

/* The largest eigenvalue of d2 psi / dF2 at rest, for a Young's modulus of 1. */
double pel_solid_law_stiffness(const pel_solid_law *law);

/* words of scenes, by kind; null after the last */
extern const char *const pel_volume_words[];
/* the same of elements */
extern const char *const pel_volume_element_words[];

#endif
