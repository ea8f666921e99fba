/* Mooney-Rivlin, incompressible: psi = c1 (I1 - 3) + c2 (I2 - 3) with I1 = tr C + h, I2 = J^2 + tr C h, h = 1 / J^2.
   Numbers: c1 and c2 over mu = 2 (c1 + c2). */
#ifndef PEL_LAW_MOONEY_RIVLIN_H
#define PEL_LAW_MOONEY_RIVLIN_H

#include "law/strain.h"

enum { pel_law_mooney_rivlin_traits = PEL_LAW_BY_AREA | PEL_LAW_READS_MOONEY_RATIO };

PEL_INLINE void pel_law_mooney_rivlin(const pel_lane *numbers, const pel_strain *s, pel_response *r)
{
    const pel_lane two = pel_lane_splat(2), c1 = numbers[0], c2 = numbers[1];
    pel_area area = pel_area_of(s);
    pel_incompressible v = pel_incompressible_of(&area);
    pel_lane trace = two * (area.trace + pel_lane_splat(1));
    const pel_isotropic f = {
        .energy = c1 * v.i1 + c2 * v.i2,
        .t = c1 + c2 * v.thickness,
        .j = c1 * v.slope + c2 * (two * area.ratio + trace * v.slope),
        .tt = pel_lane_splat(0),
        .tj = c2 * v.slope,
        .jj = c1 * v.curvature + c2 * (two + trace * v.curvature),
    };
    pel_respond_isotropic(s, area.bounded, &f, r);
}

static inline pel_membrane_law pel_law_mooney_rivlin_of(const pel_membrane_material *material)
{
    double c1 = 0.5 / (1 + material->mooney_ratio);
    return (pel_membrane_law){.kind = material->kind,
                              .modulus = material->young * material->thickness / 3,
                              .poisson = 0.5,
                              .numbers = {c1, material->mooney_ratio * c1}};
}

static inline pel_law_refusal pel_law_mooney_rivlin_refuse(const pel_membrane_material *material)
{
    if (!(material->mooney_ratio >= 0) || !isfinite(material->mooney_ratio))
        return (pel_law_refusal){"mooney_ratio", "mooney_ratio >= 0", material->mooney_ratio};
    return (pel_law_refusal){0};
}

#endif
