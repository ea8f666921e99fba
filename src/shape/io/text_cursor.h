/* A cursor over the bytes of a mesh file. Lines end with \n, \r or both; nothing relies on a terminating zero. Line
   numbers are counted only when an error needs one. */
#ifndef PEL_IO_TEXT_CURSOR_H
#define PEL_IO_TEXT_CURSOR_H

#include "base/status.h"

typedef struct pel_text_cursor {
    const char *name; /* of the file, for messages */
    const char *begin, *at, *end;
    bool binary; /* errors name the byte offset instead of the line */
} pel_text_cursor;

static inline bool pel_is_line_end(char c)
{
    return c == '\n' || c == '\r';
}

/* white space within a line */
static inline bool pel_is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

static inline bool pel_is_space(char c)
{
    return pel_is_blank(c) || pel_is_line_end(c);
}

static inline bool pel_is_digit(char c)
{
    return (unsigned)(c - '0') < 10;
}

/* at the end of a word: white space, a comment, a continuation or the end of the file */
static inline bool pel_text_cursor_at_break(const pel_text_cursor *scan)
{
    return scan->at == scan->end || pel_is_space(*scan->at) || *scan->at == '#' || *scan->at == '\\';
}

static inline void pel_text_cursor_skip_blanks(pel_text_cursor *scan)
{
    while (scan->at < scan->end && pel_is_blank(*scan->at))
        scan->at++;
}

/* white space and line ends */
static inline void pel_text_cursor_skip_spaces(pel_text_cursor *scan)
{
    while (scan->at < scan->end && pel_is_space(*scan->at))
        scan->at++;
}

/* up to the end of this line */
static inline void pel_text_cursor_skip_line(pel_text_cursor *scan)
{
    while (scan->at < scan->end && !pel_is_line_end(*scan->at))
        scan->at++;
}

/* white space, line ends and comments from # to the end of the line */
void pel_text_cursor_skip_comments(pel_text_cursor *scan);
/* the word here, with its length (0 at the end of the line or file); moves after it */
const char *pel_text_cursor_word(pel_text_cursor *scan, size_t *length);
/* whether the next characters are `word` in any case and then a break; if so moves after it */
bool pel_text_cursor_accept(pel_text_cursor *scan, const char *word);
/* whether a word of this length is among the words, which end with null */
bool pel_word_is_one_of(const char *word, size_t length, const char *const *words);
/* A number up to a break: moves after it. False if there is none (does not move). */
bool pel_text_cursor_any_number(pel_text_cursor *scan, double *value);
/* the same; false (and stays there) for nan and infinity too */
bool pel_text_cursor_number(pel_text_cursor *scan, double *value);
/* Decimal digits with a sign, followed by any character: moves after them. False if there are none or too many for 64
   bits (does not move). */
bool pel_text_cursor_integer(pel_text_cursor *scan, int64_t *value);

/* PEL_BAD_FORMAT at the character `at`: its line and column, or its byte offset in a binary file */
pel_status pel_text_cursor_fail(const pel_text_cursor *scan, const char *at, pel_error *error, const char *remedy,
                                const char *what_format, ...) PEL_PRINTF(5, 6);
/* the same for a word that is not the number it should be: quotes it */
pel_status pel_text_cursor_fail_number(const pel_text_cursor *scan, pel_error *error, const char *wanted);

#endif
