/* The two springs of paper A, lane by lane, against long double. */
#include "check.h"
#include "random.h"

#include "measure/spring.h"

#define ROUNDING (sizeof(pel_real) == 8 ? 4e-16 : 3e-7)

static pel_wide3 random_offset(random_state *random, double size)
{
    pel_wide3 d;
    for (int lane = 0; lane < PEL_WIDTH; lane++) {
        d.x[lane] = (pel_real)(size * random_normal(random));
        d.y[lane] = (pel_real)(size * random_normal(random));
        d.z[lane] = (pel_real)(size * random_normal(random));
    }
    return d;
}

static long double length_of(const pel_wide3 *d, int lane)
{
    long double x = (long double)d->x[lane], y = (long double)d->y[lane], z = (long double)d->z[lane];
    return sqrtl(x * x + y * y + z * z);
}

static void test_structural(void **unused)
{
    (void)unused;
    random_state random = {1};
    for (int trial = 0; trial < 20000; trial++) {
        pel_wide3 d = random_offset(&random, pow(10, random_between(&random, -8, 8)));
        pel_wide length = pel_spring_length(d),
                 rest = length * pel_wide_splat((pel_real)random_between(&random, 0.2, 3));
        pel_wide k = pel_wide_splat((pel_real)random_between(&random, 0.1, 50));
        pel_wide scale = pel_spring_scale(length, k, k * rest), energy = pel_spring_energy(length, rest, k);
        for (int lane = 0; lane < PEL_WIDTH; lane++) {
            long double exact = length_of(&d, lane), stretch = exact - (long double)rest[lane];
            assert_near((double)((long double)length[lane] / exact), 1, ROUNDING);
            double expected = (double)((long double)k[lane] * (1 - (long double)rest[lane] / exact));
            assert_near((double)scale[lane], expected, 4 * ROUNDING * 4 * (double)k[lane]);
            assert_near((double)((long double)energy[lane] / ((long double)k[lane] * exact * exact)),
                        (double)(0.5L * stretch * stretch / (exact * exact)), 16 * ROUNDING);
        }
    }
}

/* no length: no force and no energy, for any stiffness */
static void test_zero(void **unused)
{
    (void)unused;
    const pel_wide zero = pel_wide_splat(0), k = pel_wide_splat(3);
    pel_wide3 d = {zero, zero, zero}, v = {k, k, k};
    pel_wide length = pel_spring_length(d), scale = pel_spring_scale(length, k, k * pel_wide_splat((pel_real)0.25));
    pel_wide damping = pel_volumetric_damping(d, v, k);
    for (int lane = 0; lane < PEL_WIDTH; lane++) {
        assert_true(isfinite(scale[lane]) && scale[lane] * d.x[lane] == 0);
        assert_true(isfinite(damping[lane]) && damping[lane] * d.x[lane] == 0);
    }
}

/* c e takes the part of the velocity that is along e */
static void test_volumetric_damping(void **unused)
{
    (void)unused;
    random_state random = {2};
    for (int trial = 0; trial < 2000; trial++) {
        pel_wide3 e = random_offset(&random, 0.1), v = random_offset(&random, 5);
        pel_wide c = pel_volumetric_damping(e, v, pel_wide_splat(2));
        for (int lane = 0; lane < PEL_WIDTH; lane++) {
            double along = (double)(v.x[lane] * e.x[lane] + v.y[lane] * e.y[lane] + v.z[lane] * e.z[lane]);
            double length = (double)length_of(&e, lane), scale = (double)length_of(&v, lane);
            assert_near((double)c[lane] * length, 2 * along / length, 16 * ROUNDING * scale);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_structural),
        cmocka_unit_test(test_zero),
        cmocka_unit_test(test_volumetric_damping),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
