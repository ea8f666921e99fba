#include "check.h"
#include "failing_malloc.h"

#include "view/series.h"

#include <unistd.h>

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static void test_columns(void **unused)
{
    (void)unused;
    const char *const names[3] = {"a, \"b\"_x", "time", "absent"};
    double values[3][3];
    write_text("series-test.csv", "frame,time,\"a, \"\"b\"\"_x\",z\r\n0,0.5,1e-3,9\r\n1,,x,9\n2,1.5,-4,9");
    assert_int_equal(view_series_read("series-test.csv", names, 3, values[0], 3, NULL), PEL_OK);
    assert_true(values[0][0] == 1e-3 && values[0][1] == 0.5 && isnan(values[0][2]));
    assert_true(isnan(values[1][0]) && isnan(values[1][1]));
    /* the last row has no end yet */
    assert_true(isnan(values[2][0]) && isnan(values[2][1]));
    /* fewer rows than are asked for, and none at all */
    write_text("series-test.csv", "time\n3\n");
    assert_int_equal(view_series_read("series-test.csv", names, 3, values[0], 3, NULL), PEL_OK);
    assert_true(values[0][1] == 3 && isnan(values[1][1]));
    write_text("series-test.csv", "");
    assert_int_equal(view_series_read("series-test.csv", names, 3, values[0], 3, NULL), PEL_OK);
    assert_true(isnan(values[0][1]));
    unlink("series-test.csv");
    pel_error error;
    assert_int_equal(view_series_read("no-such.csv", names, 3, values[0], 3, &error), PEL_BAD_FILE);
    assert_string_equal(error.file, "no-such.csv");
}

static pel_status read_case(const void *data, pel_error *error)
{
    const char *const name = "time";
    double values[2];
    return view_series_read(data, &name, 1, values, 2, error);
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    write_text("series-memory.csv", "frame,time\n0,1\n");
    assert_true(for_every_allocation_failure(read_case, "series-memory.csv") >= 2);
    unlink("series-memory.csv");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_columns), cmocka_unit_test(test_out_of_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
