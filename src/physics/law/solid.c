#include "law/solid.h"

#include "math/extremes.h"

#define VOLUME_WORD(KIND, name, word) word,
const char *const pel_volume_words[] = {PEL_VOLUME_LAWS(VOLUME_WORD) NULL};

const char *const pel_volume_element_words[] = {"linear", "smooth", NULL};

pel_solid_law pel_solid_law_of(pel_volume_kind kind, double poisson, double mooney_ratio)
{
    const double mu = 0.5 / (1 + poisson), lambda = poisson / ((1 + poisson) * (1 - 2 * poisson));
    pel_solid_law law = {.kind = kind};
    switch (kind) {
    case PEL_VOLUME_STVK:
        law.a2 = -0.5 * mu;
        law.a4 = 0.25 * mu;
        law.b2 = 0.25 * lambda;
        break;
    case PEL_VOLUME_COROTATED:
        law.a1 = -2 * mu;
        law.a2 = mu;
        law.k = lambda;
        break;
    case PEL_VOLUME_MOONEY_RIVLIN:
    case PEL_VOLUME_NEO_HOOKEAN: {
        const double ratio = kind == PEL_VOLUME_NEO_HOOKEAN ? 0 : mooney_ratio;
        const double c1 = 0.5 * mu / (1 + ratio), c2 = ratio * c1;
        law.a2 = c1 + 3 * c2;
        law.b2 = c2;
        law.a4 = -0.5 * c2;
        law.c = -2 * c1 - 4 * c2;
        law.k = lambda + 2 * c1;
        law.shape_k = 2 * c1;
        break;
    }
    }
    return law;
}

double pel_solid_law_stiffness(const pel_solid_law *law)
{
    /* at rest all laws are linear elasticity: 2 mu for shear without rotation, 2 mu + 3 lambda for a change of size */
    const double shear = 2 * law->a2 + 12 * law->a4 - law->c;
    const double size = 2 * law->a2 + 12 * law->a4 + 12 * law->b2 + 2 * law->c + 3 * law->k;
    return pel_max(shear, size);
}
