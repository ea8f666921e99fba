/* The laws of cloth against closed forms: the modulus of woven cloth off its axes, and the tension field of a sheet
   that is sheared, pulled and left slack. */
#include "check.h"
#include "gradient.h"
#include "law_forms.h"
#include "measure/element.h"
#include "random.h"

static pel_membrane_material woven(void)
{
    pel_membrane_material material = law_material(PEL_MEMBRANE_ORTHOTROPIC, 8, 0.25, 0.5);
    material.weft = 3;
    material.shear = 0.4;
    return material;
}

/* the law with its warp turned by an angle from the first axis */
static pel_membrane_law turned(double angle)
{
    const pel_membrane_material material = woven();
    pel_membrane_law law = pel_membrane_law_of(&material);
    law.numbers[0] = cos(angle);
    law.numbers[1] = sin(angle);
    return law;
}

/* strain of a sheet that is pulled by 1 N/m along the first axis: the first column of the compliance */
static void pull(const pel_membrane_law *law, double strain[3])
{
    const double rest[3] = {0, 0, 0};
    double d[6];
    pel_membrane_law_response(law, rest, NULL, d, NULL);
    const double c11 = d[3] * d[5] - d[4] * d[4], c12 = d[2] * d[4] - d[1] * d[5], c13 = d[1] * d[4] - d[2] * d[3];
    const double determinant = d[0] * c11 + d[1] * c12 + d[2] * c13;
    strain[0] = c11 / determinant;
    strain[1] = c12 / determinant;
    strain[2] = c13 / determinant;
}

/* the largest energy of a unit strain, over all directions of warp: by brute force over strains e, with e12 twice in
   their size */
static void test_stiffness(void **unused)
{
    (void)unused;
    const pel_membrane_law law = turned(0);
    const double rest[3] = {0, 0, 0}, step = 3.14159265358979323846 / 400;
    double d[6], most = 0;
    pel_membrane_law_response(&law, rest, NULL, d, NULL);
    for (int i = 0; i < 400; i++)
        for (int k = 0; k < 400; k++) {
            const double e11 = sin(k * step) * cos(i * step), e22 = sin(k * step) * sin(i * step);
            const double shear = sqrt(2) * cos(k * step);
            most = fmax(most, d[0] * e11 * e11 + 2 * d[1] * e11 * e22 + d[3] * e22 * e22 + d[5] * shear * shear);
        }
    assert_near(pel_membrane_law_stiffness(&law), most, 1e-4 * most);
}

/* Jones 1975: modulus, lateral strain and shear of a pull at the angle a to the warp */
static void test_off_axis(void **unused)
{
    (void)unused;
    const double e1 = 8 * 0.5, e2 = 3 * 0.5, g = 0.4 * 0.5, nu = 0.25;
    for (double a = -1.6; a < 1.6; a += 0.1) {
        const double c = cos(a), s = sin(a), cc = c * c, ss = s * s, mixed = 1 / g - 2 * nu / e1;
        const pel_membrane_law law = turned(a);
        double strain[3];
        pull(&law, strain);
        assert_near(strain[0], cc * cc / e1 + ss * ss / e2 + mixed * cc * ss, 1e-12);
        assert_near(strain[1], (1 / e1 + 1 / e2 - 1 / g) * cc * ss - nu / e1 * (cc * cc + ss * ss), 1e-12);
        assert_near(fabs(strain[2]), fabs(2 * c * s * (cc / e1 - ss / e2 - (cc - ss) * 0.5 * mixed)), 1e-12);
    }
    /* Poisson coupling is that of the warp over that of the weft as their moduli are */
    double along[3], across[3];
    const pel_membrane_law warp = turned(0), weft = turned(acos(-1.0) / 2);
    pull(&warp, along);
    pull(&weft, across);
    assert_near(-along[1] / along[0], nu, 1e-14);
    assert_near(-across[1] / across[0], nu * e2 / e1, 1e-14);
}

typedef struct at_point {
    pel_membrane_law law;
    int component;
} at_point;

static double energy_of(const void *context, const double *strain)
{
    return pel_membrane_law_response(&((const at_point *)context)->law, strain, NULL, NULL, NULL);
}

static double stress_of(const void *context, const double *strain)
{
    const at_point *point = context;
    double stress[3];
    pel_membrane_law_response(&point->law, strain, stress, NULL, NULL);
    return stress[point->component];
}

static void test_turned_stress_and_tangent(void **unused)
{
    (void)unused;
    static const int places[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    random_state random = {5};
    for (int trial = 0; trial < 200; trial++) {
        at_point point = {turned(random_between(&random, 0, 6.28)), 0};
        double strain[3], stress[3], tangent[6];
        for (int i = 0; i < 3; i++)
            strain[i] = random_between(&random, -0.2, 0.4);
        pel_membrane_law_response(&point.law, strain, stress, tangent, NULL);
        for (int i = 0; i < 3; i++) {
            assert_near(numeric_derivative(energy_of, &point, strain, i, 1e-3), stress[i], 1e-9);
            for (point.component = 0; point.component < 3; point.component++)
                assert_near(numeric_derivative(stress_of, &point, strain, i, 1e-3), tangent[places[i][point.component]],
                            1e-9);
        }
    }
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_membrane_material bad = woven();
    pel_error error;
    assert_int_equal(pel_membrane_material_check(&bad, NULL), PEL_OK);
    bad.weft = -1;
    assert_int_equal(pel_membrane_material_check(&bad, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "weft"));
    bad = woven();
    bad.shear = (double)NAN;
    assert_int_equal(pel_membrane_material_check(&bad, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "shear"));
    bad = woven();
    bad.weft = 8 / (0.25 * 0.25) * 1.01;
    assert_int_equal(pel_membrane_material_check(&bad, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "poisson"));
    bad.weft *= 0.98;
    assert_int_equal(pel_membrane_material_check(&bad, NULL), PEL_OK);
}

/* ---- tension field ---- */

static const double young = 5, thickness = 0.4, share = 1e-3;

/* Small strain. A shear g pulls along one diagonal and presses along the other: it wrinkles, with the tension E h g / 2
   on the diagonal, so that the shear stiffness is E h / 4 in place of E h / (2 (1 + nu)). Zero stress across a pull:
   E h. A sheet that is pressed is slack. */
static void test_sheared_sheet(void **unused)
{
    (void)unused;
    for (double nu = 0; nu <= 0.5; nu += 0.125) {
        const pel_membrane_material material = law_material(PEL_MEMBRANE_TENSION_FIELD, young, nu, thickness);
        const double stiffness = young * thickness, e = 1e-6;
        const double sheared[6] = {1, 0.5 * e, 0.5 * e, 1, 0, 0}, pulled[6] = {1 + e, 0, 0, 1 - 0.9 * e, 0, 0};
        const double pressed[6] = {1 - e, 0, 0, 1 - 2 * e, 0, 0};
        double p[6], mu, lambda;
        pel_plane_stress_lame(young, nu, thickness, &mu, &lambda);
        pel_membrane_density(&material, sheared, p);
        assert_near(p[1] / e, (1 - share) * stiffness / 4 + share * mu, 1e-5 * stiffness);
        pel_membrane_density(&material, pulled, p);
        assert_near(p[0] / e, (1 - share) * stiffness + share * (2 * mu + lambda - 0.9 * lambda), 1e-5 * stiffness);
        pel_membrane_density(&material, pressed, p);
        assert_near(p[0] / e, -share * (2 * mu + 3 * lambda), 1e-5 * stiffness);
    }
}

/* at any stretch: taut as neo-Hookean; narrower than a strip that is pulled, the pull of the strip, whatever the width
 */
static void test_pulled_sheet(void **unused)
{
    (void)unused;
    for (double nu = 0; nu <= 0.5; nu += 0.1)
        for (double l = 1.05; l < 3; l += 0.25) {
            const pel_membrane_material field = law_material(PEL_MEMBRANE_TENSION_FIELD, young, nu, thickness);
            pel_membrane_material solid = field;
            solid.kind = PEL_MEMBRANE_NEO_HOOKEAN;
            const double width = law_width(&solid, l), tension = law_tension(&solid, l, width);
            for (double part = 0.3; part < 1.3; part += 0.1) {
                const double f[6] = {l, 0, 0, part * width, 0, 0};
                double p[6], q[6];
                const double energy = pel_membrane_density(&field, f, p), whole = pel_membrane_density(&solid, f, q);
                if (part > 1) {
                    assert_near(energy, whole, 0);
                    assert_near(p[0], q[0], 1e-14);
                    assert_near(p[3], q[3], 1e-14);
                    continue;
                }
                assert_near(p[0], (1 - share) * tension + share * q[0], 1e-9);
                assert_near(p[3], share * q[3], 1e-12);
                assert_true(energy <= whole + 1e-12);
            }
        }
}

/* stress and tangent are derivatives, taut, wrinkled and slack, and the energy is convex along lines of strain */
static void test_derivatives(void **unused)
{
    (void)unused;
    static const int places[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    random_state random = {6};
    const pel_membrane_material material = law_material(PEL_MEMBRANE_TENSION_FIELD, young, 0.3, thickness);
    int loose = 0, slack = 0;
    for (int trial = 0; trial < 400; trial++) {
        at_point point = {pel_membrane_law_of(&material), 0};
        double strain[3], stress[3], tangent[6], positive[6];
        for (int i = 0; i < 3; i++)
            strain[i] = random_between(&random, -0.3, 0.5);
        const double mean = 0.5 * (strain[0] + strain[1]);
        const double size = hypot(0.5 * (strain[0] - strain[1]), 0.5 * strain[2]);
        const double width = 0.5 * (law_pulled_width(0.3, sqrt(1 + 2 * (mean + size))) - 1);
        /* away from the changes of state, where the tangent jumps */
        if (law_is_near_kink(&material, strain, 0.01))
            continue;
        slack += mean + size < 0;
        loose += mean + size > 0 && mean - size < width;
        pel_membrane_law_response(&point.law, strain, stress, tangent, positive);
        for (int i = 0; i < 6; i++)
            assert_near(tangent[i], positive[i], 0);
        for (int i = 0; i < 3; i++) {
            assert_near(numeric_derivative(energy_of, &point, strain, i, 1e-3), stress[i], 1e-7);
            for (point.component = 0; point.component < 3; point.component++)
                assert_near(numeric_derivative(stress_of, &point, strain, i, 1e-3), tangent[places[i][point.component]],
                            1e-6);
        }
    }
    print_message("%d wrinkled, %d slack\n", loose, slack);
    assert_true(loose > 50 && slack > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stiffness),
        cmocka_unit_test(test_off_axis),
        cmocka_unit_test(test_turned_stress_and_tangent),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_sheared_sheet),
        cmocka_unit_test(test_pulled_sheet),
        cmocka_unit_test(test_derivatives),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
