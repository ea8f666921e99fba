/* Pellicle: energies of single triangles as functions of their three vertices: membranes, fibres, volume and pressure.
   Pure functions without state: any thread may call them. Positions x (3 x 3): a row for each vertex, metres. */
#ifndef PELLICLE_ELEMENT_H
#define PELLICLE_ELEMENT_H

#include "material.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The rest shape of a triangle in a frame of its own: first axis along x0 - x2, second one in the triangle's plane,
   counter-clockwise. The inverse of D_m = [X0 - X2, X1 - X2] (paper B, section 2) is the upper triangle
   [[inverse[0], inverse[1]], [0, inverse[2]]]. */
typedef struct pel_rest_triangle {
    double inverse[3]; /* 1/m */
    double area;       /* m2 */
} pel_rest_triangle;

/* From rest positions in space (3 x 3). False, and all zero, when the triangle has no area. */
PEL_API bool pel_rest_triangle_setup(const double rest[3][3], pel_rest_triangle *triangle);

/* For fibres: projects a vector in space into the plane of the rest triangle and normalizes it, in the frame of the
   triangle. False, and direction (1, 0), if the vector is zero or normal to the triangle, or if the triangle has no
   area. */
PEL_API bool pel_rest_triangle_direction(const double rest[3][3], const double vector[3], double direction[2]);

/* F = D_s D_m^-1 (3 x 2) row-major, D_s = [x0 - x2, x1 - x2]. */
PEL_API void pel_deformation_gradient(const pel_rest_triangle *triangle, const double x[3][3],
                                      double deformation_gradient[6]);

/* Gradient of area times psi on the vertices from P = d psi / d F (3 x 2): paper B, equation 1. Sums to zero. */
PEL_API void pel_stress_gradient(const pel_rest_triangle *triangle, const double first_piola[6], double gradient[3][3]);

/* Energy of the triangle [J] and its gradient on the vertices [N], the negative of the forces; gradient may be null.
   For PEL_MEMBRANE_LINEAR the frame is that of the edge x0 - x2. */
PEL_API double pel_membrane_energy(const pel_rest_triangle *triangle, const pel_membrane_material *material,
                                   const double x[3][3], double gradient[3][3]);

/* The same for fibres along the unit vector direction of the rest frame, stiffness [N/m]. */
PEL_API double pel_fibre_energy(const pel_rest_triangle *triangle, pel_fibre_kind kind, double stiffness,
                                const double direction[2], const double x[3][3], double gradient[3][3]);

/* The same for an active fibre of the given rest length (relative, 1 = passive). */
PEL_API double pel_fibre_active_energy(const pel_rest_triangle *triangle, double stiffness, double rest_length,
                                       const double direction[2], const double x[3][3], double gradient[3][3]);

/* Signed volume between the triangle and the origin, x0 . (x1 x x2) / 6 [m3]: the volume of a closed mesh is the sum
   over its triangles. The gradient (may be null) is that of this sum only when added up around each vertex. */
PEL_API double pel_triangle_volume(const double x[3][3], double gradient[3][3]);

/* The force of a pressure on the back of the triangle (positive inflates) on each of its vertices [N]: a third of
   pressure times area along the normal. On a closed mesh this is pressure times the gradient of the volume at every
   vertex: consistent and conservative, without net force or torque. */
PEL_API void pel_triangle_pressure_force(const double x[3][3], double pressure, double force[3]);

#ifdef __cplusplus
}
#endif
#endif
