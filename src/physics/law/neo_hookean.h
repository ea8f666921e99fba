/* Neo-Hookean in plane stress, compressible up to the incompressible limit (theory page, section 17). The solid has

       psi3 = mu/2 (tr C + c - 3 - 2 ln J3) + lambda3/4 (J3^2 - 1 - 2 ln J3),     J3 = J sqrt c

   with the square c of the thickness stretch and lambda3 = 2 mu nu / (1 - 2 nu): polyconvex (Ciarlet 1988), and zero
   normal stress, mu (c - 1) + lambda3/2 (J^2 c - 1) = 0, has a closed form,

       c = (1 - nu) / d,    d = 1 - 2 nu + nu J^2

   without a special case at nu = 0.5, where c = 1 / J^2. With x = J3^2 - 1 = (1 - 2 nu) (J^2 - 1) / d

       psi / mu = (tr C - 2) / 2 - (1 - nu) (J^2 - 1) / (2 d) ln(1 + x) / x,    psi_J / mu = -c / J

   the second by the envelope theorem. So t = mu (I - c K) with K = C^-1, and the tangent

       D = 2 mu c (K x K + g K (x) K),    (K x K) e = K e K,    g = nu J^2 / d

   is positive definite at any strain. Its inverse needs no inverse of C (Sherman, Morrison):

       D^-1 = (C x C - g / (1 + 2 g) C (x) C) / (2 mu c)

   Numbers: nu, 1 / (2 (1 - nu)). */
#ifndef PEL_LAW_NEO_HOOKEAN_H
#define PEL_LAW_NEO_HOOKEAN_H

#include "law/strain.h"

enum { pel_law_neo_hookean_traits = PEL_LAW_BY_AREA | PEL_LAW_READS_POISSON | PEL_LAW_COMPLIANT };

/* ln(1 + x) / x */
PEL_INLINE pel_lane pel_logarithm_over(pel_lane x)
{
    const pel_lane one = pel_lane_splat(1);
    /* the series has all digits there */
    pel_lane_mask is_small = pel_lane_above(PEL_CONSTANT(1e-9), pel_lane_abs(x));
    return pel_lane_select(is_small, one - PEL_CONSTANT(0.5) * x,
                           pel_lane_log1p(x) / pel_lane_select(is_small, one, x));
}

PEL_INLINE void pel_law_neo_hookean(const pel_lane *numbers, const pel_strain *s, pel_response *r)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), half = PEL_CONSTANT(0.5);
    const pel_lane nu = numbers[0], most = one - nu;
    pel_square_area area = pel_square_area_of(s);
    pel_lane bulk = nu * area.square, d = most + nu * (area.square - one), wide = d + two * bulk;
    /* c / J^2, exactly 1 at rest */
    pel_lane pull = most / (d * area.square), c = pull * area.square, over = two * numbers[1] * c;
    pel_lane j = pel_lane_sqrt(area.square), below = pel_lane_min(s->area_ratio - j, pel_lane_splat(0));
    pel_isotropic f;
    f.j = -(pull * j);
    f.energy = s->strain.a + s->strain.b + f.j * below -
               half * c * area.excess * pel_logarithm_over((most - nu) * area.excess * over);
    f.t = half;
    f.tt = f.tj = pel_lane_splat(0);
    f.jj = pull * (one + two * bulk * over);
    pel_respond_isotropic(s, j, &f, r);
    r->stress = (pel_symmetric2){one - pull * s->cauchy.b, one - pull * s->cauchy.a, pull * s->cauchy.c};
    /* one quotient: they are what takes long */
    pel_lane inverse = one / (d * wide);
    r->compliance = (pel_compliance){numbers[1] * d, bulk * d * inverse, most * wide * inverse};
}

static inline pel_membrane_law pel_law_neo_hookean_of(const pel_membrane_material *material)
{
    pel_membrane_law law = {.kind = material->kind, .poisson = material->poisson, .numbers = {material->poisson}};
    double lambda;
    law.numbers[1] = 0.5 / (1 - material->poisson);
    pel_plane_stress_lame(material->young, material->poisson, material->thickness, &law.modulus, &lambda);
    return law;
}

static inline pel_law_refusal pel_law_neo_hookean_refuse(const pel_membrane_material *material)
{
    if (!(material->poisson >= 0) || !(material->poisson <= 0.5))
        return (pel_law_refusal){"poisson", "0 <= poisson <= 0.5 for neo-hookean, or take stvk or corotated",
                                 material->poisson};
    return (pel_law_refusal){0};
}

#endif
