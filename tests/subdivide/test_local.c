#include "failing_malloc.h"
#include "sample.h"

#include "pellicle/mesh_check.h"
#include "pellicle/shape.h"
#include "subdivide/local.h"

/* edges near the pole of a unit sphere are at most this long */
static const double finest = 0.05;

static bool divides(const void *user, int32_t level, int32_t triangle, double edge, const double center[3])
{
    (void)level, (void)triangle;
    const double *pole = user;
    double d[3] = {center[0] - pole[0], center[1] - pole[1], center[2] - pole[2]};
    return edge > finest && edge > 0.5 * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static double pole[3]; /* a vertex of the sphere */
static const pel_local_def usual = {.divides = divides, .user = pole, .depth = 3, .memory_limit = (size_t)1 << 30};

static pel_mesh *create_sphere(void)
{
    pel_shape_def def;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_def_of_name("geodesic-sphere", &def, NULL), PEL_OK);
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    double *height = malloc((size_t)mesh->vertex_count * sizeof *height);
    assert_non_null(height);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        height[v] = mesh->positions[v][2];
    assert_int_equal(pel_mesh_add_field(mesh, "height", 1, height, NULL), PEL_OK);
    free(height);
    memcpy(pole, mesh->positions[0], sizeof pole);
    return mesh;
}

static double distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static void test_local(void **unused)
{
    (void)unused;
    pel_mesh *mesh = create_sphere(), *fine;
    assert_int_equal(pel_mesh_subdivide_locally(mesh, &usual, &fine, NULL), PEL_OK);
    /* vertices keep their numbers and places */
    assert_memory_equal(fine->positions, mesh->positions, (size_t)mesh->vertex_count * sizeof *mesh->positions);
    const pel_field *field = pel_mesh_field(fine, "height");
    double nearest = 1, farthest = 0;
    for (int32_t t = 0; t < fine->triangle_count; t++)
        for (int i = 0; i < 3; i++) {
            const double *a = fine->positions[fine->triangles[t][i]],
                         *b = fine->positions[fine->triangles[t][(i + 1) % 3]];
            double edge = distance(a, b);
            if (distance(a, pole) < 1e-9)
                farthest = fmax(farthest, edge);
            if (distance(a, pole) > 1)
                nearest = fmin(nearest, edge);
        }
    assert_true(farthest > 0 && farthest <= finest);
    assert_true(nearest > 0.15);
    assert_true(fine->triangle_count > mesh->triangle_count && fine->triangle_count < 4 * mesh->triangle_count);
    /* no slits, all on the sphere, fields like positions */
    pel_mesh_report *report;
    assert_int_equal(pel_mesh_check(fine, &report, NULL), PEL_OK);
    assert_true(report->closed && report->manifold && report->oriented);
    pel_mesh_report_destroy(report);
    for (int32_t v = 0; v < fine->vertex_count; v++) {
        assert_true(fabs(distance(fine->positions[v], (double[3]){0}) - 1) < 0.003);
        assert_true(fabs(field->values[v] - fine->positions[v][2]) < 1e-12);
    }
    pel_mesh_destroy(fine);
    pel_mesh_destroy(mesh);
}

static void test_memory_limit(void **unused)
{
    (void)unused;
    pel_mesh *mesh = create_sphere(), *fine;
    pel_local_def def = usual;
    def.memory_limit = 1;
    assert_int_equal(pel_mesh_subdivide_locally(mesh, &def, &fine, NULL), PEL_OK);
    assert_int_equal(fine->triangle_count, mesh->triangle_count);
    pel_mesh_destroy(fine);
    def.memory_limit = (size_t)400 << 10;
    assert_int_equal(pel_mesh_subdivide_locally(mesh, &def, &fine, NULL), PEL_OK);
    /* one level: edges of the base are from 0.2 to 0.3 long */
    assert_true(fine->triangle_count > mesh->triangle_count);
    for (int32_t t = 0; t < fine->triangle_count; t++)
        assert_true(distance(fine->positions[fine->triangles[t][0]], fine->positions[fine->triangles[t][1]]) > 0.09);
    pel_mesh_destroy(fine);
    pel_mesh_destroy(mesh);
}

/* flat: new vertices and their fields lie on the edges, and the area of the surface stays; three levels or none */
static void test_flat(void **unused)
{
    (void)unused;
    pel_mesh *mesh = create_sphere(), *fine;
    pel_mesh_report *coarse_report, *report;
    pel_error error;
    pel_local_def def = usual;
    def.is_flat = def.all_levels = true;
    assert_int_equal(pel_mesh_subdivide_locally(mesh, &def, &fine, NULL), PEL_OK);
    assert_int_equal(pel_mesh_check(mesh, &coarse_report, NULL), PEL_OK);
    assert_int_equal(pel_mesh_check(fine, &report, NULL), PEL_OK);
    assert_true(report->closed && report->manifold && report->oriented);
    assert_true(fine->triangle_count > mesh->triangle_count);
    assert_near(report->area, coarse_report->area, 1e-14 * coarse_report->area);
    const pel_field *field = pel_mesh_field(fine, "height");
    for (int32_t v = 0; v < fine->vertex_count; v++)
        assert_near(field->values[v], fine->positions[v][2], 1e-15);
    pel_mesh_report_destroy(coarse_report);
    pel_mesh_report_destroy(report);
    pel_mesh_destroy(fine);
    def.memory_limit = 1;
    assert_int_equal(pel_mesh_subdivide_locally(mesh, &def, &fine, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.remedy, "use 0 levels"));
    pel_mesh_destroy(mesh);
}

static pel_status refine_case(const void *mesh, pel_error *error)
{
    pel_mesh *fine;
    pel_status status = pel_mesh_subdivide_locally(mesh, &usual, &fine, error);
    assert_true((fine != NULL) == (status == PEL_OK));
    pel_mesh_destroy(fine);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    pel_mesh *mesh = create_sphere();
    for_every_allocation_failure(refine_case, mesh);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_local),
        cmocka_unit_test(test_memory_limit),
        cmocka_unit_test(test_flat),
        cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
