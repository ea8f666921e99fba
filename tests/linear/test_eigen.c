/* Eigenvalues against closed forms: a chain of springs, repeated eigenvalues, dense matrices. */
#include "check.h"

#include "failing_malloc.h"
#include "linear/eigen.h"

#include <math.h>
#include <string.h>

enum { CHAIN = 400, WANTED = 8 };
#define PI 3.14159265358979323846

/* y = K^-1 M x of a chain of unit springs between fixed ends (Thomas); masses are those of the metric */
static double masses[CHAIN];

static void measure_chain(void *context, const double *x, double *y)
{
    (void)context;
    for (int i = 0; i < CHAIN; i++)
        y[i] = masses[i] * x[i];
}

static void invert_chain(void *context, const double *x, double *y)
{
    double upper[CHAIN], before = 0;
    (void)context;
    for (int i = 0; i < CHAIN; i++) {
        double pivot = 2 + (i > 0 ? upper[i - 1] : 0);
        upper[i] = -1 / pivot;
        before = y[i] = (masses[i] * x[i] + before) / pivot;
    }
    for (int i = CHAIN - 2; i >= 0; i--)
        y[i] -= upper[i] * y[i + 1];
}

static void test_chain(void **unused)
{
    (void)unused;
    pel_eigen *eigen;
    assert_int_equal(pel_eigen_create(CHAIN, WANTED, &eigen, NULL), PEL_OK);
    const pel_eigen_def def = {invert_chain, measure_chain, NULL, 1e-8, 200, NULL};
    for (double mass = 1; mass < 3; mass++) {
        for (int i = 0; i < CHAIN; i++)
            masses[i] = mass;
        pel_eigen_result result = pel_eigen_solve(eigen, &def);
        assert_int_equal(result.count, WANTED);
        for (int k = 0; k < WANTED; k++) {
            double exact = mass / (2 - 2 * cos((k + 1) * PI / (CHAIN + 1)));
            /* rounding of the sums, over the gap */
            assert_near(pel_eigen_value(eigen, k) / exact, 1, 1e-10);
            /* length 1 in the metric, and a sine */
            const double *x = pel_eigen_vector(eigen, k);
            double sine = sqrt(2 / (mass * (CHAIN + 1)));
            for (int i = 0; i < CHAIN; i += 7)
                assert_near(fabs(x[i]), fabs(sine * sin((k + 1) * PI * (i + 1) / (CHAIN + 1))), 1e-7);
        }
    }
    pel_eigen_destroy(eigen);
}

/* eigenvalues 5, 5, 5, 4, 4, 4, 3, ... */
static void scale(void *context, const double *x, double *y)
{
    (void)context;
    for (int i = 0; i < CHAIN; i++)
        y[i] = i < 12 ? (5 - i / 3) * x[i] : x[i] / (2 + i);
}

static void copy(void *context, const double *x, double *y)
{
    (void)context;
    memcpy(y, x, CHAIN * sizeof *y);
}

static void test_repeated(void **unused)
{
    (void)unused;
    pel_eigen *eigen;
    assert_int_equal(pel_eigen_create(CHAIN, WANTED, &eigen, NULL), PEL_OK);
    const pel_eigen_def def = {scale, copy, NULL, 1e-9, 200, NULL};
    assert_int_equal(pel_eigen_solve(eigen, &def).count, WANTED);
    for (int k = 0; k < WANTED; k++)
        assert_near(pel_eigen_value(eigen, k), 5 - k / 3, 1e-12);
    for (int a = 0; a < WANTED; a++)
        for (int b = 0; b < WANTED; b++) {
            double sum = 0;
            for (int i = 0; i < CHAIN; i++)
                sum += pel_eigen_vector(eigen, a)[i] * pel_eigen_vector(eigen, b)[i];
            assert_near(sum, a == b, 1e-10);
        }
    pel_eigen_destroy(eigen);
}

/* an operator of rank 3 has no more eigenvalues to find */
static void project(void *context, const double *x, double *y)
{
    (void)context;
    memset(y, 0, CHAIN * sizeof *y);
    for (int i = 0; i < 3; i++)
        y[i] = (i + 1) * x[i];
}

static void test_rank(void **unused)
{
    (void)unused;
    pel_eigen *eigen;
    assert_int_equal(pel_eigen_create(CHAIN, WANTED, &eigen, NULL), PEL_OK);
    const pel_eigen_def def = {project, copy, NULL, 1e-9, 50, NULL};
    assert_int_equal(pel_eigen_solve(eigen, &def).count, 3);
    for (int k = 0; k < 3; k++)
        assert_near(pel_eigen_value(eigen, k), 3 - k, 1e-12);
    pel_eigen_destroy(eigen);
}

/* six values far above the others, as those of rigid motions beside vibrations of a solid, hide the others at first */
static void scale_far(void *context, const double *x, double *y)
{
    (void)context;
    for (int i = 0; i < CHAIN; i++)
        y[i] = i < 6 ? 1e9 * x[i] : (2 + 5.0 / i) * x[i];
}

static void test_far(void **unused)
{
    (void)unused;
    pel_eigen *eigen;
    assert_int_equal(pel_eigen_create(CHAIN, WANTED, &eigen, NULL), PEL_OK);
    const pel_eigen_def def = {scale_far, copy, NULL, 1e-6, 200, NULL};
    assert_int_equal(pel_eigen_solve(eigen, &def).count, WANTED);
    for (int k = 6; k < WANTED; k++)
        assert_near(pel_eigen_value(eigen, k), 2 + 5.0 / k, 1e-7);
    pel_eigen_destroy(eigen);
}

static void test_dense(void **unused)
{
    (void)unused;
    enum { N = 20 };
    double matrix[N * N], copied[N * N], values[N], vectors[N * N];
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            matrix[i * N + j] = copied[i * N + j] = sin(1.7 * (i + j)) + (i == j ? 3 : 0) + cos(i * j);
    pel_eigen_dense(N, copied, values, vectors);
    for (int k = 0; k < N; k++) {
        assert_true(k == 0 || values[k] <= values[k - 1]);
        for (int i = 0; i < N; i++) {
            double product = 0;
            for (int j = 0; j < N; j++)
                product += matrix[i * N + j] * vectors[k * N + j];
            assert_near(product, values[k] * vectors[k * N + i], 1e-12);
        }
    }
}

static pel_status create_eigen(const void *data, pel_error *error)
{
    pel_eigen *eigen;
    (void)data;
    pel_status status = pel_eigen_create(50, 3, &eigen, error);
    assert_true((eigen == NULL) == (status != PEL_OK));
    pel_eigen_destroy(eigen);
    return status;
}

static void test_allocation_failure(void **unused)
{
    (void)unused;
    assert_true(for_every_allocation_failure(create_eigen, NULL) > 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_chain), cmocka_unit_test(test_repeated), cmocka_unit_test(test_rank),
        cmocka_unit_test(test_far),   cmocka_unit_test(test_dense),    cmocka_unit_test(test_allocation_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
