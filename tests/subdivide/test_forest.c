#include "failing_malloc.h"
#include "sample.h"

#include "pellicle/subdivide.h"
#include "subdivide/forest.h"

/* the finest level is what pel_mesh_subdivide makes, every coarser one the same for fewer levels */
static void test_levels_are_subdivisions(void **unused)
{
    (void)unused;
    random_state random = {31};
    enum { DEPTH = 3 };
    for (int trial = 0; trial < 10; trial++) {
        pel_mesh *mesh = trial == 0 ? sample_sphere(5) : sample_random(&random), *fine;
        pel_lod_forest *forest;
        assert_int_equal(pel_lod_forest_create(mesh, DEPTH, 0, &forest, NULL), PEL_OK);
        assert_int_equal(forest->depth, DEPTH);
        for (int32_t l = 0; l <= DEPTH; l++) {
            assert_int_equal(pel_mesh_subdivide(mesh, l, &fine, NULL), PEL_OK);
            const pel_topology *level = forest->levels[l];
            assert_int_equal(level->vertex_count, fine->vertex_count);
            assert_int_equal(level->triangle_count, fine->triangle_count);
            assert_memory_equal(level->triangles, fine->triangles, (size_t)fine->triangle_count * 3 * sizeof(int32_t));
            assert_memory_equal(forest->rest_positions, fine->positions,
                                (size_t)fine->vertex_count * 3 * sizeof(double));
            pel_mesh_destroy(fine);
        }
        pel_lod_forest_destroy(forest);
        pel_mesh_destroy(mesh);
    }
}

/* parents of vertices and triangles against the triangles of the levels */
static void test_family(void **unused)
{
    (void)unused;
    pel_mesh *mesh = sample_sphere(2);
    pel_lod_forest *forest;
    assert_int_equal(pel_lod_forest_create(mesh, 2, 0, &forest, NULL), PEL_OK);
    int32_t parents[2];
    assert_false(pel_lod_forest_vertex_parents(forest, 0, parents));
    for (int32_t l = 0; l < 2; l++) {
        const pel_topology *coarse = forest->levels[l], *fine = forest->levels[l + 1];
        for (int32_t t = 0; t < coarse->triangle_count; t++)
            for (int32_t i = 0; i < 3; i++) {
                int32_t v = pel_lod_midpoint(coarse, 3 * t + i), child = pel_lod_child(t, i);
                assert_int_equal(pel_lod_parent(child), t);
                assert_int_equal(fine->triangles[child][0], coarse->triangles[t][i]);
                assert_int_equal(fine->triangles[child][1], v);
                assert_int_equal(fine->triangles[pel_lod_child(t, 3)][i], v);
                assert_int_equal(pel_lod_forest_vertex_level(forest, v), l + 1);
                assert_true(pel_lod_forest_vertex_parents(forest, v, parents));
                int32_t a = coarse->triangles[t][i], b = coarse->triangles[t][(i + 1) % 3];
                assert_true((parents[0] == a && parents[1] == b) || (parents[0] == b && parents[1] == a));
            }
    }
    pel_lod_forest_destroy(forest);
    pel_mesh_destroy(mesh);
}

static void test_memory_bound(void **unused)
{
    (void)unused;
    pel_mesh *mesh = sample_sphere(5);
    pel_lod_forest *forest;
    pel_error error;
    assert_int_equal(pel_lod_forest_create(mesh, 2, 0, &forest, NULL), PEL_OK);
    const size_t bytes = pel_lod_forest_bytes(forest->levels[0], 2);
    /* 500, 2000 and 8000 triangles: 44 bytes each and 4 for each vertex, positions of the finest alone */
    assert_true(bytes > 10500 * 42 + 4002 * 24 && bytes < 10500 * 44 + 4002 * 24 + 2000);
    pel_lod_forest_destroy(forest);
    assert_int_equal(pel_lod_forest_create(mesh, 2, bytes, &forest, &error), PEL_OK);
    pel_lod_forest_destroy(forest);
    assert_int_equal(pel_lod_forest_create(mesh, 2, bytes - 1, &forest, &error), PEL_BAD_ARGUMENT);
    assert_null(forest);
    assert_non_null(strstr(error.remedy, "use 1 levels"));
    assert_int_equal(pel_lod_forest_create(mesh, 12, 0, &forest, &error), PEL_BAD_ARGUMENT);
    assert_non_null(strstr(error.remedy, "use 10 levels"));
    assert_int_equal(pel_lod_forest_create(mesh, -1, 0, &forest, &error), PEL_BAD_ARGUMENT);
    for (int32_t levels = 13; levels < 100; levels += 86) {
        assert_int_equal(pel_lod_forest_create(mesh, levels, 0, &forest, &error), PEL_BAD_ARGUMENT);
        assert_non_null(strstr(error.remedy, "from 0 to 12"));
    }
    pel_mesh_destroy(mesh);
}

static void test_interpolate(void **unused)
{
    (void)unused;
    random_state random = {33};
    pel_mesh *mesh = sample_random(&random);
    pel_lod_forest *forest;
    assert_int_equal(pel_lod_forest_create(mesh, 2, 0, &forest, NULL), PEL_OK);
    size_t count = (size_t)forest->levels[2]->vertex_count;
    double *values = calloc(count, sizeof *values);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        values[v] = mesh->positions[v][2];
    assert_int_equal(pel_lod_forest_interpolate(forest, 1, false, values, NULL), PEL_OK);
    for (size_t v = 0; v < count; v++)
        assert_near(values[v], forest->rest_positions[v][2], 0);
    for (int32_t v = 0; v < mesh->vertex_count; v++)
        values[v] = v % 2;
    assert_int_equal(pel_lod_forest_interpolate(forest, 1, true, values, NULL), PEL_OK);
    for (size_t v = 0; v < count; v++)
        assert_true(values[v] >= 0 && values[v] <= 1);
    free(values);
    pel_lod_forest_destroy(forest);
    pel_mesh_destroy(mesh);
}

static pel_status forest_case(const void *mesh, pel_error *error)
{
    pel_lod_forest *forest = (pel_lod_forest *)1;
    pel_status status = pel_lod_forest_create(mesh, 2, 0, &forest, error);
    assert_true((status == PEL_OK) == (forest != NULL));
    pel_lod_forest_destroy(forest);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    pel_mesh *mesh = sample_sphere(3);
    assert_true(for_every_allocation_failure(forest_case, mesh) > 10);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_levels_are_subdivisions),
        cmocka_unit_test(test_family),
        cmocka_unit_test(test_memory_bound),
        cmocka_unit_test(test_interpolate),
        cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
