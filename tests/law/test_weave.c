/* Woven cloth by curves of its threads: strips pulled along the warp and the weft have exactly their curves, small
   strains the moduli of orthotropic cloth, and compression the first slope; curves that are refused. */
#include "check.h"
#include "law_forms.h"
#include "measure/element.h"

static const double thickness = 5e-4;

static pel_membrane_material cloth(void)
{
    pel_membrane_material material = {.kind = PEL_MEMBRANE_WEAVE,
                                      .young = 1,
                                      .poisson = 0.2,
                                      .thickness = thickness,
                                      .shear = 3e4,
                                      .warp_curve = {{0.02, 2e4}, {0.05, 2e5}, {0.08, 1e6}},
                                      .weft_curve = {{0.05, 3e4}, {0.1, 1.5e5}}};
    return material;
}

/* stress of a curve by its points [Pa] */
static double read_curve(const double points[PEL_WEAVE_POINTS][2], double strain)
{
    double last[2] = {0, 0}, slope = points[0][1] / points[0][0];
    for (int i = 0; i < PEL_WEAVE_POINTS && points[i][0] > 0; i++) {
        slope = (points[i][1] - last[1]) / (points[i][0] - last[0]);
        if (strain < points[i][0])
            break;
        last[0] = points[i][0];
        last[1] = points[i][1];
    }
    return last[1] + slope * (strain - last[0]);
}

static void stresses(const pel_membrane_material *material, double a, double b, double stress[2])
{
    const double f[6] = {1 + a, 0, 0, 1 + b, 0, 0};
    double p[6];
    pel_membrane_density(material, f, p);
    stress[0] = p[0] / thickness;
    stress[1] = p[3] / thickness;
}

static void test_strips_have_their_curves(void **unused)
{
    (void)unused;
    const pel_membrane_material material = cloth();
    const double warp = 1e6, weft = 6e5;
    for (double e = -0.04; e < 0.15; e += 0.005) {
        double stress[2];
        stresses(&material, e, -material.poisson * e, stress);
        assert_near(stress[0], read_curve(material.warp_curve, e), 1e-9 * warp);
        assert_near(stress[1], 0, 1e-9 * warp);
        stresses(&material, -material.poisson * weft / warp * e, e, stress);
        assert_near(stress[1], read_curve(material.weft_curve, e), 1e-9 * warp);
        assert_near(stress[0], 0, 1e-9 * warp);
    }
}

static void test_small_strains_are_orthotropic(void **unused)
{
    (void)unused;
    const pel_membrane_material material = cloth();
    pel_membrane_material linear = material;
    linear.kind = PEL_MEMBRANE_ORTHOTROPIC;
    linear.young = 1e6;
    linear.weft = 6e5;
    pel_membrane_law a = pel_membrane_law_of(&material), b = pel_membrane_law_of(&linear);
    for (double angle = 0; angle < 3; angle += 0.3) {
        const double rest[3] = {0, 0, 0};
        double d[2][6];
        a.numbers[0] = b.numbers[0] = cos(angle);
        a.numbers[1] = b.numbers[1] = sin(angle);
        pel_membrane_law_response(&a, rest, NULL, d[0], NULL);
        pel_membrane_law_response(&b, rest, NULL, d[1], NULL);
        for (int i = 0; i < 6; i++)
            assert_near(d[0][i], d[1][i], 1e-9 * 1e6 * thickness);
    }
}

static void refused(const pel_membrane_material *material, const char *name)
{
    pel_error error;
    assert_int_equal(pel_membrane_material_check(material, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, name));
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_membrane_material material = cloth();
    assert_int_equal(pel_membrane_material_check(&material, NULL), PEL_OK);
    material.warp_curve[1][0] = 0.02;
    refused(&material, "warp_curve");
    material = cloth();
    material.weft_curve[1][1] = 3e4;
    refused(&material, "weft_curve");
    material = cloth();
    material.weft_curve[0][0] = 0;
    refused(&material, "weft_curve");
    material = cloth();
    material.shear = 0;
    refused(&material, "shear");
    material = cloth();
    material.warp_curve[2][1] = (double)INFINITY;
    refused(&material, "warp_curve");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_strips_have_their_curves),
        cmocka_unit_test(test_small_strains_are_orthotropic),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
