#include "io/json.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/text.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

/* most texts are formatted once */
enum { PRINT_ROOM = 240 };

/* ---- raw text ---- */

/* room for `size` more bytes and a zero */
static char *extend(pel_json *json, size_t size)
{
    void *text = json->text;
    if (json->failed || !pel_reserve(&text, &json->capacity, json->length + size + 1, 1)) {
        json->failed = true;
        return NULL;
    }
    json->text = text;
    return json->text + json->length;
}

static void append(pel_json *json, const char *bytes, size_t size)
{
    if (json->file != NULL) {
        fwrite(bytes, 1, size, json->file);
        return;
    }
    char *end = extend(json, size);
    if (end == NULL)
        return;
    memcpy(end, bytes, size);
    end[size] = '\0';
    json->length += size;
}

void pel_json_print(pel_json *json, const char *format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    char *end = json->file == NULL ? extend(json, PRINT_ROOM) : NULL;
    int size = end != NULL ? vsnprintf(end, PRINT_ROOM + 1, format, arguments) : 0;
    if (size > PRINT_ROOM && (end = extend(json, (size_t)size)) != NULL)
        vsnprintf(end, (size_t)size + 1, format, again);
    json->length += end != NULL ? (size_t)size : 0;
    if (json->file != NULL)
        vfprintf(json->file, format, arguments);
    va_end(again);
    va_end(arguments);
}

const char *pel_json_letter(const char *text, char escaped[7])
{
    const unsigned char *s = (const unsigned char *)text;
    size_t length = pel_utf8_length(text, SIZE_MAX);
    if (length == 0)
        memcpy(escaped, "\\ufffd", 7);
    else if (*s == '"' || *s == '\\')
        snprintf(escaped, 7, "\\%c", *s);
    else if (*s == '\n')
        memcpy(escaped, "\\n", 3);
    else if (*s < ' ' || *s == '<' || *s == 0x7f)
        snprintf(escaped, 7, "\\u%04x", (unsigned)*s);
    else {
        memcpy(escaped, text, length);
        escaped[length] = '\0';
    }
    return text + (length > 0 ? length : 1);
}

/* letters of ASCII that stand for themselves */
static size_t plain_length(const char *text)
{
    size_t length = 0;
    while (text[length] >= ' ' && text[length] < 0x7f && strchr("\"\\<", text[length]) == NULL)
        length++;
    return length;
}

void pel_json_put_text(pel_json *json, const char *text)
{
    char letter[7];
    append(json, "\"", 1);
    while (*text != '\0') {
        size_t plain = plain_length(text);
        append(json, text, plain);
        text += plain;
        if (*text == '\0')
            break;
        text = pel_json_letter(text, letter);
        append(json, letter, strlen(letter));
    }
    append(json, "\"", 1);
}

void pel_json_put_number(pel_json *json, double number)
{
    char text[32] = "null";
    if (isfinite(number))
        pel_number_print(text, number);
    append(json, text, strlen(text));
}

void pel_json_put_numbers(pel_json *json, const double *numbers, int32_t count)
{
    append(json, "[", 1);
    for (int32_t i = 0; i < count; i++) {
        if (i > 0)
            append(json, ", ", json->style == PEL_JSON_COMPACT ? 1 : 2);
        pel_json_put_number(json, numbers[i]);
    }
    append(json, "]", 1);
}

/* ---- items ---- */

static void new_line(pel_json *json)
{
    pel_json_print(json, "\n%*s", 2 * json->depth, "");
}

void pel_json_key(pel_json *json, const char *key)
{
    bool is_indented = json->style == PEL_JSON_INDENTED, is_compact = json->style == PEL_JSON_COMPACT;
    if (json->is_filled)
        append(json, ", ", json->style == PEL_JSON_SPACED ? 2 : 1);
    if (is_indented && json->depth > 0)
        new_line(json);
    json->is_filled = true;
    if (key == NULL)
        return;
    pel_json_put_text(json, key);
    append(json, ": ", is_compact ? 1 : 2);
}

void pel_json_open(pel_json *json, const char *key, char bracket)
{
    pel_json_key(json, key);
    append(json, &bracket, 1);
    json->depth++;
    json->is_filled = false;
}

void pel_json_close(pel_json *json, char bracket)
{
    json->depth--;
    if (json->style == PEL_JSON_INDENTED && json->is_filled)
        new_line(json);
    append(json, &bracket, 1);
    json->is_filled = true;
    if (json->style == PEL_JSON_INDENTED && json->depth == 0)
        append(json, "\n", 1);
}

void pel_json_text(pel_json *json, const char *key, const char *text)
{
    if (text == NULL) {
        pel_json_null(json, key);
        return;
    }
    pel_json_key(json, key);
    pel_json_put_text(json, text);
}

void pel_json_number(pel_json *json, const char *key, double number)
{
    pel_json_key(json, key);
    pel_json_put_number(json, number);
}

void pel_json_integer(pel_json *json, const char *key, int64_t number)
{
    pel_json_key(json, key);
    pel_json_print(json, "%" PRId64, number);
}

void pel_json_bool(pel_json *json, const char *key, bool value)
{
    pel_json_key(json, key);
    pel_json_print(json, value ? "true" : "false");
}

void pel_json_null(pel_json *json, const char *key)
{
    pel_json_key(json, key);
    append(json, "null", 4);
}

void pel_json_numbers(pel_json *json, const char *key, const double *numbers, int32_t count)
{
    pel_json_key(json, key);
    pel_json_put_numbers(json, numbers, count);
}

void pel_json_free(pel_json *json)
{
    if (json == NULL)
        return;
    pel_free(json->text);
    *json = (pel_json){.file = json->file, .style = json->style};
}
