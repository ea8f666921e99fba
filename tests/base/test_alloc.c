/* Every public function that allocates, with every single allocation failing; and the harness on known numbers. */
#include "check.h"
#include "failing_malloc.h"

#include "base/memory.h"
#include "pellicle/pellicle.h"

static void test_harness_counts(void **unused)
{
    (void)unused;
    void *before = pel_allocate(3, 8);
    failing_malloc_begin(3);
    void *first = pel_allocate(3, 8), *second = pel_allocate_aligned(3, 8), *third = pel_allocate(3, 8);
    before = pel_reallocate(before, 4000, 8);
    first = pel_reallocate(first, 4000, 8);
    assert_non_null(second);
    assert_null(third);
    pel_free(second);
    allocation_count count = failing_malloc_end();
    assert_int_equal(count.calls, 5);
    assert_int_equal(count.failed, 1);
    assert_int_equal(count.live, 1);
    pel_free(before);
    pel_free(first);
}

static const double corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
static const int32_t faces[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};

static pel_status make_mesh(const void *unused, pel_error *error)
{
    (void)unused;
    pel_mesh *mesh;
    pel_status status = pel_mesh_create(corners, 4, faces, 4, &mesh, error);
    if (status != PEL_OK)
        assert_null(mesh);
    pel_mesh_destroy(mesh);
    return status;
}

static pel_status add_fields(const void *unused, pel_error *error)
{
    (void)unused;
    pel_mesh *mesh;
    pel_status status = pel_mesh_create(corners, 4, faces, 4, &mesh, error);
    if (status == PEL_OK)
        status = pel_mesh_add_field(mesh, "weight", 1, NULL, error);
    if (status == PEL_OK)
        status = pel_mesh_add_field(mesh, "direction", 3, corners, error);
    if (status == PEL_OK)
        status = pel_mesh_add_field(mesh, "weight", 1, corners, error);
    pel_mesh_destroy(mesh);
    return status;
}

static void test_mesh(void **unused)
{
    (void)unused;
    assert_int_equal(for_every_allocation_failure(make_mesh, NULL), 3);
    assert_int_equal(for_every_allocation_failure(add_fields, NULL), 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_harness_counts),
        cmocka_unit_test(test_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
