/* Text of quoted and plain YAML scalars, with the cases that libfyaml 0.7.12 gets wrong. */
#include "check.h"

#include "keys/scalar.h"
#include "pellicle/scene.h"

static void check(char quote, const char *source, const char *expected)
{
    pel_arena arena = {0};
    size_t length;
    const char *text = pel_scene_decode_scalar(&arena, source, strlen(source), quote, &length);
    assert_string_equal(text, expected);
    assert_int_equal(length, strlen(expected));
    pel_arena_free(&arena);
}

static void test_plain(void **unused)
{
    (void)unused;
    check('\0', "", "");
    check('\0', "two  words", "two  words");
    check('\0', "one\n  two", "one two");
    check('\0', "one  \r\n\r\n \n  two\n three", "one\n\ntwo three");
    check('\0', "it's \\n \"so\"", "it's \\n \"so\"");
}

static void test_single_quotes(void **unused)
{
    (void)unused;
    check('\'', "it''s", "it's");
    check('\'', "'''''''''''''''''''''''''''''''''' b", "''''''''''''''''' b");
    check('\'', " a \n\n  b\\n ", " a\nb\\n ");
}

static void test_double_quotes(void **unused)
{
    (void)unused;
    check('"', "\\a\\b\\t\\n\\v\\f\\r\\e\\ \\\"\\/\\\\", "\a\b\t\n\v\f\r\x1b \"/\\");
    check('"', "\\N\\_\\L\\P", "\xc2\x85\xc2\xa0\xe2\x80\xa8\xe2\x80\xa9");
    check('"', "\\x41\\u00e9\\U0001F600", "A\xc3\xa9\xf0\x9f\x98\x80");
    check('"', "\\ud83d\\ude00\\ud83dx", "\xf0\x9f\x98\x80\xef\xbf\xbdx");
    check('"', "a  \\\n   b \n c\\\n\n d", "a  b c\nd");
    check('"', "\\n\\n\\n\\n\\n\\n\\n\\n\\n\\n\\n\\n\\n\\nz", "\n\n\n\n\n\n\n\n\n\n\n\n\n\nz");
    /* cut off escapes stay inside the source */
    check('"', "\\", "");
    check('"', "\\u4", "\x04");
}

static void test_zero_byte(void **unused)
{
    (void)unused;
    pel_arena arena = {0};
    size_t length;
    pel_scene_decode_scalar(&arena, "a\\0b", 4, '"', &length);
    assert_int_equal(length, 3);
    pel_arena_free(&arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plain),
        cmocka_unit_test(test_single_quotes),
        cmocka_unit_test(test_double_quotes),
        cmocka_unit_test(test_zero_byte),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
