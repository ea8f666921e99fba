/* Pellicle: readings of a simulation on vertices and triangles: forces, energies, stresses. */
#ifndef PELLICLE_SIM_FORCES_H
#define PELLICLE_SIM_FORCES_H

#include "sim_step.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Force on each vertex at the present state (vertex_count x 3): the sum of eq., shell and loads, without
   contact [N]. */
PEL_API void pel_sim_get_forces(pel_sim *sim, int32_t body, double *forces);
/* Elastic energy on each vertex (vertex_count) [J]: half of each spring at it plus its volumetric spring. */
PEL_API void pel_sim_get_energies(const pel_sim *sim, int32_t body, double *spring, double *volumetric);
/* Energies of a shell on each vertex (vertex_count) [J]: a third of membrane, fibres and mid-edge bending of each
   triangle, a quarter of the bending of each hinge at it; zeros if the body is no shell. */
PEL_API void pel_sim_get_shell_energies(const pel_sim *sim, int32_t body, double *membrane, double *bending,
                                        double *fibre);
/* Force of the body's pressure on each vertex (vertex_count x 3) [N]; zeros without pressure. */
PEL_API void pel_sim_get_pressure_forces(pel_sim *sim, int32_t body, double *forces);
/* Virial of springs and shell on each vertex (vertex_count) [J]: half of tension times length of each spring at it, and
   a third of the virial of each shell triangle at it. Divided by twice the vertex's area it is the mean tension of the
   net or sheet [N/m], positive in tension; the sum over all vertices is the derivative of the energy of springs,
   membrane and fibres with respect to the logarithm of the body's size. */
PEL_API void pel_sim_get_spring_virials(const pel_sim *sim, int32_t body, double *virials);
/* A triangle of a shell. Tensors lie in its plane and have the components xx, yy, zz, xy, yz, xz along the axes of
   space: strain and piola_stress in the rest plane, the others in the present one. Positive moments stretch the outer
   side (that of the normal). Bending follows small strain theory: the moment of a plate on the rest shape, rotated with
   the triangle. The moments of hinges are conjugate to their angles, so they have the Poisson's ratio of hinges. */
typedef struct pel_triangle_mechanics {
    double area, rest_area; /* m2, present and at rest */
    double thickness;       /* m, present: h J^(-nu / (1 - nu)), exact for incompressible sheets; 0 = none */
    double strain[6];       /* Green strain */
    double piola_stress[6]; /* Pa, second Piola-Kirchhoff, of membrane and fibres */
    double force[6];        /* N/m, resultant N of membrane and fibres per present length */
    double moment[6];       /* N, resultant M of bending per length */
    double membrane_energy, fibre_energy, bending_energy; /* J/m2, per area at rest */
} pel_triangle_mechanics;

/* Reads the triangles of a body (triangle_count) in the order of pel_sim_get_triangles; zeros if it is no shell. */
PEL_API void pel_sim_get_mechanics(pel_sim *sim, int32_t body, pel_triangle_mechanics *triangles);

#ifdef __cplusplus
}
#endif
#endif
