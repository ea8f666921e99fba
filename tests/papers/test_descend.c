/* Gradient descent on E_S: no force, no motion; a prediction without iterations; iterations take the stretch back. */
#include "check.h"

#include "papers/b/descend.h"

#include <pellicle/measure.h>
#include <pellicle/shape.h>

#include <math.h>

enum { VERTICES = 92 };

/* mean distance from the middle and area over those at rest, after two frames */
static void run(double pressure, double wanted, int *iterations, double *radius, double *area)
{
    pel_error error;
    pel_mesh *ball;
    pel_shape_def shape = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    const double energies[3] = {0, wanted, wanted};
    double x[VERTICES][3];
    shape.frequency = 3;
    assert_int_equal(pel_shape_create(&shape, &ball, &error), PEL_OK);
    assert_int_equal(ball->vertex_count, VERTICES);
    const b_descent def = {.young = 1e5,
                           .poisson = 0.3,
                           .density = 1000,
                           .thickness = 0.01,
                           .pressure = pressure,
                           .dt = 1.0 / 60,
                           .frames = 2,
                           .energies = energies,
                           .most = 2000};
    assert_int_equal(b_descend(ball, &def, x, iterations, &error), PEL_OK);
    *radius = 0;
    for (int v = 0; v < VERTICES; v++)
        *radius += sqrt(x[v][0] * x[v][0] + x[v][1] * x[v][1] + x[v][2] * x[v][2]) / VERTICES;
    *area = pel_surface_area(x[0], ball->triangles[0], ball->triangle_count) /
            pel_surface_area(ball->positions[0], ball->triangles[0], ball->triangle_count);
    pel_mesh_destroy(ball);
}

static void test_descent(void **unused)
{
    (void)unused;
    int iterations;
    double radius, area, predicted;
    run(0, 1e-20, &iterations, &radius, &area);
    assert_int_equal(iterations, 0);
    assert_near(radius, 1, 1e-12);
    /* two steps of the acceleration p / (rho h) inward: 3 p dt^2 / (rho h) */
    run(100, (double)HUGE_VAL, &iterations, &predicted, &area);
    assert_int_equal(iterations, 0);
    assert_near(1 - predicted, 3 * 100 / (10.0 * 3600), 5e-4);
    /* 96 iterations; a wrong gradient takes some hundred */
    run(100, 1e-6, &iterations, &radius, &area);
    assert_true(iterations > 4 && iterations < 150);
    assert_true(1 - radius < 0.05 * (1 - predicted));
    assert_near(area, 1, 1e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_descent)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
