#include "check.h"

#include "io/json.h"

static void test_strings(void **unused)
{
    (void)unused;
    pel_json json = {0};
    pel_json_string(&json, "a\"b\\c\n\t</script> \xc3\xa9 \xff\xed\xa0\x80|");
    assert_string_equal(json.text, "\"a\\\"b\\\\c\\n\\u0009\\u003c/script> \xc3\xa9 \\ufffd\\ufffd\\ufffd\\ufffd|\"");
    pel_json_free(&json);
}

static void test_numbers(void **unused)
{
    (void)unused;
    const double numbers[4] = {0.1, -2, (double)NAN, (double)HUGE_VAL};
    pel_json json = {0};
    pel_json_print(&json, "{\"a\":");
    pel_json_numbers(&json, numbers, 4);
    pel_json_print(&json, ",\"%s\":%d}", "b", 7);
    assert_string_equal(json.text, "{\"a\":[0.1,-2,null,null],\"b\":7}");
    pel_json_free(&json);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_strings), cmocka_unit_test(test_numbers)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
