/* Columns of series.csv that add up bodies or choose one of many places: cuts and their tips. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "pellicle/frames.h"
#include "run/warned.h"

#include <math.h>

/* m, half a cut */
#define HALF 0.02

/* two sheets that are stretched by 5 and 10 % and cut one after the other, beside one that is not */
static const char sheets[] =
    "version: 1\nbodies:\n"
    "  - { name: whole, mesh: { shape: grid, nx: 4, ny: 4, size_x: 0.04, size_y: 0.04, translate: [0, 0.2, 0] },\n"
    "      membrane: { preset: skin }, pinned: boundary }\n"
    "  - { name: left, mesh: { shape: grid, nx: 12, ny: 12, size_x: 0.12, size_y: 0.12 }, membrane: { preset: skin },\n"
    "      supports: [ { name: a, at: { box: { min: [-1, -1, -1], max: [-0.0599, 1, 1] } } },\n"
    "        { name: b, at: { box: { min: [0.0599, -1, -1], max: [1, 1, 1] } }, displacement: [0.006, 0, 0] } ] }\n"
    "  - { name: right, mesh: { shape: grid, nx: 12, ny: 12, size_x: 0.12, size_y: 0.12, translate: [0.2, 0, 0] },\n"
    "      membrane: { preset: skin },\n"
    "      supports: [ { name: c, at: { box: { min: [-1, -1, -1], max: [0.1401, 1, 1] } } },\n"
    "        { name: d, at: { box: { min: [0.2599, -1, -1], max: [1, 1, 1] } }, displacement: [0.012, 0, 0] } ] }\n"
    "cuts:\n"
    "  - { at: 0.5, body: left, path: [[0, -0.02, 0], [0, 0.02, 0]] }\n"
    "  - { at: 1, body: right, path: [[0.2, -0.02, 0], [0.2, 0.02, 0]] }\n"
    "gravity: [0, 0, 0]\nsolver: { method: static, dt: 0.5 }\nduration: 1.5\noutput: { every: 0.5 }\n";

enum { LENGTH, TIPS, RATE, TIP_X, TIP_Y, FORCE_Y, COLUMNS };
static const char *const columns[COLUMNS] = {"cut_length", "tips", "tip_rate", "tip_x", "tip_y", "tip_force_y"};

static pel_series *run_sheets(const char *const *overrides, int32_t count)
{
    char path[256];
    pel_run_summary summary;
    pel_series *series;
    run_scene(sheets, overrides, count, NULL, 0, &summary);
    assert_int_equal(pel_series_read(in_folder(path, "warned", "series.csv"), columns, COLUMNS, &series, NULL), PEL_OK);
    assert_int_equal(series->row_count, 4);
    return series;
}

/* the tip of the largest rate, whichever body has it: twice the stretch gives four times the rate */
static void test_cuts(void **unused)
{
    (void)unused;
    const double precise = sizeof(pel_real) == sizeof(float) ? 1e-5 : 1e-12;
    pel_series *series = run_sheets(NULL, 0);
    for (int row = 0; row < 2; row++) {
        assert_true(pel_series_value(series, LENGTH, row) == 0 && pel_series_value(series, TIPS, row) == 0);
        assert_true(isnan(pel_series_value(series, RATE, row)) && isnan(pel_series_value(series, TIP_X, row)));
    }
    for (int row = 2; row < 4; row++) {
        assert_near(pel_series_value(series, LENGTH, row), (row - 1) * 2 * HALF, precise);
        assert_near(pel_series_value(series, TIPS, row), 2 * (row - 1), 0);
        assert_near(pel_series_value(series, TIP_X, row), row == 2 ? 0.003 : 0.206, 1e-3);
        assert_near(fabs(pel_series_value(series, TIP_Y, row)), HALF, 0.1 * HALF);
        assert_true(pel_series_value(series, FORCE_Y, row) * pel_series_value(series, TIP_Y, row) > 0);
    }
    double first = pel_series_value(series, RATE, 2), second = pel_series_value(series, RATE, 3);
    assert_true(first > 0);
    assert_near(second / first, 4, 0.4);
    pel_series_destroy(series);
    check_contains("warned", "summary.json", "\"fracture_energy\": 0, \"islands\": 0, \"released\": 0, \"cuts\": 2}");
    /* the second sheet less stretched than the first */
    const char *const less = "bodies.right.supports.d.displacement=[0.003, 0, 0]";
    series = run_sheets(&less, 1);
    assert_near(pel_series_value(series, TIPS, 3), 4, 0);
    assert_near(pel_series_value(series, RATE, 3), first, 1e-3 * first);
    assert_near(pel_series_value(series, TIP_X, 3), 0.003, 1e-3);
    pel_series_destroy(series);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_cuts)};
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
