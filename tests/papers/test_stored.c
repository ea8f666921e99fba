/* Numbers of the version before: which of an experiment's numbers differ from them. */
#include "check.h"

#include "papers/lab/stored.h"

#include <math.h>

static const lab_stored numbers[] = {
    {"other", "depth", 7},
    {"press", "depth", 2},
    {"press", "pairs", 0},
    {"press", "way", -4},
};

/* the verdict with a depth, a number of pairs and a way, which is left out if it is NaN */
static lab_verdict judge(double depth, double pairs, double way, int *claims)
{
    lab_experiment experiment = {.name = "press"};
    lab_begin_claim(&experiment, LAB_PAPER, "it is pressed", NULL);
    lab_tell(&experiment, "depth", depth, (double)NAN, "");
    lab_tell(&experiment, "pairs", pairs, (double)NAN, "");
    if (!isnan(way))
        lab_tell(&experiment, "way", way, (double)NAN, "");
    lab_judge_stored(&experiment, numbers, 4);
    lab_verdict verdict = lab_experiment_verdict(&experiment);
    *claims = experiment.claim_count;
    lab_clear(&experiment);
    return verdict;
}

static void test_numbers(void **unused)
{
    (void)unused;
    int claims;
    assert_int_equal(judge(2, 0, -4, &claims), LAB_HOLDS);
    assert_int_equal(claims, 2);
    assert_int_equal(judge(2.0199, 0, -3.9601, &claims), LAB_HOLDS);
    assert_int_equal(judge(2.0201, 0, -4, &claims), LAB_FAILS);
    assert_int_equal(judge(2, 1e-12, -4, &claims), LAB_FAILS);
    assert_int_equal(judge(2, 0, 4, &claims), LAB_FAILS);
    /* a number that is gone */
    assert_int_equal(judge(2, 0, (double)NAN, &claims), LAB_FAILS);
    assert_int_equal(judge((double)NAN, 0, -4, &claims), LAB_FAILS);
}

/* no claim without numbers of the experiment */
static void test_no_numbers(void **unused)
{
    (void)unused;
    lab_experiment experiment = {.name = "new"};
    lab_judge_stored(&experiment, numbers, 4);
    assert_int_equal(experiment.claim_count, 0);
    lab_clear(&experiment);
}

/* the table of the program has numbers of both papers, no two of one name */
static void test_table(void **unused)
{
    (void)unused;
    const lab_stored *table;
    int count = lab_stored_numbers(&table);
    assert_true(count > 200);
    for (int i = 0; i < count; i++)
        for (int k = 0; k < i; k++)
            assert_false(strcmp(table[i].experiment, table[k].experiment) == 0 &&
                         strcmp(table[i].finding, table[k].finding) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_no_numbers),
        cmocka_unit_test(test_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
