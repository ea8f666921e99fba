#include "io/text_cursor.h"

#include "base/number.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void pel_text_cursor_skip_comments(pel_text_cursor *scan)
{
    pel_text_cursor_skip_spaces(scan);
    while (scan->at < scan->end && *scan->at == '#') {
        pel_text_cursor_skip_line(scan);
        pel_text_cursor_skip_spaces(scan);
    }
}

const char *pel_text_cursor_word(pel_text_cursor *scan, size_t *length)
{
    pel_text_cursor_skip_blanks(scan);
    const char *word = scan->at;
    while (scan->at < scan->end && !pel_is_space(*scan->at))
        scan->at++;
    *length = (size_t)(scan->at - word);
    return word;
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c + ('a' - 'A')) : c;
}

bool pel_text_cursor_accept(pel_text_cursor *scan, const char *word)
{
    pel_text_cursor behind = *scan;
    for (; *word != '\0'; word++, behind.at++)
        if (behind.at == scan->end || lower(*behind.at) != lower(*word))
            return false;
    if (!pel_text_cursor_at_break(&behind))
        return false;
    scan->at = behind.at;
    return true;
}

bool pel_word_is_one_of(const char *word, size_t length, const char *const *words)
{
    for (; *words != NULL; words++)
        if (strlen(*words) == length && memcmp(*words, word, length) == 0)
            return true;
    return false;
}

bool pel_text_cursor_any_number(pel_text_cursor *scan, double *value)
{
    const char *start = scan->at, *behind = pel_number_parse(start, scan->end, value);
    if (behind == NULL)
        return false;
    scan->at = behind;
    bool whole = pel_text_cursor_at_break(scan);
    if (!whole)
        scan->at = start;
    return whole;
}

bool pel_text_cursor_number(pel_text_cursor *scan, double *value)
{
    const char *start = scan->at;
    if (pel_text_cursor_any_number(scan, value) && isfinite(*value))
        return true;
    scan->at = start;
    return false;
}

bool pel_text_cursor_integer(pel_text_cursor *scan, int64_t *value)
{
    const char *at = scan->at;
    bool negative = at < scan->end && *at == '-';
    if (at < scan->end && (*at == '-' || *at == '+'))
        at++;
    const char *digits = at;
    int64_t sum = 0;
    for (; at < scan->end && pel_is_digit(*at); at++) {
        if (sum > (INT64_MAX - 9) / 10)
            return false;
        sum = 10 * sum + (*at - '0');
    }
    if (at == digits)
        return false;
    *value = negative ? -sum : sum;
    scan->at = at;
    return true;
}

/* line and column of a character; a line ends with \n, \r or \r\n */
static void find_place(const pel_text_cursor *scan, const char *at, int32_t *line, int32_t *column)
{
    const char *line_start = scan->begin;
    *line = 1;
    for (const char *c = scan->begin; c < at; c++) {
        if (*c == '\n' || (*c == '\r' && (c + 1 == scan->end || c[1] != '\n'))) {
            *line += *line < INT32_MAX;
            line_start = c + 1;
        }
    }
    int64_t offset = at - line_start + 1;
    *column = offset < INT32_MAX ? (int32_t)offset : INT32_MAX;
}

pel_status pel_text_cursor_fail(const pel_text_cursor *scan, const char *at, pel_error *error, const char *remedy,
                                const char *what_format, ...)
{
    if (error == NULL)
        return PEL_BAD_FORMAT;
    char what[sizeof error->what];
    va_list arguments;
    va_start(arguments, what_format);
    vsnprintf(what, sizeof what, what_format, arguments);
    va_end(arguments);
    pel_fail(error, PEL_BAD_FORMAT, "%s", what);
    pel_fail_remedy(error, "%s", remedy);
    if (scan->binary) {
        pel_fail_offset(error, scan->name, at - scan->begin);
        return PEL_BAD_FORMAT;
    }
    int32_t line, column;
    find_place(scan, at, &line, &column);
    pel_fail_place(error, scan->name, line, column);
    return PEL_BAD_FORMAT;
}

/* A copy of the word at the cursor for a message, in quotes. Files that are no meshes may hold secrets, so only short
   words of letters, digits and signs are shown. */
static void quote_word(const pel_text_cursor *scan, char *text, size_t size)
{
    static const char shown[] = "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ+-.,/_";
    size_t length = 0, known = 0;
    while (scan->at + length < scan->end && !pel_is_space(scan->at[length]))
        length++;
    while (known < length && scan->at[known] != '\0' && strchr(shown, scan->at[known]) != NULL)
        known++;
    if (length > 0 && known == length && length + 3 <= size)
        snprintf(text, size, "'%.*s'", (int)length, scan->at);
    else
        snprintf(text, size, "%s", length > 0 ? "this word" : "");
}

pel_status pel_text_cursor_fail_number(const pel_text_cursor *scan, pel_error *error, const char *wanted)
{
    char word[24];
    quote_word(scan, word, sizeof word);
    if (scan->at == scan->end)
        return pel_text_cursor_fail(scan, scan->at, error, "the file seems to be cut off: copy or export it again",
                                    "the file ends where %s should be", wanted);
    if (word[0] == '\0')
        return pel_text_cursor_fail(scan, scan->at, error, "complete the line", "the line ends where %s should be",
                                    wanted);
    static const char digits[] = "0123456789";
    const char *comma = strchr(word, ',');
    bool is_decimal =
        comma != NULL && strchr(digits, comma[-1]) != NULL && comma[1] != '\0' && strchr(digits, comma[1]) != NULL;
    return pel_text_cursor_fail(scan, scan->at, error,
                                is_decimal ? "write numbers with a point: 0.5" : "correct the value", "%s is not %s",
                                word, wanted);
}
