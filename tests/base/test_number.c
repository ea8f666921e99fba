#include "check.h"
#include "comma_locale.h"
#include "random.h"

#include "base/number.h"

#include <stdbool.h>
#include <stdlib.h>

static random_state generator = {.seed = 20240607};

/* same bits and same end as strtod */
static void check_against_strtod(const char *text)
{
    double value = 0;
    char *expected_end;
    const double expected = strtod(text, &expected_end);
    const char *end = pel_number_parse(text, text + strlen(text), &value);
    if (end != expected_end || memcmp(&value, &expected, sizeof value) != 0) {
        print_error("'%s' gives %a, strtod gives %a\n", text, value, expected);
        fail();
    }
}

static void test_chosen_texts(void **unused)
{
    (void)unused;
    static const char *const texts[] = {
        "0",
        "-0",
        "+1",
        "1.",
        ".5",
        "-.5e1",
        "1e5",
        "1E+5",
        "1e-5",
        "123456789012345678901234567890",
        "1e22",
        "1e23",
        "9007199254740993",
        "9007199254740993.00000",
        "9007199254740992.5",
        "9007199254740993.0000000000000000000001",
        "0.1",
        "0.30000000000000004",
        "1.7976931348623157e308",
        "1.7976931348623159e308",
        "1e309",
        "-1e400",
        "1e-400",
        "4.9e-324",
        "2.4703282292062327e-324",
        "2.4703282292062328e-324",
        "2.2250738585072011e-308",
        "2.2250738585072014e-308",
        "1e99999999999999999999",
        "1e-99999999999999999999",
        "0e99999999999999999999",
        "0.000000000000000000000000000000000000000000000000000000000000000000000000000001",
        "000000000000000000000001.5",
        "18446744073709551615",
        "18446744073709551616",
        "1844674407370955161.5e3",
        "1e27",
        "1e-27",
        "12345678901234567e27",
        "12345678901234567e-27",
        "12345678901234567e-28",
        "1e",
        "1e+",
        "1ex",
        "2.5abc",
        "inf",
        "-INF",
        "Infinity",
        "nan",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        check_against_strtod(texts[i]);
}

static void test_no_number(void **unused)
{
    (void)unused;
    static const char *const texts[] = {"",   "-",   "+",   ".",   "-.",  "e5",  "x",       " 1",
                                        "in", "\n1", "--1", "xnf", "zan", "nax", "ynfinity"};
    double value;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        assert_null(pel_number_parse(texts[i], texts[i] + strlen(texts[i]), &value));
}

/* nothing past the end is read */
static void test_stops_at_end(void **unused)
{
    (void)unused;
    const char *text = "12.5e10";
    const double expected[7] = {1, 12, 12, 12.5, 12.5, 12.5e1, 12.5e10};
    for (size_t length = 1; length <= 7; length++) {
        double value;
        assert_non_null(pel_number_parse(text, text + length, &value));
        assert_near(value, expected[length == 5 ? 4 : length - 1], 0);
    }
}

/* random doubles of every size, printed with 1 to 25 digits in both notations */
static void test_random_doubles(void **unused)
{
    (void)unused;
    char text[512];
    for (int i = 0; i < ROUNDS(400000, 40000); i++) {
        uint64_t bits = random_bits(&generator);
        double value;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value))
            continue;
        int digits = 1 + (int)(random_bits(&generator) % 25);
        snprintf(text, sizeof text, "%.*e", digits, value);
        check_against_strtod(text);
        /* of the size of coordinates */
        value = ldexp((double)(bits >> 11), -(int)(random_bits(&generator) % 80)) * ((bits & 1) != 0 ? 1 : -1);
        snprintf(text, sizeof text, "%.*g", digits, value);
        check_against_strtod(text);
        snprintf(text, sizeof text, "%.*f", digits, value);
        check_against_strtod(text);
    }
}

/* random digits with a random exponent: every way of the parser and the borders between them */
static void test_random_digits(void **unused)
{
    (void)unused;
    char text[128];
    for (int i = 0; i < ROUNDS(1000000, 100000); i++) {
        uint64_t bits = random_bits(&generator);
        int count = 1 + (int)(bits % 22), point = (int)((bits >> 8) % 23), length = 0;
        for (int d = 0; d < count; d++) {
            if (d == point)
                text[length++] = '.';
            text[length++] =
                (char)('0' + (bits >> 16 & 3 ? random_bits(&generator) % 10 : 9 * (random_bits(&generator) % 2)));
        }
        snprintf(text + length, sizeof text - (size_t)length, "e%d", (int)(bits >> 32 & 127) - 64);
        check_against_strtod(text);
    }
}

/* the middle between two doubles, exactly, a little less and a little more */
static void test_ties(void **unused)
{
    (void)unused;
    char text[1200];
    for (int i = 0; i < 20000; i++) {
        uint64_t bits = random_bits(&generator);
        double mantissa = (double)(UINT64_C(1) << 52 | bits >> 12);
        int exponent = (int)(random_bits(&generator) % 160) - 100;
        /* all digits of (2 mantissa + 1) 2^(exponent - 1) */
        long double tie = ldexpl(2.0L * (long double)mantissa + 1.0L, exponent - 1);
        int length = snprintf(text, sizeof text, "%.110Lf", tie);
        check_against_strtod(text);
        text[length] = '1';
        text[length + 1] = '\0';
        check_against_strtod(text);
    }
}

#ifdef __SIZEOF_INT128__
/* w / 10^k with 63-bit w next to a tie: whether the division left a rest decides */
static void test_quotients_at_ties(void **unused)
{
    (void)unused;
    __extension__ typedef unsigned __int128 wide;
    for (int i = 0; i < 50000; i++) {
        int k = 1 + (int)(random_bits(&generator) % 27);
        wide tie = (random_bits(&generator) >> 11 | UINT64_C(1) << 53 | 1);
        for (int power = 0; power < k; power++)
            tie *= 5;
        while (tie >> 64 != 0)
            tie >>= 1;
        for (uint64_t step = 0; step < 2; step++) {
            char text[64];
            snprintf(text, sizeof text, "%llue-%d", (unsigned long long)((uint64_t)tie + step), k);
            check_against_strtod(text);
        }
    }
}
#endif

/* a tie that only a digit after a thousand zeros decides */
static void test_tie_decided_late(void **unused)
{
    (void)unused;
    char text[1200];
    const char *const ends[2] = {"", "1"};
    for (int i = 0; i < 2; i++) {
        snprintf(text, sizeof text, "1.00000000000000011102230246251565404236316680908203125%01000d%s", 0, ends[i]);
        check_against_strtod(text);
    }
}

static void test_very_long_numbers(void **unused)
{
    (void)unused;
    static char text[5000];
    for (int point = 0; point < 4000; point += 97) {
        for (int i = 0; i < 4000; i++)
            text[i] = (char)('0' + (point % 2 != 0 ? random_bits(&generator) % 10 : 0));
        text[0] = '3';
        text[3999] = '7';
        text[point] = '.';
        text[4000] = '\0';
        check_against_strtod(text);
        snprintf(text + 4000, 100, "e-%d", point);
        check_against_strtod(text);
    }
}

static void test_print_reads_back(void **unused)
{
    (void)unused;
    char text[PEL_NUMBER_SIZE];
    for (int i = 0; i < 100000; i++) {
        uint64_t bits = random_bits(&generator);
        double value;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value))
            continue;
        size_t length = pel_number_print(text, value);
        assert_true(length < PEL_NUMBER_SIZE && length == strlen(text));
        const double back = strtod(text, NULL);
        assert_memory_equal(&back, &value, sizeof value);
    }
    pel_number_print(text, 0.1);
    assert_string_equal(text, "0.1");
    pel_number_print(text, -0.0);
    assert_string_equal(text, "-0");
    pel_number_print(text, 1e300);
    assert_string_equal(text, "1e+300");
    pel_number_print(text, (double)-HUGE_VAL);
    assert_string_equal(text, "-inf");
}

/* a decimal comma changes nothing */
static void test_locale(void **unused)
{
    (void)unused;
    if (!set_comma_locale())
        skip();
    double value, slow;
    const char *text = "0.5", *digits = "0.12345678901234567890123";
    assert_non_null(pel_number_parse(text, text + 3, &value));
    assert_non_null(pel_number_parse(digits, digits + strlen(digits), &slow));
    char printed[PEL_NUMBER_SIZE];
    pel_number_print(printed, 0.5);
    setlocale(LC_NUMERIC, "C");
    assert_near(value, 0.5, 0);
    assert_near(slow, 0.12345678901234567890123, 0);
    assert_string_equal(printed, "0.5");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_chosen_texts),      cmocka_unit_test(test_no_number),
        cmocka_unit_test(test_stops_at_end),      cmocka_unit_test(test_random_doubles),
        cmocka_unit_test(test_random_digits),     cmocka_unit_test(test_ties),
#ifdef __SIZEOF_INT128__
        cmocka_unit_test(test_quotients_at_ties),
#endif
        cmocka_unit_test(test_tie_decided_late),  cmocka_unit_test(test_very_long_numbers),
        cmocka_unit_test(test_print_reads_back),  cmocka_unit_test(test_locale),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
