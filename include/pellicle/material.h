/* Pellicle: constitutive energies of thin membranes and of fibres in them, as functions of the deformation gradient.
   Pure functions without state: any thread may call them.

   The deformation gradient F (3 x 2) maps rest directions in the plane of a triangle (an orthonormal frame of its own)
   to space; it is row-major: F[2 i + j] is component i of the image of rest axis j. Energies are per unit rest area
   with the thickness included [J/m2]; the first Piola-Kirchhoff stress P = d psi / d F (3 x 2) is then a force per unit
   rest length [N/m].

   With E = young, nu = poisson, h = thickness, C = F^T F, J = sqrt(det C) the area ratio, plane stress throughout:
       mu = E h / (2 (1 + nu)),   lambda = E h nu / (1 - nu^2)          (not the lambda of a solid, which diverges)
   stvk           mu |e|^2 + lambda/2 tr^2 e,            e = (C - I) / 2
   corotated      mu |S - I|^2 + lambda/2 tr^2 (S - I),  S = sqrt C
   linear         mu |e|^2 + lambda/2 tr^2 e,            e = (G + G^T) / 2 - I, G = F in a frame turning with the image
                  of the first rest axis: drops rigid motion, but depends on the choice of that axis
   mooney-rivlin  c1 (I1 - 3) + c2 (I2 - 3),             I1 = tr C + 1/J^2, I2 = J^2 + tr C / J^2
                  incompressible: c1 + c2 = E h / 6, c2 = mooney_ratio c1, poisson is not read
   neo-hookean    mu/2 (tr C + c - 3 - 2 ln J3) + lambda3/4 (J3^2 - 1 - 2 ln J3),  J3 = J sqrt c,
                  lambda3 = 2 mu nu / (1 - 2 nu): the solid in plane stress, whose thickness stretch squared is
                  c = (1 - nu) / (1 - 2 nu + nu J^2); with poisson 0.5 the incompressible one. 0 <= poisson <= 0.5.
                  The default: it resists compression to any extent, where stvk softens below a stretch of 0.58
   gent           -mu Jm/2 ln(1 - (I1 - 3) / Jm),        mu = E h / 3, Jm = extension_limit
                  incompressible, poisson is not read. Beyond 0.99 Jm the energy continues as its parabola there, beyond
                  2 Jm as its tangent
   fung           E h/b (exp(b w / (E h)) - 1),          w = the energy of stvk, b = stiffening
   orthotropic    1/2 e^T D e, e = (C - I) / 2 in the axes of warp and weft: woven cloth. With n = 1 - poisson^2 weft /
                  young, D11 = young h / n, D22 = weft h / n, D12 = poisson weft h / n, D33 = shear h; poisson is the
                  contraction of the weft over the stretch of a pulled warp, poisson^2 weft < young
   tension-field  neo-hookean without its compression: a sheet without bending that wrinkles. With the principal
                  stretches a >= b and the width w(a) of a strip that is pulled by a: b >= w taut, as neo-hookean; b < w
                  wrinkled, its energy at (a, w), tension along a alone; a <= 1 slack. 0.001 of neo-hookean remains
   weave          woven cloth by curves: a strip that is pulled along the warp or the weft, free to contract, has the
                  stress of warp_curve or weft_curve over its strain, linear between points and beyond the last, in
                  compression with the first slope; shear as orthotropic. young is not read
   elastoplastic  mu |h|^2 + lambda/2 tr^2 h, h = ln(C) / 2, until von Mises' stress (plane stress, Kirchhoff) reaches
                  yield, which grows by hardening times the plastic strain; beyond, the energy of a step from the shape
                  without stress, elastic plus dissipated. The shape follows when a step of a simulation is accepted
   Sources: Sun 2021 (paper B) section 2, Kim and Eberle 2020, Ciarlet 1988, Gent 1996, Fung 1967, Pipkin 1986, Simo and
   Taylor 1986; theory page sections 3 and 17.

   Collapsed triangles (J = 0, down to a point) give finite energies and stresses, never NaN. Incompressible laws and
   neo-hookean are infinite there: below J = 0.01 they continue as their tangents in J, so that a squeezed triangle is
   pushed open with a large, finite force. A triangle squeezed to a line has no normal: forces across the line are
   omitted. */
#ifndef PELLICLE_MATERIAL_H
#define PELLICLE_MATERIAL_H

#include "kinds.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pel_membrane_material {
    pel_membrane_kind kind;
    double young;           /* Young's modulus at small strain [Pa], > 0 */
    double poisson;         /* Poisson's ratio, -1 < poisson < 1; above 0.5 only for sheets that are not solids */
    double thickness;       /* [m], > 0 */
    double mooney_ratio;    /* c2 / c1, >= 0; read by mooney-rivlin only */
    double extension_limit; /* Jm, the I1 - 3 at which chains end, > 0; read by gent only */
    double stiffening;      /* b, > 0; read by fung only */
    double weft;            /* orthotropic: Young's modulus across the warp [Pa], whose own is young; 0 = young */
    double shear;           /* orthotropic: shear modulus [Pa]; 0 = young / (2 (1 + poisson)). weave: > 0 */
    double warp_curve[PEL_WEAVE_POINTS][2]; /* weave: points (strain, stress [Pa]) of force over area at rest; both rise
                                               from (0, 0), which is no point; a strain of 0 ends it */
    double weft_curve[PEL_WEAVE_POINTS][2]; /* the same across the warp */
    double yield;                           /* elastoplastic: yield stress [Pa], > 0 */
    double hardening;                       /* elastoplastic: its growth over plastic strain [Pa], >= 0 */
} pel_membrane_material;

/* The name of a law in scene files; "unknown" for any other number. */
PEL_API const char *pel_membrane_kind_name(pel_membrane_kind kind);

/* Refuses NaN, infinity and values out of the ranges above, for the members that the law reads (PEL_BAD_ARGUMENT with
   the member). */
PEL_API pel_status pel_membrane_material_check(const pel_membrane_material *material, pel_error *error);

/* Plane-stress Lame parameters with the thickness included [N/m], theory page section 1. */
PEL_API void pel_plane_stress_lame(double young, double poisson, double thickness, double *mu, double *lambda);

/* Energy per unit rest area psi [J/m2], of orthotropic with the warp along the first rest axis; first_piola (3 x 2)
   row-major, may be null. The stress is the exact derivative of psi, including the rotation of the frame for
   PEL_MEMBRANE_LINEAR. The material must be valid. */
PEL_API double pel_membrane_density(const pel_membrane_material *material, const double deformation_gradient[6],
                                    double first_piola[6]);

/* Energy [J/m2] per unit rest area of fibres along the unit vector `direction` in the rest frame; first_piola may be
   null. A fibre compressed to length 0 exerts no force. */
PEL_API double pel_fibre_density(pel_fibre_kind kind, double stiffness, const double direction[2],
                                 const double deformation_gradient[6], double first_piola[6]);

/* Active fibre: k/2 (sqrt I5 - rest_length)^2, at rest when it has rest_length times the length of the rest shape.
   rest_length < 1 contracts (a muscle), 1 is PEL_FIBRE_SQRT. rest_length >= 0; first_piola may be null. */
PEL_API double pel_fibre_active_density(double stiffness, double rest_length, const double direction[2],
                                        const double deformation_gradient[6], double first_piola[6]);

#ifdef __cplusplus
}
#endif
#endif
