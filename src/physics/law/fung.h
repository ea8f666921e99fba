/* Fung-type tissue (Fung 1967, isotropic): psi = E h / b (exp Q - 1) with Q = b w / (E h), w the energy of stvk.h, and
   the stiffening b: young and poisson at small strain, a stiffness that grows as exp(b e^2 / 2) with the strain e of a
   pull. Above Q = 20, at 5e8 times the stiffness of rest, the energy continues linearly in Q, so that it stays finite.
   Numbers: lambda / mu, and b mu / (E h) = b / (2 (1 + nu)). */
#ifndef PEL_LAW_FUNG_H
#define PEL_LAW_FUNG_H

#include "law/stvk.h"

enum { pel_law_fung_traits = PEL_LAW_OF_STRAIN | PEL_LAW_READS_POISSON | PEL_LAW_READS_STIFFENING };

PEL_INLINE void pel_law_fung(const pel_lane *numbers, const pel_strain *s, pel_response *r)
{
    const pel_lane most = pel_lane_splat(20), b = numbers[1];
    pel_response q;
    pel_law_stvk(numbers, s, &q);
    pel_lane exponent = b * q.energy, bounded = pel_lane_min(exponent, most), rise = pel_lane_expm1(bounded);
    pel_lane scale = rise + pel_lane_splat(1);
    const pel_symmetric2 t = q.stress;
    r->energy = (rise + scale * (exponent - bounded)) / b;
    r->stress = (pel_symmetric2){scale * t.a, scale * t.b, scale * t.c};
    pel_lane outer = pel_lane_where(pel_lane_above(most, exponent), b * scale);
    r->tangent = (pel_symmetric3){
        scale * q.tangent.a11 + outer * t.a * t.a,
        scale * q.tangent.a12 + outer * t.a * t.b,
        outer * t.a * t.c,
        scale * q.tangent.a22 + outer * t.b * t.b,
        outer * t.b * t.c,
        scale * q.tangent.a33 + outer * t.c * t.c,
    };
    r->positive = r->tangent; /* a sum of positive definite and positive semi-definite */
    r->by_trace = r->by_area = pel_lane_splat(0);
}

static inline pel_membrane_law pel_law_fung_of(const pel_membrane_material *material)
{
    pel_membrane_law law = pel_law_stvk_of(material);
    law.numbers[1] = material->stiffening / (2 * (1 + material->poisson));
    return law;
}

static inline pel_law_refusal pel_law_fung_refuse(const pel_membrane_material *material)
{
    if (!(material->stiffening >= 1e-9) || !(material->stiffening <= 1e9))
        return (pel_law_refusal){"stiffening", "1e-9 <= stiffening <= 1e9", material->stiffening};
    return (pel_law_refusal){0};
}

#endif
