/* A decimal number is w 10^k with integers w and k. The nearest double is found by the first of three methods that
   applies:

   1. w <= 2^53 and |k| <= 22: both w and 10^|k| are doubles, so one multiplication or division rounds once (Clinger,
      "How to read floating point numbers accurately", 1990).
   2. w < 2^64 (19 digits) and |k| <= 27: 10^k = 5^k 2^k and 5^27 < 2^63, so w 5^k fits 128 bits, and w / 5^-k is a
      128-bit quotient with a remainder that decides on which side of a tie it lies. Rounding to 53 bits is done in
   integers. All numbers printed with 17 digits between 1e-10 and 1e27 end here.
   3. Anything else goes to strtod, as digits without a point and an exponent (independent of the locale). 800 digits
      and a mark for further non-zero digits are enough: a tie between doubles has at most 767. */
#include "base/number.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct decimal {
    uint64_t mantissa; /* the first 19 significant digits */
    int64_t exponent;  /* of ten, belonging to the mantissa */
    int64_t written;   /* the exponent after the letter e */
    bool negative;
    bool whole; /* no digit but zeros is missing from the mantissa */
} decimal;

static inline bool is_digit(char c)
{
    return (unsigned)(c - '0') < 10;
}

/* digits and a point; returns the end, null when there is no digit */
static inline const char *parse_digits(const char *at, const char *end, decimal *number)
{
    const uint64_t room_for_one_more = (UINT64_MAX - 9) / 10;
    const char *start = at;
    uint64_t mantissa = 0;
    while (at < end && is_digit(*at) && mantissa <= room_for_one_more)
        mantissa = 10 * mantissa + (uint64_t)(*at++ - '0');
    int64_t dropped = 0, digits = at - start;
    for (; at < end && is_digit(*at); at++, digits++, dropped++)
        number->whole = number->whole && *at == '0';
    if (at < end && *at == '.') {
        const char *point = ++at;
        while (at < end && is_digit(*at) && mantissa <= room_for_one_more && dropped == 0)
            mantissa = 10 * mantissa + (uint64_t)(*at++ - '0');
        number->exponent = point - at;
        digits += at - point;
        for (; at < end && is_digit(*at); at++, digits++)
            number->whole = number->whole && *at == '0';
    }
    number->exponent += dropped;
    number->mantissa = mantissa;
    return digits > 0 ? at : NULL;
}

/* an exponent, or nothing when no digit follows the letter */
static inline const char *parse_exponent(const char *at, const char *end, decimal *number)
{
    if (at == end || (*at != 'e' && *at != 'E'))
        return at;
    const char *digits = at + 1;
    bool negative = digits < end && *digits == '-';
    if (digits < end && (*digits == '-' || *digits == '+'))
        digits++;
    if (digits == end || !is_digit(*digits))
        return at;
    const int64_t enough = INT64_C(1) << 50;
    int64_t value = 0;
    for (; digits < end && is_digit(*digits); digits++)
        if (value < enough)
            value = 10 * value + (*digits - '0');
    number->written = negative ? -value : value;
    number->exponent += number->written;
    return digits;
}

static double power_of_two(int exponent)
{
    uint64_t bits = (uint64_t)(1023 + exponent) << 52;
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

#ifdef __SIZEOF_INT128__
__extension__ typedef unsigned __int128 wide;

static int bit_length(wide value)
{
    uint64_t high = (uint64_t)(value >> 64);
    return high != 0 ? 128 - __builtin_clzll(high) : 64 - __builtin_clzll((uint64_t)value);
}

/* nearest double to value 2^exponent, where `more` says that a fraction below the last bit was cut off */
static double round_wide(wide value, int exponent, bool more)
{
    int shift = bit_length(value) - DBL_MANT_DIG;
    if (shift <= 0)
        return (double)(uint64_t)value * power_of_two(exponent);
    uint64_t kept = (uint64_t)(value >> shift);
    wide rest = value & (((wide)1 << shift) - 1), half = (wide)1 << (shift - 1);
    if (rest > half || (rest == half && (more || (kept & 1) != 0)))
        kept++;
    return (double)kept * power_of_two(exponent + shift);
}

/* w 10^k through 128-bit integers; w > 0, |k| <= 27 */
static double scale_wide(uint64_t mantissa, int exponent)
{
    static const uint64_t powers_of_five[28] = {
        1U,
        5U,
        25U,
        125U,
        625U,
        3125U,
        15625U,
        78125U,
        390625U,
        1953125U,
        9765625U,
        48828125U,
        244140625U,
        1220703125U,
        6103515625U,
        30517578125U,
        152587890625U,
        762939453125U,
        3814697265625U,
        19073486328125U,
        95367431640625U,
        476837158203125U,
        2384185791015625U,
        11920928955078125U,
        59604644775390625U,
        298023223876953125U,
        1490116119384765625U,
        7450580596923828125U,
    };
    if (exponent >= 0)
        return round_wide((wide)mantissa * powers_of_five[exponent], exponent, false);
    uint64_t divisor = powers_of_five[-exponent];
    int shift = 64 + __builtin_clzll(mantissa);
    wide dividend = (wide)mantissa << shift, quotient = dividend / divisor;
    return round_wide(quotient, exponent - shift, quotient * divisor != dividend);
}
#endif

/* the third way: significant digits and exponent handed to strtod */
static double parse_slowly(const char *at, const char *end, int64_t exponent)
{
    enum { DIGIT_LIMIT = 800 };
    char text[DIGIT_LIMIT + 32];
    int count = 0;
    bool after_point = false, more = false;
    for (; at < end && (is_digit(*at) || *at == '.'); at++) {
        if (*at == '.') {
            after_point = true;
            continue;
        }
        bool taken = count < DIGIT_LIMIT;
        if (!taken)
            more = more || *at != '0';
        else if (count > 0 || *at != '0')
            text[count++] = *at;
        exponent += !taken - after_point;
    }
    if (more) {
        text[count++] = '1';
        exponent--;
    }
    const int64_t limit = 100000;
    exponent = exponent < -limit ? -limit : exponent > limit ? limit : exponent;
    snprintf(text + count, sizeof text - (size_t)count, "e%d", (int)exponent);
    return strtod(text, NULL);
}

static double decimal_value(const decimal *number, const char *digits, const char *end)
{
    static const double powers_of_ten[23] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                             1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const uint64_t largest_exact = UINT64_C(1) << DBL_MANT_DIG;
    int64_t exponent = number->exponent;
    if (number->whole) {
        if (number->mantissa == 0)
            return 0;
        if (number->mantissa <= largest_exact && exponent >= -22 && exponent <= 22)
            return exponent < 0 ? (double)number->mantissa / powers_of_ten[-exponent]
                                : (double)number->mantissa * powers_of_ten[exponent];
#ifdef __SIZEOF_INT128__
        if (exponent >= -27 && exponent <= 27)
            return scale_wide(number->mantissa, (int)exponent);
#endif
    }
    return parse_slowly(digits, end, number->written);
}

/* the length of `word` when the text begins with it in any case, else 0 */
static size_t match_word(const char *at, const char *end, const char *word)
{
    size_t length = strlen(word);
    if ((size_t)(end - at) < length)
        return 0;
    for (size_t i = 0; i < length; i++)
        if ((at[i] | 0x20) != word[i])
            return 0;
    return length;
}

static const char *parse_special(const char *at, const char *end, double *value)
{
    static const char *const words[3] = {"infinity", "inf", "nan"};
    for (int i = 0; i < 3; i++) {
        size_t length = match_word(at, end, words[i]);
        if (length > 0) {
            *value = i < 2 ? (double)HUGE_VAL : (double)NAN;
            return at + length;
        }
    }
    return NULL;
}

const char *pel_number_parse(const char *at, const char *end, double *value)
{
    decimal number = {.whole = true};
    if (at < end && (*at == '-' || *at == '+'))
        number.negative = *at++ == '-';
    const char *digits = at;
    const char *behind = parse_digits(at, end, &number);
    if (behind == NULL) {
        behind = parse_special(at, end, value);
    } else {
        behind = parse_exponent(behind, end, &number);
        *value = decimal_value(&number, digits, end);
    }
    if (behind != NULL && number.negative)
        *value = -*value;
    return behind;
}

/* replaces the decimal point of the locale by '.' */
static size_t fix_point(char *text)
{
    size_t length = 0;
    bool inside = false;
    for (const char *at = text; *at != '\0'; at++) {
        bool usual = is_digit(*at) || *at == '-' || *at == '+' || *at == 'e';
        if (usual || !inside)
            text[length++] = *at;
        if (!usual && !inside)
            text[length - 1] = '.';
        inside = !usual;
    }
    text[length] = '\0';
    return length;
}

size_t pel_number_print(char text[PEL_NUMBER_SIZE], double value)
{
    if (!isfinite(value))
        return (size_t)snprintf(text, PEL_NUMBER_SIZE, "%s", isnan(value) ? "nan" : value > 0 ? "inf" : "-inf");
    size_t length = 0;
    double back = 0;
    for (int digits = DBL_DIG; digits <= DBL_DECIMAL_DIG; digits++) {
        snprintf(text, PEL_NUMBER_SIZE, "%.*g", digits, value);
        length = fix_point(text);
        if (pel_number_parse(text, text + length, &back) != NULL && back == value)
            break;
    }
    return length;
}
