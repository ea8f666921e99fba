/* Claims, their numbers and their verdicts; and what a case leaves behind: numbers.csv, the page. */
#include "check.h"
#include "failing_malloc.h"

#include "papers/lab/experiment.h"
#include "papers/lab/page.h"

#include <unistd.h>

/* beyond the 16 claims and the 320 numbers of which all later ones were once dropped in silence */
enum { CLAIMS = 40, NUMBERS = 25 };

static char folder[] = "claim-XXXXXX";

static pel_status run_many(lab_experiment *experiment)
{
    char name[64];
    for (int c = 0; c < CLAIMS; c++) {
        lab_begin_claim(experiment, LAB_THEORY, "one more", NULL);
        for (int i = 0; i < NUMBERS; i++) {
            snprintf(name, sizeof name, "number %d of %d", i, c);
            /* the last one of all is wrong */
            lab_at_most(experiment, name, c * NUMBERS + i, CLAIMS * NUMBERS - 2, "here");
        }
    }
    return PEL_OK;
}

static const lab_case many = {.name = "many", .doc = "many numbers", .group = "paper A", .run = run_many};

static int count_lines(const char *path)
{
    int lines = 0, letter;
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while ((letter = fgetc(file)) != EOF)
        lines += letter == '\n';
    fclose(file);
    return lines;
}

static int count_text(const char *path, const char *text)
{
    static char line[1 << 16];
    int count = 0;
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file) != NULL)
        count += strstr(line, text) != NULL;
    fclose(file);
    return count;
}

/* a claim that fails far behind the others fails the experiment, and all numbers are written */
static void test_no_limit(void **unused)
{
    (void)unused;
    pel_error error;
    char path[LAB_PATH_SIZE], text[64];
    lab_experiment experiment = {.folder = folder, .error = &error};
    assert_int_equal(lab_run_case(&many, &experiment), PEL_OK);
    assert_int_equal(experiment.claim_count, CLAIMS);
    assert_int_equal(experiment.finding_count, CLAIMS * NUMBERS);
    for (int c = 0; c < CLAIMS - 1; c++)
        assert_string_equal(lab_claim_text(&experiment, c, text, sizeof text), "holds (25 of 25)");
    assert_string_equal(lab_claim_text(&experiment, CLAIMS - 1, text, sizeof text), "fails (24 of 25)");
    assert_int_equal(lab_experiment_verdict(&experiment), LAB_FAILS);
    assert_int_equal(count_lines(lab_path(&experiment, "numbers.csv", path)), 1 + CLAIMS * NUMBERS);
    const lab_experiment *const all[] = {&experiment};
    assert_int_equal(lab_write_page(folder, all, 1, &error), PEL_OK);
    assert_int_equal(count_text(lab_path(&experiment, "index.md", path), "| theory | one more |"), CLAIMS);
    assert_int_equal(count_text(path, "pellicle reproduce many"), 1);
    assert_int_equal(count_text(path, "39 claims hold, 0 differ, 1 fail. 999 of 1000 judged numbers"), 1);
    assert_int_equal(count_text(lab_path(&experiment, "index.html", path), "<tr><td>theory</td><td>one more"), CLAIMS);
    lab_clear(&experiment);
    assert_null(experiment.findings);
}

/* two tables, and a claim that holds by construction */
static pel_status run_tabled(lab_experiment *experiment)
{
    lab_begin_claim(experiment, LAB_PAPER, "four are four", NULL);
    lab_by_construction(experiment, "so it is laid out");
    lab_expect(experiment, "four", 4, 4, 0, "");
    lab_begin_claim(experiment, LAB_PAPER, "five are five", NULL);
    lab_expect(experiment, "five", 5, 5, 0, "");
    lab_begin_table(experiment, "Times", "body|s");
    lab_add_row(experiment, "kitten|2 < 3");
    lab_add_row(experiment, "hand|");
    lab_begin_table(experiment, "Others", "one");
    lab_add_row(experiment, "last");
    return PEL_OK;
}

static const lab_case tabled = {
    .name = "tabled", .doc = "tables", .group = "paper B", .place = "section 6, table 1", .run = run_tabled};

static void test_tables(void **unused)
{
    (void)unused;
    pel_error error;
    char path[LAB_PATH_SIZE], text[64];
    lab_experiment experiment = {.folder = folder, .error = &error};
    assert_int_equal(lab_run_case(&tabled, &experiment), PEL_OK);
    assert_string_equal(lab_claim_text(&experiment, 0, text, sizeof text),
                        "holds (1 of 1), by construction: so it is laid out");
    assert_string_equal(lab_claim_text(&experiment, 1, text, sizeof text), "holds (1 of 1)");
    assert_int_equal(count_text(lab_path(&experiment, "numbers.csv", path), ",holds,1"), 1);
    const lab_experiment *const all[] = {&experiment};
    assert_int_equal(lab_write_page(folder, all, 1, &error), PEL_OK);
    static const char *const markdown[] = {
        "2 claims hold, 0 differ, 0 fail. 2 of 2 judged numbers are within their limits; 1 of them hold by "
        "construction.",
        "## paper B, section 6, table 1: tables",
        "| body | s |",
        "|---|---|",
        "| kitten | 2 &lt; 3 |",
        "| hand |  |",
        "Others:",
        "| last |",
    };
    lab_path(&experiment, "index.md", path);
    for (size_t i = 0; i < sizeof markdown / sizeof *markdown; i++)
        assert_true(count_text(path, markdown[i]) >= 1);
    lab_path(&experiment, "index.html", path);
    assert_int_equal(count_text(path, "<tr><td>kitten</td><td>2 &lt; 3</td></tr>"), 1);
    assert_int_equal(count_text(path, "</table>"), 4);
    lab_clear(&experiment);
}

static pel_status run_tabled_with_failures(const void *unused, pel_error *error)
{
    (void)unused;
    lab_experiment experiment = {.folder = folder, .error = error};
    pel_status status = lab_run_case(&tabled, &experiment);
    lab_clear(&experiment);
    return status;
}

/* out of memory is an error, not a claim fewer */
static pel_status run_with_failures(const void *unused, pel_error *error)
{
    (void)unused;
    lab_experiment experiment = {.folder = folder, .error = error};
    pel_status status = lab_run_case(&many, &experiment);
    lab_clear(&experiment);
    return status;
}

static void test_out_of_memory(void **unused)
{
    (void)unused;
    assert_true(for_allocation_failures(run_with_failures, NULL, 37) >= CLAIMS + CLAIMS * NUMBERS);
    assert_true(for_allocation_failures(run_tabled_with_failures, NULL, 1) >= 9);
}

static lab_experiment judged(lab_origin origin, const char *reason, double value)
{
    lab_experiment experiment = {0};
    lab_begin_claim(&experiment, origin, "it is 1", reason);
    lab_expect(&experiment, "value", value, 1, 0.25, "");
    lab_tell(&experiment, "beside", -1, 1, "");
    return experiment;
}

static void test_verdicts(void **unused)
{
    (void)unused;
    static const struct {
        lab_origin origin;
        const char *reason;
        double value;
        bool given_bodies;
        lab_verdict verdict;
    } rows[] = {
        {LAB_PAPER, NULL, 1.25, false, LAB_HOLDS},           {LAB_PAPER, NULL, 1.26, false, LAB_FAILS},
        {LAB_PAPER, "known", 1.26, false, LAB_DIFFERS},      {LAB_PAPER, NULL, 0.7, true, LAB_DIFFERS},
        {LAB_REGRESSION, NULL, 0.7, true, LAB_DIFFERS},      {LAB_REGRESSION, "known", 0.7, false, LAB_FAILS},
        {LAB_THEORY, "known", (double)NAN, true, LAB_FAILS}, {LAB_REFERENCE, NULL, 0.75, false, LAB_HOLDS},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        lab_experiment experiment = judged(rows[i].origin, rows[i].reason, rows[i].value);
        experiment.given_bodies = rows[i].given_bodies;
        assert_int_equal(lab_claim_verdict(&experiment, 0), rows[i].verdict);
        assert_true(lab_finding_holds(&experiment.findings[1]));
        lab_clear(&experiment);
    }
    lab_experiment told = {0};
    lab_begin_claim(&told, LAB_PAPER, "nothing is judged", NULL);
    lab_tell(&told, "value", 2, 1, "");
    assert_int_equal(lab_experiment_verdict(&told), LAB_ONLY_TOLD);
    lab_clear(&told);
}

/* a reason speaks of the bodies of the program, also where others were given */
static void test_reasons(void **unused)
{
    (void)unused;
    static const struct {
        const char *reason, *text;
        bool given_bodies;
    } rows[] = {
        {"the liver folds", "differs (0 of 1 hold): the liver folds", false},
        {"the liver folds", "differs (0 of 1 hold) on bodies that were given; on those of the program: the liver folds",
         true},
        {NULL, "differs (0 of 1 hold) on bodies that were given", true},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[128];
        lab_experiment experiment = judged(LAB_PAPER, rows[i].reason, 2);
        experiment.given_bodies = rows[i].given_bodies;
        assert_string_equal(lab_claim_text(&experiment, 0, text, sizeof text), rows[i].text);
        lab_clear(&experiment);
    }
}

static void test_limits(void **unused)
{
    (void)unused;
    lab_experiment experiment = {0};
    lab_begin_claim(&experiment, LAB_THEORY, "limits", NULL);
    lab_at_most(&experiment, "at most", 2, 2, "");
    lab_at_most(&experiment, "above", 2.5, 2, "");
    lab_at_least(&experiment, "at least", 2, 2, "");
    lab_at_least(&experiment, "below", 1.5, 2, "");
    static const bool holds[] = {true, false, true, false};
    for (int i = 0; i < 4; i++)
        assert_int_equal(lab_finding_holds(&experiment.findings[i]), holds[i]);
    lab_clear(&experiment);
}

static int make_folder(void **unused)
{
    (void)unused;
    return mkdtemp(folder) != NULL ? 0 : 1;
}

static int remove_folder(void **unused)
{
    (void)unused;
    char path[64];
    static const char *const names[] = {"numbers.csv", "index.html", "index.md"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        unlink(path);
    }
    return rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_limit), cmocka_unit_test(test_tables),  cmocka_unit_test(test_out_of_memory),
        cmocka_unit_test(test_verdicts), cmocka_unit_test(test_reasons), cmocka_unit_test(test_limits),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
