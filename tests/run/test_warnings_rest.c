/* Columns that stay straight under more than Euler's load, and less. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "run/warned.h"
#include "run/warnings_rest.h"

/* a clamped column, 0.2 x 0.02 m */
#define COLUMN                                                                                                         \
    "version: 1\nbodies: [ { name: column, mesh: { shape: grid, nx: 16, ny: 2, size_x: 0.2, size_y: 0.02 }, "          \
    "membrane: { young: 1e9, poisson: 0, thickness: 0.001 }, supports: [ { at: { box: { min: [-1, -1, -1], max: "      \
    "[-0.0999, 1, 1] } }, rotation: fixed } ] } ]\n"                                                                   \
    "loads: [ { force: [-9, 0, 0], per: length, at: { box: { min: [0.0999, -1, -1], max: [1, 1, 1] } } } ]\n"          \
    "solver: { method: implicit, drag: 5 }\nduration: 0.3\n"

static const char *unstable(const char *const *changes, int32_t count)
{
    static pel_run_summary summary;
    run_scene(COLUMN, changes, count, NULL, 100, &summary);
    const pel_run_warning *warning = find_warning(&summary, "unstable-balance");
    return warning != NULL ? warning->text : NULL;
}

static void test_columns(void **unused)
{
    (void)unused;
    /* Euler's load: pi^2 E h^3 / 12 / (2 L)^2 = 5.14 N/m */
    const char *const less[] = {"loads.0.force=[-4.8, 0, 0]"}, *const more[] = {"loads.0.force=[-5.6, 0, 0]"};
    assert_null(unstable(less, 1));
    assert_non_null(strstr(unstable(more, 1), "nothing pushes it aside"));
    /* without drag it vibrates along its axis; a small push takes it aside, and the run shows that */
    const char *const undamped[] = {"solver.drag=0"};
    assert_non_null(unstable(undamped, 1));
    const char *const pushed[] = {"loads.0.force=[-9, 0, 0.1]", "duration=1"};
    assert_null(unstable(pushed, 2));
    /* under tension */
    const char *const pulled[] = {"loads.0.force=[9, 0, 0]"};
    assert_null(unstable(pulled, 1));
}

/* a ruler that is near its rest shape at the end, since it swings */
static void test_swing(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    run_scene(
        "version: 1\nbodies: [ { name: ruler, mesh: { shape: grid, nx: 30, ny: 4, size_x: 0.3, size_y: 0.03 }, "
        "membrane: { young: 2e11, poisson: 0.3, thickness: 0.001 }, bending: {}, mass: { density: 7800 }, pinned: { "
        "box: { min: [-1, -1, -1], max: [-0.139, 1, 1] } } } ]\ngravity: [0, 0, -9.81]\nduration: 1.5\n"
        "output: { every: 0.01 }\n",
        NULL, 0, NULL, 0, &summary);
    assert_true(summary.residual_displacement < 0.1 * summary.max_displacement);
    assert_null(find_warning(&summary, "unstable-balance"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_columns), cmocka_unit_test(test_swing)};
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
