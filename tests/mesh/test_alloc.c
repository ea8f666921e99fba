/* Meshes, shapes and topology with every single allocation failing. */
#include "check.h"
#include "failing_malloc.h"

#include "pellicle/shape.h"
#include "pellicle/topology.h"

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

/* data: a pel_shape_kind */
static pel_status make_shape(const void *data, pel_error *error)
{
    pel_shape_def def = pel_shape_def_default(*(const pel_shape_kind *)data);
    pel_mesh *mesh;
    pel_status status = pel_shape_create(&def, &mesh, error);
    if (status != PEL_OK)
        assert_null(mesh);
    pel_mesh_destroy(mesh);
    return status;
}

static void test_shapes(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < PEL_SHAPE_COUNT; kind++)
        assert_true(for_every_allocation_failure(make_shape, &(pel_shape_kind){(pel_shape_kind)kind}) >= 3);
}

/* data: a pel_mesh */
static pel_status make_topology(const void *data, pel_error *error)
{
    pel_topology *topology;
    pel_status status = pel_topology_create(data, &topology, error);
    if (status != PEL_OK)
        assert_null(topology);
    pel_topology_destroy(topology);
    return status;
}

static void test_topology(void **unused)
{
    (void)unused;
    const pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GRID);
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    assert_true(for_every_allocation_failure(make_topology, mesh) >= 5);
    pel_mesh_destroy(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mesh),
        cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_topology),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
