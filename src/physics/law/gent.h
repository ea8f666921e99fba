/* Gent 1996, incompressible: psi = -mu Jm/2 ln(1 - (I1 - 3) / Jm) with I1 = tr C + 1 / J^2: rubber whose chains end at
   I1 - 3 = Jm, neo-Hookean for Jm -> infinity. Beyond 99 % of the limit the energy continues as its parabola there,
   beyond twice the limit as its tangent, so that any shape has a finite energy and stiffness. Numbers: Jm. */
#ifndef PEL_LAW_GENT_H
#define PEL_LAW_GENT_H

#include "law/strain.h"

enum { pel_law_gent_traits = PEL_LAW_BY_AREA | PEL_LAW_READS_EXTENSION_LIMIT };

PEL_INLINE void pel_law_gent(const pel_lane *numbers, const pel_strain *s, pel_response *r)
{
    const pel_lane one = pel_lane_splat(1), half = PEL_CONSTANT(0.5), limit = numbers[0];
    pel_area area = pel_area_of(s);
    pel_incompressible v = pel_incompressible_of(&area);
    /* share of the limit, and the rest of it beyond the last point of the logarithm */
    pel_lane share = v.i1 / limit, at = pel_lane_min(share, PEL_CONSTANT(0.99));
    pel_lane beyond = pel_lane_min(share, pel_lane_splat(2)) - at, far = share - at - beyond;
    pel_lane slope = one / (one - at), curvature = slope * slope, end = slope + beyond * curvature;
    pel_lane value = -pel_lane_log1p(-at) + beyond * (slope + half * beyond * curvature) + far * end;
    pel_lane by_i = half * end;
    pel_lane by_ii = pel_lane_where(pel_lane_above(pel_lane_splat(2), share), half * curvature / limit);
    const pel_isotropic f = {
        .energy = half * limit * value,
        .t = by_i,
        .j = by_i * v.slope,
        .tt = by_ii,
        .tj = by_ii * v.slope,
        .jj = by_ii * v.slope * v.slope + by_i * v.curvature,
    };
    pel_respond_isotropic(s, area.bounded, &f, r);
}

static inline pel_membrane_law pel_law_gent_of(const pel_membrane_material *material)
{
    return (pel_membrane_law){.kind = material->kind,
                              .modulus = material->young * material->thickness / 3,
                              .poisson = 0.5,
                              .numbers = {material->extension_limit}};
}

static inline pel_law_refusal pel_law_gent_refuse(const pel_membrane_material *material)
{
    if (!(material->extension_limit > 0) || !(material->extension_limit <= 1e12))
        return (pel_law_refusal){"extension_limit", "0 < extension_limit <= 1e12", material->extension_limit};
    return (pel_law_refusal){0};
}

#endif
