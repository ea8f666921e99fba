#include "check.h"

#include "base/text.h"

#include <pellicle/base.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>

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
    /* parts between hyphens */
    static const char *const kinds[] = {"lens-capsule", "capsule", "uv-sphere", "geodesic-sphere"};
    assert_string_equal(pel_nearest_name("capsule", kinds, 4), "capsule");
    assert_string_equal(pel_nearest_name("lens", kinds, 4), "lens-capsule");
    assert_string_equal(pel_nearest_name("sphere", kinds, 4), "uv-sphere");
    assert_null(pel_nearest_name("spheres-of", kinds, 4));
    assert_null(pel_nearest_name("phere", kinds, 2));
    /* a third of the letters may be wrong, and two of short names */
    for (int length = 4; length <= 14; length++)
        for (int wrong = 1; wrong < length; wrong++) {
            char name[16] = "", *right = "abcdefghijklmn";
            const char *const known[] = {name};
            snprintf(name, sizeof name, "%.*s", length, right);
            for (int i = 0; i < wrong; i++)
                name[i] = (char)('0' + i);
            char asked[16];
            snprintf(asked, sizeof asked, "%.*s", length, right);
            bool is_near = wrong <= 2 || 3 * wrong <= length;
            assert_true((pel_nearest_name(asked, known, 1) != NULL) == is_near);
        }
}

/* every sequence of two bytes becomes valid UTF-8 that JSON allows */
/* the UTF-8 of a number, as RFC 3629 has it; returns its bytes */
static size_t encode(uint32_t code, char text[4])
{
    static const unsigned heads[] = {0, 0, 0xc0, 0xe0, 0xf0};
    size_t length = code < 0x80 ? 1 : code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
    for (size_t i = length; i-- > 1; code >>= 6)
        text[i] = (char)(0x80 | (code & 0x3f));
    text[0] = (char)(heads[length] | code);
    return length;
}

/* every code point is a character, surrogates are none, and no four bytes are one that no code point gives */
static void test_utf8(void **unused)
{
    (void)unused;
    char text[4], again[4];
    for (uint32_t code = 0; code < 0x110000; code++) {
        size_t length = encode(code, text), expected = code < 0xd800 || code > 0xdfff ? length : 0;
        if (pel_utf8_length(text, 4) != expected || pel_utf8_length(text, length) != expected ||
            pel_utf8_length(text, length - 1) != 0)
            fail_msg("code point %x", (unsigned)code);
    }
    uint32_t state = 1;
    for (int i = 0; i < ROUNDS(2000000, 100000); i++) {
        state = state * 1664525 + 1013904223;
        /* heads are more telling than letters */
        const unsigned char bytes[4] = {(unsigned char)(0xc0 | state >> 26), (unsigned char)(state >> 18),
                                        (unsigned char)(0x80 | (state >> 12 & 0x7f)),
                                        (unsigned char)(0x80 | (state >> 4 & 0x3f))};
        memcpy(text, bytes, 4);
        size_t length = pel_utf8_length(text, 4);
        uint32_t code = bytes[0] & (0x7fu >> length);
        for (size_t k = 1; k < length; k++)
            code = code << 6 | (bytes[k] & 0x3f);
        if (length == 0)
            continue;
        assert_int_equal(encode(code, again), length);
        assert_memory_equal(again, text, length);
        assert_true(code < 0x110000 && (code < 0xd800 || code > 0xdfff));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_edit_distance),
        cmocka_unit_test(test_long_names_are_cut),
        cmocka_unit_test(test_nearest_name),
        cmocka_unit_test(test_utf8),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
