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

static void test_round_trip(void **unused)
{
    (void)unused;
    const char *const names[3] = {"frames/f00000.vtp", "a&b.vtp", "/tmp/far.vtp"};
    const double times[3] = {0, 0.1, 1.0 / 3.0};
    pel_pvd *pvd;
    assert_int_equal(pel_pvd_write("./pvd-trip.pvd", names, times, 3, NULL), PEL_OK);
    assert_int_equal(pel_pvd_read("./pvd-trip.pvd", &pvd, NULL), PEL_OK);
    assert_int_equal(pvd->frame_count, 3);
    for (int i = 0; i < 3; i++)
        assert_true(pvd->times[i] == times[i]);
    assert_string_equal(pvd->paths[0], "./frames/f00000.vtp");
    assert_string_equal(pvd->paths[1], "./a&b.vtp");
    assert_string_equal(pvd->paths[2], "/tmp/far.vtp");
    pel_pvd_destroy(pvd);
    unlink("pvd-trip.pvd");
}

static pel_status read_case(const void *data, pel_error *error)
{
    pel_pvd *pvd = (pel_pvd *)1;
    pel_status status = pel_pvd_read(data, &pvd, error);
    assert_true(status == PEL_OK || pvd == NULL);
    pel_pvd_destroy(pvd);
    return status;
}

static void test_damaged(void **unused)
{
    (void)unused;
    static const struct {
        const char *text, *what;
    } cases[] = {
        {"", "this is no VTK collection file"},
        {"solid ball", "this is no VTK collection file"},
        {"<Collection></Collection>", "there is no frame in the collection"},
        {"<Collection><DataSet timestep=\"0\" file=\"a.vtp\"/>", "the end of the file is missing"},
        {"<Collection><DataSet timestep=\"nan\" file=\"a.vtp\"/></Collection>", "a frame has no time"},
        {"<Collection><DataSet file=\"a.vtp\"/></Collection>", "a frame has no time"},
        {"<Collection><DataSet timestep=\"0\" file=\"\"/></Collection>", "a frame names no file"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        FILE *file = fopen("pvd-damaged.pvd", "w");
        fputs(cases[i].text, file);
        fclose(file);
        pel_error error;
        assert_int_equal(read_case("pvd-damaged.pvd", &error), PEL_BAD_FORMAT);
        assert_string_equal(error.what, cases[i].what);
        assert_string_equal(error.file, "pvd-damaged.pvd");
    }
    unlink("pvd-damaged.pvd");
    assert_int_equal(read_case("no-such.pvd", NULL), PEL_BAD_FILE);
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    const char *const names[2] = {"a.vtp", "b.vtp"};
    const double times[2] = {0, 1};
    assert_int_equal(pel_pvd_write("pvd-memory.pvd", names, times, 2, NULL), PEL_OK);
    assert_true(for_every_allocation_failure(read_case, "pvd-memory.pvd") >= 5);
    unlink("pvd-memory.pvd");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_content), cmocka_unit_test(test_refuses),
                                       cmocka_unit_test(test_round_trip), cmocka_unit_test(test_damaged),
                                       cmocka_unit_test(test_out_of_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
