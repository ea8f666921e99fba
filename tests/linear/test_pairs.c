/* Pairs of L-BFGS: on a quadratic energy the loops give what the pairs say, and reject pairs that curve downward. */
#include "check.h"
#include "failing_malloc.h"
#include "random.h"

#include "linear/pairs.h"

enum { SIZE = 12, PAIRS = 5 };

/* a quadratic energy of stiffness k per component: the gradient at x */
static void gradient_at(const double k[SIZE], const double x[SIZE], double gradient[SIZE])
{
    for (int i = 0; i < SIZE; i++)
        gradient[i] = k[i] * x[i];
}

static void move(double x[SIZE], random_state *random)
{
    for (int i = 0; i < SIZE; i++)
        x[i] = random_between(random, -1, 1);
}

/* the secant equation of the newest pair: H (change of the gradient) = step, whatever the guess between the loops */
static void test_secant(void **unused)
{
    (void)unused;
    random_state random = {3};
    pel_pairs pairs;
    double k[SIZE], x[2][SIZE], g[2][SIZE], d[SIZE];
    assert_int_equal(pel_pairs_create(&pairs, PAIRS, SIZE, NULL), PEL_OK);
    for (int i = 0; i < SIZE; i++)
        k[i] = random_between(&random, 0.1, 10);
    move(x[0], &random);
    gradient_at(k, x[0], g[0]);
    for (int n = 0; n < 2 * PAIRS; n++) {
        move(x[1], &random);
        gradient_at(k, x[1], g[1]);
        pel_pairs_keep(&pairs, SIZE, (const double *const[]){x[0], x[1]}, (const double *const[]){g[0], g[1]});
        assert_int_equal(pairs.count, n + 1 < PAIRS ? n + 1 : PAIRS);
        for (int i = 0; i < SIZE; i++)
            d[i] = g[1][i] - g[0][i];
        pel_pairs_begin(&pairs, SIZE, d);
        for (int i = 0; i < SIZE; i++)
            d[i] *= 0.7;
        pel_pairs_end(&pairs, SIZE, d);
        for (int i = 0; i < SIZE; i++)
            assert_near(d[i], x[1][i] - x[0][i], 1e-10);
        memcpy(x[0], x[1], sizeof x[0]);
        memcpy(g[0], g[1], sizeof g[0]);
    }
    assert_true(pel_pairs_scale(&pairs, SIZE) > 0.1 && pel_pairs_scale(&pairs, SIZE) < 10);
    pel_pairs_forget(&pairs);
    assert_true(pel_pairs_scale(&pairs, SIZE) == 0);
    pel_pairs_release(&pairs);
}

/* a pair that curves downward would turn directions uphill */
static void test_downward(void **unused)
{
    (void)unused;
    const double x[2][2] = {{0, 0}, {1, 0}}, g[2][2] = {{0, 0}, {-1, 0}};
    pel_pairs pairs;
    assert_int_equal(pel_pairs_create(&pairs, PAIRS, 2, NULL), PEL_OK);
    pel_pairs_keep(&pairs, 2, (const double *const[]){x[0], x[1]}, (const double *const[]){g[0], g[1]});
    assert_int_equal(pairs.count, 0);
    pel_pairs_release(&pairs);
}

static pel_status make(const void *unused, pel_error *error)
{
    (void)unused;
    pel_pairs pairs;
    pel_status status = pel_pairs_create(&pairs, PAIRS, SIZE, error);
    pel_pairs_release(&pairs);
    return status;
}

static void test_allocation_failure(void **unused)
{
    (void)unused;
    for_every_allocation_failure(make, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_secant),
        cmocka_unit_test(test_downward),
        cmocka_unit_test(test_allocation_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
