/* The membrane of a triangle for loops over many triangles of one material. */
#ifndef PEL_ELEMENT_MEMBRANE_H
#define PEL_ELEMENT_MEMBRANE_H

#include "material/membrane.h"
#include "pellicle/element.h"

/* pel_membrane_energy with the material's law taken once */
double pel_membrane_law_energy(const pel_rest_triangle *triangle, const pel_membrane_law *law, const double x[3][3],
                               double gradient[3][3]);

/* The direction of the rest frame in which the triangle is stretched most; the first axis where there is none. */
void pel_principal_direction(const pel_rest_triangle *triangle, const double x[3][3], double direction[2]);

#endif
