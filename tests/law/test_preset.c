/* Presets of materials: the numbers agree with the sources that they name, in the units of the sources, and each preset
   sets only the numbers that its law reads. */
#include "check.h"

#include "measure/element.h"
#include "pellicle/preset.h"

/* a source: the range of each number, in SI units */
typedef struct source {
    const char *name;
    pel_membrane_kind kind;
    double young[2], poisson[2], thickness[2], density[2], mooney_ratio;
} source;

#define MPA(value) ((value)*1e6)
#define GPA(value) ((value)*1e9)
#define UM(value) ((value)*1e-6)
#define KPSI(value) ((value)*6.894757e6)
#define MIL(value) ((value)*25.4e-6)
#define WEIGHT(value) ((value)*1e3 / 9.80665) /* kN/m3; 77 are 7850 kg/m3 in round numbers */
#define EXACT(value)                                                                                                   \
    {                                                                                                                  \
        (value), (value)                                                                                               \
    }
/* of an incompressible solid with this shear modulus */
#define SHEAR(value) EXACT(3 * (value))

static const source sources[] = {
    {"lens-capsule", PEL_MEMBRANE_NEO_HOOKEAN, EXACT(MPA(1.5)), EXACT(0.47), {UM(11), UM(15)}, {1000, 1100}, 0},
    {"skin", PEL_MEMBRANE_NEO_HOOKEAN, EXACT(129e3), {0.45, 0.5}, {1e-3, 4e-3}, {1093, 1190}, 0},
    {"rubber", PEL_MEMBRANE_MOONEY_RIVLIN, SHEAR(MPA(0.39)), EXACT(0.5), {UM(500), UM(2000)}, {910, 950}, 0.1},
    /* s+ of 3 bar, s- a tenth of it */
    {"latex-balloon", PEL_MEMBRANE_MOONEY_RIVLIN, SHEAR(3.3e5), EXACT(0.5), {UM(200), UM(300)}, {910, 950}, 0.1},
    {"silicone", PEL_MEMBRANE_NEO_HOOKEAN, {117e3, 119e3}, {0.48, 0.5}, {1e-3, 3e-3}, EXACT(1070), 0},
    {"paper", PEL_MEMBRANE_NEO_HOOKEAN, {GPA(2), GPA(4)}, {0.25, 0.35}, EXACT(UM(100)), EXACT(0.08 / UM(100)), 0},
    {"polyester-film",
     PEL_MEMBRANE_NEO_HOOKEAN,
     {KPSI(710), KPSI(740)},
     EXACT(0.38),
     {UM(22.9), MIL(0.92)},
     EXACT(1390),
     0},
    {"aluminium-foil", PEL_MEMBRANE_NEO_HOOKEAN, {GPA(69), GPA(71)}, EXACT(0.33), EXACT(UM(16)), EXACT(2700), 0},
    {"steel-sheet", PEL_MEMBRANE_NEO_HOOKEAN, EXACT(GPA(210)), EXACT(0.3), EXACT(UM(500)), {7850, WEIGHT(78.5)}, 0},
    {"denim", PEL_MEMBRANE_ORTHOTROPIC, {1.26e6, 1.27e6}, {0.0498, 0.0499}, EXACT(8e-4), EXACT(405), 0},
    {"tablecloth", PEL_MEMBRANE_ORTHOTROPIC, {8.1e6, 8.2e6}, {1.7e-4, 1.8e-4}, EXACT(2.5e-4), EXACT(512), 0},
    {"rib-knit", PEL_MEMBRANE_ORTHOTROPIC, {6.5e4, 6.6e4}, {-0.0055, -0.0054}, EXACT(1e-3), EXACT(276), 0},
};
enum { SOURCE_COUNT = sizeof sources / sizeof *sources };

static void check_range(const char *name, const char *what, double value, const double range[2])
{
    const double rounding = 1e-12;
    if (!(value >= range[0] * (1 - rounding) && value <= range[1] * (1 + rounding)))
        fail_msg("%s: %s is %g, not %g to %g", name, what, value, range[0], range[1]);
}

static void test_sources(void **unused)
{
    (void)unused;
    int32_t count;
    pel_material_presets(&count);
    assert_int_equal(count, SOURCE_COUNT);
    for (int i = 0; i < SOURCE_COUNT; i++) {
        const source *s = &sources[i];
        const pel_material_preset *preset = pel_material_preset_find(s->name);
        assert_non_null(preset);
        assert_string_equal(preset->name, s->name);
        assert_int_equal(preset->material.kind, s->kind);
        check_range(s->name, "young", preset->material.young, s->young);
        check_range(s->name, "poisson", preset->material.poisson, s->poisson);
        check_range(s->name, "thickness", preset->material.thickness, s->thickness);
        check_range(s->name, "density", preset->density, s->density);
        assert_near(preset->material.mooney_ratio, s->mooney_ratio, 0);
        assert_true(preset->doc[0] != '\0' && preset->source[0] != '\0');
    }
    assert_null(pel_material_preset_find("rubbers"));
    assert_null(pel_material_preset_find(""));
}

/* valid, and 0 where its law does not read it */
static void test_materials(void **unused)
{
    (void)unused;
    int32_t count;
    const pel_material_preset *presets = pel_material_presets(&count);
    for (int32_t i = 0; i < count; i++) {
        const pel_membrane_material *m = &presets[i].material;
        assert_int_equal(pel_membrane_material_check(m, NULL), PEL_OK);
        assert_true((m->mooney_ratio > 0) == (m->kind == PEL_MEMBRANE_MOONEY_RIVLIN));
        assert_true((m->extension_limit > 0) == (m->kind == PEL_MEMBRANE_GENT));
        assert_true((m->stiffening > 0) == (m->kind == PEL_MEMBRANE_FUNG));
        assert_true((m->weft > 0 && m->shear > 0) == (m->kind == PEL_MEMBRANE_ORTHOTROPIC));
        assert_true((presets[i].bending[0] > 0) == (presets[i].bending[1] > 0));
    }
}

/* the sheet of a cloth has the stiffness that was measured: pulled along the warp with the weft held, C11, and so on */
static void test_cloth(void **unused)
{
    (void)unused;
    static const struct {
        const char *name;
        double c11, c22, c12, c33;
    } measured[] = {{"denim", 1013.89, 205.352, 10.2341, 53.3872},
                    {"tablecloth", 2027.49, 2002.09, 0.345588, 19.189},
                    {"rib-knit", 65.166, 42.871, -0.234556, 83.1756}};
    for (size_t i = 0; i < sizeof measured / sizeof *measured; i++) {
        const pel_membrane_law law = pel_membrane_law_of(&pel_material_preset_find(measured[i].name)->material);
        const double rest[3] = {0, 0, 0};
        double d[6];
        pel_membrane_law_response(&law, rest, NULL, d, NULL);
        assert_near(d[0], measured[i].c11, 1e-9 * d[0]);
        assert_near(d[3], measured[i].c22, 1e-9 * d[0]);
        assert_near(d[1], measured[i].c12, 1e-9 * d[0]);
        assert_near(d[5], measured[i].c33, 1e-9 * d[0]);
    }
}

/* the stress that makers of silicone state: 69 kPa at twice the length; neo-Hooke has mu (l - 1 / l^2) */
static void test_silicone(void **unused)
{
    (void)unused;
    const pel_material_preset *silicone = pel_material_preset_find("silicone");
    double shear = silicone->material.young / (2 * (1 + silicone->material.poisson));
    assert_near(shear * (2 - 0.25), 69e3, 0.01 * 69e3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sources),
        cmocka_unit_test(test_materials),
        cmocka_unit_test(test_cloth),
        cmocka_unit_test(test_silicone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
