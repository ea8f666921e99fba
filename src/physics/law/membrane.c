#include "law/membrane.h"

#include "base/status.h"
#include "law/laws.h"

#include <math.h>

typedef struct law_row {
    pel_membrane_law (*of)(const pel_membrane_material *material);
    pel_law_refusal (*refuse)(const pel_membrane_material *material);
} law_row;

static const law_row rows[] = {
#define ROW(KIND, law, name) [PEL_MEMBRANE_##KIND] = {pel_law_##law##_of, pel_law_##law##_refuse},
    PEL_MEMBRANE_LAWS(ROW)
#undef ROW
};

#define WORD(KIND, law, name) name,
const char *const pel_membrane_words[] = {PEL_MEMBRANE_LAWS(WORD) NULL};
#undef WORD

static const pel_material_number numbers[] = {
    {"poisson", PEL_LAW_READS_POISSON, offsetof(pel_membrane_material, poisson)},
    {"mooney_ratio", PEL_LAW_READS_MOONEY_RATIO, offsetof(pel_membrane_material, mooney_ratio)},
    {"extension_limit", PEL_LAW_READS_EXTENSION_LIMIT, offsetof(pel_membrane_material, extension_limit)},
    {"stiffening", PEL_LAW_READS_STIFFENING, offsetof(pel_membrane_material, stiffening)},
    {"weft", PEL_LAW_READS_WEFT, offsetof(pel_membrane_material, weft)},
    {"shear", PEL_LAW_READS_SHEAR, offsetof(pel_membrane_material, shear)},
    {"yield", PEL_LAW_YIELDS, offsetof(pel_membrane_material, yield)},
    {"hardening", PEL_LAW_YIELDS, offsetof(pel_membrane_material, hardening)},
};

void pel_plane_stress_lame(double young, double poisson, double thickness, double *mu, double *lambda)
{
    *mu = young * thickness / (2 * (1 + poisson));
    *lambda = young * thickness * poisson / (1 - poisson * poisson);
}

static bool is_known(pel_membrane_kind kind)
{
    return (unsigned)kind < PEL_MEMBRANE_COUNT;
}

const char *pel_membrane_kind_name(pel_membrane_kind kind)
{
    return is_known(kind) ? pel_membrane_words[kind] : "unknown";
}

pel_membrane_law pel_membrane_law_of(const pel_membrane_material *material)
{
    return rows[is_known(material->kind) ? material->kind : PEL_MEMBRANE_STVK].of(material);
}

int pel_membrane_law_traits(pel_membrane_kind kind)
{
    return pel_law_traits(kind);
}

const pel_material_number *pel_material_number_at(int32_t index)
{
    return index >= 0 && (size_t)index < sizeof numbers / sizeof *numbers ? &numbers[index] : NULL;
}

static pel_status refuse(pel_error *error, const char *member, double value, const char *range)
{
    pel_fail(error, PEL_BAD_ARGUMENT, "membrane material: %s is %g", member, value);
    pel_fail_remedy(error, "give a number with %s", range);
    return PEL_BAD_ARGUMENT;
}

pel_status pel_membrane_material_check(const pel_membrane_material *material, pel_error *error)
{
    PEL_REFUSE_NULL(material, error);
    if (!is_known(material->kind))
        return pel_fail(error, PEL_BAD_ARGUMENT, "membrane material: kind %d is unknown", (int)material->kind);
    if (!(material->young > 0) || !isfinite(material->young))
        return refuse(error, "young", material->young, "young > 0, in pascal");
    if (!(fabs(material->poisson) < 1))
        return refuse(error, "poisson", material->poisson, "-1 < poisson < 1");
    if (!(material->thickness > 0) || !isfinite(material->thickness))
        return refuse(error, "thickness", material->thickness, "thickness > 0, in metres");
    pel_law_refusal bad = rows[material->kind].refuse(material);
    return bad.member == NULL ? PEL_OK : refuse(error, bad.member, bad.value, bad.range);
}
