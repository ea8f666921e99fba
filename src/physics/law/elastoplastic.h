/* Sheets that stretch for good: elastic by Hencky's logarithmic strains, plastic by von Mises' yield stress in plane
   stress with isotropic hardening (Simo and Taylor 1986; large strains by Simo 1992). With the principal strains
   h_i = ln C_i / 2 of the triangle from its present shape without stress, u = h1 + h2, v = h1 - h2, and the Kirchhoff
   stresses p = (t1 + t2) / 2, d = (t1 - t2) / 2, in units of the shear modulus G,

       p = A u,  A = (1 + nu) / (1 - nu),    d = v,    q^2 = p^2 + 3 d^2

   A step from a trial strain beyond q = Y = yield + hardening a, with the slip a so far, returns to

       p / (1 + A m), d / (1 + 3 m),    where Y / q(m) = 1 - hardening m

   Newton's method finds m: Y / q is nearly linear, and linear for nu = 1/2. Slip grows by m q, u by m p and v by 3 m d
   stay. The energy of the step, elastic plus dissipated, is convex, and its derivative the returned stress, so that
   methods that minimise find the end of the step, slip included (Ortiz and Stainier 1999). The shape without stress
   follows when a step is accepted (force/flow.c). Below a stretch of 0.01 the logarithm goes on as its tangent in C.
   Numbers: the slip, nu, yield / G, hardening / G. */
#ifndef PEL_LAW_ELASTOPLASTIC_H
#define PEL_LAW_ELASTOPLASTIC_H

#include "law/strain.h"

enum {
    pel_law_elastoplastic_traits = PEL_LAW_OF_STRAIN | PEL_LAW_YIELDS | PEL_LAW_READS_POISSON,
    PEL_RETURN_ROUNDS = 6 /* of Newton's method: 12 digits after 4 */
};

/* where the difference of two principal values has lost half its digits */
#ifdef PEL_LANE_SINGLE
#define PEL_RETURN_NEAR 1e-3f
#else
#define PEL_RETURN_NEAR 1e-6
#endif

/* the return of a trial strain; without yield m = 0 */
typedef struct pel_return {
    pel_principal axes;      /* of the strain; no inverses */
    pel_lane size;           /* half the difference of the principal values of C */
    pel_lane slope1, slope2; /* dh / de */
    pel_lane_mask is_low1, is_low2;
    pel_lane bulk, m, p, d, q, yield; /* A, and returned p and d */
} pel_return;

/* ln(1 + twice) / 2 */
PEL_INLINE pel_lane pel_half_log(pel_lane twice, pel_lane *slope, pel_lane_mask *is_low)
{
    const pel_lane half = PEL_CONSTANT(0.5), one = pel_lane_splat(1), least = PEL_CONSTANT(1e-4 - 1);
    const pel_lane bounded = pel_lane_max(twice, least);
    *is_low = pel_lane_above(least, twice);
    *slope = one / (one + bounded);
    return half * (pel_lane_log1p(bounded) + (twice - bounded) * *slope);
}

/* m of the trial p and d */
PEL_INLINE void pel_return_solve(pel_return *r, pel_lane hardening)
{
    const pel_lane zero = pel_lane_splat(0), one = pel_lane_splat(1), three = pel_lane_splat(3);
    const pel_lane p = r->p, d = r->d;
    const pel_lane_mask yields = pel_lane_above(pel_lane_sqrt(p * p + three * d * d), r->yield);
    r->m = zero;
    for (int i = 0;; i++) {
        const pel_lane along = one / (one + r->bulk * r->m), across = one / (one + three * r->m);
        r->p = p * along;
        r->d = d * across;
        r->q = pel_lane_sqrt(r->p * r->p + three * r->d * r->d);
        if (i == PEL_RETURN_ROUNDS)
            return;
        const pel_lane over = pel_lane_quotient(one, r->q), share = r->yield * over;
        const pel_lane fall = r->bulk * r->p * r->p * along + pel_lane_splat(9) * r->d * r->d * across;
        r->m =
            pel_lane_where(yields, r->m + (one - hardening * r->m - share) / (share * fall * over * over + hardening));
    }
}

PEL_INLINE pel_return pel_return_of(const pel_lane *numbers, const pel_strain *s)
{
    const pel_lane zero = pel_lane_splat(0), one = pel_lane_splat(1), half = PEL_CONSTANT(0.5);
    const pel_lane difference = half * (s->cauchy.a - s->cauchy.b), sum = s->strain.a + s->strain.b;
    pel_return r;
    r.size = pel_lane_sqrt(difference * difference + s->cauchy.c * s->cauchy.c);
    r.axes = (pel_principal){pel_lane_select(pel_lane_above(r.size, zero),
                                             difference / pel_lane_max(r.size, PEL_CONSTANT(PEL_REAL_TINY)), one),
                             pel_lane_quotient(s->cauchy.c, r.size), zero, zero};
    const pel_lane h1 = pel_half_log(sum + r.size, &r.slope1, &r.is_low1);
    const pel_lane h2 = pel_half_log(sum - r.size, &r.slope2, &r.is_low2);
    r.bulk = (one + numbers[1]) / (one - numbers[1]);
    r.p = r.bulk * (h1 + h2);
    r.d = h1 - h2;
    r.yield = numbers[2] + numbers[3] * numbers[0];
    pel_return_solve(&r, numbers[3]);
    return r;
}

/* derivatives of (p, d) by (u, v) */
PEL_INLINE pel_symmetric2 pel_return_tangent(const pel_return *r, pel_lane hardening)
{
    const pel_lane zero = pel_lane_splat(0), one = pel_lane_splat(1), three = pel_lane_splat(3);
    const pel_lane a = r->bulk / (one + r->bulk * r->m), b = one / (one + three * r->m);
    const pel_lane along = a * r->p, across = three * b * r->d;
    const pel_lane sum = along * r->p + three * across * r->d +
                         hardening * r->q * r->q / pel_lane_max(one - hardening * r->m, PEL_CONSTANT(1e-12));
    const pel_lane over = pel_lane_where(pel_lane_above(r->m, zero), pel_lane_quotient(one, sum));
    return (pel_symmetric2){a - along * along * over, b - across * across * over, -(along * across * over)};
}

PEL_INLINE void pel_law_elastoplastic(const pel_lane *numbers, const pel_strain *s, pel_response *r)
{
    const pel_lane zero = pel_lane_splat(0), two = pel_lane_splat(2), half = PEL_CONSTANT(0.5);
    const pel_return at = pel_return_of(numbers, s);
    const pel_lane slip = at.m * at.q;
    r->energy = half * (at.p * at.p / at.bulk + at.d * at.d) + (at.yield + half * numbers[3] * slip) * slip;
    const pel_lane t1 = (at.p + at.d) * at.slope1, t2 = (at.p - at.d) * at.slope2;
    const pel_lane mean = half * (t1 + t2), difference = half * (t1 - t2);
    r->stress = (pel_symmetric2){mean + difference * at.axes.cosine, mean - difference * at.axes.cosine,
                                 difference * at.axes.sine};
    const pel_symmetric2 d = pel_return_tangent(&at, numbers[3]);
    const pel_lane bend1 = pel_lane_select(at.is_low1, zero, two * t1 * at.slope1);
    const pel_lane bend2 = pel_lane_select(at.is_low2, zero, two * t2 * at.slope2);
    pel_principal_tangent n = {(d.a + two * d.c + d.b) * at.slope1 * at.slope1 - bend1,
                               (d.a - d.b) * at.slope1 * at.slope2,
                               (d.a - two * d.c + d.b) * at.slope2 * at.slope2 - bend2, zero};
    n.shear = pel_lane_select(pel_lane_above(at.size, PEL_CONSTANT(PEL_RETURN_NEAR)), difference / at.size,
                              half * (n.n11 - n.n12));
    const pel_principal_tangent positive = pel_positive_part(&n);
    r->tangent = pel_tangent_from_principal(&at.axes, &n);
    r->positive = pel_tangent_from_principal(&at.axes, &positive);
    r->by_trace = r->by_area = zero;
}

static inline pel_membrane_law pel_law_elastoplastic_of(const pel_membrane_material *material)
{
    const double shear = 0.5 * material->young / (1 + material->poisson);
    return (pel_membrane_law){.kind = material->kind,
                              .poisson = material->poisson,
                              .modulus = shear * material->thickness,
                              .numbers = {0, material->poisson, material->yield / shear, material->hardening / shear}};
}

static inline pel_law_refusal pel_law_elastoplastic_refuse(const pel_membrane_material *material)
{
    if (!(material->yield > 0) || !isfinite(material->yield))
        return (pel_law_refusal){"yield", "yield > 0, in pascal", material->yield};
    if (!(material->hardening >= 0) || !isfinite(material->hardening))
        return (pel_law_refusal){"hardening", "hardening >= 0, in pascal", material->hardening};
    return (pel_law_refusal){0};
}

#endif
