/* Tension field: a sheet without bending that wrinkles instead of carrying compression, by the relaxed energy of
   neo_hookean.h (Pipkin 1986; Steigmann 1990). With the principal values C1 >= C2 of C and the natural width
   w = C2 at which a sheet pulled to C1 is free of lateral stress,

       C2 >= w: taut, the law itself
       C2 < w, C1 > 1: wrinkled, psi(C1, w(C1)), stress along the first axis alone
       C1 <= 1: slack, no energy

   Zero lateral stress makes the width equal to the thickness, c = w, which gives nu C1 w^2 + (1 - 2 nu) w = 1 - nu, so

       w = 2 (1 - nu) / (1 - 2 nu + s),   s = sqrt((1 - 2 nu)^2 + 4 nu (1 - nu) C1),   dw/dC1 = -nu w^2 / s

   and the tension t1 = 1 - w / C1. A share REST of the law remains in compression, so that a slack sheet has a
   stiffness: the energy is (1 - REST) of the relaxed one and REST of the law. Numbers: as neo_hookean.h. */
#ifndef PEL_LAW_TENSION_FIELD_H
#define PEL_LAW_TENSION_FIELD_H

#include "law/neo_hookean.h"

enum { pel_law_tension_field_traits = PEL_LAW_OF_STRAIN | PEL_LAW_READS_POISSON };

#define PEL_TENSION_FIELD_REST 1e-3

/* wrinkled by the first principal value: energy, tension and its derivative by the strain e1 = (C1 - 1) / 2 */
typedef struct pel_uniaxial {
    pel_lane energy, tension, slope, width;
} pel_uniaxial;

/* from twice e1, which is exact near rest */
PEL_INLINE pel_uniaxial pel_uniaxial_of(const pel_lane *numbers, pel_lane twice)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), half = PEL_CONSTANT(0.5), nu = numbers[0];
    const pel_lane most = one - nu, part = most - nu, change = two * two * nu * most * twice, along = one + twice;
    /* part^2 + 4 nu (1 - nu) = 1 */
    const pel_lane root = pel_lane_sqrt(one + change), narrower = change / ((one + root) * (part + root));
    pel_uniaxial r;
    r.width = two * most / (part + root);
    const pel_lane over = r.width / along;
    r.tension = one - over;
    r.slope = two * (over / along + nu * r.width * r.width / (root * along));
    /* psi of C1 and C2 = c = w: J^2 = C1 w, x = J3^2 - 1 = (1 - 2 nu) (J^2 - 1) / d */
    const pel_lane excess = twice - narrower - twice * narrower, bulk = most + nu * excess;
    r.energy = half * (twice - narrower) - half * r.width * excess * pel_logarithm_over(part * excess / bulk);
    return r;
}

PEL_INLINE void pel_law_tension_field(const pel_lane *numbers, const pel_strain *s, pel_response *r)
{
    const pel_lane zero = pel_lane_splat(0), one = pel_lane_splat(1), half = PEL_CONSTANT(0.5);
    const pel_lane rest = PEL_CONSTANT(PEL_TENSION_FIELD_REST);
    pel_response law;
    pel_law_neo_hookean(numbers, s, &law);
    /* with J itself, the stress is the derivative of the energy below the bound of J too */
    const pel_lane trace = law.by_trace + law.by_trace, pull = pel_lane_quotient(law.by_area, s->area_ratio);
    law.stress = (pel_symmetric2){trace + pull * s->cauchy.b, trace + pull * s->cauchy.a, -(pull * s->cauchy.c)};
    const pel_lane mean = half * (s->cauchy.a + s->cauchy.b), difference = half * (s->cauchy.a - s->cauchy.b);
    const pel_lane size = pel_lane_sqrt(difference * difference + s->cauchy.c * s->cauchy.c);
    const pel_lane second = mean - size;
    pel_principal p;
    p.cosine =
        pel_lane_select(pel_lane_above(size, zero), difference / pel_lane_max(size, PEL_CONSTANT(PEL_REAL_TINY)), one);
    p.sine = pel_lane_quotient(s->cauchy.c, size);
    p.inverse1 = p.inverse2 = zero;
    const pel_lane twice = pel_lane_max(s->strain.a + s->strain.b + size, zero);
    const pel_uniaxial pulled = pel_uniaxial_of(numbers, twice);
    const pel_lane_mask is_pulled = pel_lane_above(twice, zero);
    const pel_lane_mask is_loose = pel_lane_above(pulled.width, second) & (is_pulled | pel_lane_above(one, second));
    const pel_lane tension = pel_lane_where(is_pulled, pulled.tension),
                   energy = pel_lane_where(is_pulled, pulled.energy);
    /* a difference above 0 wherever the sheet is wrinkled: C1 > 1 >= w > C2 */
    const pel_principal_tangent n = {pel_lane_where(is_pulled, pulled.slope), zero, zero,
                                     pel_lane_quotient(tension, size + size)};
    const pel_symmetric3 d = pel_tangent_from_principal(&p, &n);
    const pel_lane cc = half * (one + p.cosine), ss = half * (one - p.cosine), cs = half * p.sine;
    const pel_symmetric2 t = {tension * cc, tension * ss, tension * cs};
    /* shares of both energies */
    const pel_lane own = pel_lane_select(is_loose, rest, one), other = one - own;
    r->energy = own * law.energy + other * energy;
    r->stress = (pel_symmetric2){own * law.stress.a + other * t.a, own * law.stress.b + other * t.b,
                                 own * law.stress.c + other * t.c};
#define PEL_MIX(part, entry) (own * law.part.entry + other * d.entry)
    r->tangent = (pel_symmetric3){PEL_MIX(tangent, a11), PEL_MIX(tangent, a12), PEL_MIX(tangent, a13),
                                  PEL_MIX(tangent, a22), PEL_MIX(tangent, a23), PEL_MIX(tangent, a33)};
#undef PEL_MIX
    r->positive = r->tangent; /* both are positive definite or semi-definite */
    r->by_trace = r->by_area = zero;
}

static inline pel_membrane_law pel_law_tension_field_of(const pel_membrane_material *material)
{
    return pel_law_neo_hookean_of(material);
}

static inline pel_law_refusal pel_law_tension_field_refuse(const pel_membrane_material *material)
{
    return pel_law_neo_hookean_refuse(material);
}

#endif
