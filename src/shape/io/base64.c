#include "io/base64.h"

#include "io/text_cursor.h"

/* -1 = none of the alphabet */
static int value_of(char letter)
{
    if (letter >= 'A' && letter <= 'Z')
        return letter - 'A';
    if (letter >= 'a' && letter <= 'z')
        return letter - 'a' + 26;
    if (pel_is_digit(letter))
        return letter - '0' + 52;
    return letter == '+' ? 62 : letter == '/' ? 63 : -1;
}

size_t pel_base64_decode(const char *at, const char *end, unsigned char *bytes, size_t limit)
{
    size_t count = 0;
    unsigned group = 0, digits = 0, padding = 0;
    for (; at < end && count < limit; at++) {
        int value = value_of(*at);
        if (pel_is_space(*at))
            continue;
        if (value < 0 && *at != '=')
            break;
        padding += *at == '=';
        group = group << 6 | (value < 0 ? 0u : (unsigned)value);
        if (++digits < 4)
            continue;
        for (unsigned i = 0; i + padding < 3 && count < limit; i++)
            bytes[count++] = (unsigned char)(group >> (16 - 8 * i));
        group = digits = padding = 0;
    }
    return count;
}
