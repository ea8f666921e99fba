/* Cells of CSV lines: quotes, empty ones, ends of lines, and cells that are too long. */
#include "check.h"

#include "io/csv.h"

static void check(const char *line, const char *const cells[])
{
    char cell[12];
    int i = 0;
    while (pel_csv_next(&line, cell, sizeof cell))
        assert_string_equal(cell, cells[i++]);
    assert_null(cells[i]);
    assert_null(line);
}

static void test_cells(void **unused)
{
    (void)unused;
    check("a,b\n", (const char *const[]){"a", "b", NULL});
    check("a,b\r\nc", (const char *const[]){"a", "b", NULL});
    check("1.5", (const char *const[]){"1.5", NULL});
    check("", (const char *const[]){"", NULL});
    check(",,", (const char *const[]){"", "", "", NULL});
    check("\"a,b\",\"say \"\"so\"\"\",c", (const char *const[]){"a,b", "say \"so\"", "c", NULL});
    check("\"\",\"\"\"\"", (const char *const[]){"", "\"", NULL});
    check("a\"b,c\"d,e", (const char *const[]){"ab,cd", "e", NULL});
    /* open quotes end with the line */
    check("\"a,b\nc", (const char *const[]){"a,b", NULL});
    check("0123456789abcdef,x", (const char *const[]){"0123456789a", "x", NULL});
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_cells)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
