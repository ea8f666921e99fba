#include "check.h"

#include "failing_malloc.h"
#include "pellicle/mesh_check.h"
#include "pellicle/shape.h"
#include "pellicle/topology.h"
#include "random.h"

#include <math.h>
#include <stdlib.h>

static pel_mesh *make_sphere(int32_t frequency)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    pel_mesh *mesh;
    def.frequency = frequency;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

/* a copy without the triangles whose centre is beyond `limit` along the axis */
static pel_mesh *cut_cap(const pel_mesh *mesh, int axis, double limit)
{
    int32_t(*kept)[3] = calloc((size_t)mesh->triangle_count, sizeof *kept), count = 0;
    pel_mesh *made, *clean;
    assert_non_null(kept);
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double centre = 0;
        for (int i = 0; i < 3; i++)
            centre += mesh->positions[mesh->triangles[t][i]][axis] / 3;
        if (centre <= limit)
            memcpy(kept[count++], mesh->triangles[t], sizeof *kept);
    }
    assert_int_equal(pel_mesh_create(mesh->positions[0], mesh->vertex_count, kept[0], count, &made, NULL), PEL_OK);
    assert_int_equal(pel_mesh_repair(made, NULL, &clean, NULL, NULL), PEL_OK);
    pel_mesh_destroy(made);
    free(kept);
    return clean;
}

static pel_mesh_report *report_of(const pel_mesh *mesh)
{
    pel_mesh_report *report;
    assert_int_equal(pel_mesh_check(mesh, &report, NULL), PEL_OK);
    return report;
}

/* a cap of a sphere is replaced by a nearly flat lid: the volume is that of the rest, and the winding goes on */
static void test_caps(void **unused)
{
    (void)unused;
    /* rims below and above the limit of direct triangulation */
    const int32_t frequencies[3] = {4, 12, 60};
    for (int i = 0; i < 3; i++) {
        pel_mesh *sphere = make_sphere(frequencies[i]), *open = cut_cap(sphere, 2, 0.5), *filled;
        pel_fill_summary summary;
        assert_int_equal(pel_mesh_fill_holes(open, 10000, &filled, &summary, NULL), PEL_OK);
        assert_int_equal(summary.filled_holes, 1);
        assert_int_equal(summary.left_holes, 0);
        assert_int_equal(summary.triangles, filled->triangle_count - open->triangle_count);
        assert_memory_equal(filled->triangles, open->triangles, (size_t)open->triangle_count * sizeof *open->triangles);
        pel_mesh_report *report = report_of(filled);
        assert_true(report->closed && report->oriented && report->manifold);
        assert_int_equal(report->genus, 0);
        assert_int_equal(report->error_count, 0);
        assert_int_equal(report->issues[PEL_ISSUE_INSIDE_OUT].count, 0);
        assert_true(summary.quality_min > 0);
        /* a ball less a cap of height 1/2 has 27/32 of its volume; the mesh lies inside and its rim is a zigzag */
        double expected = 4.0 / 3 * 3.14159265358979 * 27 / 32, coarse = 1.5 / frequencies[i];
        assert_true(fabs(report->volume / expected - 1) < coarse);
        pel_mesh_report_destroy(report);
        pel_mesh_destroy(filled);
        pel_mesh_destroy(open);
        pel_mesh_destroy(sphere);
    }
}

/* a concave polygon in the plane is filled within itself: the area is that of the polygon */
static void test_concave_rim(void **unused)
{
    (void)unused;
    /* an L of six corners, as the missing top of a box with walls and a floor */
    enum { N = 6 };
    const double outline[N][2] = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
    double positions[2 * N][3];
    int32_t triangles[2 * N + 4][3] = {{0, 0, 0}}, count = 0;
    for (int i = 0; i < N; i++)
        for (int k = 0; k < 2; k++) {
            positions[k * N + i][0] = outline[i][0];
            positions[k * N + i][1] = outline[i][1];
            positions[k * N + i][2] = k;
        }
    for (int i = 0; i < N; i++) {
        int32_t a = i, b = (i + 1) % N, walls[2][3] = {{a, b, N + b}, {a, N + b, N + a}};
        memcpy(triangles[count], walls, sizeof walls);
        count += 2;
    }
    const int32_t floors[4][3] = {{0, 3, 1}, {1, 3, 2}, {0, 4, 3}, {0, 5, 4}};
    memcpy(triangles[count], floors, sizeof floors);
    count += 4;
    pel_mesh *mesh, *filled;
    assert_int_equal(pel_mesh_create(positions[0], 2 * N, triangles[0], count, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_mesh_fill_holes(mesh, 100, &filled, NULL, NULL), PEL_OK);
    pel_mesh_report *report = report_of(filled);
    assert_true(report->closed && report->oriented);
    assert_true(fabs(report->volume - 3) < 1e-12);
    assert_true(fabs(report->area - (2 * 3 + 8)) < 1e-12);
    pel_mesh_report_destroy(report);
    pel_mesh_destroy(filled);
    pel_mesh_destroy(mesh);
}

/* a long rim like an eight, two vertices of which are at the same place: no chord joins them, and no triangle is flat
 */
static void test_pinched_rim(void **unused)
{
    (void)unused;
    enum { N = 200 };
    const double pi = 3.14159265358979323846;
    double positions[2 * N][3];
    int32_t triangles[2 * N][3];
    for (int i = 0; i < N; i++) {
        const double angle = 2 * pi * i / N, radius = i % (N / 2) == 0 ? 0 : fabs(sin(angle));
        for (int k = 0; k < 2; k++) {
            positions[k * N + i][0] = (radius + k) * cos(angle);
            positions[k * N + i][1] = (radius + k) * sin(angle);
            positions[k * N + i][2] = -k;
        }
        const int32_t a = i, b = (i + 1) % N, wall[2][3] = {{a, N + b, b}, {a, N + a, N + b}};
        memcpy(triangles[2 * i], wall, sizeof wall);
    }
    pel_mesh *mesh, *filled;
    pel_fill_summary summary;
    assert_int_equal(pel_mesh_create(positions[0], 2 * N, triangles[0], 2 * N, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_mesh_fill_holes(mesh, 1000, &filled, &summary, NULL), PEL_OK);
    assert_int_equal(summary.filled_holes, 2);
    for (int32_t t = mesh->triangle_count; t < filled->triangle_count; t++) {
        bool has[2] = {false, false};
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 2; k++)
                has[k] |= filled->triangles[t][c] == k * N / 2;
        assert_false(has[0] && has[1]);
    }
    assert_true(summary.quality_min > 0);
    pel_mesh_destroy(filled);
    pel_mesh_destroy(mesh);
}

/* rims beyond the limit stay, and the rim of a single triangle encloses nothing */
static void test_left_holes(void **unused)
{
    (void)unused;
    pel_mesh *sphere = make_sphere(6), *open = cut_cap(sphere, 0, 0.2), *filled;
    pel_fill_summary summary;
    assert_int_equal(pel_mesh_fill_holes(open, 5, &filled, &summary, NULL), PEL_OK);
    assert_int_equal(summary.filled_holes, 0);
    assert_int_equal(summary.left_holes, 1);
    assert_int_equal(filled->triangle_count, open->triangle_count);
    pel_mesh_destroy(filled);
    pel_mesh_destroy(open);
    pel_mesh_destroy(sphere);
    double positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    int32_t triangle[3] = {0, 1, 2};
    pel_mesh *lone;
    assert_int_equal(pel_mesh_create(positions, 3, triangle, 1, &lone, NULL), PEL_OK);
    assert_int_equal(pel_mesh_fill_holes(lone, 100, &filled, &summary, NULL), PEL_OK);
    assert_int_equal(summary.left_holes, 1);
    assert_int_equal(filled->triangle_count, 1);
    pel_mesh_destroy(filled);
    pel_mesh_destroy(lone);
}

/* triangles taken at random out of a sphere: the filled mesh is a manifold, and fields are kept */
static void test_random_holes(void **unused)
{
    (void)unused;
    random_state random = {11};
    for (int round = 0; round < 60; round++) {
        pel_mesh *sphere = make_sphere(4 + round % 5), *clean, *filled;
        int32_t kept = 0;
        for (int32_t t = 0; t < sphere->triangle_count; t++)
            if (random_bits(&random) % 8 != 0)
                memmove(sphere->triangles[kept++], sphere->triangles[t], sizeof *sphere->triangles);
        sphere->triangle_count = kept;
        double *values = calloc((size_t)sphere->vertex_count, sizeof *values);
        for (int32_t v = 0; v < sphere->vertex_count; v++)
            values[v] = sphere->positions[v][0];
        assert_int_equal(pel_mesh_add_field(sphere, "x", 1, values, NULL), PEL_OK);
        free(values);
        assert_int_equal(pel_mesh_repair(sphere, NULL, &clean, NULL, NULL), PEL_OK);
        pel_fill_summary summary;
        assert_int_equal(pel_mesh_fill_holes(clean, 1000, &filled, &summary, NULL), PEL_OK);
        assert_true(summary.filled_holes > 0);
        pel_topology *topology;
        assert_int_equal(pel_topology_create(filled, &topology, NULL), PEL_OK);
        assert_true(topology->boundary_edge_count == 0 || summary.left_holes > 0);
        pel_topology_destroy(topology);
        const pel_field *field = pel_mesh_field(filled, "x");
        for (int32_t v = 0; v < filled->vertex_count; v++)
            assert_true(field->values[v] == filled->positions[v][0]);
        pel_mesh_destroy(filled);
        pel_mesh_destroy(clean);
        pel_mesh_destroy(sphere);
    }
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_mesh *sphere = make_sphere(2), *filled = sphere;
    pel_error error;
    assert_int_equal(pel_mesh_fill_holes(NULL, 10, &filled, NULL, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_mesh_fill_holes(sphere, 10, NULL, NULL, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_mesh_fill_holes(sphere, 2, &filled, NULL, &error), PEL_BAD_ARGUMENT);
    memcpy(sphere->triangles[0], sphere->triangles[1], sizeof *sphere->triangles);
    assert_int_equal(pel_mesh_fill_holes(sphere, 10, &filled, NULL, &error), PEL_BAD_MESH);
    assert_null(filled);
    pel_mesh_destroy(sphere);
}

static pel_status fill_once(const void *context, pel_error *error)
{
    pel_mesh *filled;
    pel_status status = pel_mesh_fill_holes(context, 10000, &filled, NULL, error);
    pel_mesh_destroy(filled);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    pel_mesh *sphere = make_sphere(40), *open = cut_cap(sphere, 2, 0.3);
    assert_true(for_every_allocation_failure(fill_once, open) > 10);
    pel_mesh_destroy(open);
    pel_mesh_destroy(sphere);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_caps),
        cmocka_unit_test(test_concave_rim),
        cmocka_unit_test(test_pinched_rim),
        cmocka_unit_test(test_left_holes),
        cmocka_unit_test(test_random_holes),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
