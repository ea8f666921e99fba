#include "check.h"
#include "gradient.h"
#include "law_forms.h"
#include "random.h"

#include "measure/element.h"

enum { TRIALS = 200, KIND_COUNT = PEL_MEMBRANE_COUNT + 1 };

static const double young = 5, poisson = 0.3, thickness = 0.4;

/* all laws, and neo-Hookean again as the incompressible one */
static pel_membrane_material material_of(int kind)
{
    bool again = kind == KIND_COUNT - 1;
    return law_material(again ? PEL_MEMBRANE_NEO_HOOKEAN : kind, young, again ? 0.5 : poisson, thickness);
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

static bool is_near_kink(const pel_membrane_material *material, const double f[6])
{
    const double strain[3] = {0.5 * (f[0] * f[0] + f[2] * f[2] + f[4] * f[4] - 1),
                              0.5 * (f[1] * f[1] + f[3] * f[3] + f[5] * f[5] - 1),
                              f[0] * f[1] + f[2] * f[3] + f[4] * f[5]};
    return law_is_near_kink(material, strain, 0.02);
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
            if (area_ratio(f) < 0.25 || is_near_kink(&material, f))
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

/* psi is the same for any choice of the rest axes; linear and weave are those that are not */
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
        if (kind == PEL_MEMBRANE_LINEAR || kind == PEL_MEMBRANE_WEAVE)
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
        double mu, lambda, nu = law_is_incompressible(&material) ? 0.5 : poisson;
        pel_plane_stress_lame(young, nu, thickness, &mu, &lambda);
        const double e = 1e-6;
        const double stretched[6] = {1 + e, 0, 0, 1, 0, 0}, sheared[6] = {1, e, 0, 1, 0, 0};
        double p[6], psi = pel_membrane_density(&material, stretched, p);
        assert_near(p[0] / e, 2 * mu + lambda, 3e-5);
        assert_near(p[3] / e, lambda, 3e-5);
        assert_near(psi / (0.5 * e * e), 2 * mu + lambda, 1e-4);
        if (kind == PEL_MEMBRANE_TENSION_FIELD)
            continue; /* a shear compresses it: tests/law/test_cloth.c */
        psi = pel_membrane_density(&material, sheared, p);
        assert_near(p[1] / e, mu, 3e-5);
        assert_near(psi / (0.5 * e * e), mu, 1e-4);
    }
}

/* P of a sheet with the principal stretches l and m against the tensions of the law; along the rest axes, so that
   linear is among them */
static void check_tensions(const pel_membrane_material *material, double l, double m)
{
    const double f[6] = {0, -m, l, 0, 0, 0};
    double p[6], t1 = law_tension(material, l, m), t2 = law_tension(material, m, l);
    pel_membrane_density(material, f, p);
    assert_near(p[2], t1, 1e-11 * (1 + fabs(t1)));
    assert_near(p[1], -t2, 1e-11 * (1 + fabs(t2)));
    assert_near(p[0], 0, 1e-14);
    assert_near(p[3], 0, 1e-14);
}

static void test_tensions(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        pel_membrane_material material = material_of(kind);
        for (double l = 0.6; l < 1.8; l += 0.06) {
            check_tensions(&material, l, l);
            for (double m = 0.6; m < 1.8; m += 0.15)
                check_tensions(&material, l, m);
        }
    }
}

/* theory page section 3: tension T per unit rest width for a stretch, the width free */
static void test_uniaxial_closed_forms(void **unused)
{
    (void)unused;
    const double stiffness = young * thickness, c1 = stiffness / (6 * 1.2), c2 = 0.2 * c1;
    for (double stretch = 0.7; stretch < 1.6; stretch += 0.05) {
        const double square = stretch * stretch, rubber = stretch - 1 / square, e = 0.5 * (square - 1);
        double tension[KIND_COUNT], width[KIND_COUNT];
        for (int kind = 0; kind < KIND_COUNT; kind++) {
            pel_membrane_material material = material_of(kind);
            width[kind] = law_width(&material, stretch);
            tension[kind] = law_tension(&material, stretch, width[kind]);
        }
        width[PEL_MEMBRANE_STVK] = width[PEL_MEMBRANE_FUNG] = width[PEL_MEMBRANE_ORTHOTROPIC] =
            sqrt(1 - poisson * (square - 1));
        tension[PEL_MEMBRANE_STVK] = tension[PEL_MEMBRANE_ORTHOTROPIC] = 0.5 * stiffness * stretch * (square - 1);
        tension[PEL_MEMBRANE_FUNG] = stiffness * stretch * e * exp(6 * e * e / 2);
        width[PEL_MEMBRANE_COROTATED] = width[PEL_MEMBRANE_LINEAR] = 1 - poisson * (stretch - 1);
        tension[PEL_MEMBRANE_COROTATED] = tension[PEL_MEMBRANE_LINEAR] = stiffness * (stretch - 1);
        width[PEL_MEMBRANE_MOONEY_RIVLIN] = width[PEL_MEMBRANE_GENT] = width[KIND_COUNT - 1] = 1 / sqrt(stretch);
        tension[PEL_MEMBRANE_MOONEY_RIVLIN] = 2 * (c1 + c2 / stretch) * rubber;
        tension[PEL_MEMBRANE_GENT] = stiffness / 3 * rubber * 20 / (20 - (square + 2 / stretch - 3));
        tension[KIND_COUNT - 1] = stiffness / 3 * rubber;
        width[PEL_MEMBRANE_WEAVE] = 1 - poisson * (stretch - 1);
        tension[PEL_MEMBRANE_WEAVE] = stiffness * law_thread(stretch - 1);
        /* the strain beyond yield .35 goes to slip and stress as 1 to the hardening .1 */
        const double h = log(stretch), slip = fmax(0, (h - 0.35) / 1.1), pull = h - slip;
        width[PEL_MEMBRANE_ELASTOPLASTIC] = exp(-poisson * pull - 0.5 * slip);
        tension[PEL_MEMBRANE_ELASTOPLASTIC] =
            stiffness * (h < -0.35 ? -0.35 - 0.1 * (-h - 0.35) / 1.1 : pull) / stretch;
        if (h < -0.35)
            width[PEL_MEMBRANE_ELASTOPLASTIC] =
                exp(poisson * (0.35 + 0.1 * (-h - 0.35) / 1.1) + 0.5 * (-h - 0.35) / 1.1);
        /* neo-Hookean: the sides without stress are as wide as the sheet is thick, c = m^2, in a quadratic equation */
        const double part = 1 - 2 * poisson, rest = 1 - poisson;
        double m = sqrt(2 * rest / (part + sqrt(part * part + 4 * poisson * square * rest)));
        width[PEL_MEMBRANE_NEO_HOOKEAN] = m;
        tension[PEL_MEMBRANE_NEO_HOOKEAN] = stiffness / (2 * (1 + poisson)) * (stretch - m * m / stretch);
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

/* tension of equibiaxial stretch 2 over the incompressible one: near poisson 0.5 nothing jumps */
static void test_neo_hookean_is_plane_stress(void **unused)
{
    (void)unused;
    static const double ratios[][2] = {{0.49, 1.006}, {0.4999, 1.0}, {0.5, 1.0}};
    const double f[6] = {2, 0, 0, 2, 0, 0}, incompressible = 2 - pow(2, -5);
    for (int i = 0; i < 3; i++) {
        pel_membrane_material material = law_material(PEL_MEMBRANE_NEO_HOOKEAN, 3, ratios[i][0], 1);
        double p[6];
        pel_membrane_density(&material, f, p);
        print_message("poisson %g: %.4f of the incompressible tension\n", ratios[i][0], p[0] / incompressible);
        assert_near(p[0] / incompressible, ratios[i][1], 5e-4);
    }
    /* the stress belongs to the thickness without normal stress, at any size */
    for (double nu = 0; nu <= 0.5; nu += 1.0 / 64)
        for (double j = 0.011; j < 900; j *= 1.3) {
            pel_membrane_material material = law_material(PEL_MEMBRANE_NEO_HOOKEAN, 2 * (1 + nu), nu, 1);
            const double stretched[6] = {j, 0, 0, 1, 0, 0};
            double p[6], c = law_thickness(nu, j);
            pel_membrane_density(&material, stretched, p);
            assert_near(p[3], 1 - c, 1e-10 * (1 + c));
        }
}

/* I1 - 3 -> Jm: neo-Hookean without a limit, stiff near it, continuous and finite beyond */
static void test_gent_limit(void **unused)
{
    (void)unused;
    pel_membrane_material gent = law_material(PEL_MEMBRANE_GENT, young, poisson, thickness), rubber = gent;
    rubber.kind = PEL_MEMBRANE_MOONEY_RIVLIN;
    rubber.mooney_ratio = 0;
    const double f[6] = {1.7, 0.2, 0, 1.3, 0.1, 0};
    double p[6], q[6];
    gent.extension_limit = 1e12;
    double energy = pel_membrane_density(&gent, f, p);
    assert_near(energy, pel_membrane_density(&rubber, f, q), 1e-11);
    for (int i = 0; i < 6; i++)
        assert_near(p[i], q[i], 1e-11);
    gent.extension_limit = 2;
    /* and the energy is the work of the stress, by trapezoids: 0.3 % of it, where the stress is steep */
    double before = 0, work = 0;
    for (double l = 1; l < 20; l *= 1.001) {
        const double stretched[6] = {l, 0, 0, 1, 0, 0};
        energy = pel_membrane_density(&gent, stretched, p);
        assert_true(isfinite(energy) && p[0] >= before);
        work += 0.5 * (before + p[0]) * (l - l / 1.001);
        assert_near(energy, work, 3e-3 * energy);
        before = p[0];
    }
    /* 0.99 of the limit at l^2 + 1 / l^2 = 2 + 1.98 */
    double square = 0.5 * (3.98 + sqrt(3.98 * 3.98 - 4)), at = sqrt(square);
    const double below[6] = {at * (1 - 1e-9), 0, 0, 1, 0, 0}, above[6] = {at * (1 + 1e-9), 0, 0, 1, 0, 0};
    assert_near(pel_membrane_density(&gent, above, q) / pel_membrane_density(&gent, below, p), 1, 1e-6);
    assert_near(q[0] / p[0], 1, 1e-5);
    assert_near(p[0], young * thickness / 3 * (at - 1 / (at * square)) * 100, 1e-3 * p[0]);
}

/* stiffening -> 0 is St. Venant-Kirchhoff; huge strains stay finite */
static void test_fung_limit(void **unused)
{
    (void)unused;
    pel_membrane_material fung = law_material(PEL_MEMBRANE_FUNG, young, poisson, thickness), stvk = fung;
    stvk.kind = PEL_MEMBRANE_STVK;
    const double f[6] = {1.4, 0.2, 0, 1.1, 0.1, 0}, torn[6] = {50, 0, 0, 50, 0, 0};
    double p[6], q[6];
    assert_true(pel_membrane_density(&fung, f, p) > 1.1 * pel_membrane_density(&stvk, f, q));
    assert_true(isfinite(pel_membrane_density(&fung, torn, p)) && isfinite(p[0]));
    fung.stiffening = 1e-8;
    assert_near(pel_membrane_density(&fung, f, p), pel_membrane_density(&stvk, f, q), 1e-8);
    for (int i = 0; i < 6; i++)
        assert_near(p[i], q[i], 1e-7);
}

/* ---- stress and tangent as functions of the strain ---- */

typedef struct response_point {
    pel_membrane_law law;
    int component;
} response_point;

static double energy_of_strain(const void *context, const double *strain)
{
    const response_point *point = context;
    return pel_membrane_law_response(&point->law, strain, NULL, NULL, NULL);
}

static double stress_of_strain(const void *context, const double *strain)
{
    const response_point *point = context;
    double stress[3];
    pel_membrane_law_response(&point->law, strain, stress, NULL, NULL);
    return stress[point->component];
}

/* Green strain of a random triangle of this size that is neither crushed nor torn */
static void random_strain(random_state *random, double size, double strain[3])
{
    double f[6];
    random_gradient(random, f);
    for (int i = 0; i < 6; i++)
        f[i] *= size;
    strain[0] = 0.5 * (f[0] * f[0] + f[2] * f[2] + f[4] * f[4] - 1);
    strain[1] = 0.5 * (f[1] * f[1] + f[3] * f[3] + f[5] * f[5] - 1);
    strain[2] = f[0] * f[1] + f[2] * f[3] + f[4] * f[5];
}

/* (11, 12, 13, 22, 23, 33) of strains (e11, e22, 2 e12) as a matrix in the orthonormal basis of tensors */
static void tensor_matrix(const double d[6], double m[3][3])
{
    const double root = sqrt(2);
    const double rows[3][3] = {
        {d[0], d[1], root * d[2]}, {d[1], d[3], root * d[4]}, {root * d[2], root * d[4], 2 * d[5]}};
    memcpy(m, rows, sizeof rows);
}

/* smallest eigenvalue by Jacobi rotations */
static double smallest_eigenvalue(const double given[3][3])
{
    double m[3][3];
    memcpy(m, given, sizeof m);
    for (int round = 0; round < 30; round++) {
        int i = round % 3, j = (i + 1) % 3, k = (i + 2) % 3;
        double angle = 0.5 * atan2(2 * m[i][j], m[j][j] - m[i][i]), c = cos(angle), s = sin(angle);
        double ii = c * c * m[i][i] - 2 * c * s * m[i][j] + s * s * m[j][j];
        double jj = s * s * m[i][i] + 2 * c * s * m[i][j] + c * c * m[j][j];
        double ik = c * m[i][k] - s * m[j][k], jk = s * m[i][k] + c * m[j][k];
        m[i][i] = ii;
        m[j][j] = jj;
        m[i][j] = m[j][i] = 0;
        m[i][k] = m[k][i] = ik;
        m[j][k] = m[k][j] = jk;
    }
    return fmin(m[0][0], fmin(m[1][1], m[2][2]));
}

/* D+ is D with its negative eigenvalues 0: D+ and D+ - D are positive semi-definite and their product has no trace */
static void check_positive_part(const double tangent[6], const double positive[6], double scale)
{
    double d[3][3], plus[3][3], rest[3][3], product = 0;
    tensor_matrix(tangent, d);
    tensor_matrix(positive, plus);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            rest[i][j] = plus[i][j] - d[i][j];
            product += plus[i][j] * rest[i][j];
        }
    assert_true(smallest_eigenvalue((const double(*)[3])plus) > -1e-12 * scale);
    assert_true(smallest_eigenvalue((const double(*)[3])rest) > -1e-12 * scale);
    assert_near(product, 0, 1e-11 * scale * scale);
}

static void test_stress_and_tangent_of_strain(void **unused)
{
    (void)unused;
    static const int places[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    random_state random = {12};
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        pel_membrane_material material = material_of(kind);
        response_point point = {pel_membrane_law_of(&material), 0};
        double worst = 0;
        int indefinite = 0;
        for (int trial = 0; trial < TRIALS; trial++) {
            double strain[3], stress[3], tangent[6], positive[6], scale = 0, size = 0;
            /* the tangent of corotated is indefinite beyond a trace of U of 2 + 2 mu / lambda */
            do
                random_strain(&random, kind == PEL_MEMBRANE_COROTATED && trial % 2 == 1 ? 2.5 : 1, strain);
            while (law_is_near_kink(&material, strain, 1e-3));
            pel_membrane_law_response(&point.law, strain, stress, tangent, positive);
            for (int i = 0; i < 6; i++)
                scale = fmax(scale, fabs(tangent[i]));
            for (int i = 0; i < 3; i++)
                size = fmax(size, fabs(stress[i]));
            for (int i = 0; i < 3; i++) {
                double slope = numeric_derivative(energy_of_strain, &point, strain, i, 2e-4);
                assert_near(slope, stress[i], 1e-8 * (size + 1));
                for (point.component = 0; point.component < 3; point.component++)
                    worst = fmax(worst, fabs(numeric_derivative(stress_of_strain, &point, strain, i, 2e-4) -
                                             tangent[places[i][point.component]]) /
                                            scale);
            }
            check_positive_part(tangent, positive, scale);
            double d[3][3];
            tensor_matrix(tangent, d);
            indefinite += smallest_eigenvalue((const double(*)[3])d) < -1e-6 * scale;
        }
        print_message("%s: relative error of the tangent %.1e, %d of %d indefinite\n",
                      pel_membrane_kind_name(material.kind), worst, indefinite, TRIALS);
        assert_true(worst < 1e-7);
        assert_true(kind != PEL_MEMBRANE_COROTATED || indefinite > 0); /* the case is met */
    }
}

/* D at rest is that of plane stress, the bound of stability with it */
static void test_tangent_at_rest(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        pel_membrane_material material = material_of(kind);
        pel_membrane_law law = pel_membrane_law_of(&material);
        const double rest[3] = {0, 0, 0};
        double mu, lambda, stress[3], d[6], plus[6];
        pel_plane_stress_lame(young, law_is_incompressible(&material) ? 0.5 : poisson, thickness, &mu, &lambda);
        assert_near(law.poisson, law_is_incompressible(&material) ? 0.5 : poisson, 0);
        assert_near(pel_membrane_law_response(&law, rest, stress, d, plus), 0, 0);
        const double expected[6] = {2 * mu + lambda, lambda, 0, 2 * mu + lambda, 0, mu};
        for (int i = 0; i < 6; i++) {
            assert_near(d[i], expected[i], 1e-14 * young);
            assert_near(plus[i], expected[i], 1e-14 * young);
        }
        assert_near(pel_membrane_law_stiffness(&law), 2 * (mu + lambda), 1e-14 * young);
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
    pel_membrane_material material = law_material(PEL_MEMBRANE_MOONEY_RIVLIN, 6, 0.5, 1);
    material.mooney_ratio = 0.25;
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
    enum { BAD = 14 };
    pel_membrane_material bad[BAD];
    for (int i = 0; i < BAD; i++)
        bad[i] = good;
    bad[5].kind = bad[6].kind = PEL_MEMBRANE_MOONEY_RIVLIN;
    bad[7].kind = bad[8].kind = PEL_MEMBRANE_GENT;
    bad[9].kind = PEL_MEMBRANE_FUNG;
    bad[10].kind = bad[11].kind = PEL_MEMBRANE_NEO_HOOKEAN;
    for (int i = 0; i < BAD; i++)
        assert_int_equal(pel_membrane_material_check(&bad[i], &error), PEL_OK);
    bad[0].young = 0;
    bad[1].young = (double)HUGE_VAL;
    bad[2].poisson = 1;
    bad[3].poisson = (double)NAN;
    bad[4].thickness = 0;
    bad[5].mooney_ratio = -0.1;
    bad[6].mooney_ratio = (double)NAN;
    bad[7].extension_limit = 0;
    bad[8].extension_limit = (double)HUGE_VAL;
    bad[9].stiffening = -1;
    bad[10].poisson = -0.1;
    bad[11].poisson = 0.51;
    bad[12].young = -1;
    bad[13].kind = (pel_membrane_kind)77;
    for (int i = 0; i < BAD; i++)
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
        cmocka_unit_test(test_tensions),
        cmocka_unit_test(test_neo_hookean_is_plane_stress),
        cmocka_unit_test(test_gent_limit),
        cmocka_unit_test(test_fung_limit),
        cmocka_unit_test(test_stress_and_tangent_of_strain),
        cmocka_unit_test(test_tangent_at_rest),
        cmocka_unit_test(test_small_energies_are_exact),
        cmocka_unit_test(test_degenerate),
        cmocka_unit_test(test_mooney_parameters),
        cmocka_unit_test(test_check),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
