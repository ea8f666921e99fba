/* Tetrahedra: singular values, energies and derivatives of all laws against finite differences and linear elasticity,
   positive parts, and the lanes against the functions in double. */
#define PEL_LANE_DOUBLE
#include "check.h"
#include "random.h"

#include "math/vec3.h"
#include "measure/tetra.h"
#include "measure/tetra_lanes.h"

static const double corners[4][3] = {{0.1, 0, 0.05}, {1, 0.1, 0}, {0.2, 0.9, 0.1}, {0.15, 0.2, 1.1}};

static pel_solid_law law_of(int kind)
{
    return pel_solid_law_of((pel_volume_kind)kind, 0.3, 0.4);
}

static pel_rest_tetra rest_shape(void)
{
    pel_rest_tetra rest;
    assert_true(pel_rest_tetra_setup(corners, &rest));
    return rest;
}

static void random_gradient(random_state *random, double size, double f[9])
{
    for (int i = 0; i < 9; i++)
        f[i] = (i % 4 == 0) + random_between(random, -size, size);
}

static double determinant(const double f[9])
{
    double normal[3];
    pel_vec3_cross(f, f + 3, normal);
    return pel_vec3_dot(normal, f + 6);
}

static void assert_rotation(const double r[9])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            assert_near(pel_vec3_dot(r + 3 * i, r + 3 * j), i == j, 1e-13);
    assert_near(determinant(r), 1, 1e-13);
}

static void assert_decomposed(const double f[9])
{
    double u[9], s[3], v[9];
    pel_signed_svd(f, u, s, v);
    assert_rotation(u);
    assert_rotation(v);
    assert_true(s[0] >= s[1] && s[1] >= fabs(s[2]) - 1e-15);
    for (int i = 0; i < 9; i++) {
        double sum = 0;
        for (int k = 0; k < 3; k++)
            sum += u[i / 3 * 3 + k] * s[k] * v[i % 3 * 3 + k];
        assert_near(sum, f[i], 1e-13);
    }
}

static void svd_has_rotations_and_the_sign_of_the_determinant(void **state)
{
    (void)state;
    random_state random = {1};
    double f[9];
    for (int round = 0; round < 2000; round++) {
        random_gradient(&random, 1.5, f);
        assert_decomposed(f);
    }
    static const double special[][9] = {{0},
                                        {1, 0, 0, 0, 1, 0, 0, 0, 1},
                                        {2, 0, 0, 0, 0, 0, 0, 0, 0},
                                        {0, 0, 0, 0, 0, 0, 0, 0, -2},
                                        {-1, 0, 0, 0, -1, 0, 0, 0, -1},
                                        {0, 1, 0, 1, 0, 0, 0, 0, 1},
                                        {1, 1, 1, 1, 1, 1, 1, 1, 1}};
    for (size_t i = 0; i < sizeof special / sizeof *special; i++)
        assert_decomposed(special[i]);
}

/* all laws at small strain: lambda/2 (tr e)^2 + mu e : e */
static void all_laws_are_linear_elasticity_at_small_strain(void **state)
{
    (void)state;
    const double poisson = 0.3, mu = 0.5 / (1 + poisson), lambda = poisson / ((1 + poisson) * (1 - 2 * poisson));
    random_state random = {2};
    for (int kind = 0; kind < PEL_VOLUME_COUNT; kind++)
        for (int round = 0; round < 20; round++) {
            double f[9], trace = 0, square = 0, stress[9];
            random_gradient(&random, 1e-5, f);
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) {
                    double e = 0.5 * (f[3 * i + j] + f[3 * j + i]) - (i == j);
                    trace += i == j ? e : 0;
                    square += e * e;
                }
            const pel_solid_law law = law_of(kind);
            const double energy = 0.5 * lambda * trace * trace + mu * square;
            assert_near(pel_solid_density(&law, f, stress), energy, 1e-3 * energy + 1e-15);
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++) {
                    double e = 0.5 * (f[3 * i + j] + f[3 * j + i]) - (i == j);
                    assert_near(stress[3 * i + j], (i == j ? lambda * trace : 0) + 2 * mu * e, 2e-9);
                }
        }
}

/* the formulas of pellicle/volume.h by stretches */
static void densities_are_the_documented_ones(void **state)
{
    (void)state;
    const double a = 1.3, b = 0.8, c = 1.1, f[9] = {a, 0, 0, 0, b, 0, 0, 0, c}, young = 7, poisson = 0.3, ratio = 0.4;
    const double mu = young / (2 * (1 + poisson)), lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
    const double first = a * a + b * b + c * c, second = a * a * b * b + b * b * c * c + a * a * c * c, j = a * b * c;
    const double e[3] = {0.5 * (a * a - 1), 0.5 * (b * b - 1), 0.5 * (c * c - 1)}, trace = e[0] + e[1] + e[2];
    const double c1 = 0.5 * mu / (1 + ratio), c2 = ratio * c1;
    const double expected[PEL_VOLUME_COUNT] = {
        [PEL_VOLUME_STVK] = 0.5 * lambda * trace * trace + mu * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]),
        [PEL_VOLUME_COROTATED] =
            mu * ((a - 1) * (a - 1) + (b - 1) * (b - 1) + (c - 1) * (c - 1)) + 0.5 * lambda * (j - 1) * (j - 1),
        [PEL_VOLUME_NEO_HOOKEAN] = 0.5 * mu * (first - 3) - mu * (j - 1) + 0.5 * (lambda + mu) * (j - 1) * (j - 1),
        [PEL_VOLUME_MOONEY_RIVLIN] = c1 * (first - 3) + c2 * (second - 3) - (2 * c1 + 4 * c2) * (j - 1) +
                                     0.5 * (lambda + 2 * c1) * (j - 1) * (j - 1)};
    for (int kind = 0; kind < PEL_VOLUME_COUNT; kind++) {
        double density;
        assert_int_equal(pel_volume_density((pel_volume_kind)kind, young, poisson, ratio, f, &density, NULL, NULL),
                         PEL_OK);
        assert_near(density, expected[kind], 1e-12);
    }
}

static void bad_numbers_are_refused(void **state)
{
    (void)state;
    double density, f[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const struct {
        int kind;
        double young, poisson, ratio;
    } bad[] = {{-1, 1, 0.3, 0}, {PEL_VOLUME_COUNT, 1, 0.3, 0},
               {0, 0, 0.3, 0},  {0, (double)NAN, 0.3, 0},
               {0, 1, 0.5, 0},  {0, 1, -0.1, 0},
               {0, 1, 0.3, -1}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(pel_volume_density((pel_volume_kind)bad[i].kind, bad[i].young, bad[i].poisson, bad[i].ratio, f,
                                            &density, NULL, NULL),
                         PEL_BAD_ARGUMENT);
    f[4] = (double)NAN;
    assert_int_equal(pel_volume_density(0, 1, 0.3, 0, f, &density, NULL, NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_volume_density(0, 1, 0.3, 0, NULL, &density, NULL, NULL), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_volume_density(0, 1, 0.3, 0, f, NULL, NULL, NULL), PEL_BAD_ARGUMENT);
}

/* positions from mild to turned inside out */
static void random_positions(random_state *random, double size, double x[12])
{
    for (int i = 0; i < 12; i++)
        x[i] = corners[i / 3][i % 3] + random_between(random, -size, size);
}

static double evaluate(const pel_rest_tetra *rest, const pel_solid_law *law, const double *x, double *gradient,
                       double *hessian, pel_tangent_kind kind)
{
    const pel_tangent_sum sum = {gradient, hessian, 12};
    memset(gradient, 0, 12 * sizeof *gradient);
    if (hessian != NULL)
        memset(hessian, 0, 144 * sizeof *hessian);
    return pel_tetra_tangent(rest, law, 3.7, x, kind, &sum);
}

static void derivatives_are_those_of_the_energy(void **state)
{
    (void)state;
    const double h = 1e-6;
    const pel_rest_tetra rest = rest_shape();
    random_state random = {3};
    for (int kind = 0; kind < PEL_VOLUME_COUNT; kind++)
        for (int round = 0; round < 60; round++) {
            const pel_solid_law law = law_of(kind);
            double x[12], gradient[12], hessian[144], above[12], below[12], f[9], u[9], s[3], v[9], points[4][3];
            random_positions(&random, round % 2 == 0 ? 0.2 : 1, x);
            memcpy(points, x, sizeof points);
            pel_tetra_deformation(&rest, (const double(*)[3])points, f);
            pel_signed_svd(f, u, s, v);
            if (s[1] + s[2] < 0.1) /* the rotation jumps */
                continue;
            evaluate(&rest, &law, x, gradient, hessian, PEL_TANGENT_EXACT);
            for (int i = 0; i < 12; i++) {
                const double kept = x[i];
                x[i] = kept + h;
                const double more = evaluate(&rest, &law, x, above, NULL, PEL_TANGENT_EXACT);
                x[i] = kept - h;
                const double less = evaluate(&rest, &law, x, below, NULL, PEL_TANGENT_EXACT);
                x[i] = kept;
                assert_near(gradient[i], (more - less) / (2 * h), 1e-6 * (1 + fabs(gradient[i])) + 1e-7 * fabs(more));
                for (int j = 0; j < 12; j++)
                    assert_near(hessian[12 * j + i], (above[j] - below[j]) / (2 * h),
                                1e-5 * (1 + fabs(hessian[12 * j + i])) + 1e-7 * fabs(gradient[j]));
            }
        }
}

/* the positive part has no direction of negative curvature, and is the whole at rest */
static void positive_parts_are_positive(void **state)
{
    (void)state;
    const pel_rest_tetra rest = rest_shape();
    random_state random = {4};
    int differ = 0;
    for (int kind = 0; kind < PEL_VOLUME_COUNT; kind++)
        for (int round = 0; round < 60; round++) {
            const pel_solid_law law = law_of(kind);
            double x[12], gradient[12], exact[144], positive[144];
            random_positions(&random, round == 0 ? 0 : 1, x);
            evaluate(&rest, &law, x, gradient, exact, PEL_TANGENT_EXACT);
            evaluate(&rest, &law, x, gradient, positive, PEL_TANGENT_POSITIVE);
            for (int i = 0; i < 144; i++) {
                assert_near(positive[i], positive[i % 12 * 12 + i / 12], 1e-9);
                if (round == 0)
                    assert_near(positive[i], exact[i], 1e-9);
            }
            for (int trial = 0; trial < 40; trial++) {
                double d[12], by_exact = 0, by_positive = 0;
                for (int i = 0; i < 12; i++)
                    d[i] = random_normal(&random);
                for (int i = 0; i < 144; i++) {
                    by_exact += d[i / 12] * exact[i] * d[i % 12];
                    by_positive += d[i / 12] * positive[i] * d[i % 12];
                }
                assert_true(by_positive >= -1e-9 * fabs(by_exact));
                assert_true(by_positive >= by_exact - 1e-9 * fabs(by_exact));
                differ += by_exact < -1e-3;
            }
        }
    assert_true(differ > 10);
}

static void lanes_give_the_same(void **state)
{
    (void)state;
    const pel_rest_tetra rest = rest_shape();
    random_state random = {5};
    for (int kind = 0; kind < PEL_VOLUME_COUNT; kind++)
        for (int round = 0; round < 100; round++) {
            const pel_solid_law law = law_of(kind);
            double x[12], gradient[12];
            pel_lane3 points[4], f[3], stress[3];
            pel_lane numbers[9];
            random_positions(&random, 0.8, x);
            const double energy = evaluate(&rest, &law, x, gradient, NULL, PEL_TANGENT_EXACT);
            for (int k = 0; k < 9; k++)
                numbers[k] = rest.gradients[k / 3][k % 3];
            for (int k = 0; k < 4; k++)
                points[k] = (pel_lane3){x[3 * k], x[3 * k + 1], x[3 * k + 2]};
            const pel_tetra_gradients b = pel_tetra_gradients_of(numbers);
            pel_tetra_columns(&b, points, f);
            assert_near(3.7 * pel_tetra_stress(&law, (pel_volume_kind)kind, f, stress), energy, 1e-11 * (1 + energy));
            const pel_tetra_parts parts = pel_tetra_parts_of(&law, (pel_volume_kind)kind, f);
            assert_true(parts.shape >= -1e-12);
            /* neither part is above 0 at rest, else projection lacks the stiffness of shear */
            const pel_lane3 unit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
            const pel_tetra_parts rest_parts = pel_tetra_parts_of(&law, (pel_volume_kind)kind, unit);
            assert_near(rest_parts.shape, 0, 1e-14);
            assert_near(rest_parts.size, 0, 1e-14);
            for (int k = 0; k < 4; k++) {
                const pel_lane3 row = pel_tetra_row(stress, b.corner[k]);
                assert_near(3.7 * row.x, gradient[3 * k], 1e-10 * (1 + fabs(gradient[3 * k])));
                assert_near(3.7 * row.y, gradient[3 * k + 1], 1e-10 * (1 + fabs(gradient[3 * k + 1])));
                assert_near(3.7 * row.z, gradient[3 * k + 2], 1e-10 * (1 + fabs(gradient[3 * k + 2])));
            }
        }
}

static void flat_and_turned_tetrahedra_have_no_rest_shape(void **state)
{
    (void)state;
    double x[4][3];
    pel_rest_tetra rest;
    memcpy(x, corners, sizeof x);
    assert_true(pel_rest_tetra_setup((const double(*)[3])x, &rest));
    assert_near(rest.volume, pel_tetrahedron_volume((const double(*)[3])x), 1e-15);
    pel_vec3_copy(corners[1], x[0]);
    pel_vec3_copy(corners[0], x[1]);
    assert_false(pel_rest_tetra_setup((const double(*)[3])x, &rest));
    assert_true(rest.volume < 0);
    pel_vec3_copy(x[1], x[0]);
    assert_false(pel_rest_tetra_setup((const double(*)[3])x, &rest));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(svd_has_rotations_and_the_sign_of_the_determinant),
        cmocka_unit_test(all_laws_are_linear_elasticity_at_small_strain),
        cmocka_unit_test(densities_are_the_documented_ones),
        cmocka_unit_test(bad_numbers_are_refused),
        cmocka_unit_test(derivatives_are_those_of_the_energy),
        cmocka_unit_test(positive_parts_are_positive),
        cmocka_unit_test(lanes_give_the_same),
        cmocka_unit_test(flat_and_turned_tetrahedra_have_no_rest_shape),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
