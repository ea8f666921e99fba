/* Bisection of tetrahedra: whole meshes with edges as short as wanted where they are wanted, and not elsewhere. */
#include "check.h"
#include "failing_malloc.h"

#include "math/vec3.h"
#include "pellicle/measure.h"
#include "pellicle/shape.h"
#include "pellicle/topology.h"
#include "pellicle/volume.h"
#include "tetra/bisect.h"

#include <float.h>

#define EDGE 0.25
#define FINE 0.06
#define GRADE 0.5

/* FINE at the top of a unit ball, and longer with the distance from there */
static double wanted(void *user, const double center[3])
{
    (void)user;
    return fmax(FINE, GRADE * hypot(hypot(center[0], center[1]), center[2] - 1));
}

static double anything(void *user, const double center[3])
{
    (void)user, (void)center;
    return DBL_MAX;
}

static pel_mesh *make_ball(int32_t frequency)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = frequency;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return mesh;
}

static pel_mesh *fill(const pel_mesh *surface)
{
    pel_mesh *filled;
    assert_int_equal(pel_mesh_fill(surface, EDGE, &filled, NULL), PEL_OK);
    return filled;
}

static pel_mesh *bisect(const pel_mesh *filled, const pel_bisect_def *def)
{
    pel_mesh *finer;
    assert_int_equal(pel_mesh_bisect(filled, def, &finer, NULL), PEL_OK);
    return finer;
}

static double volume_of(const pel_mesh *mesh)
{
    return pel_surface_volume(mesh->positions[0], mesh->triangles[0], mesh->triangle_count, NULL);
}

/* sine of the smallest angle between a face of a tetrahedron and an edge that meets it: volume over base and edge */
static double flatness(const double x[4][3], double volume)
{
    double least = 1;
    for (int i = 0; i < 4; i++) {
        double normal[3], longest = 0;
        pel_vec3_triangle_normal(x[(i + 1) % 4], x[(i + 2) % 4], x[(i + 3) % 4], normal);
        for (int k = 1; k < 4; k++)
            longest = fmax(longest, pel_vec3_distance(x[i], x[(i + k) % 4]));
        least = fmin(least, 6 * volume / pel_vec3_length(normal) / longest);
    }
    return least;
}

typedef struct figures {
    double volume, longest, flatness; /* longest: edge over what is wanted */
} figures;

/* faces fit: the tetrahedra fill what is inside of a closed surface */
static figures check_whole(const pel_mesh *mesh)
{
    figures found = {.flatness = 1};
    for (int32_t t = 0; t < mesh->tetrahedron_count; t++) {
        double x[4][3], center[3] = {0};
        for (int k = 0; k < 4; k++) {
            pel_vec3_copy(mesh->positions[mesh->tetrahedra[t][k]], x[k]);
            pel_vec3_along(center, 0.25, x[k], center);
        }
        const double volume = pel_tetrahedron_volume((const double(*)[3])x);
        assert_true(volume > 0);
        found.volume += volume;
        found.flatness = fmin(found.flatness, flatness((const double(*)[3])x, volume));
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < i; j++)
                found.longest = fmax(found.longest, pel_vec3_distance(x[i], x[j]) / wanted(NULL, center));
    }
    pel_topology *topology;
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    assert_int_equal(topology->boundary_edge_count, 0);
    pel_topology_destroy(topology);
    assert_near(volume_of(mesh), found.volume, 1e-12 * found.volume);
    return found;
}

static void short_where_wanted(void **state)
{
    (void)state;
    pel_mesh *ball = make_ball(30), *filled = fill(ball);
    const pel_bisect_def def = {wanted, NULL, ball, INT32_MAX};
    pel_mesh *finer = bisect(filled, &def);
    const figures before = check_whole(filled), after = check_whole(finer);
    assert_true(before.longest > 3 && after.longest <= 1 + 1e-12);
    assert_true(after.flatness > 0.3 * before.flatness);
    /* few tetrahedra: eight times as many for each halving everywhere would be 64 */
    assert_in_range(finer->tetrahedron_count, 2 * filled->tetrahedron_count, 12 * filled->tetrahedron_count);
    /* new vertices of the surface lie on the ball, so that it is filled better */
    assert_true(after.volume > before.volume + 0.001 && after.volume < 4.1888);
    for (int32_t t = 0; t < finer->triangle_count; t++)
        for (int k = 0; k < 3; k++)
            assert_near(pel_vec3_length(finer->positions[finer->triangles[t][k]]), 1, 2e-3);
    pel_mesh_destroy(finer);
    /* without a surface all stays where it was, and again gives the same */
    pel_mesh *flat = bisect(filled, &(pel_bisect_def){wanted, NULL, NULL, INT32_MAX});
    assert_near(check_whole(flat).volume, before.volume, 1e-12);
    pel_mesh *again = bisect(flat, &(pel_bisect_def){wanted, NULL, NULL, INT32_MAX});
    assert_int_equal(again->tetrahedron_count, flat->tetrahedron_count);
    pel_mesh_destroy(again);
    pel_mesh_destroy(flat);
    pel_mesh_destroy(filled);
    pel_mesh_destroy(ball);
}

static void nothing_and_not_all(void **state)
{
    (void)state;
    pel_mesh *ball = make_ball(6), *filled = fill(ball);
    pel_mesh *same = bisect(filled, &(pel_bisect_def){anything, NULL, ball, INT32_MAX});
    assert_int_equal(same->tetrahedron_count, filled->tetrahedron_count);
    assert_memory_equal(same->positions, filled->positions, (size_t)filled->vertex_count * sizeof *filled->positions);
    pel_mesh_destroy(same);
    /* what stops early is whole, too */
    const int32_t most = filled->tetrahedron_count + 500;
    pel_mesh *stopped = bisect(filled, &(pel_bisect_def){wanted, NULL, ball, most});
    assert_in_range(stopped->tetrahedron_count, most, most + 50);
    check_whole(stopped);
    pel_mesh_destroy(stopped);
    pel_mesh_destroy(filled);
    pel_mesh_destroy(ball);
}

static pel_status bisect_case(const void *data, pel_error *error)
{
    pel_mesh *finer;
    const pel_bisect_def def = {wanted, NULL, data, ((const pel_mesh *)data)->tetrahedron_count + 30};
    pel_status status = pel_mesh_bisect(data, &def, &finer, error);
    assert_true((status == PEL_OK) == (finer != NULL));
    pel_mesh_destroy(finer);
    return status;
}

static void memory_runs_out(void **state)
{
    (void)state;
    pel_mesh *ball = make_ball(3), *filled = fill(ball);
    assert_true(for_every_allocation_failure(bisect_case, filled) > 10);
    pel_mesh_destroy(filled);
    pel_mesh_destroy(ball);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(short_where_wanted),
        cmocka_unit_test(nothing_and_not_all),
        cmocka_unit_test(memory_runs_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
