#include "check.h"

#include "base/text.h"

static void test_edit_distance(void **unused)
{
    (void)unused;
    static const struct {
        const char *a, *b;
        size_t distance;
    } pairs[] = {
        {"", "", 0},
        {"", "abc", 3},
        {"abc", "", 3},
        {"radius", "radius", 0},
        {"radius", "raduis", 1},
        {"radius", "radus", 1},
        {"radius", "radiuss", 1},
        {"radius", "rodius", 1},
        {"Size-X", "size_x", 0},
        {"kitten", "sitting", 3},
        {"ca", "abc", 3},
        {"stiffness", "damping", 8},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        assert_int_equal(pel_edit_distance(pairs[i].a, pairs[i].b), pairs[i].distance);
        assert_int_equal(pel_edit_distance(pairs[i].b, pairs[i].a), pairs[i].distance);
    }
}

static void test_long_names_are_cut(void **unused)
{
    (void)unused;
    char a[200], b[200];
    memset(a, 'a', sizeof a - 1);
    memset(b, 'a', sizeof b - 1);
    a[sizeof a - 1] = b[sizeof b - 1] = '\0';
    b[150] = 'b';
    assert_int_equal(pel_edit_distance(a, b), 0);
    assert_int_equal(pel_edit_distance(a, ""), 63);
}

static void test_nearest_name(void **unused)
{
    (void)unused;
    static const char *const names[] = {"stiffness", "damping", "radius", "nx", "ny"};
    assert_string_equal(pel_nearest_name("stifness", names, 5), "stiffness");
    assert_string_equal(pel_nearest_name("dampning", names, 5), "damping");
    assert_string_equal(pel_nearest_name("ny", names, 5), "ny");
    assert_string_equal(pel_nearest_name("ni", names, 5), "nx");
    assert_null(pel_nearest_name("colour", names, 5));
    assert_null(pel_nearest_name("qq", names, 5));
    assert_null(pel_nearest_name("radius", names, 0));
}

/* every sequence of two bytes becomes valid UTF-8 that JSON allows */
static void test_json_letters(void **unused)
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_edit_distance),
        cmocka_unit_test(test_long_names_are_cut),
        cmocka_unit_test(test_nearest_name),
        cmocka_unit_test(test_json_letters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
