#include "check.h"
#include "gradient.h"
#include "random.h"

#include "pellicle/material.h"

typedef struct fibre {
    int kind; /* 3 = active */
    double stiffness, rest_length, direction[2];
} fibre;

static double density(const fibre *one, const double f[6], double p[6])
{
    if (one->kind == 3)
        return pel_fibre_active_density(one->stiffness, one->rest_length, one->direction, f, p);
    return pel_fibre_density((pel_fibre_kind)one->kind, one->stiffness, one->direction, f, p);
}

static double density_only(const void *context, const double *f)
{
    return density(context, f, NULL);
}

static fibre random_fibre(random_state *random, int kind)
{
    double angle = random_between(random, 0, 6.28);
    return (fibre){kind, 1.7, 0.6, {cos(angle), sin(angle)}};
}

static void test_stress_is_the_derivative(void **unused)
{
    (void)unused;
    random_state random = {7};
    for (int kind = 0; kind < 4; kind++)
        for (int trial = 0; trial < 200; trial++) {
            fibre one = random_fibre(&random, kind);
            double f[6], p[6], image = 0;
            for (int i = 0; i < 6; i++)
                f[i] = (i == 0 || i == 3 ? 1 : 0) + 0.4 * random_normal(&random);
            for (int i = 0; i < 3; i++)
                image += pow(f[2 * i] * one.direction[0] + f[2 * i + 1] * one.direction[1], 2);
            if (image < 0.1)
                continue;
            density(&one, f, p);
            for (int i = 0; i < 6; i++)
                assert_near(numeric_derivative(density_only, &one, f, i, 4e-3), p[i], 1e-8);
        }
}

static void test_arap_is_sqrt_on_membranes(void **unused)
{
    (void)unused;
    random_state random = {8};
    for (int trial = 0; trial < 100; trial++) {
        fibre one = random_fibre(&random, PEL_FIBRE_ARAP), two = one;
        two.kind = PEL_FIBRE_SQRT;
        double f[6];
        for (int i = 0; i < 6; i++)
            f[i] = random_normal(&random);
        assert_near(density(&one, f, NULL), density(&two, f, NULL), 0);
    }
}

/* at rest along the fibre: energy and stress 0, curvature k, 4 k, k; across the fibre nothing at all */
static void test_rest(void **unused)
{
    (void)unused;
    const double curvature[3] = {1, 4, 1}, e = 1e-5;
    for (int kind = 0; kind < 3; kind++) {
        fibre one = {kind, 2, 1, {1, 0}};
        const double rest[6] = {1, 0, 0, 1, 0, 0}, along[6] = {1 + e, 0, 0, 1, 0, 0}, across[6] = {1, 0, 0, 3, 0, 0};
        double p[6];
        assert_near(density(&one, rest, p), 0, 0);
        assert_near(p[0], 0, 0);
        assert_near(density(&one, along, NULL) / (0.5 * e * e), 2 * curvature[kind], 1e-3);
        assert_near(density(&one, across, NULL), 0, 0);
    }
}

static void test_active(void **unused)
{
    (void)unused;
    fibre one = {3, 2, 0.5, {0, 1}};
    const double rest[6] = {1, 0, 0, 1, 0, 0}, half[6] = {1, 0, 0, 0.5, 0, 0}, crushed[6] = {1, 0, 0, 0, 0, 0};
    double p[6];
    assert_near(density(&one, rest, p), 0.25, 0);
    assert_near(p[3], 1, 0);
    assert_near(density(&one, half, p), 0, 0);
    assert_near(p[3], 0, 0);
    assert_near(density(&one, crushed, p), 0.25, 0);
    assert_near(p[3], 0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stress_is_the_derivative),
        cmocka_unit_test(test_arap_is_sqrt_on_membranes),
        cmocka_unit_test(test_rest),
        cmocka_unit_test(test_active),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
