#include "io/xml.h"

#include <string.h>

typedef struct entity {
    char letter;
    const char *text;
} entity;

static const entity entities[] = {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&apos;"}};
enum { ENTITY_COUNT = sizeof entities / sizeof entities[0] };

void pel_xml_write_escaped(pel_file_writer *writer, const char *text)
{
    for (; *text != '\0'; text++) {
        const char *replacement = NULL;
        for (size_t i = 0; i < ENTITY_COUNT; i++)
            if (entities[i].letter == *text)
                replacement = entities[i].text;
        if (replacement != NULL)
            pel_file_writer_write(writer, replacement, strlen(replacement));
        else
            pel_file_writer_write(writer, (unsigned char)*text < ' ' ? "?" : text, 1);
    }
}

bool pel_xml_next(const char **at, const char *end, pel_xml_tag *tag)
{
    const char *start = memchr(*at, '<', (size_t)(end - *at));
    if (start == NULL)
        return false;
    char quote = '\0';
    ++start;
    bool comment = end - start >= 3 && memcmp(start, "!--", 3) == 0;
    for (const char *p = comment ? start + 3 : start; p < end; p++) {
        if (comment) {
            if (*p != '>' || p - start < 5 || memcmp(p - 2, "--", 2) != 0)
                continue;
            *tag = (pel_xml_tag){start, p};
            *at = p + 1;
            return true;
        }
        if (quote != '\0') {
            quote = *p == quote ? '\0' : quote;
        } else if (*p == '"' || *p == '\'') {
            quote = *p;
        } else if (*p == '>') {
            *tag = (pel_xml_tag){start, p};
            *at = p + 1;
            return true;
        }
    }
    return false;
}

static bool is_space(char letter)
{
    return letter == ' ' || letter == '\t' || letter == '\n' || letter == '\r';
}

bool pel_xml_is(const pel_xml_tag *tag, const char *name)
{
    size_t length = strlen(name), available = (size_t)(tag->end - tag->start);
    if (available < length || memcmp(tag->start, name, length) != 0)
        return false;
    return available == length || is_space(tag->start[length]) || tag->start[length] == '/';
}

/* the value of the next `name="value"` at or after `at`; returns its end, null if there is none */
static const char *next_attribute(const char *at, const char *end, pel_xml_tag *name, pel_xml_tag *value)
{
    while (at < end && is_space(*at))
        at++;
    name->start = at;
    while (at < end && *at != '=' && !is_space(*at))
        at++;
    name->end = at;
    while (at < end && (*at == '=' || is_space(*at)))
        at++;
    if (at >= end || (*at != '"' && *at != '\''))
        return NULL;
    value->start = at + 1;
    value->end = memchr(value->start, *at, (size_t)(end - value->start));
    return value->end != NULL ? value->end + 1 : NULL;
}

/* one character of escaped text; returns how many characters it took */
static size_t unescape(const char *at, const char *end, char *letter)
{
    *letter = *at;
    for (size_t i = 0; i < ENTITY_COUNT && *at == '&'; i++) {
        size_t length = strlen(entities[i].text);
        if ((size_t)(end - at) >= length && memcmp(at, entities[i].text, length) == 0) {
            *letter = entities[i].letter;
            return length;
        }
    }
    return 1;
}

bool pel_xml_attribute(const pel_xml_tag *tag, const char *name, char *text, size_t size)
{
    pel_xml_tag found, value;
    const char *at = tag->start;
    text[0] = '\0';
    while (at < tag->end && !is_space(*at))
        at++;
    while ((at = next_attribute(at, tag->end, &found, &value)) != NULL) {
        if ((size_t)(found.end - found.start) != strlen(name) || memcmp(found.start, name, strlen(name)) != 0)
            continue;
        size_t length = 0;
        for (const char *p = value.start; p < value.end && length < size; length++)
            p += unescape(p, value.end, &text[length]);
        text[length < size ? length : 0] = '\0';
        return length < size;
    }
    return false;
}

bool pel_xml_count(const pel_xml_tag *tag, const char *name, int64_t *count)
{
    enum { MOST_DIGITS = 18 }; /* cannot overflow */
    char text[64];
    *count = 0;
    if (!pel_xml_attribute(tag, name, text, sizeof text))
        return false;
    const char *p = text;
    while (is_space(*p))
        p++;
    const char *digits = p;
    for (; *p >= '0' && *p <= '9' && p - digits < MOST_DIGITS; p++)
        *count = *count * 10 + (*p - '0');
    const bool any = p > digits;
    while (is_space(*p))
        p++;
    return any && *p == '\0';
}
