/* Curvatures against closed forms, with the order in which the error falls with the edge length.

   Theory of these measures, as asserted here: on meshes whose vertices have six regular triangles (the torus) both
   converge in every vertex with order 2; the twelve vertices of five triangles of a geodesic sphere keep an error in
   the ellipsoid, so that its mean error is of order 1; with vertices in random places single values do not converge (Xu
   2004; Borrelli, Cazals, Morvan 2003), but integrals over the surface do, with order 2. */
#include "closed_form.h"

static double order(double coarse, double fine)
{
    return log2(coarse / fine);
}

static void test_sphere(void **unused)
{
    (void)unused;
    curved_mesh coarse = make_sphere(16, 2), fine = make_sphere(32, 2);
    curvature_error before = curvature_error_of(&coarse, sphere_curvature);
    curvature_error after = curvature_error_of(&fine, sphere_curvature);
    assert_true(after.mean_largest < 1e-7 && after.gaussian_largest < 1e-4);
    assert_true(order(before.mean_largest, after.mean_largest) > 3.5);
    assert_near(order(before.gaussian_largest, after.gaussian_largest), 2, 0.1);
    assert_near(order(before.gaussian_square, after.gaussian_square), 2, 0.1);
    destroy_mesh(&coarse);
    destroy_mesh(&fine);
}

static void test_torus(void **unused)
{
    (void)unused;
    curved_mesh coarse = make_torus(32), fine = make_torus(64);
    curvature_error before = curvature_error_of(&coarse, torus_curvature);
    curvature_error after = curvature_error_of(&fine, torus_curvature);
    assert_true(after.mean_largest < 1e-3 && after.gaussian_largest < 5e-3);
    assert_near(order(before.mean_largest, after.mean_largest), 2, 0.1);
    assert_near(order(before.mean_square, after.mean_square), 2, 0.1);
    assert_near(order(before.gaussian_largest, after.gaussian_largest), 2, 0.1);
    assert_near(order(before.gaussian_square, after.gaussian_square), 2, 0.1);
    destroy_mesh(&coarse);
    destroy_mesh(&fine);
}

static void test_ellipsoid(void **unused)
{
    (void)unused;
    curved_mesh coarse = make_ellipsoid(32), fine = make_ellipsoid(64);
    curvature_error before = curvature_error_of(&coarse, ellipsoid_curvature);
    curvature_error after = curvature_error_of(&fine, ellipsoid_curvature);
    assert_true(after.mean_largest < 0.04 && after.mean_square < 3e-4);
    assert_true(after.gaussian_largest < 0.04 && after.gaussian_square < 4e-4);
    assert_true(order(before.mean_square, after.mean_square) > 1);
    assert_true(order(before.gaussian_square, after.gaussian_square) > 1);
    destroy_mesh(&coarse);
    destroy_mesh(&fine);
}

/* any smooth weight on the surface */
static double weight(const double x[3])
{
    return 1 + x[0] * x[1] + x[2] * x[2] * x[2];
}

/* integrals of weighted curvatures over the ellipsoid by the midpoint rule: error about 1e-7 */
static curvature exact_integral(void)
{
    enum { ROWS = 1500, COLUMNS = 100 };
    double product = half_axes[0] * half_axes[1] * half_axes[2];
    curvature sum = {0, 0};
    for (int i = 0; i < ROWS; i++)
        for (int j = 0; j < COLUMNS; j++) {
            double z = -1 + (2 * i + 1.0) / ROWS, radius = sqrt(1 - z * z), turn = 2 * pi * j / COLUMNS;
            double unit[3] = {radius * cos(turn), radius * sin(turn), z}, x[3], s = 0;
            for (int c = 0; c < 3; c++) {
                x[c] = half_axes[c] * unit[c];
                s += unit[c] * unit[c] / (half_axes[c] * half_axes[c]);
            }
            double area = product * sqrt(s) * 2 / ROWS * 2 * pi / COLUMNS;
            curvature here = ellipsoid_curvature(x);
            sum.mean += weight(x) * here.mean * area;
            sum.gaussian += weight(x) * here.gaussian * area;
        }
    return sum;
}

static curvature integral_error(int32_t frequency, curvature exact)
{
    curved_mesh curved = make_irregular(frequency);
    for (int32_t v = 0; v < curved.mesh->vertex_count; v++) {
        pel_vertex_measure measure;
        pel_vertex_measure_fill(curved.topology, curved.positions, v, &measure);
        exact.mean -= weight(curved.mesh->positions[v]) * measure.mean_curvature * measure.area;
        exact.gaussian -= weight(curved.mesh->positions[v]) * measure.angle_defect;
    }
    destroy_mesh(&curved);
    return (curvature){fabs(exact.mean), fabs(exact.gaussian)};
}

static void test_irregular(void **unused)
{
    (void)unused;
    curvature exact = exact_integral();
    curvature before = integral_error(16, exact), after = integral_error(64, exact);
    assert_true(after.mean < 2e-3 && after.gaussian < 2e-3);
    /* over two halvings of the edges, with chance in the meshes */
    assert_true(order(before.mean, after.mean) / 2 > 1.7);
    assert_true(order(before.gaussian, after.gaussian) / 2 > 1.7);

    /* single values keep an error of some percent */
    curved_mesh curved = make_irregular(64);
    curvature_error error = curvature_error_of(&curved, ellipsoid_curvature);
    assert_true(error.mean_square < 0.05 && error.gaussian_square < 0.05);
    destroy_mesh(&curved);
}

/* integral of the mean curvature: 4 pi r, 2 pi^2 R */
static void test_integral_of_mean_curvature(void **unused)
{
    (void)unused;
    pel_curvature_summary summary;
    curved_mesh sphere = make_sphere(40, 0.5), torus = make_torus(80);
    pel_surface_curvature_summary(sphere.topology, sphere.positions, &summary);
    /* area over radius, with the area of the triangles */
    assert_near(summary.mean_curvature_integral, summary.area / 0.5, 1e-5);
    assert_near(summary.mean_curvature_integral, 4 * pi * 0.5, 2e-3);
    assert_near(summary.mean_curvature_mean, 2, 1e-4);
    pel_surface_curvature_summary(torus.topology, torus.positions, &summary);
    assert_near(summary.mean_curvature_integral, 2 * pi * pi * torus_major, 1e-2);
    destroy_mesh(&sphere);
    destroy_mesh(&torus);
}

/* half of edge length times exterior angle, summed over the edges: the exact integral for a polyhedron (Steiner) */
static double edge_integral(const curved_mesh *curved)
{
    double sum = 0;
    for (int32_t e = 0; e < curved->topology->edge_count; e++) {
        int32_t h[2] = {curved->topology->half_edge_of_edge[e], 0};
        h[1] = curved->topology->twin[h[0]];
        double n[2][3], u[3], length = 0, sine = 0, cosine = 0;
        for (int side = 0; side < 2; side++) {
            const int32_t *t = curved->mesh->triangles[h[side] / 3];
            double(*x)[3] = curved->mesh->positions, p[3], q[3];
            for (int c = 0; c < 3; c++) {
                p[c] = x[t[1]][c] - x[t[0]][c];
                q[c] = x[t[2]][c] - x[t[0]][c];
            }
            for (int c = 0; c < 3; c++)
                n[side][c] = p[(c + 1) % 3] * q[(c + 2) % 3] - p[(c + 2) % 3] * q[(c + 1) % 3];
        }
        for (int c = 0; c < 3; c++) {
            u[c] = curved->mesh->positions[pel_half_edge_target(curved->topology, h[0])][c] -
                   curved->mesh->positions[pel_half_edge_origin(curved->topology, h[0])][c];
            length += u[c] * u[c];
            cosine += n[0][c] * n[1][c];
        }
        length = sqrt(length);
        for (int c = 0; c < 3; c++)
            sine += u[c] / length * (n[0][(c + 1) % 3] * n[1][(c + 2) % 3] - n[0][(c + 2) % 3] * n[1][(c + 1) % 3]);
        sum += length * atan2(sine, cosine) / 2;
    }
    return sum;
}

static void test_against_dihedral_angles(void **unused)
{
    (void)unused;
    curved_mesh curved[2] = {make_irregular(32), make_torus(48)};
    for (int i = 0; i < 2; i++) {
        pel_curvature_summary summary;
        pel_surface_curvature_summary(curved[i].topology, curved[i].positions, &summary);
        assert_near(summary.mean_curvature_integral / edge_integral(&curved[i]), 1, 3e-3);
        destroy_mesh(&curved[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),
        cmocka_unit_test(test_torus),
        cmocka_unit_test(test_ellipsoid),
        cmocka_unit_test(test_irregular),
        cmocka_unit_test(test_integral_of_mean_curvature),
        cmocka_unit_test(test_against_dihedral_angles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
