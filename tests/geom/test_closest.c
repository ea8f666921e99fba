#include "check.h"

#include "pellicle/geometry.h"
#include "random.h"

/* weighted sum of points (count x 3) */
static void combine(const double (*points)[3], const double *weights, int count, double sum[3])
{
    sum[0] = sum[1] = sum[2] = 0;
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            sum[k] += weights[i] * points[i][k];
}

static double distance2(const double a[3], const double b[3])
{
    return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
}

/* weights in range, of sum one, and giving the distance that was returned */
static void check_answer(const double (*points)[3], int first, int second, const double *weights, double answer2)
{
    double sums[2] = {0, 0}, p[3], q[3];
    for (int i = 0; i < first + second; i++) {
        assert_true(weights[i] >= 0 && weights[i] <= 1);
        sums[i >= first] += weights[i];
    }
    assert_near(sums[0], 1, 1e-15);
    assert_near(sums[1], 1, 1e-15);
    combine(points, weights, first, p);
    combine(points + first, weights + first, second, q);
    assert_near(sqrt(answer2), sqrt(distance2(p, q)), 1e-14);
}

/* The distance between two simplices of first and second corners (2 or 3) by Frank-Wolfe steps with away directions:
   slow, knows no cases; an upper and a lower bound of the squared distance. */
static void bound_distance(const double (*points)[3], int first, int second, double *lower, double *upper)
{
    double weights[6] = {0}, p[3], q[3], d[3];
    for (int i = 0; i < first + second; i++)
        weights[i] = i < first ? 1.0 / first : 1.0 / second;
    *lower = 0;
    for (int step = 0; step < 4000; step++) {
        combine(points, weights, first, p);
        combine(points + first, weights + first, second, q);
        for (int k = 0; k < 3; k++)
            d[k] = p[k] - q[k];
        *upper = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        double gap = 0, best_gain = 0;
        int best_from = -1, best_to = -1;
        for (int part = 0; part < 2; part++) {
            int begin = part ? first : 0, end = part ? first + second : first;
            int to = -1, from = -1;
            double low = HUGE_VAL, high = -HUGE_VAL, mean = 0;
            for (int i = begin; i < end; i++) {
                double slope = (part ? -1 : 1) * (d[0] * points[i][0] + d[1] * points[i][1] + d[2] * points[i][2]);
                mean += weights[i] * slope;
                if (slope < low) {
                    low = slope;
                    to = i;
                }
                if (weights[i] > 0 && slope > high) {
                    high = slope;
                    from = i;
                }
            }
            gap += mean - low;
            if (high - low > best_gain) {
                best_gain = high - low;
                best_from = from;
                best_to = to;
            }
        }
        double support = *upper - gap;
        if (support > 0 && *upper > 0 && support * support / *upper > *lower)
            *lower = support * support / *upper;
        double length2 = best_from < 0 ? 0 : distance2(points[best_from], points[best_to]);
        if (length2 == 0)
            return;
        double move = best_gain / length2 < weights[best_from] ? best_gain / length2 : weights[best_from];
        weights[best_from] -= move;
        weights[best_to] += move;
    }
}

static double closest(const double (*points)[3], int first, int second, double *weights)
{
    weights[0] = 1;
    if (first == 1 && second == 2)
        return pel_closest_point_segment(points[0], points[1], points[2], weights + 1);
    if (first == 1)
        return pel_closest_point_triangle(points[0], points[1], points[2], points[3], weights + 1);
    if (second == 2)
        return pel_closest_segment_segment(points[0], points[1], points[2], points[3], weights);
    return pel_closest_segment_triangle(points[0], points[1], points[2], points[3], points[4], weights);
}

static void check_bounds(const double (*points)[3], int first, int second)
{
    double weights[6], lower, upper;
    double answer2 = closest(points, first, second, weights);
    check_answer(points, first, second, weights, answer2);
    bound_distance(points, first, second, &lower, &upper);
    assert_true(sqrt(answer2) <= sqrt(upper) + 1e-13);
    assert_true(sqrt(answer2) >= sqrt(lower) - 1e-13);
}

static const int kinds[4][2] = {{1, 2}, {1, 3}, {2, 2}, {2, 3}};

/* generic, planar, small-integer (many degenerate) and thin inputs against the slow bounds */
static void test_against_bounds(void **unused)
{
    (void)unused;
    random_state random = {1};
    for (int trial = 0; trial < ROUNDS(1200, 120); trial++) {
        double points[5][3];
        for (int i = 0; i < 5; i++)
            for (int k = 0; k < 3; k++) {
                int style = trial % 4;
                points[i][k] = style == 0   ? random_between(&random, -1, 1)
                               : style == 1 ? (k == 2 ? 0.25 : random_between(&random, -1, 1))
                               : style == 2 ? (double)random_integer(&random, -1, 1)
                                            : random_between(&random, -1, 1) * (k == 0 ? 1 : 1e-9);
            }
        for (int kind = 0; kind < 4; kind++)
            check_bounds((const double(*)[3])points, kinds[kind][0], kinds[kind][1]);
    }
}

static void test_known_places(void **unused)
{
    (void)unused;
    const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 1, 0};
    const double above[3] = {0.25, 0.25, 2}, beside[3] = {1, 1, 0}, below[3] = {0.25, 0.25, -1};
    double weights[5];
    assert_near(pel_closest_point_triangle(above, a, b, c, weights), 4, 0);
    assert_near(weights[0], 0.5, 0);
    assert_near(weights[1], 0.25, 0);
    assert_near(pel_closest_point_triangle(beside, a, b, c, weights), 0.5, 1e-16);
    assert_near(weights[0], 0, 0);
    assert_near(pel_closest_segment_triangle(above, below, a, b, c, weights), 0, 0);
    assert_near(weights[1], 2.0 / 3, 1e-16);
    assert_near(pel_closest_segment_segment(a, b, a, c, weights), 0, 0);
    assert_near(pel_closest_point_segment(above, a, a, weights), 4.125, 0);
}

/* coordinates from 1e-6 to 1e6 give the same weights */
static void test_scale(void **unused)
{
    (void)unused;
    random_state random = {2};
    for (int trial = 0; trial < 2000; trial++) {
        double points[5][3], scaled[5][3], weights[6], again[6];
        double scale = ldexp(1, (int)random_integer(&random, -20, 20)), thin = pow(10, -9 - trial % 8);
        for (int i = 0; i < 5; i++)
            for (int k = 0; k < 3; k++)
                /* every second time thin: nearly parallel, to the last digits */
                scaled[i][k] =
                    scale * (points[i][k] = random_between(&random, -1, 1) * (k > 0 && trial % 2 == 1 ? thin : 1));
        for (int kind = 0; kind < 4; kind++) {
            int first = kinds[kind][0], second = kinds[kind][1];
            double answer2 = closest((const double(*)[3])points, first, second, weights);
            assert_near(closest((const double(*)[3])scaled, first, second, again), answer2 * scale * scale, 0);
            assert_memory_equal(weights, again, (size_t)(first + second) * sizeof *weights);
        }
    }
}

static void test_bad_numbers(void **unused)
{
    (void)unused;
    const double bad[3] = {(double)NAN, HUGE_VAL, 0};
    double points[5][3] = {{0}}, weights[6];
    for (int kind = 0; kind < 4; kind++)
        for (int i = 0; i < kinds[kind][0] + kinds[kind][1]; i++) {
            memset(points, 0, sizeof points);
            points[1][0] = points[2][1] = 1;
            memcpy(points[i], bad, sizeof bad);
            closest((const double(*)[3])points, kinds[kind][0], kinds[kind][1], weights);
            for (int w = 0; w < kinds[kind][0] + kinds[kind][1]; w++)
                assert_true(weights[w] >= 0 && weights[w] <= 1);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_bounds),
        cmocka_unit_test(test_known_places),
        cmocka_unit_test(test_scale),
        cmocka_unit_test(test_bad_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
