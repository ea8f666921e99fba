/* Elements in double: a law on the strain of a triangle, with the law's numbers taken once. */
#ifndef PEL_MEASURE_ELEMENT_H
#define PEL_MEASURE_ELEMENT_H

#include "law/membrane.h"
#include "pellicle/element.h"

/* the result of pel_membrane_density; first_piola may be null */
double pel_membrane_law_density(const pel_membrane_law *law, const double deformation_gradient[6],
                                double first_piola[6]);

/* the result of pel_membrane_energy; gradient may be null */
double pel_membrane_law_energy(const pel_rest_triangle *triangle, const pel_membrane_law *law, const double x[3][3],
                               double gradient[3][3]);

/* A law at the strain (e11, e22, 2 e12), which is the Green strain of some C with det C >= 0: density [J/m2], second
   Piola-Kirchhoff stress [N/m], and the tangent d2 psi / ds2 [N/m] and its positive semi-definite part (11, 12, 13, 22,
   23, 33). The last three may be null. */
double pel_membrane_law_response(const pel_membrane_law *law, const double strain[3], double stress[3],
                                 double tangent[6], double positive[6]);

/* The largest eigenvalue of d2 psi / dF2 at rest [N/m], from the tangent there. */
double pel_membrane_law_stiffness(const pel_membrane_law *law);

/* d11 of the tangent at rest, along the first axis of the law [N/m]. */
double pel_membrane_law_along(const pel_membrane_law *law);

/* The same of fibres over their stiffness, along the fibre. */
double pel_fibre_law_stiffness(pel_fibre_kind kind);

/* The gradient in space of a linear function on a triangle, from its values at the corners; 0 without area. */
void pel_triangle_gradient(const double x[3][3], const double values[3], double gradient[3]);

/* The direction of the rest frame in which the triangle is stretched most; the first axis if there is none. */
void pel_principal_direction(const pel_rest_triangle *triangle, const double x[3][3], double direction[2]);

/* As pel_fibre_active_energy, of a muscle of the given activation times tension [N/m]. */
double pel_muscle_energy(const pel_rest_triangle *triangle, double tension, double optimum, double width,
                         const double direction[2], const double x[3][3], double gradient[3][3]);

#endif
