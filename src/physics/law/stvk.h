/* St. Venant-Kirchhoff: psi = mu |e|^2 + lambda/2 tr^2 e of the Green strain; paper B, section 2. The same quadratic
   function of the strain of the triangle factor is the linear law. Numbers: lambda / mu. */
#ifndef PEL_LAW_STVK_H
#define PEL_LAW_STVK_H

#include "law/strain.h"

enum { pel_law_stvk_traits = PEL_LAW_CONSTANT_TANGENT | PEL_LAW_READS_POISSON };

PEL_INLINE void pel_law_stvk(const pel_lane *numbers, const pel_strain *s, pel_response *r)
{
    const pel_lane zero = pel_lane_splat(0), one = pel_lane_splat(1), two = pel_lane_splat(2);
    const pel_symmetric2 e = s->strain;
    pel_lane volume = numbers[0] * (e.a + e.b), along = two + numbers[0];
    r->stress = (pel_symmetric2){two * e.a + volume, two * e.b + volume, e.c};
    r->energy = PEL_CONSTANT(0.5) * (e.a * r->stress.a + e.b * r->stress.b + e.c * e.c);
    r->tangent = (pel_symmetric3){along, numbers[0], zero, along, zero, one};
    r->positive = r->tangent; /* positive definite for -1 < poisson < 1 */
    r->by_trace = r->by_area = zero;
}

static inline pel_membrane_law pel_law_stvk_of(const pel_membrane_material *material)
{
    double mu, lambda;
    pel_membrane_law law = {.kind = material->kind, .poisson = material->poisson};
    pel_plane_stress_lame(material->young, material->poisson, material->thickness, &law.modulus, &lambda);
    pel_plane_stress_lame(1, material->poisson, 1, &mu, &lambda);
    law.numbers[0] = lambda / mu;
    return law;
}

static inline pel_law_refusal pel_law_stvk_refuse(const pel_membrane_material *material)
{
    (void)material;
    return (pel_law_refusal){0};
}

#endif
