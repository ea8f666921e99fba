#include "check.h"

#include "pellicle/mesh.h"

static const double square[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
static const int32_t halves[6] = {0, 1, 2, 0, 2, 3};

static void test_create_copies(void **unused)
{
    (void)unused;
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(square, 4, halves, 2, &mesh, NULL), PEL_OK);
    assert_int_equal(mesh->vertex_count, 4);
    assert_memory_equal(mesh->positions, square, sizeof square);
    assert_memory_equal(mesh->triangles, halves, sizeof halves);
    pel_mesh_destroy(mesh);
}

static void test_create_refuses(void **unused)
{
    (void)unused;
    pel_mesh *mesh;
    pel_error error;
    char text[600];
    double bad[12];
    memcpy(bad, square, sizeof bad);
    bad[7] = (double)NAN;
    assert_int_equal(pel_mesh_create(bad, 4, halves, 2, &mesh, &error), PEL_BAD_ARGUMENT);
    assert_null(mesh);
    assert_int_equal(error.element, 2);
    assert_non_null(strstr(pel_error_text(&error, text, sizeof text), "vertex 2"));
    assert_int_equal(pel_mesh_create(square, 3, halves, 2, &mesh, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(error.element, 1);
    assert_int_equal(pel_mesh_create(square, 0, halves, 2, &mesh, &error), PEL_BAD_ARGUMENT);
}

static void test_fields(void **unused)
{
    (void)unused;
    pel_mesh *mesh;
    assert_int_equal(pel_mesh_create(square, 4, halves, 2, &mesh, NULL), PEL_OK);
    const double values[4] = {1, 2, 3, 4}, others[4] = {5, 6, 7, 8};
    assert_int_equal(pel_mesh_add_field(mesh, "thickness", 1, values, NULL), PEL_OK);
    assert_int_equal(pel_mesh_add_field(mesh, "thickness", 1, others, NULL), PEL_OK);
    assert_int_equal(mesh->field_count, 1);
    assert_memory_equal(pel_mesh_field(mesh, "thickness")->values, others, sizeof others);
    assert_null(pel_mesh_field(mesh, "absent"));
    assert_int_equal(pel_mesh_add_field(mesh, "", 1, NULL, NULL), PEL_BAD_ARGUMENT);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_create_copies),
        cmocka_unit_test(test_create_refuses),
        cmocka_unit_test(test_fields),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
