#include "check.h"
#include "failing_malloc.h"

#include "pellicle/frames.h"

#include <unistd.h>

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static const char *const names[3] = {"a, \"b\"_x", "time", "absent"};

static pel_series *read_series(const char *text)
{
    pel_series *series;
    write_text("series-test.csv", text);
    assert_int_equal(pel_series_read("series-test.csv", names, 3, &series, NULL), PEL_OK);
    assert_int_equal(series->column_count, 3);
    unlink("series-test.csv");
    return series;
}

static void test_columns(void **unused)
{
    (void)unused;
    pel_series *series = read_series("frame,time,\"a, \"\"b\"\"_x\",z\r\n0,0.5,1e-3,9\r\n1,,x,9\n2,1.5,-4,9");
    /* the last row has no end yet */
    assert_int_equal(series->row_count, 2);
    assert_true(pel_series_value(series, 0, 0) == 1e-3 && pel_series_value(series, 1, 0) == 0.5);
    assert_true(isnan(pel_series_value(series, 2, 0)) && isnan(pel_series_value(series, 0, 1)));
    assert_true(isnan(pel_series_value(series, 1, 1)));
    /* beyond what is there */
    assert_true(isnan(pel_series_value(series, 0, 2)) && isnan(pel_series_value(series, 3, 0)));
    assert_true(isnan(pel_series_value(series, -1, 0)) && isnan(pel_series_value(series, 0, -1)));
    pel_series_destroy(series);
    /* a short row; columns as they are in memory */
    series = read_series("time,frame,\"a, \"\"b\"\"_x\"\n3,1,5\n4\n");
    assert_int_equal(series->row_count, 2);
    assert_true(series->values[0] == 5 && isnan(series->values[1]) && series->values[2] == 3 && series->values[3] == 4);
    pel_series_destroy(series);
}

static void test_no_rows(void **unused)
{
    (void)unused;
    static const char *const texts[] = {"", "time", "time\n", "time\n3"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        pel_series *series = read_series(texts[i]);
        assert_int_equal(series->row_count, 0);
        assert_true(isnan(pel_series_value(series, 1, 0)));
        pel_series_destroy(series);
    }
}

static void test_refusals(void **unused)
{
    (void)unused;
    pel_error error;
    pel_series *series;
    assert_int_equal(pel_series_read("no-such.csv", names, 3, &series, &error), PEL_BAD_FILE);
    assert_null(series);
    assert_string_equal(error.file, "no-such.csv");
    assert_int_equal(pel_series_read("no-such.csv", names, 0, &series, &error), PEL_BAD_ARGUMENT);
    assert_int_equal(pel_series_read("no-such.csv", NULL, 1, &series, &error), PEL_BAD_ARGUMENT);
    pel_series_destroy(NULL);
}

/* each file of a run has a name of its own */
static void test_file_names(void **unused)
{
    (void)unused;
    assert_string_equal(pel_run_file_name(PEL_RUN_SERIES), "series.csv");
    for (int a = 0; a < PEL_RUN_FILE_COUNT; a++)
        for (int b = 0; b < a; b++)
            assert_string_not_equal(pel_run_file_name((pel_run_file)a), pel_run_file_name((pel_run_file)b));
    assert_null(pel_run_file_name(PEL_RUN_FILE_COUNT));
}

static pel_status read_case(const void *data, pel_error *error)
{
    pel_series *series;
    pel_status status = pel_series_read(data, names, 3, &series, error);
    assert_true((series == NULL) == (status != PEL_OK));
    pel_series_destroy(series);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    write_text("series-memory.csv", "frame,time\n0,1\n");
    assert_true(for_every_allocation_failure(read_case, "series-memory.csv") >= 4);
    unlink("series-memory.csv");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_columns),    cmocka_unit_test(test_no_rows),       cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_file_names), cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
