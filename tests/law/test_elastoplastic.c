/* Sheets that stretch for good: the return of trial strains against bisection of the flow, von Mises'
   closed forms of pulled, evenly stretched and sheared sheets, and the work that a step takes. */
#include "check.h"
#include "law_forms.h"
#include "measure/element.h"
#include "random.h"

static pel_membrane_material metal(double hardening)
{
    pel_membrane_material material = law_material(PEL_MEMBRANE_ELASTOPLASTIC, 7e10, 0.33, 1e-4);
    material.yield = 1e8;
    material.hardening = hardening;
    return material;
}

/* Kirchhoff stresses of a sheet with the principal logarithmic strains h1, h2 along its axes [Pa] */
static void stresses(const pel_membrane_material *material, double h1, double h2, double stress[2])
{
    const double f[6] = {exp(h1), 0, 0, exp(h2), 0, 0};
    double p[6];
    pel_membrane_density(material, f, p);
    stress[0] = p[0] * exp(h1) / material->thickness;
    stress[1] = p[3] * exp(h2) / material->thickness;
}

static void test_returns(void **unused)
{
    (void)unused;
    random_state random = {21};
    for (int trial = 0; trial < 2000; trial++) {
        const pel_membrane_material material = metal(trial % 3 == 0 ? 0 : 7e10 * random_between(&random, 0, 0.2));
        const double size = exp(random_between(&random, -7, 0)), angle = random_between(&random, 0, 6.2832);
        double stress[2], found[2];
        law_return(&material, size * cos(angle), size * sin(angle), stress);
        stresses(&material, size * cos(angle), size * sin(angle), found);
        for (int i = 0; i < 2; i++)
            assert_near(found[i], stress[i], 1e-9 * material.yield + 1e-6 * fabs(stress[i]) * (size > 0.5));
    }
}

/* without hardening: yield along a pull, on all sides, and over the root of 3 in shear */
static void test_yield_surface(void **unused)
{
    (void)unused;
    const pel_membrane_material material = metal(0);
    double stress[2];
    for (double h = 0.003; h < 0.1; h *= 2) {
        stresses(&material, h, h, stress);
        assert_near(stress[0], material.yield, 1e-6 * material.yield);
        assert_near(stress[1], material.yield, 1e-6 * material.yield);
        stresses(&material, h, -h, stress);
        assert_near(stress[0], material.yield / sqrt(3), 1e-6 * material.yield);
        assert_near(stress[1], -material.yield / sqrt(3), 1e-6 * material.yield);
        /* pulled with free sides: elastic contraction, and half of the plastic strain */
        const double elastic = material.yield / material.young;
        stresses(&material, h, -material.poisson * elastic - 0.5 * (h - elastic), stress);
        assert_near(stress[0], material.yield, 1e-6 * material.yield);
        assert_near(stress[1], 0, 1e-6 * material.yield);
    }
}

/* the energy of a pull is elastic energy, and yield stress and hardening over the plastic strain */
static void test_energy_of_a_pull(void **unused)
{
    (void)unused;
    const double hardening = 5e9, h = 0.02;
    const pel_membrane_material material = metal(hardening);
    const double slip = (material.young * h - material.yield) / (material.young + hardening);
    const double stress = material.yield + hardening * slip, elastic = stress / material.young;
    const double f[6] = {exp(h), 0, 0, exp(-material.poisson * elastic - 0.5 * slip), 0, 0};
    assert_near(pel_membrane_density(&material, f, NULL) / material.thickness,
                0.5 * stress * elastic + material.yield * slip + 0.5 * hardening * slip * slip, 1e-7 * stress * h);
}

/* what has slipped hardens */
static void test_slip_hardens(void **unused)
{
    (void)unused;
    const pel_membrane_material material = metal(5e9);
    pel_membrane_law law = pel_membrane_law_of(&material);
    law.numbers[0] = 0.01;
    const double f[6] = {exp(0.01), 0, 0, exp(0.01), 0, 0};
    double p[6];
    pel_membrane_law_density(&law, f, p);
    /* equal on all sides: u = 2 h, slip is the plastic u */
    const double bulk = 0.5 * material.young / (1 - material.poisson), y = 1e8 + 5e9 * 0.01;
    const double slip = (bulk * 0.02 - y) / (bulk + 5e9);
    assert_true(slip > 0);
    assert_near(p[0] * exp(0.01) / material.thickness, y + 5e9 * slip, 1e-6 * y);
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_error error;
    pel_membrane_material material = metal(0);
    assert_int_equal(pel_membrane_material_check(&material, &error), PEL_OK);
    material.yield = 0;
    assert_int_equal(pel_membrane_material_check(&material, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "yield"));
    material = metal(-1);
    assert_int_equal(pel_membrane_material_check(&material, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "hardening"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_returns),          cmocka_unit_test(test_yield_surface),
        cmocka_unit_test(test_energy_of_a_pull), cmocka_unit_test(test_slip_hardens),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
