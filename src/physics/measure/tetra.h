/* Linear tetrahedra: F = sum_k x_k b_k^T with the gradients b_k of the shape functions at rest, energy = young volume
   psi(F) by a law of law/solid.h.

   In the frames of the singular value decomposition F = U s V^T the second derivative of psi falls apart: by the
   diagonal of U^T dF V it is the Hessian A of psi by s; by the symmetric and the antisymmetric part of each pair (i, j)
   beside it p = (psi_i - psi_j) / (s_i - s_j) and q = (psi_i + psi_j) / (s_i + s_j) (Stomakhin et al. 2012; Smith, De
   Goes, Kim 2019). With the sums of law/solid.h p has no quotient at all and q one for a1 only, so equal stretches need
   no care. Clamping the eigenvalues of A, p and q at 0 gives the positive semi-definite part. */
#ifndef PEL_MEASURE_TETRA_H
#define PEL_MEASURE_TETRA_H

#include "law/solid.h"
#include "measure/tangent.h"

typedef struct pel_rest_tetra {
    double gradients[4][3]; /* b_k [1/m] */
    double volume;          /* m3 */
} pel_rest_tetra;

/* False if the volume is not above 0. */
bool pel_rest_tetra_setup(const double x[4][3], pel_rest_tetra *rest);

/* F by rows. */
void pel_tetra_deformation(const pel_rest_tetra *rest, const double x[4][3], double f[9]);

/* F = U diag(s) V^T with rotations U and V and |s[2]| the least: s[2] has the sign of det F. By rows. */
void pel_signed_svd(const double f[9], double u[9], double s[3], double v[9]);

/* The rotation nearest to F. */
void pel_nearest_rotation(const double f[9], double r[9]);

/* psi for a Young's modulus of 1 and dpsi/dF (nullable). */
double pel_solid_density(const pel_solid_law *law, const double f[9], double first_piola[9]);

/* Of F = sum_k x_k b_k^T over `count` points (3 count), whose gradients b_k sum to 0: F by rows; and gradient and
   Hessian of scale psi [J] added over 3 count unknowns, with the energy. */
void pel_patch_deformation(int count, const double (*gradients)[3], const double *x, double f[9]);
double pel_patch_tangent(int count, const double (*gradients)[3], const pel_solid_law *law, double scale,
                         const double *x, pel_tangent_kind kind, const pel_tangent_sum *sum);

/* The same of a tetrahedron, over 12 unknowns. */
double pel_tetra_tangent(const pel_rest_tetra *rest, const pel_solid_law *law, double scale, const double *x,
                         pel_tangent_kind kind, const pel_tangent_sum *sum);

#endif
