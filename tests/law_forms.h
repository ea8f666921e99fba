/* Membrane laws by their principal stretches, written with the C library from theory page sections 3 and 17: the oracle
   of all that is made of src/physics/law. A new law needs a case in law_tension. */
#ifndef PEL_TESTS_LAW_FORMS_H
#define PEL_TESTS_LAW_FORMS_H

#include "law/membrane.h"

#include <math.h>

/* a thread that stiffens to the double at 0.15 and to four times at 0.3 */
#define LAW_CURVE(young)                                                                                               \
    {                                                                                                                  \
        {0.15, 0.15 * (young)}, {0.3, 0.45 * (young)},                                                                 \
        {                                                                                                              \
            0.5, 1.25 * (young)                                                                                        \
        }                                                                                                              \
    }

/* its tension over Young's modulus */
static inline double law_thread(double strain)
{
    return strain + fmax(0, strain - 0.15) + 2 * fmax(0, strain - 0.3);
}

/* a material of a law with numbers of its own that count */
static inline pel_membrane_material law_material(int kind, double young, double poisson, double thickness)
{
    return (pel_membrane_material){.kind = (pel_membrane_kind)kind,
                                   .young = young,
                                   .poisson = poisson,
                                   .thickness = thickness,
                                   .mooney_ratio = 0.2,
                                   .extension_limit = 20,
                                   .stiffening = 6,
                                   /* without a direction: stvk */
                                   .weft = young,
                                   .shear = 0.5 * young / (1 + poisson),
                                   .warp_curve = LAW_CURVE(young),
                                   .weft_curve = LAW_CURVE(young),
                                   .yield = 0.35 * young,
                                   .hardening = 0.1 * young};
}

static inline bool law_is_incompressible(const pel_membrane_material *m)
{
    return pel_membrane_law_of(m).poisson == 0.5;
}

/* square of the thickness stretch of a neo-Hookean sheet, by bisection of the normal stress times J */
static inline double law_thickness(double poisson, double area_ratio)
{
    double low = -60, high = 60;
    for (int i = 0; i < 200; i++) {
        double u = 0.5 * (low + high), volume = area_ratio * exp(0.5 * u);
        double stress = (1 - 2 * poisson) * (exp(u) - 1) + poisson * (volume * volume - 1);
        *(stress > 0 ? &high : &low) = u;
    }
    return exp(low);
}

/* square of the width of a neo-Hookean strip that is pulled to the stretch l, by bisection of its lateral stress */
static inline double law_pulled_width(double poisson, double l)
{
    double low = 0, high = 1;
    for (int i = 0; i < 200 && l > 1; i++) {
        double w = 0.5 * (low + high);
        *(w > law_thickness(poisson, l * sqrt(w)) ? &high : &low) = w;
    }
    return high;
}

/* von Mises' stress of two Kirchhoff stresses */
static inline double law_mises(double a, double b)
{
    return sqrt(a * a - a * b + b * b);
}

/* The returned Kirchhoff stresses of a sheet that yields, and its slip; by bisection of the flow. */
static inline double law_return(const pel_membrane_material *m, double h1, double h2, double stress[2])
{
    const double along = 0.5 * m->young / (1 - m->poisson) * (h1 + h2),
                 across = 0.5 * m->young / (1 + m->poisson) * (h1 - h2);
    double low = 0, high = 1e9 / m->young, flow = 0, q = 0;
    for (int i = 0; i < 400; i++) {
        const double p = along / (1 + 0.5 * m->young / (1 - m->poisson) * flow),
                     d = across / (1 + 1.5 * m->young / (1 + m->poisson) * flow);
        stress[0] = p + d;
        stress[1] = p - d;
        q = law_mises(stress[0], stress[1]);
        if (i == 0 && q <= m->yield)
            return 0;
        *(q > m->yield + m->hardening * flow * q ? &low : &high) = flow;
        flow = 0.5 * (low + high);
    }
    return flow * q;
}

/* whether a Green strain (e11, e22, 2 e12) is that near to a change of state of a tension field, where its tangent
 * jumps
 */
static inline bool law_is_near_kink(const pel_membrane_material *material, const double strain[3], double near)
{
    const double mean = 0.5 * (strain[0] + strain[1]), size = hypot(0.5 * (strain[0] - strain[1]), 0.5 * strain[2]);
    if (material->kind == PEL_MEMBRANE_WEAVE) {
        const double a = sqrt(1 + 2 * strain[0]) - 1, b = sqrt(1 + 2 * strain[1]) - 1;
        return fmin(fmin(fabs(a - 0.15), fabs(a - 0.3)), fmin(fabs(b - 0.15), fabs(b - 0.3))) < near;
    }
    if (material->kind == PEL_MEMBRANE_ELASTOPLASTIC) {
        const double h1 = 0.5 * log(1 + 2 * (mean + size)), h2 = 0.5 * log(1 + 2 * (mean - size));
        const double scale = 1 / (1 - material->poisson * material->poisson);
        return fabs(law_mises(scale * (h1 + material->poisson * h2), scale * (h2 + material->poisson * h1)) -
                    material->yield / material->young) < 4 * near;
    }
    const double width = 0.5 * (law_pulled_width(material->poisson, sqrt(1 + 2 * (mean + size))) - 1);
    return material->kind == PEL_MEMBRANE_TENSION_FIELD &&
           (fabs(mean + size) < near || fabs(mean - size - width) < near || mean - size < -0.45);
}

/* tension d psi / dl of a sheet with the principal stretches l and m: force per rest width */
static inline double law_tension(const pel_membrane_material *material, double l, double m)
{
    double mu, lambda, stiffness = material->young * material->thickness;
    double e1 = 0.5 * (l * l - 1), e2 = 0.5 * (m * m - 1), square = l * l * m * m;
    pel_plane_stress_lame(material->young, material->poisson, material->thickness, &mu, &lambda);
    switch (material->kind) {
    case PEL_MEMBRANE_STVK:
    case PEL_MEMBRANE_ORTHOTROPIC:
        return l * (2 * mu * e1 + lambda * (e1 + e2));
    case PEL_MEMBRANE_MOONEY_RIVLIN: {
        double c1 = stiffness / 6 / (1 + material->mooney_ratio), c2 = material->mooney_ratio * c1;
        return 2 * c1 * (l - 1 / (l * square)) + 2 * c2 * (l * m * m - 1 / (l * l * l));
    }
    case PEL_MEMBRANE_NEO_HOOKEAN:
        return mu * (l - law_thickness(material->poisson, l * m) / l);
    case PEL_MEMBRANE_TENSION_FIELD: {
        double width = law_pulled_width(material->poisson, fmax(l, m)),
               whole = mu * (l - law_thickness(material->poisson, l * m) / l);
        if (fmin(l, m) * fmin(l, m) >= width)
            return whole;
        return 1e-3 * whole + (l > m && l > 1 ? 0.999 * mu * (l - width / l) : 0);
    }
    case PEL_MEMBRANE_GENT: {
        double limit = material->extension_limit, invariant = l * l + m * m + 1 / square - 3;
        return stiffness / 3 * (l - 1 / (l * square)) * limit / (limit - invariant);
    }
    case PEL_MEMBRANE_FUNG: {
        double w = mu * (e1 * e1 + e2 * e2) + 0.5 * lambda * (e1 + e2) * (e1 + e2);
        return l * (2 * mu * e1 + lambda * (e1 + e2)) * exp(material->stiffening * w / stiffness);
    }
    case PEL_MEMBRANE_WEAVE: {
        const double n = 1 - material->poisson * material->poisson, contraction = material->poisson / n;
        return stiffness * (law_thread(l - 1) + material->poisson * contraction * (l - 1) + contraction * (m - 1));
    }
    case PEL_MEMBRANE_ELASTOPLASTIC: {
        double stress[2];
        law_return(material, log(l), log(m), stress);
        return material->thickness * stress[0] / l;
    }
    case PEL_MEMBRANE_COROTATED:
    case PEL_MEMBRANE_LINEAR:
    default:
        return 2 * mu * (l - 1) + lambda * (l + m - 2);
    }
}

/* the width m at a stretch l that leaves the sides without tension */
static inline double law_width(const pel_membrane_material *material, double l)
{
    double low = 0.3, high = 2;
    for (int i = 0; i < 100; i++) {
        double m = 0.5 * (low + high);
        *(law_tension(material, m, l) > 0 ? &high : &low) = m;
    }
    return low;
}

#endif
