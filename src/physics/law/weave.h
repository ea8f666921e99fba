/* Woven cloth by curves of its threads: orthotropic.h with a nonlinear pull along the warp and along the weft, as a
   tensile test gives it. With the engineering strains a = sqrt(2 e11 + 1) - 1 of the warp and b of the weft,

       psi = W1(a) + W2(b) + D12 a b + G/2 (2 e12)^2

   A curve P(a) [force per width] is linear between points and goes on with its last slope; in compression it has the
   first one, E:

       P(a) = E a + sum of k_i max(0, a - a_i)

   With the contraction nu of the weft over the stretch of a pulled warp, n = 1 - nu^2 E2 / E1,

       W1'(a) = P1(a) + nu^2 E2 / n a,    W2'(b) = P2(b) + nu^2 E2^2 / (E1 n) b,    D12 = nu E2 / n

   so that a strip that is pulled along either thread, free to contract, has exactly its curve, and small strains have
   the moduli of orthotropic.h. Below a stretch of 0.01 the law goes on as its tangent in C11, and C22.
   Numbers: the axis (2), D12 / G, then for warp and weft the first slope and the kinks (a_i, k_i), over G. */
#ifndef PEL_LAW_WEAVE_H
#define PEL_LAW_WEAVE_H

#include "law/orthotropic.h"

enum {
    pel_law_weave_traits = PEL_LAW_ORIENTED | PEL_LAW_READS_POISSON | PEL_LAW_READS_SHEAR,
    PEL_WEAVE_COUPLING = PEL_LAW_AXIS,
    PEL_WEAVE_CURVES,
    PEL_WEAVE_CURVE_NUMBERS = 1 + 2 * (PEL_WEAVE_POINTS - 1)
};

/* strain of a thread and its derivatives by the Green strain, and its curve there */
typedef struct pel_thread {
    pel_lane strain, slope, curvature;
    pel_lane energy, tension, stiffness;
} pel_thread;

/* from twice the Green strain along it, which is exact near rest */
PEL_INLINE pel_thread pel_thread_at(const pel_lane *curve, pel_lane twice)
{
    const pel_lane zero = pel_lane_splat(0), one = pel_lane_splat(1), half = PEL_CONSTANT(0.5);
    const pel_lane least = PEL_CONSTANT(1e-4 - 1), bounded = pel_lane_max(twice, least);
    const pel_lane stretch = pel_lane_sqrt(one + bounded);
    pel_thread t;
    t.slope = one / stretch;
    t.curvature = pel_lane_where(pel_lane_above(twice, least), -(t.slope * t.slope * t.slope));
    t.strain = bounded / (one + stretch) + half * (twice - bounded) * t.slope;
    t.tension = curve[0] * t.strain;
    t.energy = half * t.tension * t.strain;
    t.stiffness = curve[0];
    for (int i = 1; i < PEL_WEAVE_CURVE_NUMBERS; i += 2) {
        const pel_lane beyond = pel_lane_max(t.strain - curve[i], zero), pull = curve[i + 1] * beyond;
        t.tension += pull;
        t.energy += half * pull * beyond;
        t.stiffness += pel_lane_where(pel_lane_above(beyond, zero), curve[i + 1]);
    }
    return t;
}

PEL_INLINE void pel_law_weave(const pel_lane *numbers, const pel_strain *s, pel_response *r)
{
    const pel_lane cosine = numbers[0], sine = numbers[1], coupling = numbers[PEL_WEAVE_COUPLING];
    const pel_lane zero = pel_lane_splat(0), one = pel_lane_splat(1), two = pel_lane_splat(2);
    const pel_symmetric2 e = pel_turned_strain(cosine, sine, s->strain);
    const pel_thread a = pel_thread_at(numbers + PEL_WEAVE_CURVES, two * e.a);
    const pel_thread b = pel_thread_at(numbers + PEL_WEAVE_CURVES + PEL_WEAVE_CURVE_NUMBERS, two * e.b);
    const pel_lane pull_a = a.tension + coupling * b.strain, pull_b = b.tension + coupling * a.strain;
    r->energy = a.energy + b.energy + coupling * a.strain * b.strain + PEL_CONSTANT(0.5) * e.c * e.c;
    r->stress = pel_turned_stress(cosine, sine, (pel_symmetric2){pull_a * a.slope, pull_b * b.slope, e.c});
    const pel_principal_tangent n = {a.stiffness * a.slope * a.slope + pull_a * a.curvature,
                                     coupling * a.slope * b.slope,
                                     b.stiffness * b.slope * b.slope + pull_b * b.curvature, one};
    /* the axes of cloth instead of principal ones: cosine and sine of twice their angle */
    const pel_principal axes = {cosine * cosine - sine * sine, two * cosine * sine, zero, zero};
    const pel_principal_tangent positive = pel_positive_part(&n);
    r->tangent = pel_tangent_from_principal(&axes, &n);
    r->positive = pel_tangent_from_principal(&axes, &positive);
    r->by_trace = r->by_area = zero;
}

/* points of a curve, up to the first without a strain */
static inline int pel_weave_count(const double points[PEL_WEAVE_POINTS][2])
{
    int count = 0;
    while (count < PEL_WEAVE_POINTS && points[count][0] > 0)
        count++;
    return count;
}

/* of the line to point i [Pa] */
static inline double pel_weave_slope(const double points[PEL_WEAVE_POINTS][2], int i)
{
    return i == 0 ? points[0][1] / points[0][0] : (points[i][1] - points[i - 1][1]) / (points[i][0] - points[i - 1][0]);
}

/* the numbers of a curve with a first slope that is larger by `more`, over G */
static inline void pel_weave_fill(const double points[PEL_WEAVE_POINTS][2], double more, double shear, double *numbers)
{
    const int count = pel_weave_count(points);
    numbers[0] = (pel_weave_slope(points, 0) + more) / shear;
    for (int i = 1; i < PEL_WEAVE_POINTS; i++) {
        numbers[2 * i - 1] = i < count ? points[i - 1][0] : 0;
        numbers[2 * i] = i < count ? (pel_weave_slope(points, i) - pel_weave_slope(points, i - 1)) / shear : 0;
    }
}

static inline pel_membrane_law pel_law_weave_of(const pel_membrane_material *material)
{
    const double warp = pel_weave_slope(material->warp_curve, 0), weft = pel_weave_slope(material->weft_curve, 0);
    const double nu = material->poisson, n = 1 - nu * nu * weft / warp, shear = material->shear;
    pel_membrane_law law = {
        .kind = material->kind, .poisson = nu, .modulus = shear * material->thickness, .numbers = {1, 0}};
    double *curves = law.numbers + PEL_WEAVE_CURVES;
    law.numbers[PEL_WEAVE_COUPLING] = nu * weft / (n * shear);
    pel_weave_fill(material->warp_curve, nu * nu * weft / n, shear, curves);
    pel_weave_fill(material->weft_curve, nu * nu * weft * weft / (warp * n), shear, curves + PEL_WEAVE_CURVE_NUMBERS);
    return law;
}

static inline pel_law_refusal pel_weave_refuse_curve(const double points[PEL_WEAVE_POINTS][2], const char *name)
{
    const int count = pel_weave_count(points);
    if (count == 0)
        return (pel_law_refusal){name, "at least one point [strain, stress in pascal] of a strain above 0", 0};
    for (int i = 0; i < count; i++) {
        if (i > 0 && !(points[i][0] > points[i - 1][0]))
            return (pel_law_refusal){name, "strains that rise from point to point", points[i][0]};
        if (!(pel_weave_slope(points, i) > 0) || !isfinite(points[i][0]) || !isfinite(points[i][1]))
            return (pel_law_refusal){name, "finite stresses [Pa] above 0 that rise from point to point", points[i][1]};
    }
    return (pel_law_refusal){0};
}

static inline pel_law_refusal pel_law_weave_refuse(const pel_membrane_material *material)
{
    pel_law_refusal bad = pel_weave_refuse_curve(material->warp_curve, "warp_curve");
    if (bad.member == NULL)
        bad = pel_weave_refuse_curve(material->weft_curve, "weft_curve");
    if (bad.member != NULL)
        return bad;
    if (!(material->shear > 0) || !isfinite(material->shear))
        return (pel_law_refusal){"shear", "shear > 0, in pascal: a curve does not tell it", material->shear};
    if (!(material->poisson * material->poisson * pel_weave_slope(material->weft_curve, 0) <
          pel_weave_slope(material->warp_curve, 0)))
        return (pel_law_refusal){"poisson", "poisson^2 times the first slope of the weft below that of the warp",
                                 material->poisson};
    return (pel_law_refusal){0};
}

#endif
