/* Membrane energies. Every isotropic one is a function of the trace t of C = F^T F and of the area ratio J, so that
       P = 2 (d psi / d t) F + (d psi / d J) G,    G = d J / d F = [ f2 x n, n x f1 ]
   for the columns f1, f2 of F and the unit normal n. J is the length of f1 x f2, not the root of det C: it stays exact
   for needles. St. Venant-Kirchhoff needs no normal and is computed by its second Piola-Kirchhoff stress.

   Energies near rest are written with d = J^2 - 1 and the Green strain e instead of as differences of numbers near 3,
   from J^2 = 1 + 2 tr e + 4 det e:
       I1 - 3         = (2 tr e d - 4 det e) / J^2
       I2 - 3         = (d^2 - 4 det e) / J^2
       t/2 - 1 - ln J = (d - ln(1 + d)) / 2 - 2 det e
   so that a strain of 1e-8 still has an energy with 8 digits. */
#include "material/membrane.h"

#include "base/status.h"
#include "math/vec3.h"

#include <math.h>

/* area ratio below which barriers go on as tangents */
static const double area_ratio_floor = 0.01;

/* F in the quantities that energies are made of */
typedef struct strain_measure {
    double column[2][3];   /* f1, f2 */
    double cofactor[2][3]; /* the columns of G */
    double green[3];       /* Green strain e11, e22, e12 */
    double green_trace, green_determinant;
    double area_ratio; /* J */
} strain_measure;

static void green_strain(const double f[6], double green[3])
{
    green[0] = 0.5 * (f[0] * f[0] + f[2] * f[2] + f[4] * f[4] - 1);
    green[1] = 0.5 * (f[1] * f[1] + f[3] * f[3] + f[5] * f[5] - 1);
    green[2] = 0.5 * (f[0] * f[1] + f[2] * f[3] + f[4] * f[5]);
}

static void measure_strain(const double f[6], strain_measure *m)
{
    pel_vec3_set(m->column[0], f[0], f[2], f[4]);
    pel_vec3_set(m->column[1], f[1], f[3], f[5]);
    double normal[3];
    pel_vec3_cross(m->column[0], m->column[1], normal);
    m->area_ratio = pel_vec3_normalize(normal);
    pel_vec3_cross(m->column[1], normal, m->cofactor[0]);
    pel_vec3_cross(normal, m->column[0], m->cofactor[1]);
    green_strain(f, m->green);
    m->green_trace = m->green[0] + m->green[1];
    m->green_determinant = m->green[0] * m->green[1] - m->green[2] * m->green[2];
}

static void store_columns(const double first[3], const double second[3], double p[6])
{
    for (int i = 0; i < 3; i++) {
        p[2 * i] = first[i];
        p[2 * i + 1] = second[i];
    }
}

/* P = 2 by_trace F + by_area G */
static void isotropic_stress(const strain_measure *m, double by_trace, double by_area, double p[6])
{
    double columns[2][3];
    for (int j = 0; j < 2; j++)
        for (int i = 0; i < 3; i++)
            columns[j][i] = 2 * by_trace * m->column[j][i] + by_area * m->cofactor[j][i];
    store_columns(columns[0], columns[1], p);
}

static double stvk(double mu, double lambda, const double f[6], double p[6])
{
    double e[3];
    green_strain(f, e);
    double trace = e[0] + e[1];
    if (p != NULL) {
        double s11 = 2 * mu * e[0] + lambda * trace, s22 = 2 * mu * e[1] + lambda * trace, s12 = 2 * mu * e[2];
        for (int i = 0; i < 3; i++) {
            double f1 = f[2 * i], f2 = f[2 * i + 1];
            p[2 * i] = f1 * s11 + f2 * s12;
            p[2 * i + 1] = f1 * s12 + f2 * s22;
        }
    }
    return mu * (e[0] * e[0] + e[1] * e[1] + 2 * e[2] * e[2]) + 0.5 * lambda * trace * trace;
}

/* with s = tr S = sqrt(t + 2 J), S = (C + J I) / s and |S - I|^2 = t - 2 s + 2 */
static double corotated(double mu, double lambda, const double f[6], double p[6])
{
    strain_measure m;
    measure_strain(f, &m);
    double c11 = 1 + 2 * m.green[0], c22 = 1 + 2 * m.green[1];
    double s = sqrt(c11 + c22 + 2 * m.area_ratio), inverse = s > 0 ? 1 / s : 0;
    double u11 = inverse * (c11 + m.area_ratio) - 1, u22 = inverse * (c22 + m.area_ratio) - 1;
    double u12 = inverse * 2 * m.green[2], trace = u11 + u22;
    if (p != NULL) {
        double by_s = inverse * (lambda * trace - 2 * mu);
        isotropic_stress(&m, mu + 0.5 * by_s, by_s, p);
    }
    return mu * (u11 * u11 + u22 * u22 + 2 * u12 * u12) + 0.5 * lambda * trace * trace;
}

/* In the frame of f1 the gradient is the triangle [[a, b], [0, c]] with a = |f1|, b = f2 . t1, c = f2 . t2.
   Turning of the frame: d b / d f1 = c t2 / a and d c / d f1 = -b t2 / a. */
static double linear(double mu, double lambda, const double f[6], double p[6])
{
    double t1[3] = {f[0], f[2], f[4]}, t2[3] = {f[1], f[3], f[5]};
    double a = pel_vec3_normalize(t1), b = pel_vec3_dot(t1, t2);
    pel_vec3_along(t2, -b, t1, t2);
    double c = pel_vec3_normalize(t2);
    double e11 = a - 1, e22 = c - 1, e12 = 0.5 * b, trace = e11 + e22;
    if (p != NULL) {
        double by_a = 2 * mu * e11 + lambda * trace, by_b = 2 * mu * e12, by_c = 2 * mu * e22 + lambda * trace;
        double turning = a > 0 ? (by_b * c - by_c * b) / a : 0;
        double first[3], second[3];
        pel_vec3_scale(t1, by_a, first);
        pel_vec3_along(first, turning, t2, first);
        pel_vec3_scale(t1, by_b, second);
        pel_vec3_along(second, by_c, t2, second);
        store_columns(first, second, p);
    }
    return mu * (e11 * e11 + e22 * e22 + 2 * e12 * e12) + 0.5 * lambda * trace * trace;
}

/* psi from h = 1 / J^2, or its tangent below the floor */
static double mooney_rivlin(double c1, double c2, const double f[6], double p[6])
{
    strain_measure m;
    measure_strain(f, &m);
    double j = m.area_ratio, trace = 2 + 2 * m.green_trace, d = (j - 1) * (j + 1), det4 = 4 * m.green_determinant;
    double floored = fmax(j, area_ratio_floor);
    double h = 1 / (floored * floored), slope = -2 * h / floored;
    double i1, i2;
    if (j >= area_ratio_floor) {
        i1 = h * (2 * m.green_trace * d - det4);
        i2 = h * (d * d - det4);
    } else {
        h += slope * (j - area_ratio_floor);
        i1 = trace + h - 3;
        i2 = j * j + trace * h - 3;
    }
    if (p != NULL)
        isotropic_stress(&m, c1 + c2 * h, c1 * slope + c2 * (2 * j + trace * slope), p);
    return c1 * i1 + c2 * i2;
}

static double neo_hookean(double mu, double lambda, const double f[6], double p[6])
{
    strain_measure m;
    measure_strain(f, &m);
    double j = m.area_ratio, d = (j - 1) * (j + 1);
    double floored = fmax(j, area_ratio_floor), slope = 1 / floored;
    double log_j, shear;
    if (j >= area_ratio_floor) {
        log_j = 0.5 * log1p(d);
        shear = 0.5 * d - 2 * m.green_determinant - log_j;
    } else {
        log_j = log(area_ratio_floor) + slope * (j - area_ratio_floor);
        shear = m.green_trace - log_j;
    }
    if (p != NULL)
        isotropic_stress(&m, 0.5 * mu, (lambda * log_j - mu) * slope, p);
    return mu * shear + 0.5 * lambda * log_j * log_j;
}

void pel_plane_stress_lame(double young, double poisson, double thickness, double *mu, double *lambda)
{
    *mu = young * thickness / (2 * (1 + poisson));
    *lambda = young * thickness * poisson / (1 - poisson * poisson);
}

pel_membrane_law pel_membrane_law_of(const pel_membrane_material *material)
{
    pel_membrane_law law = {material->kind, 0, 0};
    bool incompressible = material->kind == PEL_MEMBRANE_MOONEY_RIVLIN ||
                          (material->kind == PEL_MEMBRANE_NEO_HOOKEAN && fabs(material->poisson - 0.5) < 1e-9);
    if (incompressible) {
        double ratio = material->kind == PEL_MEMBRANE_MOONEY_RIVLIN ? material->mooney_ratio : 0;
        law.kind = PEL_MEMBRANE_MOONEY_RIVLIN;
        law.first = material->young * material->thickness / (6 * (1 + ratio));
        law.second = ratio * law.first;
    } else {
        pel_plane_stress_lame(material->young, material->poisson, material->thickness, &law.first, &law.second);
    }
    return law;
}

double pel_membrane_law_density(const pel_membrane_law *law, const double f[6], double p[6])
{
    switch (law->kind) {
    case PEL_MEMBRANE_COROTATED:
        return corotated(law->first, law->second, f, p);
    case PEL_MEMBRANE_LINEAR:
        return linear(law->first, law->second, f, p);
    case PEL_MEMBRANE_MOONEY_RIVLIN:
        return mooney_rivlin(law->first, law->second, f, p);
    case PEL_MEMBRANE_NEO_HOOKEAN:
        return neo_hookean(law->first, law->second, f, p);
    case PEL_MEMBRANE_STVK:
    default:
        return stvk(law->first, law->second, f, p);
    }
}

double pel_membrane_density(const pel_membrane_material *material, const double deformation_gradient[6],
                            double first_piola[6])
{
    pel_membrane_law law = pel_membrane_law_of(material);
    return pel_membrane_law_density(&law, deformation_gradient, first_piola);
}

static pel_status refuse(pel_error *error, const char *member, double value, const char *range)
{
    pel_fail(error, PEL_BAD_ARGUMENT, "membrane material: %s is %g", member, value);
    pel_fail_remedy(error, "give a number with %s", range);
    return PEL_BAD_ARGUMENT;
}

pel_status pel_membrane_material_check(const pel_membrane_material *material, pel_error *error)
{
    if ((unsigned)material->kind > PEL_MEMBRANE_NEO_HOOKEAN)
        return pel_fail(error, PEL_BAD_ARGUMENT, "membrane material: kind %d is unknown", (int)material->kind);
    if (!(material->young > 0) || !isfinite(material->young))
        return refuse(error, "young", material->young, "young > 0, in pascal");
    if (!(fabs(material->poisson) < 1))
        return refuse(error, "poisson", material->poisson, "-1 < poisson < 1");
    if (!(material->thickness > 0) || !isfinite(material->thickness))
        return refuse(error, "thickness", material->thickness, "thickness > 0, in metres");
    if (!(material->mooney_ratio >= 0) || !isfinite(material->mooney_ratio))
        return refuse(error, "mooney_ratio", material->mooney_ratio, "mooney_ratio >= 0");
    return PEL_OK;
}
