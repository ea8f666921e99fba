#include "check.h"

#include "papers/lab/file.h"
#include "papers/lab/median.h"

#include <pellicle/error.h>

#include <sys/stat.h>
#include <unistd.h>

static char path[] = "papers-file-XXXXXX";

static void write_escaped(FILE *file, const void *context)
{
    lab_put_escaped(file, context);
}

static void test_whole(void **unused)
{
    (void)unused;
    char text[64] = "";
    pel_error error;
    assert_int_equal(lab_write_file(path, "text", write_escaped, "a < b & c > \"d\"", &error), PEL_OK);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_non_null(fgets(text, sizeof text, file));
    fclose(file);
    assert_string_equal(text, "a &lt; b &amp; c &gt; \"d\"");
}

/* neither a file that cannot be opened nor one that cannot hold its text is taken for written */
static void test_failures(void **unused)
{
    (void)unused;
    pel_error error;
    assert_int_equal(lab_write_file("no such folder/text", "text", write_escaped, "", &error), PEL_BAD_FILE);
    assert_string_equal(error.what, "cannot write the text");
    assert_string_equal(error.file, "no such folder/text");
    assert_int_equal(lab_write_file("/dev/full", "text", write_escaped, "a", &error), PEL_BAD_FILE);
    assert_string_equal(error.what, "the text could not be written completely");
    assert_string_equal(error.file, "/dev/full");
}

static void test_median(void **unused)
{
    (void)unused;
    double odd[] = {3, -1, 2}, even[] = {4, 1, 3, 2}, one[] = {7};
    assert_near(lab_median(odd, 3), 2, 0);
    assert_near(lab_median(even, 4), 2.5, 0);
    assert_near(lab_median(one, 1), 7, 0);
    assert_near(odd[0], -1, 0);
}

static int make_file(void **unused)
{
    (void)unused;
    int file = mkstemp(path);
    return file >= 0 ? close(file) : 1;
}

static int remove_file(void **unused)
{
    (void)unused;
    return unlink(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_whole),
        cmocka_unit_test(test_failures),
        cmocka_unit_test(test_median),
    };
    return cmocka_run_group_tests(tests, make_file, remove_file);
}
