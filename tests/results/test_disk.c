#include "check.h"

#include "results/disk.h"

#include <stdlib.h>
#include <string.h>

static char told[400];

static void tell(void *unused, const char *text)
{
    (void)unused;
    snprintf(told, sizeof told, "%s", text);
}

static pel_status check(const pel_disk_need *need, const char *folder, pel_error *error)
{
    const pel_log log = {.write = tell};
    told[0] = '\0';
    return pel_run_check_disk(folder, need, &log, error);
}

/* a megabyte is nothing, exabytes do not fit, and between them it is told */
static void test_bytes(void **unused)
{
    (void)unused;
    pel_error error;
    pel_disk_need need = {.frame_count = 100, .frame_bytes = 1e4, .frame_seconds = 0.1};
    assert_int_equal(check(&need, ".", &error), PEL_OK);
    assert_string_equal(told, "");
    need.frame_bytes = 1e18;
    assert_int_equal(check(&need, ".", &error), PEL_BAD_SCENE);
    assert_non_null(strstr(error.what, "100 frames of 1e+12 MB take about 1e+11 GB, and the disk has "));
    assert_non_null(strstr(error.remedy, "set output.every to "));
    /* what it names would fit */
    double every = strtod(strstr(error.remedy, "to ") + 3, NULL);
    need.frame_count *= 0.1 / every;
    assert_int_equal(check(&need, ".", &error), PEL_OK);
    /* of folders that are not there counts the first one above; file systems without blocks say nothing */
    need.frame_count = 100;
    static const char *const here[] = {"none/none", "/none", "/", "none"};
    for (size_t i = 0; i < sizeof here / sizeof *here; i++)
        assert_int_equal(check(&need, here[i], &error), PEL_BAD_SCENE);
#if defined(__linux__)
    assert_int_equal(check(&need, "/proc/self/none", &error), PEL_OK);
#endif
    need.may_take_less = true;
    assert_int_equal(check(&need, ".", &error), PEL_OK);
    assert_non_null(strstr(told, "1e+11 GB, of "));
    /* the disk has it, or at least says that it has more than a kilobyte */
    need = (pel_disk_need){.frame_count = 200000, .frame_bytes = 0.001, .frame_seconds = 0.1};
    assert_int_equal(check(&need, ".", &error), PEL_OK);
    assert_non_null(strstr(told, "200000 frames"));
    assert_non_null(strstr(told, "set output.every to 0.2 s or more"));
    /* 20 GB are told, wherever they go */
    need = (pel_disk_need){.frame_count = 10, .frame_bytes = 2e9, .frame_seconds = 0.1, .may_take_less = true};
    assert_int_equal(check(&need, ".", &error), PEL_OK);
    assert_non_null(strstr(told, "10 frames of 2e+03 MB take about 20 GB"));
}

/* points, fields and indices, in either precision; the files themselves are compared in cli/faults */
static void test_frame(void **unused)
{
    (void)unused;
    pel_vtp_field fields[2] = {{.component_count = 3}, {.component_count = 1}}, cells[1] = {{.component_count = 2}};
    pel_run_surface surface = {.vertex_count = 100000, .triangle_count = 200000, .fields = fields, .field_count = 2};
    pel_output_def output = {.every = 0.1};
    const double least = 1000, most = 2000;
    const struct {
        bool float64, compress;
        int32_t cells;
        double bytes;
    } cases[] = {{false, false, 0, 4 * 7e5 + 16 * 2e5},
                 {true, false, 0, 8 * 7e5 + 16 * 2e5},
                 {false, false, 1, 4 * 11e5 + 16 * 2e5},
                 {false, true, 0, 0.2 * (4 * 7e5 + 16 * 2e5)}};
    surface.cell_fields = cells;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        output.float64 = cases[i].float64;
        output.compress = cases[i].compress;
        surface.cell_field_count = cases[i].cells;
        double text = pel_run_frame_bytes(&surface, &output) - cases[i].bytes;
        assert_true(text > least && text < most);
    }
}

static void test_checkpoints(void **unused)
{
    (void)unused;
    pel_error error;
    pel_disk_need need = {.frame_count = 10,
                          .frame_bytes = 1e4,
                          .frame_seconds = 0.1,
                          .checkpoint_count = 1000,
                          .checkpoint_bytes = 1e17,
                          .checkpoint_seconds = 1e-3};
    assert_int_equal(check(&need, ".", &error), PEL_BAD_SCENE);
    assert_non_null(strstr(error.what, " and 1000 checkpoints of 1e+11 MB take about"));
    assert_non_null(strstr(error.remedy, "set output.checkpoint to "));
    need.checkpoint_count = 0;
    assert_int_equal(check(&need, ".", &error), PEL_OK);
}

/* more than ten million files are refused, however small */
static void test_files(void **unused)
{
    (void)unused;
    pel_error error;
    pel_disk_need need = {.frame_count = 1e7, .frame_bytes = 1e-6, .frame_seconds = 1e-3};
    assert_int_equal(check(&need, ".", &error), PEL_OK);
    assert_string_not_equal(told, "");
    need.frame_count = 1e8;
    assert_int_equal(check(&need, ".", &error), PEL_BAD_SCENE);
    assert_non_null(strstr(error.what, "in more files than 10000000"));
    assert_non_null(strstr(error.remedy, "set output.every to 0.02 s or more"));
    /* the same for checkpoints */
    need = (pel_disk_need){.checkpoint_count = 1e8, .checkpoint_bytes = 1e-6, .checkpoint_seconds = 1};
    assert_int_equal(check(&need, ".", &error), PEL_BAD_SCENE);
    assert_non_null(strstr(error.remedy, "set output.checkpoint to 20 s or more"));
}

/* the disk is that of the first folder above that is there */
static void test_missing_folders(void **unused)
{
    (void)unused;
    static const char *const folders[] = {"none", "none/none/none", "./none", "/none/none", "/", "."};
    pel_error error;
    const pel_disk_need need = {.frame_count = 100, .frame_bytes = 1e18, .frame_seconds = 0.1};
    for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
        assert_int_equal(check(&need, folders[i], &error), PEL_BAD_SCENE);
        assert_non_null(strstr(error.what, "the disk has "));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bytes), cmocka_unit_test(test_frame),           cmocka_unit_test(test_checkpoints),
        cmocka_unit_test(test_files), cmocka_unit_test(test_missing_folders),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
