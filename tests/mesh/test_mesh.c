#include "check.h"
#include "failing_malloc.h"

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
    assert_string_equal(error.what, "position (1, nan, 0) is not finite");
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

static void test_transform(void **unused)
{
    (void)unused;
    pel_mesh *mesh;
    pel_transform transform = pel_transform_default();
    assert_int_equal(pel_mesh_create(square, 4, halves, 2, &mesh, NULL), PEL_OK);
    assert_int_equal(pel_mesh_transform(mesh, &transform, NULL), PEL_OK);
    assert_memory_equal(mesh->positions, square, sizeof square);
    /* twice along x, then a quarter turn about z (not normalized), then a shift: (1, 1, 0) goes to (-1, 2, 3) */
    transform.scale[0] = 2;
    transform.rotation[2] = transform.rotation[3] = 5;
    transform.translation[2] = 3;
    assert_int_equal(pel_mesh_transform(mesh, &transform, NULL), PEL_OK);
    assert_near(mesh->positions[2][0], -1, 1e-15);
    assert_near(mesh->positions[2][1], 2, 1e-15);
    assert_near(mesh->positions[2][2], 3, 1e-15);
    assert_memory_equal(mesh->triangles, halves, sizeof halves);
    pel_mesh_destroy(mesh);
}

static void test_mirror_turns_triangles(void **unused)
{
    (void)unused;
    const int32_t turned[6] = {0, 2, 1, 0, 3, 2};
    for (int mirrored = 0; mirrored < 8; mirrored++) {
        pel_mesh *mesh;
        pel_transform transform = pel_transform_default();
        for (int i = 0; i < 3; i++)
            if (mirrored >> i & 1)
                transform.scale[i] = -1e-150;
        bool odd = mirrored == 1 || mirrored == 2 || mirrored == 4 || mirrored == 7;
        assert_int_equal(pel_mesh_create(square, 4, halves, 2, &mesh, NULL), PEL_OK);
        assert_int_equal(pel_mesh_transform(mesh, &transform, NULL), PEL_OK);
        assert_memory_equal(mesh->triangles, odd ? turned : halves, sizeof halves);
        pel_mesh_destroy(mesh);
    }
}

static void test_transform_refuses(void **unused)
{
    (void)unused;
    pel_mesh *mesh;
    pel_error error;
    const pel_transform fine = pel_transform_default();
    assert_int_equal(pel_mesh_create(square, 4, halves, 2, &mesh, NULL), PEL_OK);
    pel_transform transform = fine;
    transform.scale[1] = 0;
    assert_int_equal(pel_mesh_transform(mesh, &transform, &error), PEL_BAD_ARGUMENT);
    transform = fine;
    transform.rotation[3] = 0;
    assert_int_equal(pel_mesh_transform(mesh, &transform, &error), PEL_BAD_ARGUMENT);
    transform = fine;
    transform.translation[0] = (double)NAN;
    assert_int_equal(pel_mesh_transform(mesh, &transform, &error), PEL_BAD_ARGUMENT);
    transform = fine;
    transform.scale[0] = transform.translation[0] = 1.5e308;
    assert_int_equal(pel_mesh_transform(mesh, &transform, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(error.element, 1);
    assert_memory_equal(mesh->positions, square, sizeof square);
    pel_mesh_destroy(mesh);
}

static void test_box(void **unused)
{
    (void)unused;
    pel_mesh *mesh;
    double low[3], high[3];
    assert_int_equal(pel_mesh_create(square, 4, halves, 2, &mesh, NULL), PEL_OK);
    pel_mesh_box(mesh, low, high);
    for (int i = 0; i < 3; i++) {
        bool reached[2] = {false, false};
        for (int v = 0; v < 4; v++) {
            double x = mesh->positions[v][i];
            assert_true(low[i] <= x && x <= high[i]);
            reached[0] = reached[0] || x == low[i];
            reached[1] = reached[1] || x == high[i];
        }
        assert_true(reached[0] && reached[1]);
    }
    pel_mesh_destroy(mesh);
}

static pel_status make_mesh(const void *unused, pel_error *error)
{
    (void)unused;
    pel_mesh *mesh;
    pel_status status = pel_mesh_create(square, 4, halves, 2, &mesh, error);
    if (status != PEL_OK)
        assert_null(mesh);
    pel_mesh_destroy(mesh);
    return status;
}

static pel_status add_fields(const void *unused, pel_error *error)
{
    (void)unused;
    pel_mesh *mesh;
    pel_status status = pel_mesh_create(square, 4, halves, 2, &mesh, error);
    if (status == PEL_OK)
        status = pel_mesh_add_field(mesh, "weight", 1, NULL, error);
    if (status == PEL_OK)
        status = pel_mesh_add_field(mesh, "direction", 3, square, error);
    if (status == PEL_OK)
        status = pel_mesh_add_field(mesh, "weight", 1, square, error);
    pel_mesh_destroy(mesh);
    return status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    assert_int_equal(for_every_allocation_failure(make_mesh, NULL), 3);
    assert_int_equal(for_every_allocation_failure(add_fields, NULL), 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_create_copies),
        cmocka_unit_test(test_create_refuses),
        cmocka_unit_test(test_fields),
        cmocka_unit_test(test_transform),
        cmocka_unit_test(test_mirror_turns_triangles),
        cmocka_unit_test(test_transform_refuses),
        cmocka_unit_test(test_box),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
