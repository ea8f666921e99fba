/* Energy densities in double, with the strains and laws of the kernels. */
#define PEL_LANE_DOUBLE
#include "law/fibre.h"
#include "math/extremes.h"
#include "measure/element.h"
#include "measure/fibre.h"
#include "measure/membrane.h"

/* ---- membranes ---- */

static void store_columns(double scale, const pel_lane3 columns[2], double first_piola[6])
{
    for (int j = 0; j < 2; j++) {
        first_piola[j] = scale * columns[j].x;
        first_piola[2 + j] = scale * columns[j].y;
        first_piola[4 + j] = scale * columns[j].z;
    }
}

double pel_membrane_law_density(const pel_membrane_law *law, const double f[6], double first_piola[6])
{
    const pel_gradient columns = {{f[0], f[2], f[4]}, {f[1], f[3], f[5]}};
    pel_lane3 stress[2];
    double energy = 0;
    switch (law->kind) {
#define DENSITY(KIND, name, word)                                                                                      \
    case PEL_MEMBRANE_##KIND:                                                                                          \
        energy = pel_membrane_stress(PEL_MEMBRANE_##KIND, law->numbers, &columns, stress);                             \
        break;
        PEL_MEMBRANE_LAWS(DENSITY)
#undef DENSITY
    default:
        return 0;
    }
    if (first_piola != NULL)
        store_columns(law->modulus, stress, first_piola);
    return law->modulus * energy;
}

double pel_membrane_density(const pel_membrane_material *material, const double deformation_gradient[6],
                            double first_piola[6])
{
    pel_membrane_law law = pel_membrane_law_of(material);
    return pel_membrane_law_density(&law, deformation_gradient, first_piola);
}

static void store_tangent(double scale, const pel_symmetric3 *m, double tangent[6])
{
    const double components[6] = {m->a11, m->a12, m->a13, m->a22, m->a23, m->a33};
    for (int i = 0; tangent != NULL && i < 6; i++)
        tangent[i] = scale * components[i];
}

double pel_membrane_law_response(const pel_membrane_law *law, const double strain[3], double stress[3],
                                 double tangent[6], double positive[6])
{
    pel_strain s = {.strain = {strain[0], strain[1], strain[2]}};
    s.cauchy = (pel_symmetric2){1 + 2 * strain[0], 1 + 2 * strain[1], strain[2]};
    s.area_square = pel_lane_max(s.cauchy.a * s.cauchy.b - s.cauchy.c * s.cauchy.c, 0);
    s.area_ratio = sqrt(s.area_square);
    pel_response at;
    pel_respond(law->kind, law->numbers, &s, &at);
    if (stress != NULL) {
        stress[0] = law->modulus * at.stress.a;
        stress[1] = law->modulus * at.stress.b;
        stress[2] = law->modulus * at.stress.c;
    }
    store_tangent(law->modulus, &at.tangent, tangent);
    store_tangent(law->modulus, &at.positive, positive);
    return law->modulus * at.energy;
}

double pel_membrane_law_stiffness(const pel_membrane_law *law)
{
    const double rest[3] = {0, 0, 0};
    double d[6];
    pel_membrane_law_response(law, rest, NULL, d, NULL);
    /* in the axes of the material: stretches, and shear in the orthonormal basis */
    const double mean = 0.5 * (d[0] + d[3]), part = 0.5 * (d[0] - d[3]);
    return pel_max(mean + sqrt(part * part + d[1] * d[1]), 2 * d[5]);
}

double pel_membrane_law_along(const pel_membrane_law *law)
{
    const double rest[3] = {0, 0, 0};
    double d[6];
    pel_membrane_law_response(law, rest, NULL, d, NULL);
    return d[0];
}

/* ---- fibres ---- */

static double fibre_density(bool squared, double stiffness, double rest_length, const double a[2], const double f[6],
                            double first_piola[6])
{
    const pel_lane3 f1 = {f[0], f[2], f[4]}, f2 = {f[1], f[3], f[5]};
    pel_fibre_image fibre = pel_fibre_image_of(f1, f2, a[0], a[1]);
    pel_fibre_response r = pel_law_fibre(fibre.square, rest_length, squared);
    double pull = stiffness * r.strain * r.slope;
    /* P = pull (F a) a^T */
    const pel_lane3 columns[2] = {pel_lane3_scale(fibre.image, pull * a[0]), pel_lane3_scale(fibre.image, pull * a[1])};
    if (first_piola != NULL)
        store_columns(1, columns, first_piola);
    return stiffness * pel_law_fibre_energy(r);
}

double pel_fibre_active_density(double stiffness, double rest_length, const double direction[2],
                                const double deformation_gradient[6], double first_piola[6])
{
    return fibre_density(false, stiffness, rest_length, direction, deformation_gradient, first_piola);
}

double pel_fibre_density(pel_fibre_kind kind, double stiffness, const double direction[2],
                         const double deformation_gradient[6], double first_piola[6])
{
    return fibre_density(kind == PEL_FIBRE_STVK, stiffness, 1, direction, deformation_gradient, first_piola);
}

double pel_fibre_law_stiffness(pel_fibre_kind kind)
{
    double slope = pel_law_fibre(1, 1, kind == PEL_FIBRE_STVK).slope;
    return slope * slope;
}
