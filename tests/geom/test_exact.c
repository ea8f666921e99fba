#include "check.h"

#include <stdbool.h>

#include "pellicle/geometry.h"
#include "random.h"

__extension__ typedef __int128 int128;

static int sign_of(int128 value)
{
    return (value > 0) - (value < 0);
}

static int128 volume(const int64_t p[4][3])
{
    int128 e[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = p[i + 1][k] - p[0][k];
    return (e[0][1] * e[1][2] - e[0][2] * e[1][1]) * e[2][0] + (e[0][2] * e[1][0] - e[0][0] * e[1][2]) * e[2][1] +
           (e[0][0] * e[1][1] - e[0][1] * e[1][0]) * e[2][2];
}

/* integers of a random size; every other time a combination of the first three, so on their plane, or one beside it */
static void random_points(random_state *random, int64_t p[4][3])
{
    int64_t range = (int64_t)1 << random_integer(random, 0, 34);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            p[i][k] = random_integer(random, -range, range);
    if (random_integer(random, 0, 1) == 0)
        return;
    int64_t s = random_integer(random, -9, 9), u = random_integer(random, -9, 9);
    for (int k = 0; k < 3; k++)
        p[3][k] = p[0][k] + s * (p[1][k] - p[0][k]) + u * (p[2][k] - p[0][k]);
    p[3][random_integer(random, 0, 2)] += random_integer(random, -1, 1);
}

static void test_signs_on_integers(void **unused)
{
    (void)unused;
    random_state random = {1};
    int zeros = 0;
    for (int trial = 0; trial < ROUNDS(200000, 20000); trial++) {
        int64_t p[4][3];
        double x[4][3];
        random_points(&random, p);
        int shift = (int)random_integer(&random, -300, 300);
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++)
                x[i][k] = ldexp((double)p[i][k], shift);
        int expected = sign_of(volume((const int64_t(*)[3])p));
        assert_int_equal(pel_orient3d(x[0], x[1], x[2], x[3]), expected);
        assert_int_equal(pel_orient3d(x[1], x[0], x[2], x[3]), -expected);
        assert_int_equal(pel_orient3d(x[3], x[2], x[1], x[0]), expected);
        int128 area =
            (int128)(p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (int128)(p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
        assert_int_equal(pel_orient2d(x[0], x[1], x[2]), sign_of(area));
        zeros += expected == 0;
    }
    assert_true(zeros > ROUNDS(10000, 1000));
}

/* a plane through far and near points, and the smallest step off it */
static void test_signs_at_the_limits(void **unused)
{
    (void)unused;
    const double tiny = 0x1p-1074, huge = 0x1p1023;
    const double a[3] = {0, 0, 0}, b[3] = {huge, 0, 0}, c[3] = {0, huge, 0}, d[3] = {tiny, tiny, tiny};
    const double e[3] = {tiny, tiny, 0}, f[3] = {-huge, huge, -tiny};
    assert_int_equal(pel_orient3d(a, b, c, d), 1);
    assert_int_equal(pel_orient3d(a, b, c, e), 0);
    assert_int_equal(pel_orient3d(a, b, c, f), -1);
    assert_int_equal(pel_orient3d(b, f, c, a), pel_orient3d(a, f, b, c));
    assert_int_equal(pel_orient3d(b, f, c, a), -pel_orient3d(f, b, c, a));
    const double p[2] = {-huge, -huge}, q[2] = {huge, huge}, r[2] = {tiny, tiny}, s[2] = {tiny, 0};
    assert_int_equal(pel_orient2d(p, q, r), 0);
    assert_int_equal(pel_orient2d(p, q, s), -1);
    const double bad[3] = {(double)NAN, 0, 0};
    assert_int_equal(pel_orient3d(a, b, c, bad), 0);
}

/* ---- triangles ---- */

typedef struct whole {
    int64_t x[3];
} whole;

static whole cross(whole a, whole b)
{
    return (whole){
        {a.x[1] * b.x[2] - a.x[2] * b.x[1], a.x[2] * b.x[0] - a.x[0] * b.x[2], a.x[0] * b.x[1] - a.x[1] * b.x[0]}};
}

static whole minus(whole a, whole b)
{
    return (whole){{a.x[0] - b.x[0], a.x[1] - b.x[1], a.x[2] - b.x[2]}};
}

static bool separates(whole axis, const whole points[9])
{
    int positive = 0, negative = 0;
    for (int i = 0; i < 9; i++) {
        int64_t along = axis.x[0] * points[i].x[0] + axis.x[1] * points[i].x[1] + axis.x[2] * points[i].x[2];
        positive += along > 0;
        negative += along < 0;
    }
    return positive == 9 || negative == 9;
}

/* The difference of two convex sets misses the origin exactly when a facet, or for flat differences a line across their
   directions, separates: all candidates, in integers. */
static bool oracle_intersect(const whole a[3], const whole b[3])
{
    whole points[9], sides[6];
    for (int i = 0; i < 9; i++)
        points[i] = minus(a[i / 3], b[i % 3]);
    for (int i = 0; i < 3; i++) {
        sides[i] = minus(a[(i + 1) % 3], a[i]);
        sides[3 + i] = minus(b[(i + 1) % 3], b[i]);
    }
    for (int i = 0; i < 9; i++)
        if (separates(points[i], points))
            return false;
    for (int i = 0; i < 6; i++) {
        for (int j = 0; j < 9; j++)
            if (separates(cross(cross(sides[i], points[j]), sides[i]), points))
                return false;
        for (int j = 0; j < 6; j++) {
            whole normal = cross(sides[i], sides[j]);
            if (separates(normal, points))
                return false;
            for (int k = 0; k < 6; k++)
                if (separates(cross(normal, sides[k]), points))
                    return false;
        }
    }
    return true;
}

static void to_double(const whole a[3], double scale, double x[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            x[i][k] = scale * (double)a[i].x[k];
}

static void random_triangle(random_state *random, int64_t range, bool flat, whole a[3])
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            a[i].x[k] = flat && k == 2 ? 0 : random_integer(random, -range, range);
}

/* small grids: most pairs touch, overlap in a plane or are degenerate somewhere */
static void test_triangles(void **unused)
{
    (void)unused;
    random_state random = {2};
    int meeting = 0, trials = ROUNDS(30000, 3000);
    for (int trial = 0; trial < trials; trial++) {
        whole a[3], b[3];
        double x[3][3], y[3][3];
        int64_t range = random_integer(&random, 1, 6);
        bool flat = trial % 4 == 0;
        random_triangle(&random, range, flat, a);
        random_triangle(&random, range, flat, b);
        bool expected = oracle_intersect(a, b);
        meeting += expected;
        for (int turn = 0; turn < 3; turn++) {
            double scale = turn == 2 ? 0.1 : ldexp(1, 40 * turn);
            to_double(a, scale, x);
            to_double(b, scale, y);
            const double(*p)[3] = (const double(*)[3])x, (*q)[3] = (const double(*)[3])y;
            if (turn < 2)
                assert_int_equal(pel_triangles_intersect(p, q), expected);
            assert_int_equal(pel_triangles_intersect(q, p), pel_triangles_intersect(p, q));
            whole first = a[0];
            a[0] = a[1];
            a[1] = a[2];
            a[2] = first;
        }
    }
    assert_true(meeting > trials / 5 && meeting < trials * 4 / 5);
}

/* neighbours: against the plain test with the shared corner or edge moved apart by a hair on both sides */
static void test_neighbours(void **unused)
{
    (void)unused;
    const double a[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    const double open_edge[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, -4, 0}};
    const double folded[3][3] = {{0, 0, 0}, {4, 0, 0}, {1, 1, 0}};
    const double hinge[3][3] = {{0, 0, 0}, {4, 0, 0}, {1, 1, 0x1p-1074}};
    const double corner_free[3][3] = {{0, 0, 0}, {-1, -1, 0}, {-1, 0, 3}};
    const double corner_through[3][3] = {{0, 0, 0}, {1, 1, -1}, {1, 1, 1}};
    const double corner_touch[3][3] = {{0, 0, 0}, {1, 1, 0}, {1, 1, 1}};
    const double line[3][3] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
    assert_false(pel_triangles_intersect_beyond(a, open_edge, 2));
    assert_true(pel_triangles_intersect_beyond(a, folded, 2));
    assert_false(pel_triangles_intersect_beyond(a, hinge, 2));
    assert_false(pel_triangles_intersect_beyond(a, corner_free, 1));
    assert_true(pel_triangles_intersect_beyond(a, corner_through, 1));
    assert_true(pel_triangles_intersect_beyond(corner_through, a, 1));
    assert_true(pel_triangles_intersect_beyond(a, corner_touch, 1));
    assert_true(pel_triangles_intersect_beyond(a, line, 1));
    assert_true(pel_triangles_intersect_beyond(a, a, 3));
    assert_true(pel_triangles_intersect_beyond(a, corner_free, 0));
    const double bad[3][3] = {{(double)NAN, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    assert_true(pel_triangles_intersect(a, bad));
}

/* one common corner at the origin: the rest is the other triangle cut off near the corner */
static void test_common_corner(void **unused)
{
    (void)unused;
    random_state random = {3};
    int meeting = 0;
    for (int trial = 0; trial < ROUNDS(20000, 2000); trial++) {
        whole a[3], b[3], cut[4], part[3];
        double x[3][3], y[3][3];
        random_triangle(&random, 3, false, a);
        random_triangle(&random, 3, false, b);
        a[0] = b[0] = (whole){{0, 0, 0}};
        whole na = cross(a[1], a[2]), nb = cross(b[1], b[2]), none = {{0, 0, 0}};
        if (memcmp(&na, &none, sizeof na) == 0 || memcmp(&nb, &none, sizeof nb) == 0)
            continue;
        /* b without the corner, in units of 1/64: a quadrilateral of two triangles */
        enum { UNIT = 64 };
        for (int k = 0; k < 3; k++) {
            cut[0].x[k] = b[1].x[k];
            cut[1].x[k] = UNIT * b[1].x[k];
            cut[2].x[k] = UNIT * b[2].x[k];
            cut[3].x[k] = b[2].x[k];
            for (int i = 0; i < 3; i++)
                part[i].x[k] = UNIT * a[i].x[k];
        }
        const whole halves[2][3] = {{cut[0], cut[1], cut[2]}, {cut[0], cut[2], cut[3]}};
        bool expected = oracle_intersect(part, halves[0]) || oracle_intersect(part, halves[1]);
        to_double(a, 1, x);
        to_double(b, 1, y);
        assert_int_equal(pel_triangles_intersect_beyond((const double(*)[3])x, (const double(*)[3])y, 1), expected);
        meeting += expected;
    }
    assert_true(meeting > ROUNDS(2000, 200));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_signs_on_integers), cmocka_unit_test(test_signs_at_the_limits),
        cmocka_unit_test(test_triangles),         cmocka_unit_test(test_neighbours),
        cmocka_unit_test(test_common_corner),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
