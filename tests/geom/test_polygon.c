#include "check.h"
#include "random.h"

#include "geom/polygon.h"

/* signed area in the plane z = 0 */
static double area(const double (*p)[3], const int32_t *t)
{
    return ((p[t[1]][0] - p[t[0]][0]) * (p[t[2]][1] - p[t[0]][1]) -
            (p[t[2]][0] - p[t[0]][0]) * (p[t[1]][1] - p[t[0]][1])) /
           2;
}

/* the triangles keep the winding and fill the polygon exactly: no triangle turned over, areas add up */
static void check_cut(const double (*positions)[3], int32_t count)
{
    int32_t corners[256] = {0}, triangles[256][3];
    double whole = 0, sum = 0;
    for (int32_t i = 0; i < count; i++)
        corners[i] = i;
    for (int32_t i = 0; i < count; i++) {
        const double *p = positions[i], *q = positions[(i + 1) % count];
        whole += (p[0] * q[1] - q[0] * p[1]) / 2;
    }
    pel_polygon_cut(positions, corners, count, triangles);
    for (int32_t t = 0; t < count - 2; t++) {
        for (int i = 0; i < 3; i++)
            assert_in_range(triangles[t][i], 0, count - 1);
        assert_true(area(positions, triangles[t]) > 0);
        sum += area(positions, triangles[t]);
    }
    assert_near(sum, whole, 1e-12 * whole);
}

static void test_convex_is_fanned(void **unused)
{
    (void)unused;
    const double square[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const int32_t corners[4] = {0, 1, 2, 3}, expected[2][3] = {{0, 1, 2}, {0, 2, 3}};
    int32_t triangles[2][3];
    pel_polygon_cut(square, corners, 4, triangles);
    assert_memory_equal(triangles, expected, sizeof expected);
}

/* the reflex corner in each of the four places */
static void test_concave_quads(void **unused)
{
    (void)unused;
    const double dart[4][3] = {{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {0.5, 1, 0}};
    for (int shift = 0; shift < 4; shift++) {
        double turned[4][3];
        for (int i = 0; i < 4; i++)
            memcpy(turned[i], dart[(i + shift) % 4], sizeof turned[i]);
        check_cut((const double(*)[3])turned, 4);
    }
}

/* stars with random radii: simple, mostly concave */
static void test_random_stars(void **unused)
{
    (void)unused;
    random_state random = {.seed = 7};
    for (int i = 0; i < 3000; i++) {
        double star[64][3];
        int32_t count = (int32_t)random_integer(&random, 4, 64);
        for (int32_t k = 0; k < count; k++) {
            double angle = 2 * 3.141592653589793 * k / count, radius = random_between(&random, 0.2, 2);
            star[k][0] = radius * cos(angle);
            star[k][1] = radius * sin(angle);
            star[k][2] = 0;
        }
        check_cut((const double(*)[3])star, count);
    }
}

/* anything else still gives count - 2 triangles of its own corners */
static void test_hopeless_polygons(void **unused)
{
    (void)unused;
    random_state random = {.seed = 8};
    for (int i = 0; i < 2000; i++) {
        double points[100][3];
        int32_t corners[100], triangles[98][3];
        int32_t count = (int32_t)random_integer(&random, 3, 100);
        for (int32_t k = 0; k < 100; k++) {
            for (int axis = 0; axis < 3; axis++)
                points[k][axis] = i % 3 == 0 ? 0 : i % 3 == 1 ? random_between(&random, -1, 1) : 1e300 * (k % 7);
            corners[k] = (int32_t)random_integer(&random, 0, 99);
        }
        memset(triangles, 0xff, sizeof triangles);
        pel_polygon_cut((const double(*)[3])points, corners, count, triangles);
        for (int32_t t = 0; t < count - 2; t++)
            for (int axis = 0; axis < 3; axis++)
                assert_in_range(triangles[t][axis], 0, 99);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_convex_is_fanned),
        cmocka_unit_test(test_concave_quads),
        cmocka_unit_test(test_random_stars),
        cmocka_unit_test(test_hopeless_polygons),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
