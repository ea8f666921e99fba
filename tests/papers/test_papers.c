#include "check.h"

#include "papers/a/spheres.h"
#include "papers/papers.h"

static void test_cases(void **unused)
{
    (void)unused;
    int count = 0;
    for (const lab_case *one; (one = papers_case_at(count)) != NULL; count++) {
        assert_true(strcmp(one->group, "paper A") == 0 || strcmp(one->group, "paper B") == 0 ||
                    strcmp(one->group, "own") == 0);
        assert_non_null(one->run);
        for (int i = 0; i < count; i++)
            assert_string_not_equal(papers_case_at(i)->name, one->name);
    }
    assert_int_equal(count, 31);
}

static void test_bodies(void **unused)
{
    (void)unused;
    pel_error error;
    papers *all;
    const papers_def def = {.folder = "unused", .mesh = "missing.ply", .up = 'z'};
    assert_int_equal(papers_create(&def, &all, &error), PEL_BAD_FILE);
    papers_destroy(all);
    papers_destroy(NULL);
}

/* the triangles of paper A's table, and times that a run has */
static void test_spheres(void **unused)
{
    (void)unused;
    pel_error error;
    a_spheres *spheres;
    a_times times;
    assert_int_equal(a_spheres_create(&spheres, &error), PEL_OK);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(a_spheres_rewind(spheres, &error), PEL_OK);
        assert_int_equal(a_spheres_run(spheres, &error), PEL_OK);
    }
    assert_int_equal(a_spheres_measure(spheres, &times, &error), PEL_OK);
    assert_int_equal(times.triangles[A_BASE], 500);
    assert_int_equal(times.triangles[A_LOCAL], 584);
    assert_int_equal(times.triangles[A_EVERYWHERE], 2000);
    assert_near(times.over_base[A_BASE], 1, 0);
    for (int i = 0; i < A_SPHERES; i++)
        assert_true(times.seconds[i] > 0);
    assert_true(times.refine > 0 && times.coarsen > 0);
    a_spheres_destroy(spheres);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cases),
        cmocka_unit_test(test_bodies),
        cmocka_unit_test(test_spheres),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
