/* Warnings about tools known before the first step: blades that open less than they pass. */
#define _XOPEN_SOURCE 700 /* nftw */
#include "run/warned.h"
#include "run/warnings_contact.h"

/* a knife at 0.45 m/s in a sheet with edges of about 7.6 mm */
#define KNIFE(sharpness)                                                                                               \
    "version: 1\nbodies: [ { name: sheet, mesh: { shape: grid, nx: 15, ny: 9, size_x: 0.1, size_y: 0.06 }, membrane: " \
    "{ young: 1.0e6, thickness: 0.001 }, pinned: boundary } ]\ntools: [ { name: knife, shape: blade, edge: [[0, 0, "   \
    "-0.01], [0, 0, 0.01]]" sharpness ", motion: [{ position: [-0.06, 0.001, 0] }, { time: 0.2, position: [0.03, "     \
    "0.001, 0] }] } ]\nsolver: { method: implicit, dt: 0.01 }\nduration: 0.02\n"

static const pel_run_warning *fast(const char *text, const char *change, pel_run_summary *summary)
{
    run_scene(text, &change, change != NULL, NULL, 1, summary);
    return find_warning(summary, "fast-blade");
}

static void test_fast_blade(void **unused)
{
    (void)unused;
    pel_run_summary summary;
    double edges, dt;
    char change[60];
    const pel_run_warning *warning = fast(KNIFE(", sharpness: 300"), NULL, &summary);
    assert_true(warning != NULL && warning->first_frame == 0);
    assert_non_null(strstr(warning->text, "blade 'knife' moves by "));
    assert_int_equal(sscanf(strstr(warning->text, "moves by"), "moves by %lf edges", &edges), 1);
    assert_near(edges, 0.45 * 0.01 / 0.0076, 0.02);
    /* the step that it names, and a blade without a force */
    assert_int_equal(sscanf(strstr(warning->text, "{ dt:"), "{ dt: %lf }", &dt), 1);
    snprintf(change, sizeof change, "solver.dt=%g", dt);
    assert_null(fast(KNIFE(", sharpness: 300"), change, &summary));
    assert_null(fast(KNIFE(""), NULL, &summary));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_fast_blade)};
    return cmocka_run_group_tests(tests, make_folder, clear_folder);
}
