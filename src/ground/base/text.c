#include "base/text.h"

#include "base/number.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { LONGEST = 63 };

static char folded(char letter)
{
    if (letter == '_')
        return '-';
    return letter >= 'A' && letter <= 'Z' ? (char)(letter - 'A' + 'a') : letter;
}

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

static size_t cut_length(const char *text)
{
    return smaller(strlen(text), LONGEST);
}

size_t pel_edit_distance(const char *a, const char *b)
{
    size_t a_length = cut_length(a), b_length = cut_length(b);
    /* rows i - 2, i - 1 and i of the table: distance of the first i letters of a and the first j of b */
    size_t rows[3][LONGEST + 1];
    for (size_t j = 0; j <= b_length; j++)
        rows[0][j] = j;
    for (size_t i = 1; i <= a_length; i++) {
        size_t *row = rows[i % 3];
        const size_t *above = rows[(i + 2) % 3], *above_that = rows[(i + 1) % 3];
        row[0] = i;
        for (size_t j = 1; j <= b_length; j++) {
            char p = folded(a[i - 1]), q = folded(b[j - 1]);
            row[j] = smaller(above[j - 1] + (p != q), smaller(above[j], row[j - 1]) + 1);
            if (i > 1 && j > 1 && p == folded(b[j - 2]) && q == folded(a[i - 2]))
                row[j] = smaller(row[j], above_that[j - 2] + (p != q));
        }
    }
    return rows[a_length % 3][b_length];
}

const char *pel_longer_name(const char *name, const char *const *names, size_t count)
{
    const size_t length = strlen(name);
    for (size_t i = 0; length > 0 && i < count; i++)
        for (const char *at = strstr(names[i], name); at != NULL; at = strstr(at + 1, name))
            if ((at == names[i] || at[-1] == '-') && (at[length] == '\0' || at[length] == '-'))
                return names[i];
    return NULL;
}

bool pel_is_among(const char *name, const char *const *names, size_t count)
{
    bool any = false;
    for (size_t i = 0; i < count; i++)
        any |= strcmp(name, names[i]) == 0;
    return any;
}

const char *pel_nearest_name(const char *name, const char *const *names, size_t count)
{
    if (name == NULL || names == NULL)
        return NULL;
    size_t length = cut_length(name);
    size_t allowed = length / 3 > 2 ? length / 3 : 2;
    const char *nearest = NULL;
    for (size_t i = 0; i < count; i++) {
        size_t distance = pel_edit_distance(name, names[i]);
        /* an empty name is no help */
        if (distance <= allowed && distance < strlen(names[i])) {
            allowed = distance > 0 ? distance - 1 : 0;
            nearest = names[i];
            if (distance == 0)
                break;
        }
    }
    return nearest != NULL ? nearest : pel_longer_name(name, names, count);
}

size_t pel_utf8_length(const char *text, size_t size)
{
    const unsigned char *s = (const unsigned char *)text;
    if (size == 0 || (s[0] >= 0x80 && s[0] < 0xc2) || s[0] > 0xf4)
        return 0;
    size_t length = s[0] >= 0xf0 ? 4 : s[0] >= 0xe0 ? 3 : s[0] >= 0x80 ? 2 : 1;
    if (length > size)
        return 0;
    for (size_t i = 1; i < length; i++)
        if ((s[i] & 0xc0) != 0x80)
            return 0;
    bool overlong = (s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xf0 && s[1] < 0x90);
    bool beyond = (s[0] == 0xed && s[1] > 0x9f) || (s[0] == 0xf4 && s[1] > 0x8f);
    return overlong || beyond ? 0 : length;
}
