#include "check.h"
#include "random.h"

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

static void test_polar_and_root(void **unused)
{
    (void)unused;
    random_state random = {2};
    for (int trial = 0; trial < TRIALS; trial++) {
        double f[4], r[4], s[4], product[4], root[4];
        for (int i = 0; i < 4; i++)
            f[i] = random_normal(&random);
        pel_matrix2_polar(f, r, s);
        assert_near(pel_matrix2_determinant(r), 1, 1e-15);
        assert_near(s[1], s[2], 1e-14);
        pel_matrix2_multiply(r, s, product);
        for (int i = 0; i < 4; i++)
            assert_near(product[i], f[i], 1e-14);
        /* the root of F^T F is the stretch where F keeps the orientation */
        const double transposed[4] = {f[0], f[2], f[1], f[3]};
        pel_matrix2_multiply(transposed, f, product);
        pel_matrix2_sqrt(product, root);
        double square[4];
        pel_matrix2_multiply(root, root, square);
        for (int i = 0; i < 4; i++) {
            assert_near(square[i], product[i], 1e-13);
            if (pel_matrix2_determinant(f) > 1e-3)
                assert_near(root[i], s[i], 1e-11);
        }
    }
}

static void test_singular_matrices(void **unused)
{
    (void)unused;
    const double null[4] = {0, 0, 0, 0}, reflection[4] = {1, 0, 0, -1};
    double r[4], s[4];
    pel_matrix2_sqrt(null, s);
    for (int i = 0; i < 4; i++)
        assert_near(s[i], 0, 0);
    pel_matrix2_polar(null, r, s);
    assert_near(r[0], 1, 0);
    pel_matrix2_polar(reflection, r, s);
    assert_near(r[0], 1, 0);
    assert_near(s[3], -1, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_vec3),
        cmocka_unit_test(test_polar_and_root),
        cmocka_unit_test(test_singular_matrices),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
