/* A membrane material reduced to the two numbers that its energy needs, for loops over many triangles. */
#ifndef PEL_MATERIAL_MEMBRANE_H
#define PEL_MATERIAL_MEMBRANE_H

#include "pellicle/material.h"

typedef struct pel_membrane_law {
    pel_membrane_kind kind; /* mooney-rivlin stands for all incompressible ones */
    double first, second;   /* mu and lambda, or c1 and c2 of mooney-rivlin [N/m] */
} pel_membrane_law;

pel_membrane_law pel_membrane_law_of(const pel_membrane_material *material);

/* pel_membrane_density; first_piola may be null */
double pel_membrane_law_density(const pel_membrane_law *law, const double deformation_gradient[6],
                                double first_piola[6]);

#endif
