/* Pellicle: bending energies of two triangles that share an edge. Pure functions without state.

   Stencil: x[0], x[1] are the ends of the shared edge, x[2] and x[3] the tips of the triangles left and right of it, so
   that (x0, x1, x2) and (x1, x0, x3) have the winding of the mesh:

             x1              half-edge h = x0 -> x1 of the left triangle: x2 is its tip, x3 that of its twin
            / | \
          x2  |  x3          dihedral angle theta: 0 when flat, > 0 when the edge is a ridge seen from outside (as on
            \ | /            every convex body), in [-pi, pi]
             x0

   Neither energy converges to that of a plate on all meshes: cylindrical bending is right, but Poisson's ratio in
   bending is that of the mesh, not of the material (-1/3 on equilateral meshes; theory page, section 5). */
#ifndef PELLICLE_BENDING_H
#define PELLICLE_BENDING_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* D = young thickness^3 / (12 (1 - poisson^2)) [N m], the flexural rigidity of a plate. */
PEL_API double pel_bending_stiffness(double young, double poisson, double thickness);

/* Quadratic isometric bending (Bergou et al. 2006; paper B, equation 3): E = factor / 2 |sum_a weight[a] x_a|^2 with
   the cotangent weights of the rest shape, which sum to zero, and factor = 3 / (A0 + A1). E has no unit: multiply it by
   the paper's k_B, or by D / 3 for the energy [J] of a plate with the flexural rigidity D. */
typedef struct pel_bending_isometric {
    double weight[4];
    double factor;      /* 1/m2 */
    double rest_energy; /* E of the rest shape: not 0 where it is curved */
} pel_bending_isometric;

/* From the rest positions (4 x 3) [m]. False, and all zero, when one of the triangles has no area. */
PEL_API bool pel_bending_isometric_setup(const double rest[4][3], pel_bending_isometric *stencil);

typedef enum pel_bending_form {
    PEL_BENDING_LITERAL,        /* E, as in the paper; flattens a curved rest shape */
    PEL_BENDING_REST_SUBTRACTED /* E - E(rest): as a constraint, the rest shape satisfies it. As an energy it differs
                                   from E by a constant, so it has the same forces */
} pel_bending_form;

/* Energy E without the stiffness factor [1], and its gradient on the four points [1/m]; gradient may be null. Invariant
   under rigid motion; no net force, no net torque. */
PEL_API double pel_bending_isometric_energy(const pel_bending_isometric *stencil, pel_bending_form form,
                                            const double x[4][3], double gradient[4][3]);

/* Dihedral angle [rad] and its gradient [1/m] (may be null). 0 where a triangle has no area; the gradient omits the
   contribution of such a triangle, and is zero if the edge has no length. */
PEL_API double pel_dihedral_angle(const double x[4][3], double gradient[4][3]);

/* Hinge with a rest angle: E = 1/2 factor (theta - rest_angle)^2, factor = |e|^2 / (A0 + A1) of the rest shape, to be
   multiplied by D [J]. A fold does not pass through its closed state: the difference is taken between angles from -pi
   to pi, or along the shorter arc if the rest angle is sharper than a quarter turn. */
typedef struct pel_hinge {
    double factor;
    double rest_angle; /* rad; reverse its sign to make the surface cave in */
} pel_hinge;

/* From the rest positions (4 x 3). False, and all zero, when one of the triangles has no area. */
PEL_API bool pel_hinge_setup(const double rest[4][3], pel_hinge *hinge);

/* Energy in units of D and its gradient on the four points [1/m]; gradient may be null. */
PEL_API double pel_hinge_energy(const pel_hinge *hinge, const double x[4][3], double gradient[4][3]);

#ifdef __cplusplus
}
#endif
#endif
