/* Readers and writers of every format with every single allocation failing. */
#include "check.h"
#include "failing_malloc.h"

#include "pellicle/mesh_io.h"
#include "pellicle/results.h"
#include "pellicle/shape.h"

#include <stdlib.h>
#include <unistd.h>

static char path[] = "alloc_XXXXXX"; /* in the working directory of the test */
static pel_mesh *mesh;

static int set_up(void **unused)
{
    (void)unused;
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_LENS_CAPSULE);
    close(mkstemp(path));
    return pel_shape_create(&def, &mesh, NULL) != PEL_OK;
}

static int tear_down(void **unused)
{
    (void)unused;
    pel_mesh_destroy(mesh);
    return remove(path);
}

/* data: a pel_mesh_format */
static pel_status write_mesh(const void *data, pel_error *error)
{
    return pel_mesh_write(path, *(const pel_mesh_format *)data, mesh, NULL, error);
}

/* data: a pel_mesh_format */
static pel_status read_mesh(const void *data, pel_error *error)
{
    pel_mesh *read;
    pel_status status = pel_mesh_read(path, *(const pel_mesh_format *)data, NULL, &read, error);
    if (status != PEL_OK)
        assert_null(read);
    pel_mesh_destroy(read);
    return status;
}

static void test_mesh_files(void **unused)
{
    (void)unused;
    for (int i = PEL_FORMAT_AUTO + 1; i < PEL_FORMAT_COUNT; i++) {
        pel_mesh_format format = (pel_mesh_format)i;
        assert_true(for_every_allocation_failure(write_mesh, &format) > 0);
        assert_true(for_every_allocation_failure(read_mesh, &format) > 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mesh_files),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
