#include "check.h"
#include "random.h"

#include "math/extremes.h"
#include "math/matrix2.h"
#include "math/vec3.h"

enum { TRIALS = 1000 };

static void test_vec3(void **unused)
{
    (void)unused;
    random_state random = {1};
    for (int trial = 0; trial < TRIALS; trial++) {
        double a[3], b[3], c[3], normal[3], sum[3];
        for (int i = 0; i < 3; i++) {
            a[i] = random_normal(&random);
            b[i] = random_normal(&random);
        }
        pel_vec3_cross(a, b, c);
        assert_near(pel_vec3_dot(a, c), 0, 1e-14);
        assert_near(pel_vec3_dot(b, c), 0, 1e-14);
        double aa = pel_vec3_squared_length(a), bb = pel_vec3_squared_length(b), ab = pel_vec3_dot(a, b);
        assert_near(pel_vec3_squared_length(c), aa * bb - ab * ab, 1e-13 * aa * bb);
        pel_vec3_along(a, -1, b, sum);
        assert_near(pel_vec3_length(sum), pel_vec3_distance(a, b), 1e-15);
        pel_vec3_triangle_normal(a, b, sum, normal);
        double ba[3], sa[3];
        pel_vec3_subtract(b, a, ba);
        pel_vec3_subtract(sum, a, sa);
        assert_near(pel_vec3_dot(normal, ba), 0, 1e-13);
        assert_near(pel_vec3_dot(normal, sa), 0, 1e-13);
        double length = pel_vec3_length(a);
        assert_near(pel_vec3_normalize(a), length, 0);
        assert_near(pel_vec3_length(a), 1, 1e-15);
    }
    double null[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3];
    assert_near(pel_vec3_normalize(null), 0, 0);
    pel_vec3_cross(x, y, z);
    assert_near(z[2], 1, 0);
}

static double squared_distance(const double a[4], const double b[4])
{
    double sum = 0;
    for (int i = 0; i < 4; i++)
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    return sum;
}

/* a rotation that leaves a symmetric rest, and no other rotation is nearer */
static void test_nearest_rotation(void **unused)
{
    (void)unused;
    random_state random = {2};
    for (int trial = 0; trial < TRIALS; trial++) {
        double f[4], r[4];
        for (int i = 0; i < 4; i++)
            f[i] = random_normal(&random);
        pel_matrix2_rotation(f, r);
        assert_near(r[0] * r[3] - r[1] * r[2], 1, 1e-15);
        assert_near(r[0] * r[0] + r[2] * r[2], 1, 1e-15);
        assert_near(r[0] * r[1] + r[2] * r[3], 0, 0);
        assert_near(r[0] * f[1] + r[2] * f[3], r[1] * f[0] + r[3] * f[2], 1e-14);
        for (int i = 0; i < 10; i++) {
            double angle = random_between(&random, -4, 4);
            const double other[4] = {cos(angle), -sin(angle), sin(angle), cos(angle)};
            assert_true(squared_distance(f, r) <= squared_distance(f, other) + 1e-14);
        }
    }
}

static void test_singular_matrices(void **unused)
{
    (void)unused;
    const double null[4] = {0, 0, 0, 0}, reflection[4] = {1, 0, 0, -1}, identity[4] = {1, 0, 0, 1};
    double r[4];
    pel_matrix2_rotation(null, r);
    assert_near(squared_distance(r, identity), 0, 0);
    pel_matrix2_rotation(reflection, r);
    assert_near(squared_distance(r, identity), 0, 0);
}

/* as fmin and fmax, whose NaN vanishes too; of two zeros the second */
static void test_extremes(void **unused)
{
    (void)unused;
    const double numbers[] = {0, -1, 1, 2.5, HUGE_VAL, -HUGE_VAL, (double)NAN, 1e-300};
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 8; k++) {
            double a = numbers[i], b = numbers[k], least = pel_min(a, b), most = pel_max(a, b);
            assert_true(isnan(a) && isnan(b) ? isnan(least) : least == fmin(a, b));
            assert_true(isnan(a) && isnan(b) ? isnan(most) : most == fmax(a, b));
        }
    assert_true(signbit(pel_min(0, -0.0)) && !signbit(pel_min(-0.0, 0)));
    assert_true(signbit(pel_max(0, -0.0)) && !signbit(pel_max(-0.0, 0)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_vec3),
        cmocka_unit_test(test_nearest_rotation),
        cmocka_unit_test(test_singular_matrices),
        cmocka_unit_test(test_extremes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
