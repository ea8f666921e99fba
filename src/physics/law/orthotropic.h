/* Woven cloth: St. Venant-Kirchhoff with a stiffness along the warp and one along the weft, psi = 1/2 e^T D e of the
   Green strain in their axes. With E1, E2, G times the thickness, nu the contraction of the weft over the stretch of a
   warp that is pulled, and n = 1 - nu^2 E2 / E1

       D11 = E1 / n,    D22 = E2 / n,    D12 = nu E2 / n,    D33 = G

   which is positive definite for nu^2 E2 < E1. A sheet pulled at the angle a to the warp has the modulus

       1 / E(a) = cos^4 a / E1 + sin^4 a / E2 + (1 / G - 2 nu / E1) sin^2 a cos^2 a

   (Jones, Mechanics of Composite Materials, 1975). The element carries the cosine and sine of the warp in its rest
   frame. Numbers: these two, D11 / G, D22 / G, D12 / G. */
#ifndef PEL_LAW_ORTHOTROPIC_H
#define PEL_LAW_ORTHOTROPIC_H

#include "law/strain.h"

enum {
    pel_law_orthotropic_traits = PEL_LAW_ORIENTED | PEL_LAW_READS_POISSON | PEL_LAW_READS_WEFT | PEL_LAW_READS_SHEAR
};

/* the strain (11, 22, twice 12) in axes turned by the angle with this cosine and sine */
PEL_INLINE pel_symmetric2 pel_turned_strain(pel_lane c, pel_lane s, pel_symmetric2 e)
{
    const pel_lane two = pel_lane_splat(2), cc = c * c, ss = s * s, cs = c * s;
    return (pel_symmetric2){cc * e.a + ss * e.b + cs * e.c, ss * e.a + cc * e.b - cs * e.c,
                            two * cs * (e.b - e.a) + (cc - ss) * e.c};
}

/* a stress in these axes, turned back */
PEL_INLINE pel_symmetric2 pel_turned_stress(pel_lane c, pel_lane s, pel_symmetric2 t)
{
    const pel_lane two = pel_lane_splat(2), cc = c * c, ss = s * s, cs = c * s;
    return (pel_symmetric2){cc * t.a + ss * t.b - two * cs * t.c, ss * t.a + cc * t.b + two * cs * t.c,
                            cs * (t.a - t.b) + (cc - ss) * t.c};
}

PEL_INLINE void pel_law_orthotropic(const pel_lane *numbers, const pel_strain *s, pel_response *r)
{
    const pel_lane cosine = numbers[0], sine = numbers[1], zero = pel_lane_splat(0), one = pel_lane_splat(1);
    const pel_lane d11 = numbers[2], d22 = numbers[3], d12 = numbers[4];
    const pel_symmetric2 e = pel_turned_strain(cosine, sine, s->strain);
    const pel_symmetric2 t = {d11 * e.a + d12 * e.b, d12 * e.a + d22 * e.b, e.c};
    r->energy = PEL_CONSTANT(0.5) * (e.a * t.a + e.b * t.b + e.c * t.c);
    r->stress = pel_turned_stress(cosine, sine, t);
    /* columns of D: stresses of unit strains */
    pel_symmetric2 column[3] = {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
    for (int i = 0; i < 3; i++) {
        const pel_symmetric2 u = pel_turned_strain(cosine, sine, column[i]);
        column[i] =
            pel_turned_stress(cosine, sine, (pel_symmetric2){d11 * u.a + d12 * u.b, d12 * u.a + d22 * u.b, u.c});
    }
    r->tangent = (pel_symmetric3){column[0].a, column[0].b, column[0].c, column[1].b, column[1].c, column[2].c};
    r->positive = r->tangent;
    r->by_trace = r->by_area = zero;
}

static inline pel_membrane_law pel_law_orthotropic_of(const pel_membrane_material *material)
{
    const double young = material->young, weft = material->weft > 0 ? material->weft : young;
    const double shear = material->shear > 0 ? material->shear : 0.5 * young / (1 + material->poisson);
    const double n = 1 - material->poisson * material->poisson * weft / young;
    return (pel_membrane_law){
        .kind = material->kind,
        .poisson = material->poisson,
        .modulus = shear * material->thickness,
        .numbers = {1, 0, young / (n * shear), weft / (n * shear), material->poisson * weft / (n * shear)}};
}

static inline pel_law_refusal pel_law_orthotropic_refuse(const pel_membrane_material *material)
{
    if (!(material->weft >= 0) || !isfinite(material->weft))
        return (pel_law_refusal){"weft", "weft > 0, in pascal, or 0 for that of young", material->weft};
    if (!(material->shear >= 0) || !isfinite(material->shear))
        return (pel_law_refusal){"shear", "shear > 0, in pascal, or 0 for young / (2 (1 + poisson))", material->shear};
    if (!(material->poisson * material->poisson * material->weft < material->young))
        return (pel_law_refusal){"poisson", "poisson^2 * weft < young", material->poisson};
    return (pel_law_refusal){0};
}

#endif
