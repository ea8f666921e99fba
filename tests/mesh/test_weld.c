#include "sample.h"

#include "mesh/weld.h"

enum { MOST = 400 };

/* cubic: the lowest point reachable by steps of at most the tolerance */
static void brute_force(double (*points)[3], int32_t count, double tolerance, int32_t *index_of)
{
    int32_t first_of[MOST], places = 0;
    for (int32_t i = 0; i < count; i++)
        first_of[i] = i;
    for (bool changed = true; changed;) {
        changed = false;
        for (int32_t i = 0; i < count; i++) {
            for (int32_t j = 0; j < count; j++) {
                double d[3] = {points[i][0] - points[j][0], points[i][1] - points[j][1], points[i][2] - points[j][2]};
                if (sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) <= tolerance && first_of[j] < first_of[i]) {
                    first_of[i] = first_of[j];
                    changed = true;
                }
            }
        }
    }
    for (int32_t i = 0; i < count; i++)
        index_of[i] = first_of[i] == i ? places++ : index_of[first_of[i]];
}

static void test_against_brute_force(void **unused)
{
    (void)unused;
    random_state random = {3};
    for (int round = 0; round < 60; round++) {
        double points[MOST][3];
        int32_t index_of[MOST], expected[MOST], places, count = 1 + random_below(&random, MOST - 1);
        int32_t steps = 2 + random_below(&random, 12);
        for (int32_t i = 0; i < 3 * count; i++)
            points[i / 3][i % 3] =
                random_below(&random, steps) / (double)steps - 0.5 + 1e-3 * random_between(&random, 0, 1) * (round % 2);
        double tolerance = round % 3 == 0 ? 0 : 0.02 * random_between(&random, 0, 1);
        assert_int_equal(pel_weld_points((const double(*)[3])points, count, tolerance, index_of, &places), PEL_OK);
        brute_force(points, count, tolerance, expected);
        int32_t most = 0;
        for (int32_t i = 0; i < count; i++) {
            assert_int_equal(index_of[i], expected[i]);
            most = expected[i] > most ? expected[i] : most;
        }
        assert_int_equal(places, most + 1);
    }
}

static void test_special_numbers(void **unused)
{
    (void)unused;
    const double points[7][3] = {{0, 1, 2},
                                 {-0.0, 1, 2},
                                 {(double)NAN, 0, 0},
                                 {(double)NAN, 0, 0},
                                 {(double)HUGE_VAL, 0, 0},
                                 {(double)HUGE_VAL, 0, 0},
                                 {0, 1, 2.5}};
    const int32_t expected[7] = {0, 0, 1, 2, 3, 3, 4};
    int32_t index_of[7], places;
    for (int with_tolerance = 0; with_tolerance < 2; with_tolerance++) {
        assert_int_equal(pel_weld_points(points, 7, with_tolerance * 0.1, index_of, &places), PEL_OK);
        assert_int_equal(places, 5);
        assert_memory_equal(index_of, expected, sizeof expected);
    }
}

/* many coincident points must not make the search quadratic */
static void test_many_nan(void **unused)
{
    (void)unused;
    enum { COUNT = 300000 };
    double(*points)[3] = malloc(COUNT * sizeof *points);
    int32_t *index_of = malloc(COUNT * sizeof *index_of), places;
    assert_true(points != NULL && index_of != NULL);
    for (int32_t i = 0; i < COUNT; i++)
        points[i][0] = points[i][1] = points[i][2] = i % 2 == 0 ? (double)NAN : 1;
    assert_int_equal(pel_weld_points((const double(*)[3])points, COUNT, 0.1, index_of, &places), PEL_OK);
    assert_int_equal(places, COUNT / 2 + 1);
    free(points);
    free(index_of);
}

static void test_tolerance_allowed(void **unused)
{
    (void)unused;
    const double points[3][3] = {{0, 0, 0}, {3, 4, 0}, {(double)NAN, 0, 1}};
    assert_true(pel_weld_tolerance_allowed(points, 3, 0));
    assert_true(pel_weld_tolerance_allowed(points, 3, 0.2));
    assert_false(pel_weld_tolerance_allowed(points, 3, 0.3));
    assert_false(pel_weld_tolerance_allowed(points, 3, -1e-3));
    assert_false(pel_weld_tolerance_allowed(points, 3, 1e-20));
    assert_false(pel_weld_tolerance_allowed(points, 3, (double)NAN));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_brute_force),
        cmocka_unit_test(test_special_numbers),
        cmocka_unit_test(test_many_nan),
        cmocka_unit_test(test_tolerance_allowed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
