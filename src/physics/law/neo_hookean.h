/* Neo-Hookean in plane stress, compressible up to the incompressible limit (theory page, section 17). The solid has

       psi3 = mu/2 (tr C + c - 3 - 2 ln J3) + lambda3/2 ln^2 J3,     J3 = J sqrt c

   with the square c of the thickness stretch and lambda3 = 2 mu nu / (1 - 2 nu). Zero normal stress is
   mu (c - 1) + lambda3 ln J3 = 0, or

       (1 - 2 nu) (c - 1) + nu (2 ln J + ln c) = 0

   without a special case at nu = 0.5. It has one root c > 0 for 0 <= nu <= 0.5, and lambda3 ln J3 = -mu (c - 1):

       psi / mu = (tr C - 2) / 2 + (c - 1) / 2 - (1 + (c - 1) / 2) ln J3,    psi_J / mu = -c / J

   the second by the envelope theorem. The start below is an upper bound of the root, off by a factor of 3.6 at most for
   0.01 < J < 1000; two steps of fourth order (Fritsch, Shafer, Crowley 1973, for the Wright omega function) reach
   rounding. Numbers: nu. */
#ifndef PEL_LAW_NEO_HOOKEAN_H
#define PEL_LAW_NEO_HOOKEAN_H

#include "law/strain.h"

enum { pel_law_neo_hookean_traits = PEL_LAW_BY_AREA | PEL_LAW_READS_POISSON };

/* c - 1 of zero normal stress; p = 1 - 2 nu, q = nu, log_square = 2 ln J */
PEL_INLINE pel_lane pel_neo_hookean_thickness(pel_lane p, pel_lane q, pel_lane log_square)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), zero = pel_lane_splat(0),
                   tiny = PEL_CONSTANT(1e-30);
    /* tangents of the equation as a function of ln c and of c */
    pel_lane start = pel_lane_min(-(q * log_square) / (p + q), p / pel_lane_max(q, tiny) - log_square);
    pel_lane k = pel_lane_expm1(start), linear = -(log_square * q) / pel_lane_max(p, tiny);
    k = pel_lane_select(pel_lane_above(zero, log_square), pel_lane_min(k, linear), k);
    for (int i = 0; i < 2; i++) {
        pel_lane c = one + k, error = -(p * k) - q * (log_square + pel_lane_log1p(k)), slope = q + p * c;
        pel_lane square = two * slope * (slope + PEL_CONSTANT(2.0 / 3) * error), part = q * error;
        k = k + c * error * (square - part) / (slope * (square - two * part));
    }
    return k;
}

PEL_INLINE void pel_law_neo_hookean(const pel_lane *numbers, const pel_strain *s, pel_response *r)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), half = PEL_CONSTANT(0.5);
    pel_area area = pel_area_of(s);
    pel_lane q = numbers[0], p = one - two * q, log_square = pel_lane_log1p(area.excess);
    pel_lane k = pel_neo_hookean_thickness(p, q, log_square), c = one + k;
    pel_lane log_volume = half * (log_square + pel_lane_log1p(k)), inverse = one / area.bounded;
    pel_isotropic f;
    f.j = -(c * inverse);
    f.energy = area.trace + half * k - (one + half * k) * log_volume;
    f.energy = f.energy + f.j * pel_lane_min(area.ratio - area.bounded, pel_lane_splat(0));
    f.t = half;
    f.tt = f.tj = pel_lane_splat(0);
    f.jj = c * inverse * inverse * (one + two * q / (p * c + q));
    pel_respond_isotropic(s, area.bounded, &f, r);
}

static inline pel_membrane_law pel_law_neo_hookean_of(const pel_membrane_material *material)
{
    pel_membrane_law law = {.kind = material->kind, .poisson = material->poisson, .numbers = {material->poisson}};
    double lambda;
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
