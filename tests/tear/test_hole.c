/* The numbers of a hole against closed forms: circles and ellipses around any place, parts of them, and places farther
   out. */
#include "check.h"

#include "tear/hole.h"

#include <math.h>

#define PI 3.14159265358979323846

/* m, from the origin to an ellipse around (x, y) with half axes along x and y */
static double radius_of(double x, double y, double a, double b, double angle)
{
    double c = cos(angle) / a, s = sin(angle) / b, u = x / a, v = y / b;
    double along = c * u + s * v, square = c * c + s * s;
    return (along + sqrt(along * along - square * (u * u + v * v - 1))) / square;
}

static pel_hole_reading hole_of(double x, double y, double a, double b)
{
    pel_hole_reading hole = {.aim = 1};
    for (int k = 0; k < PEL_HOLE_SECTORS; k++)
        hole.radius[k] = radius_of(x, y, a, b, 2 * PI * (k + 0.5) / PEL_HOLE_SECTORS);
    return hole;
}

/* sums over equal sectors of smooth periodic functions are exact but for the smallest and largest distance, which lie
   within half a sector */
static void test_whole(void **unused)
{
    (void)unused;
    static const double cases[][4] = {{0, 0, 1, 1},      {0.1, 0, 1, 1}, {0, -0.2, 1.1, 1.1}, {0.1, 0.2, 1, 1},
                                      {-0.2, 0.1, 1, 1}, {0, 0, 1, 0.8}, {0.05, -0.1, 0.9, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double *c = cases[i];
        pel_hole_reading hole = hole_of(c[0], c[1], c[2], c[3]);
        pel_hole_measure(&hole);
        assert_near(hole.swept, 2 * PI, 1e-12);
        assert_near(hole.diameter, 2 * sqrt(c[2] * c[3]), 1e-9);
        assert_near(hole.offset, hypot(c[0], c[1]), 1e-9);
        assert_near(hole.roundness, fmin(c[2], c[3]) / fmax(c[2], c[3]), 1e-3);
        double largest = 0;
        for (int k = 0; k < PEL_HOLE_SECTORS; k++)
            largest = fmax(largest, hole.radius[k]);
        assert_near(hole.largest, largest, 0);
    }
}

/* of open sectors alone, wherever they are */
static void test_parts(void **unused)
{
    (void)unused;
    for (int first = 0; first < PEL_HOLE_SECTORS; first++)
        for (int count = 0; count < PEL_HOLE_SECTORS; count += 7) {
            pel_hole_reading hole = {.aim = 1};
            double sum = 0;
            for (int k = 0; k < count; k++)
                sum += hole.radius[(first + k) % PEL_HOLE_SECTORS] = 0.9 + 0.001 * k;
            pel_hole_measure(&hole);
            assert_near(hole.swept, 2 * PI * count / PEL_HOLE_SECTORS, 1e-12);
            assert_near(hole.diameter, count > 0 ? 2 * sum / count : 0, 1e-12);
            assert_near(hole.largest, count > 0 ? 0.9 + 0.001 * (count - 1) : 0, 1e-15);
            assert_true(isnan(hole.offset) && isnan(hole.roundness));
            assert_int_equal(hole.run_out_count, 0);
        }
}

/* places beyond 1.15 times the aim, of which neighbours are one, also over the end of the list */
static void test_run_outs(void **unused)
{
    (void)unused;
    for (int first = 0; first < PEL_HOLE_SECTORS; first++)
        for (int width = 0; width <= PEL_HOLE_SECTORS / 3; width += 5) {
            pel_hole_reading hole = {.aim = 2};
            for (int k = 0; k < PEL_HOLE_SECTORS; k++)
                hole.radius[k] = 2.3;
            for (int k = 0; k < width; k++)
                hole.radius[(first + k) % PEL_HOLE_SECTORS] =
                    hole.radius[(first + k + PEL_HOLE_SECTORS / 2) % PEL_HOLE_SECTORS] = nextafter(2.3, 3);
            pel_hole_measure(&hole);
            assert_int_equal(hole.run_out_count, width > 0 ? 2 : 0);
        }
    pel_hole_reading hole = hole_of(0, 0, 1.2, 1.2);
    pel_hole_measure(&hole);
    assert_int_equal(hole.run_out_count, 1);
    hole = hole_of(0, 0, 1.14, 1.14);
    pel_hole_measure(&hole);
    assert_int_equal(hole.run_out_count, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_whole), cmocka_unit_test(test_parts),
                                       cmocka_unit_test(test_run_outs)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
