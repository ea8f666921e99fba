#include "check.h"
#include "gradient.h"
#include "random.h"

#include "pellicle/material.h"

enum { TRIALS = 200, KIND_COUNT = 6 };

static const double young = 5, poisson = 0.3, thickness = 0.4;

/* the five kinds, and neo-Hookean once more as the incompressible one */
static pel_membrane_material material_of(int kind)
{
    pel_membrane_material material = {(pel_membrane_kind)kind, young, poisson, thickness, 0.3};
    if (kind == KIND_COUNT - 1) {
        material.kind = PEL_MEMBRANE_NEO_HOOKEAN;
        material.poisson = 0.5;
    }
    return material;
}

static double density_only(const void *context, const double *f)
{
    return pel_membrane_density(context, f, NULL);
}

static double area_ratio(const double f[6])
{
    double x = f[2] * f[5] - f[4] * f[3], y = f[4] * f[1] - f[0] * f[5], z = f[0] * f[3] - f[2] * f[1];
    return sqrt(x * x + y * y + z * z);
}

/* random gradient, neither crushed nor torn */
static void random_gradient(random_state *random, double f[6])
{
    do {
        for (int i = 0; i < 6; i++)
            f[i] = (i == 0 || i == 3 ? 1 : 0) + 0.4 * random_normal(random);
    } while (area_ratio(f) < 0.25);
}

static void rotate(const double r[9], const double f[6], double rotated[6])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 2; j++)
            rotated[2 * i + j] = r[3 * i] * f[j] + r[3 * i + 1] * f[2 + j] + r[3 * i + 2] * f[4 + j];
}

static void test_stress_is_the_derivative(void **unused)
{
    (void)unused;
    random_state random = {3};
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        pel_membrane_material material = material_of(kind);
        double worst = 0;
        for (int trial = 0; trial < TRIALS; trial++) {
            double f[6], p[6], scale = 0;
            random_gradient(&random, f);
            if (trial % 2 == 1)
                f[4] = f[5] = 0; /* in the plane: the 2 x 2 case */
            if (area_ratio(f) < 0.25)
                continue;
            double with_stress = pel_membrane_density(&material, f, p);
            assert_near(with_stress, pel_membrane_density(&material, f, NULL), 0);
            for (int i = 0; i < 6; i++)
                scale = fmax(scale, fabs(p[i]));
            for (int i = 0; i < 6; i++)
                worst = fmax(worst, fabs(numeric_derivative(density_only, &material, f, i, 4e-3) - p[i]) / scale);
        }
        print_message("kind %d: relative error of the stress %.1e\n", kind, worst);
        assert_true(worst < 1e-8);
    }
}

static void test_rest(void **unused)
{
    (void)unused;
    random_state random = {4};
    const double identity[6] = {1, 0, 0, 1, 0, 0};
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        pel_membrane_material material = material_of(kind);
        double p[6], r[9], f[6];
        assert_near(pel_membrane_density(&material, identity, p), 0, 0);
        for (int i = 0; i < 6; i++)
            assert_near(p[i], 0, 0);
        random_rotation(&random, r);
        rotate(r, identity, f);
        assert_near(pel_membrane_density(&material, f, p), 0, 1e-30);
        for (int i = 0; i < 6; i++)
            assert_near(p[i], 0, 1e-14);
    }
}

/* psi(R F) = psi(F) and P(R F) = R P(F); linear too, as its frame follows the triangle */
static void test_rotation_invariance(void **unused)
{
    (void)unused;
    random_state random = {5};
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        pel_membrane_material material = material_of(kind);
        for (int trial = 0; trial < TRIALS; trial++) {
            double f[6], p[6], r[9], rotated_f[6], rotated_p[6], p_of_rotated[6];
            random_gradient(&random, f);
            random_rotation(&random, r);
            rotate(r, f, rotated_f);
            double psi = pel_membrane_density(&material, f, p);
            assert_near(pel_membrane_density(&material, rotated_f, p_of_rotated), psi, 1e-13 * (1 + psi));
            rotate(r, p, rotated_p);
            for (int i = 0; i < 6; i++)
                assert_near(p_of_rotated[i], rotated_p[i], 1e-12 * (1 + fabs(psi)) * 10);
        }
    }
}

/* psi is the same for any choice of the rest axes; linear is the one that is not */
static void test_isotropy(void **unused)
{
    (void)unused;
    random_state random = {6};
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        pel_membrane_material material = material_of(kind);
        double worst = 0;
        for (int trial = 0; trial < TRIALS; trial++) {
            double f[6], turned[6], angle = random_between(&random, 0, 6.28);
            random_gradient(&random, f);
            for (int i = 0; i < 3; i++) {
                turned[2 * i] = cos(angle) * f[2 * i] + sin(angle) * f[2 * i + 1];
                turned[2 * i + 1] = -sin(angle) * f[2 * i] + cos(angle) * f[2 * i + 1];
            }
            double psi = pel_membrane_density(&material, f, NULL);
            worst = fmax(worst, fabs(pel_membrane_density(&material, turned, NULL) - psi) / (1 + psi));
        }
        if (kind == PEL_MEMBRANE_LINEAR)
            assert_true(worst > 1e-3);
        else
            assert_true(worst < 1e-12);
    }
}

/* d P / d F at rest is the plane-stress law, by complex-step-like small strains: psi = c e^2 to first order */
static void test_small_strain_moduli(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        pel_membrane_material material = material_of(kind);
        double mu, lambda, nu = kind == PEL_MEMBRANE_MOONEY_RIVLIN || kind == KIND_COUNT - 1 ? 0.5 : poisson;
        pel_plane_stress_lame(young, nu, thickness, &mu, &lambda);
        const double e = 1e-6;
        const double stretched[6] = {1 + e, 0, 0, 1, 0, 0}, sheared[6] = {1, e, 0, 1, 0, 0};
        double p[6], psi = pel_membrane_density(&material, stretched, p);
        assert_near(p[0] / e, 2 * mu + lambda, 3e-5);
        assert_near(p[3] / e, lambda, 3e-5);
        assert_near(psi / (0.5 * e * e), 2 * mu + lambda, 1e-4);
        psi = pel_membrane_density(&material, sheared, p);
        assert_near(p[1] / e, mu, 3e-5);
        assert_near(psi / (0.5 * e * e), mu, 1e-4);
    }
}

/* theory page section 3: tension T per unit rest width for a stretch, the width free */
static void test_uniaxial_closed_forms(void **unused)
{
    (void)unused;
    double mu, lambda;
    pel_plane_stress_lame(young, poisson, thickness, &mu, &lambda);
    const double stiffness = young * thickness, c1 = stiffness / (6 * 1.3), c2 = 0.3 * c1;
    for (double stretch = 0.7; stretch < 1.6; stretch += 0.05) {
        double tension[KIND_COUNT], width[KIND_COUNT];
        width[PEL_MEMBRANE_STVK] = sqrt(1 - poisson * (stretch * stretch - 1));
        tension[PEL_MEMBRANE_STVK] = 0.5 * stiffness * stretch * (stretch * stretch - 1);
        width[PEL_MEMBRANE_COROTATED] = width[PEL_MEMBRANE_LINEAR] = 1 - poisson * (stretch - 1);
        tension[PEL_MEMBRANE_COROTATED] = tension[PEL_MEMBRANE_LINEAR] = stiffness * (stretch - 1);
        width[PEL_MEMBRANE_MOONEY_RIVLIN] = width[KIND_COUNT - 1] = 1 / sqrt(stretch);
        tension[PEL_MEMBRANE_MOONEY_RIVLIN] = 2 * (c1 + c2 / stretch) * (stretch - 1 / (stretch * stretch));
        tension[KIND_COUNT - 1] = stiffness / 3 * (stretch - 1 / (stretch * stretch));
        double m = 1;
        for (int i = 0; i < 60; i++) /* Newton for mu (m^2 - 1) + lambda ln(stretch m) = 0 */
            m -= (mu * (m * m - 1) + lambda * log(stretch * m)) / (2 * mu * m + lambda / m);
        width[PEL_MEMBRANE_NEO_HOOKEAN] = m;
        tension[PEL_MEMBRANE_NEO_HOOKEAN] = mu * (stretch - 1 / stretch) + lambda * log(stretch * m) / stretch;
        for (int kind = 0; kind < KIND_COUNT; kind++) {
            pel_membrane_material material = material_of(kind);
            const double f[6] = {stretch, 0, 0, width[kind], 0, 0};
            double p[6];
            pel_membrane_density(&material, f, p);
            assert_near(p[0], tension[kind], 1e-12);
            assert_near(p[3], 0, 1e-12);
            assert_near(p[1], 0, 0);
        }
    }
}

static void test_equibiaxial_closed_forms(void **unused)
{
    (void)unused;
    double mu, lambda;
    pel_plane_stress_lame(young, poisson, thickness, &mu, &lambda);
    const double stiffness = young * thickness, c1 = stiffness / (6 * 1.3), c2 = 0.3 * c1;
    for (double stretch = 0.6; stretch < 1.8; stretch += 0.05) {
        const double s = stretch, s2 = s * s;
        double tension[KIND_COUNT];
        tension[PEL_MEMBRANE_STVK] = (mu + lambda) * s * (s2 - 1);
        tension[PEL_MEMBRANE_COROTATED] = tension[PEL_MEMBRANE_LINEAR] = 2 * (mu + lambda) * (s - 1);
        tension[PEL_MEMBRANE_MOONEY_RIVLIN] = 2 * (c1 + c2 * s2) * (s - 1 / (s2 * s2 * s));
        tension[PEL_MEMBRANE_NEO_HOOKEAN] = mu * (s - 1 / s) + 2 * lambda * log(s) / s;
        tension[KIND_COUNT - 1] = stiffness / 3 * (s - 1 / (s2 * s2 * s));
        for (int kind = 0; kind < KIND_COUNT; kind++) {
            pel_membrane_material material = material_of(kind);
            const double f[6] = {0, -s, s, 0, 0, 0};
            double p[6];
            pel_membrane_density(&material, f, p);
            assert_near(p[2], tension[kind], 1e-12 * (1 + fabs(tension[kind])));
            assert_near(p[1], -tension[kind], 1e-12 * (1 + fabs(tension[kind])));
        }
    }
}

/* energies of strains of 1e-7 keep seven digits: no differences of numbers near 3 */
static void test_small_energies_are_exact(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        pel_membrane_material material = material_of(kind);
        const double e = 1e-7;
        const double f[6] = {1 + e, 0, 0, 1, 0, 0}, g[6] = {1 + 2 * e, 0, 0, 1, 0, 0};
        double ratio = pel_membrane_density(&material, g, NULL) / pel_membrane_density(&material, f, NULL);
        assert_near(ratio, 4, 1e-5);
    }
}

/* crushed to a line, to a point, through the barrier's floor: finite, continuous, still the derivative */
static void test_degenerate(void **unused)
{
    (void)unused;
    const double cases[][6] = {{0, 0, 0, 0, 0, 0},       {1, 0, 0, 0, 0, 0},        {0, 1, 0, 0, 0, 0},
                               {1, 1, 1, 1, 1, 1},       {1, -1, 2, -2, 0, 0},      {1e-200, 0, 0, 1e-200, 0, 0},
                               {1, 0, 0, 1e-300, 0, 0},  {1e-160, 0, 0, 1, 0, 0},   {3, 1, 1e-12, 0, 0, 1e-12},
                               {1e-8, 0, 0, 1e-8, 0, 0}, {1, 1, 0, 1e-15, 0, 0},    {-1, 0, 0, 1, 0, 0},
                               {0, 1, 1, 0, 0, 0},       {1e6, 0, 0, 1e-6, 0, 1e3}, {5e-162, 0, 0, 5e-162, 0, 0}};
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        pel_membrane_material material = material_of(kind);
        for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
            double p[6];
            assert_true(isfinite(pel_membrane_density(&material, cases[c], p)));
            for (int i = 0; i < 6; i++)
                assert_true(isfinite(p[i]));
        }
        double below[6] = {0.5, 0.1, 0, 0.01, 0, 0.005}, p[6];
        pel_membrane_density(&material, below, p);
        for (int i = 0; i < 6; i++)
            assert_near(numeric_derivative(density_only, &material, below, i, 2e-4), p[i], 2e-6 * fabs(p[3]) + 1e-8);
        double at[6] = {0.1, 0, 0, 0.1 * (1 + 1e-9), 0, 0}, under[6] = {0.1, 0, 0, 0.1 * (1 - 1e-9), 0, 0}, q[6];
        double above_floor = pel_membrane_density(&material, at, p);
        assert_near(pel_membrane_density(&material, under, q), above_floor, 1e-6 * above_floor);
        assert_near(p[0], q[0], 1e-6 * fabs(p[0]));
    }
}

static void test_mooney_parameters(void **unused)
{
    (void)unused;
    pel_membrane_material material = {PEL_MEMBRANE_MOONEY_RIVLIN, 6, 0.5, 1, 0.25};
    const double f[6] = {2, 0, 0, 2, 0, 0};
    /* I1 = 8 + 1/16, I2 = 16 + 8/16 */
    assert_near(pel_membrane_density(&material, f, NULL), 0.8 * (8.0625 - 3) + 0.2 * (16.5 - 3), 1e-14);
}

static void test_check(void **unused)
{
    (void)unused;
    pel_error error;
    pel_membrane_material good = material_of(0);
    assert_int_equal(pel_membrane_material_check(&good, &error), PEL_OK);
    pel_membrane_material bad[8];
    for (int i = 0; i < 8; i++)
        bad[i] = good;
    bad[0].young = -1;
    bad[1].young = (double)INFINITY;
    bad[2].poisson = 1;
    bad[3].poisson = (double)NAN;
    bad[4].thickness = 0;
    bad[5].mooney_ratio = -0.1;
    bad[6].mooney_ratio = (double)NAN;
    bad[7].kind = (pel_membrane_kind)77;
    for (int i = 0; i < 8; i++)
        assert_int_equal(pel_membrane_material_check(&bad[i], &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "77"));
    assert_int_equal(pel_membrane_material_check(&bad[2], &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.what, "poisson is 1"));
    assert_true(error.remedy[0] != '\0');
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stress_is_the_derivative),
        cmocka_unit_test(test_rest),
        cmocka_unit_test(test_rotation_invariance),
        cmocka_unit_test(test_isotropy),
        cmocka_unit_test(test_small_strain_moduli),
        cmocka_unit_test(test_uniaxial_closed_forms),
        cmocka_unit_test(test_equibiaxial_closed_forms),
        cmocka_unit_test(test_small_energies_are_exact),
        cmocka_unit_test(test_degenerate),
        cmocka_unit_test(test_mooney_parameters),
        cmocka_unit_test(test_check),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
