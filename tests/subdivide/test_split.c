#include "sample.h"

#include "subdivide/split.h"

static void assert_same_array(const int32_t *actual, const int32_t *expected, int32_t count, const char *name)
{
    for (int32_t i = 0; i < count; i++)
        if (actual[i] != expected[i]) {
            print_error("%s[%d] is %d, expected %d\n", name, (int)i, (int)actual[i], (int)expected[i]);
            fail();
        }
}

static void assert_same_topology(const pel_topology *actual, const pel_topology *expected)
{
    assert_int_equal(actual->vertex_count, expected->vertex_count);
    assert_int_equal(actual->triangle_count, expected->triangle_count);
    assert_int_equal(actual->edge_count, expected->edge_count);
    assert_int_equal(actual->boundary_edge_count, expected->boundary_edge_count);
    assert_same_array(actual->triangles[0], expected->triangles[0], 3 * expected->triangle_count, "triangles");
    assert_same_array(actual->twin, expected->twin, 3 * expected->triangle_count, "twin");
    assert_same_array(actual->edge_of_half_edge, expected->edge_of_half_edge, 3 * expected->triangle_count, "edge");
    assert_same_array(actual->half_edge_of_edge, expected->half_edge_of_edge, expected->edge_count, "half_edge");
    assert_same_array(actual->corner_of_vertex, expected->corner_of_vertex, expected->vertex_count, "corner");
}

/* every level is what pel_topology_create makes of its triangles */
static void check_levels(const pel_mesh *mesh, int32_t levels)
{
    pel_topology *level;
    assert_int_equal(pel_topology_create(mesh, &level, NULL), PEL_OK);
    for (int32_t l = 0; l < levels; l++) {
        pel_topology *fine, *expected;
        assert_int_equal(pel_topology_split(level, &fine, NULL), PEL_OK);
        double *positions = calloc((size_t)fine->vertex_count, 3 * sizeof *positions);
        pel_mesh *fine_mesh = sample_create((const double(*)[3])positions, fine->vertex_count,
                                            (const int32_t(*)[3])fine->triangles, fine->triangle_count);
        assert_int_equal(pel_topology_create(fine_mesh, &expected, NULL), PEL_OK);
        assert_same_topology(fine, expected);
        pel_level_size size = pel_level_size_split(pel_level_size_of(level));
        assert_int_equal(size.vertex_count, fine->vertex_count);
        assert_int_equal(size.edge_count, fine->edge_count);
        assert_int_equal(size.triangle_count, fine->triangle_count);
        free(positions);
        pel_mesh_destroy(fine_mesh);
        pel_topology_destroy(expected);
        pel_topology_destroy(level);
        level = fine;
    }
    pel_topology_destroy(level);
}

static void test_known_meshes(void **unused)
{
    (void)unused;
    random_state random = {11};
    pel_mesh *meshes[] = {sample_tetrahedron(),
                          sample_octahedron(),
                          sample_sphere(5),
                          sample_ring(1000, true, &random),
                          sample_ring(3, false, &random),
                          sample_ring(400, false, &random)};
    for (size_t m = 0; m < sizeof meshes / sizeof meshes[0]; m++) {
        check_levels(meshes[m], 3);
        pel_mesh_destroy(meshes[m]);
    }
}

static void test_random_meshes(void **unused)
{
    (void)unused;
    random_state random = {12};
    for (int trial = 0; trial < 60; trial++) {
        pel_mesh *mesh = sample_random(&random);
        check_levels(mesh, 2);
        pel_mesh_destroy(mesh);
    }
}

static void test_sizes(void **unused)
{
    (void)unused;
    pel_level_size size = {252, 750, 500};
    assert_int_equal(pel_level_size_split(size).vertex_count, 1002);
    assert_int_equal(pel_level_size_split(size).triangle_count, 2000);
    assert_true(pel_level_size_fits((pel_level_size){1, 1, INT32_MAX / 3}));
    assert_false(pel_level_size_fits((pel_level_size){1, 1, INT32_MAX / 3 + 1}));
    pel_topology huge = {.vertex_count = 3, .triangle_count = INT32_MAX / 3, .edge_count = INT32_MAX / 2};
    pel_topology *fine;
    pel_error error;
    assert_int_equal(pel_topology_split(&huge, &fine, &error), PEL_BAD_ARGUMENT);
    assert_null(fine);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known_meshes),
        cmocka_unit_test(test_random_meshes),
        cmocka_unit_test(test_sizes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
