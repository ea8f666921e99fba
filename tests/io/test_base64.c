/* Base64: every letter, spaces and padding, and what is none of it. */
#include "check.h"

#include "io/base64.h"

#include <string.h>

static void expect(const char *text, const unsigned char *bytes, size_t count)
{
    unsigned char got[64] = {0};
    assert_int_equal(pel_base64_decode(text, text + strlen(text), got, sizeof got), count);
    assert_memory_equal(got, bytes, count);
}

/* each letter as the first, second, third and fourth of its group: the six bits are its number */
static void test_letters(void **unused)
{
    (void)unused;
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (unsigned value = 0; value < 64; value++)
        for (unsigned at = 0; at < 4; at++) {
            char text[] = "AAAA";
            text[at] = letters[value];
            unsigned group = value << (18 - 6 * at);
            expect(text,
                   (unsigned char[]){(unsigned char)(group >> 16), (unsigned char)(group >> 8), (unsigned char)group},
                   3);
        }
}

static void test_ends(void **unused)
{
    (void)unused;
    expect("", NULL, 0);
    expect("aGk=", (const unsigned char *)"hi", 2);
    expect("aA==", (const unsigned char *)"h", 1);
    expect(" a\nG\tk=\r\n", (const unsigned char *)"hi", 2);
    expect("aGlo*aGlo", (const unsigned char *)"hih", 3);
    unsigned char few[2] = {0, 7};
    const char *text = "aGlo";
    assert_int_equal(pel_base64_decode(text, text + 4, few, 1), 1);
    assert_int_equal(few[0], 'h');
    assert_int_equal(few[1], 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_letters),
        cmocka_unit_test(test_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
