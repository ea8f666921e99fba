#include "check.h"
#include "failing_malloc.h"

#include "base/memory.h"
#include "io/file.h"
#include "pellicle/results.h"

#include <unistd.h>

static void test_content(void **unused)
{
    (void)unused;
    const char *const names[2] = {"frames/f00000.vtp", "a&b.vtp"};
    const double times[2] = {0, 0.1};
    char *bytes;
    size_t size;
    assert_int_equal(pel_pvd_write("pvd-test.pvd", names, times, 2, NULL), PEL_OK);
    assert_int_equal(pel_file_read("pvd-test.pvd", &bytes, &size, NULL), PEL_OK);
    assert_string_equal(bytes,
                        "<?xml version=\"1.0\"?>\n"
                        "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>\n"
                        "<DataSet timestep=\"0\" group=\"\" part=\"0\" file=\"frames/f00000.vtp\"/>\n"
                        "<DataSet timestep=\"0.1\" group=\"\" part=\"0\" file=\"a&amp;b.vtp\"/>\n"
                        "</Collection>\n</VTKFile>\n");
    pel_free(bytes);
    unlink("pvd-test.pvd");
}

static void test_refuses(void **unused)
{
    (void)unused;
    pel_error error;
    assert_int_equal(pel_pvd_write("no-such-folder/a.pvd", NULL, NULL, 0, &error), PEL_BAD_FILE);
    assert_string_equal(error.file, "no-such-folder/a.pvd");
}

static pel_status write_case(const void *path, pel_error *error)
{
    const char *const names[2] = {"a.vtp", "b.vtp"};
    const double times[2] = {0, 1};
    return pel_pvd_write(path, names, times, 2, error);
}

/* nothing stays, whether there is memory or not */
static void test_allocation_failures(void **unused)
{
    (void)unused;
    assert_true(for_every_allocation_failure(write_case, "pvd-test.pvd") >= 1);
    unlink("pvd-test.pvd");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_content), cmocka_unit_test(test_refuses),
                                       cmocka_unit_test(test_allocation_failures)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
