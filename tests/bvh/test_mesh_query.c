/* Points inside surfaces and near them, against sums of solid angles and the nearest of all triangles. */
#include "check.h"
#include "failing_malloc.h"
#include "random.h"

#include "bvh/mesh_query.h"
#include "math/vec3.h"
#include "pellicle/geometry.h"
#include "pellicle/shape.h"

#include <math.h>
#include <string.h>

static pel_mesh *make_shape(pel_shape_kind kind)
{
    pel_shape_def def = pel_shape_def_default(kind);
    pel_mesh *mesh;
    def.frequency = 4;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

static void turn(pel_mesh *mesh)
{
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        int32_t v = mesh->triangles[t][1];
        mesh->triangles[t][1] = mesh->triangles[t][2];
        mesh->triangles[t][2] = v;
    }
}

/* solid angle of all triangles over 4 pi */
static double winding_of(const pel_mesh *mesh, const double point[3])
{
    double sum = 0;
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        double x[3][3], n[3], l[3];
        for (int i = 0; i < 3; i++) {
            pel_vec3_subtract(mesh->positions[mesh->triangles[t][i]], point, x[i]);
            l[i] = pel_vec3_length(x[i]);
        }
        pel_vec3_cross(x[1], x[2], n);
        sum += atan2(pel_vec3_dot(x[0], n), l[0] * l[1] * l[2] + pel_vec3_dot(x[0], x[1]) * l[2] +
                                                pel_vec3_dot(x[1], x[2]) * l[0] + pel_vec3_dot(x[2], x[0]) * l[1]);
    }
    return sum / 6.283185307179586;
}

static double distance_of(const pel_mesh *mesh, const double point[3])
{
    double least = HUGE_VAL, weights[3];
    for (int32_t t = 0; t < mesh->triangle_count; t++)
        least = fmin(least, pel_closest_point_triangle(point, mesh->positions[mesh->triangles[t][0]],
                                                       mesh->positions[mesh->triangles[t][1]],
                                                       mesh->positions[mesh->triangles[t][2]], weights));
    return sqrt(least);
}

static void check_points(const pel_mesh *mesh, int32_t count)
{
    random_state random = {7};
    pel_mesh_query *query;
    assert_int_equal(pel_mesh_query_create(mesh, &query, NULL), PEL_OK);
    assert_true(pel_mesh_query_is_closed(query));
    int inside = 0;
    failing_malloc_begin(0);
    for (int32_t n = 0; n < count; n++) {
        double x[3];
        for (int k = 0; k < 3; k++)
            x[k] = random_between(&random, -1.5, 1.5);
        /* rays that meet vertices and edges */
        if (n % 4 == 1)
            memcpy(x + 1, mesh->positions[n % mesh->vertex_count] + 1, 2 * sizeof *x);
        if (n % 4 == 2)
            x[2] = mesh->positions[n % mesh->vertex_count][2];
        double distance = distance_of(mesh, x), reach = random_between(&random, 0, 0.5);
        if (distance < 1e-9 || fabs(distance - reach) < 1e-9)
            continue;
        int32_t truth = (int32_t)lrint(winding_of(mesh, x));
        assert_int_equal(pel_mesh_query_winding(query, x), truth);
        assert_int_equal(pel_mesh_query_reaches(query, x, reach), truth != 0 || distance < reach);
        double nearest[3];
        const bool is_near = pel_mesh_query_nearest(query, x, reach, nearest);
        assert_int_equal(is_near, distance < reach);
        if (is_near) {
            assert_near(pel_vec3_distance(nearest, x), distance, 1e-12);
            assert_near(distance_of(mesh, nearest), 0, 1e-7);
        }
        inside += truth != 0;
    }
    assert_int_equal(failing_malloc_end().calls, 0);
    assert_in_range(inside, count / 20, count);
    pel_mesh_query_destroy(query);
}

static void test_closed(void **unused)
{
    (void)unused;
    static const pel_shape_kind kinds[2] = {PEL_SHAPE_GEODESIC_SPHERE, PEL_SHAPE_TORUS};
    for (int k = 0; k < 2; k++) {
        pel_mesh *mesh = make_shape(kinds[k]);
        check_points(mesh, LONG(3000, 1500));
        turn(mesh);
        check_points(mesh, LONG(3000, 1500));
        pel_mesh_destroy(mesh);
    }
}

/* all of an open surface is near or not; a ball within a ball that is turned over is a hole */
static void test_open_and_hollow(void **unused)
{
    (void)unused;
    pel_mesh *ball = make_shape(PEL_SHAPE_GEODESIC_SPHERE), *open, *hollow;
    pel_mesh_query *query;
    const double centre[3] = {0.01, 0.02, 0.03}, wall[3] = {0, 0.02, 0.75};
    assert_int_equal(pel_mesh_create(ball->positions[0], ball->vertex_count, ball->triangles[0],
                                     ball->triangle_count - 1, &open, NULL),
                     PEL_OK);
    assert_int_equal(pel_mesh_query_create(open, &query, NULL), PEL_OK);
    assert_false(pel_mesh_query_is_closed(query));
    assert_false(pel_mesh_query_reaches(query, centre, 0.9));
    assert_true(pel_mesh_query_reaches(query, centre, 0.98));
    pel_mesh_query_destroy(query);
    double positions[2 * 162][3];
    int32_t triangles[2 * 320][3], n = ball->vertex_count, m = ball->triangle_count;
    assert_true(n <= 162 && m <= 320);
    for (int32_t v = 0; v < n; v++) {
        pel_vec3_copy(ball->positions[v], positions[v]);
        pel_vec3_scale(ball->positions[v], 0.5, positions[n + v]);
    }
    for (int32_t t = 0; t < m; t++)
        for (int i = 0; i < 3; i++) {
            triangles[t][i] = ball->triangles[t][i];
            triangles[m + t][i] = n + ball->triangles[t][2 - i];
        }
    assert_int_equal(pel_mesh_create(positions[0], 2 * n, triangles[0], 2 * m, &hollow, NULL), PEL_OK);
    assert_int_equal(pel_mesh_query_create(hollow, &query, NULL), PEL_OK);
    assert_int_equal(pel_mesh_query_winding(query, centre), 0);
    assert_int_equal(pel_mesh_query_winding(query, wall), 1);
    pel_mesh_query_destroy(query);
    pel_mesh_destroy(ball);
    pel_mesh_destroy(open);
    pel_mesh_destroy(hollow);
}

/* a cylinder along x: a trifle beyond its ends, within the rounding of their boxes, is outside */
static void test_beside_ends(void **unused)
{
    (void)unused;
    const double half = 0.65, trifle = 1e-10;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_CYLINDER);
    def.height = 2 * half;
    def.capped = true;
    pel_mesh *mesh;
    pel_mesh_query *query;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    for (int32_t v = 0; v < mesh->vertex_count; v++) {
        double *x = mesh->positions[v], z = x[2];
        x[2] = x[1];
        x[1] = x[0];
        x[0] = z;
    }
    assert_int_equal(pel_mesh_query_create(mesh, &query, NULL), PEL_OK);
    random_state random = {3};
    for (int n = 0; n < 100; n++) {
        double y = random_between(&random, -0.6, 0.6), z = random_between(&random, -0.6, 0.6);
        for (int end = -1; end <= 1; end += 2) {
            assert_int_equal(pel_mesh_query_winding(query, (const double[3]){end * (half + trifle), y, z}), 0);
            assert_int_equal(pel_mesh_query_winding(query, (const double[3]){end * (half - trifle), y, z}), 1);
        }
    }
    pel_mesh_query_destroy(query);
    pel_mesh_destroy(mesh);
}

static pel_status query_case(const void *data, pel_error *error)
{
    pel_mesh_query *query;
    pel_status status = pel_mesh_query_create(data, &query, error);
    assert_true((status == PEL_OK) == (query != NULL));
    pel_mesh_query_destroy(query);
    return status;
}

static void test_allocation(void **unused)
{
    (void)unused;
    pel_mesh *mesh = make_shape(PEL_SHAPE_GEODESIC_SPHERE);
    assert_true(for_every_allocation_failure(query_case, mesh) > 10);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_beside_ends),
        cmocka_unit_test(test_closed),
        cmocka_unit_test(test_open_and_hollow),
        cmocka_unit_test(test_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
