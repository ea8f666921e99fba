#include "check.h"
#include "failing_malloc.h"

#include "io/json.h"

#include <float.h>

static void test_letters(void **unused)
{
    (void)unused;
    char letter[7];
    const struct {
        const char *text, *escaped;
        int length;
    } letters[] = {{"\"", "\\\"", 1},
                   {"\\x", "\\\\", 1},
                   {"\n", "\\n", 1},
                   {"\t", "\\u0009", 1},
                   {"<b", "\\u003c", 1},
                   {"\x7f", "\\u007f", 1},
                   {"a", "a", 1},
                   {"\xc3\xa9z", "\xc3\xa9", 2},
                   {"\xe2\x82\xac", "\xe2\x82\xac", 3},
                   {"\xc0\x80", "\\ufffd", 1},
                   {"\xed\xa0\x80", "\\ufffd", 1},
                   {"\xf0\x9f\x98\x80", "\xf0\x9f\x98\x80", 4},
                   {"\xf5\x80\x80\x80", "\\ufffd", 1}};
    for (size_t i = 0; i < sizeof letters / sizeof *letters; i++) {
        assert_ptr_equal(pel_json_letter(letters[i].text, letter), letters[i].text + letters[i].length);
        assert_string_equal(letter, letters[i].escaped);
    }
    for (int first = 1; first < 256; first++)
        for (int second = 0; second < 256; second++) {
            const char text[3] = {(char)first, (char)second, '\0'};
            int length = (int)(pel_json_letter(text, letter) - text);
            bool pair = first >= 0xc2 && first < 0xe0 && (second & 0xc0) == 0x80;
            assert_int_equal(length, pair ? 2 : 1);
            for (const char *c = letter; !pair && *c != '\0'; c++)
                assert_in_range(*c, ' ', '~');
        }
}

static const char *digits(pel_json *json, double number)
{
    pel_json_free(json);
    pel_json_put_number(json, number);
    return json->text;
}

static void test_digits(void **unused)
{
    (void)unused;
    pel_json json = {0};
    assert_string_equal(digits(&json, 0.1), "0.1");
    assert_string_equal(digits(&json, -3), "-3");
    assert_string_equal(digits(&json, 0.1 + 0.2), "0.30000000000000004");
    assert_string_equal(digits(&json, HUGE_VAL), "null");
    assert_string_equal(digits(&json, (double)NAN), "null");
    const double extremes[] = {-DBL_MAX, -DBL_MIN, -4.9406564584124654e-324};
    for (size_t i = 0; i < sizeof extremes / sizeof *extremes; i++)
        assert_true(strtod(digits(&json, extremes[i]), NULL) == extremes[i]);
    pel_json_free(&json);
}

static void test_strings(void **unused)
{
    (void)unused;
    pel_json json = {0};
    pel_json_put_text(&json, "a\"b\\c\n\t</script> \xc3\xa9 \xff\xed\xa0\x80|");
    assert_string_equal(json.text, "\"a\\\"b\\\\c\\n\\u0009\\u003c/script> \xc3\xa9 \\ufffd\\ufffd\\ufffd\\ufffd|\"");
    pel_json_free(&json);
}

static void test_raw(void **unused)
{
    (void)unused;
    const double numbers[4] = {0.1, -2, (double)NAN, (double)HUGE_VAL};
    pel_json json = {0};
    pel_json_print(&json, "{\"a\":");
    pel_json_put_numbers(&json, numbers, 4);
    pel_json_print(&json, ",\"%s\":%d}", "b", 7);
    assert_string_equal(json.text, "{\"a\":[0.1,-2,null,null],\"b\":7}");
    pel_json_free(&json);
    /* beyond the room that a text is given at first */
    char expected[1200];
    snprintf(expected, sizeof expected, "<%1000d>", 3);
    pel_json_print(&json, "<%1000d>", 3);
    assert_string_equal(json.text, expected);
    pel_json_free(&json);
}

static void put_items(pel_json *json)
{
    const double numbers[2] = {1, 0.5};
    pel_json_open(json, NULL, '{');
    pel_json_text(json, "a\"", "<");
    pel_json_text(json, "b", NULL);
    pel_json_open(json, "c", '[');
    pel_json_integer(json, NULL, -7);
    pel_json_open(json, NULL, '{');
    pel_json_close(json, '}');
    pel_json_bool(json, NULL, true);
    pel_json_close(json, ']');
    pel_json_numbers(json, "d", numbers, 2);
    pel_json_key(json, "e");
    pel_json_print(json, "%d", 3);
    pel_json_null(json, "f");
    pel_json_open(json, "g", '[');
    pel_json_close(json, ']');
    pel_json_number(json, "h", 0.25);
    pel_json_close(json, '}');
}

static const char *const styled[] = {
    "{\"a\\\"\":\"\\u003c\",\"b\":null,\"c\":[-7,{},true],\"d\":[1,0.5],\"e\":3,\"f\":null,\"g\":[],\"h\":0.25}",
    "{\"a\\\"\": \"\\u003c\", \"b\": null, \"c\": [-7, {}, true], \"d\": [1, 0.5], \"e\": 3, \"f\": null, \"g\": [], "
    "\"h\": 0.25}",
    "{\n  \"a\\\"\": \"\\u003c\",\n  \"b\": null,\n  \"c\": [\n    -7,\n    {},\n    true\n  ],\n  \"d\": [1, 0.5],\n  "
    "\"e\": 3,\n"
    "  \"f\": null,\n  \"g\": [],\n  \"h\": 0.25\n}\n"};

static void test_styles(void **unused)
{
    (void)unused;
    for (int style = PEL_JSON_COMPACT; style <= PEL_JSON_INDENTED; style++) {
        pel_json json = {.style = (pel_json_style)style};
        put_items(&json);
        assert_string_equal(json.text, styled[style]);
        assert_int_equal(json.length, strlen(styled[style]));
        pel_json_free(&json);
    }
}

/* the style of an object within another one */
static void test_mixed(void **unused)
{
    (void)unused;
    pel_json json = {.style = PEL_JSON_INDENTED};
    pel_json_open(&json, NULL, '{');
    pel_json_open(&json, "a", '{');
    json.style = PEL_JSON_SPACED;
    pel_json_integer(&json, "b", 1);
    pel_json_integer(&json, "c", 2);
    pel_json_close(&json, '}');
    json.style = PEL_JSON_INDENTED;
    pel_json_close(&json, '}');
    assert_string_equal(json.text, "{\n  \"a\": {\"b\": 1, \"c\": 2}\n}\n");
    pel_json_free(&json);
}

static void test_file(void **unused)
{
    (void)unused;
    FILE *file = tmpfile();
    assert_non_null(file);
    pel_json json = {.file = file, .style = PEL_JSON_INDENTED};
    put_items(&json);
    assert_null(json.text);
    char text[400] = "";
    rewind(file);
    assert_int_equal(fread(text, 1, sizeof text - 1, file), strlen(styled[PEL_JSON_INDENTED]));
    assert_string_equal(text, styled[PEL_JSON_INDENTED]);
    fclose(file);
}

/* without memory all is lost, and it says so */
static void test_out_of_memory(void **unused)
{
    (void)unused;
    pel_json json = {0};
    failing_malloc_begin(1);
    put_items(&json);
    allocation_count count = failing_malloc_end();
    assert_int_equal(count.failed, 1);
    assert_true(json.failed);
    pel_json_free(&json);
    assert_true(!json.failed && json.depth == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_letters), cmocka_unit_test(test_digits),        cmocka_unit_test(test_strings),
        cmocka_unit_test(test_raw),     cmocka_unit_test(test_styles),        cmocka_unit_test(test_mixed),
        cmocka_unit_test(test_file),    cmocka_unit_test(test_out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
