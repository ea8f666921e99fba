/* Surfaces of solids: closed, wound outward, and on the solid. */
#include "check.h"

#include "geom/solid_surface.h"
#include "pellicle/topology.h"

#include <stdlib.h>

static double volume_of(const double (*x)[3], const int32_t (*triangles)[3], int32_t count)
{
    double sum = 0;
    for (int32_t t = 0; t < count; t++) {
        const double *a = x[triangles[t][0]], *b = x[triangles[t][1]], *c = x[triangles[t][2]];
        sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return sum / 6;
}

/* volume of the solid, from below: corners of a round surface lie on it */
static void check_surface(const pel_solid *solid, double exact, double share)
{
    const pel_solid_surface size = pel_solid_surface_size(solid);
    double(*x)[3] = calloc((size_t)size.vertex_count, sizeof *x), normal[3];
    int32_t(*triangles)[3] = calloc((size_t)size.triangle_count, sizeof *triangles);
    pel_solid_surface_fill(solid, x, triangles);
    for (int32_t v = 0; v < size.vertex_count; v++)
        assert_near(pel_solid_distance(solid, x[v], normal), 0, 1e-15);
    pel_mesh *mesh;
    pel_topology *topology;
    assert_int_equal(pel_mesh_create(x[0], size.vertex_count, triangles[0], size.triangle_count, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_topology_create(mesh, &topology, NULL), PEL_OK);
    assert_int_equal(topology->boundary_edge_count, 0);
    double volume = volume_of((const double(*)[3])x, (const int32_t(*)[3])triangles, size.triangle_count);
    assert_true(volume <= exact * (1 + 1e-14) && volume >= share * exact);
    pel_topology_destroy(topology);
    pel_mesh_destroy(mesh);
    free(x);
    free(triangles);
}

static void test_surfaces(void **unused)
{
    (void)unused;
    const double pi = 3.14159265358979323846;
    const pel_solid ball = {.shape = PEL_TOOL_SPHERE, .radius = 0.5},
                    capsule = {.shape = PEL_TOOL_CAPSULE, .radius = 0.2, .half_length = 0.4},
                    box = {.shape = PEL_TOOL_BOX, .half_extents = {0.1, 0.2, 0.3}};
    check_surface(&ball, 4 * pi / 3 * 0.125, 0.97);
    check_surface(&capsule, 4 * pi / 3 * 0.008 + pi * 0.04 * 0.8, 0.97);
    check_surface(&box, 0.048, 1 - 1e-14);
}

/* every shape with a solid has a row without gaps */
static void test_rows(void **unused)
{
    (void)unused;
    for (int i = 0; i < PEL_TOOL_SHAPE_COUNT; i++) {
        const pel_solid_row *row = &pel_solid_rows[i];
        pel_tool_shape shape = PEL_TOOL_SUPPORT;
        assert_non_null(row->word);
        assert_int_equal(pel_solid_find(row->word, &shape), row->distance != NULL);
        assert_int_equal(shape, row->distance != NULL ? i : PEL_TOOL_SUPPORT);
        if (row->distance == NULL)
            continue;
        assert_true(row->depth != NULL && row->half_box != NULL);
        assert_true(row->has_radius || row->has_length || row->has_size || row->has_edge);
        assert_true(row->is_round ? row->has_radius : row->triangle_count > 3);
        assert_true(row->is_round || row->has_edge || row->separation != NULL);
        assert_true(row->corner_count <= PEL_SOLID_CORNERS);
    }
    assert_false(pel_solid_find("ball", &(pel_tool_shape){PEL_TOOL_BOX}));
}

/* a sphere has no length, whatever the def says; what is no solid counts as a sphere */
static void test_solid_of_a_tool(void **unused)
{
    (void)unused;
    for (int i = 0; i < PEL_TOOL_SHAPE_COUNT; i++) {
        const pel_tool_def def = {.shape = (pel_tool_shape)i, .radius = 2, .half_length = 3, .half_extents = {4, 5, 6}};
        const pel_solid solid = pel_solid_of(&def);
        assert_int_equal(solid.shape, pel_solid_rows[i].distance != NULL ? i : PEL_TOOL_SPHERE);
        assert_true(solid.radius == 2 && solid.half_extents[2] == 6);
        const pel_solid_row *row = &pel_solid_rows[i];
        assert_true(solid.half_length == (row->has_length ? 3 : 0));
        bool is_flat = row->distance != NULL && !row->is_round;
        assert_int_equal(pel_solid_is_ball(&solid), !is_flat && !row->has_length);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_surfaces),
        cmocka_unit_test(test_rows),
        cmocka_unit_test(test_solid_of_a_tool),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
