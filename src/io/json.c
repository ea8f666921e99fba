#include "io/json.h"

#include "base/memory.h"
#include "io/number.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

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
    int size = vsnprintf(NULL, 0, format, arguments);
    char *end = extend(json, (size_t)size);
    if (end != NULL) {
        vsnprintf(end, (size_t)size + 1, format, again);
        json->length += (size_t)size;
    }
    va_end(again);
    va_end(arguments);
}

/* bytes of the UTF-8 sequence at s, 0 when it is none (overlong forms, surrogates and numbers too large are none) */
static size_t sequence_length(const unsigned char *s)
{
    if (s[0] < 0x80)
        return 1;
    if (s[0] < 0xc2 || s[0] > 0xf4)
        return 0;
    size_t length = s[0] >= 0xf0 ? 4 : s[0] >= 0xe0 ? 3 : 2;
    for (size_t i = 1; i < length; i++)
        if ((s[i] & 0xc0) != 0x80)
            return 0;
    bool overlong = (s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xf0 && s[1] < 0x90);
    bool beyond = (s[0] == 0xed && s[1] > 0x9f) || (s[0] == 0xf4 && s[1] > 0x8f);
    return overlong || beyond ? 0 : length;
}

void pel_json_string(pel_json *json, const char *text)
{
    append(json, "\"", 1);
    for (const char *at = text; *at != '\0';) {
        size_t length = sequence_length((const unsigned char *)at);
        if (length == 0)
            pel_json_print(json, "\\ufffd");
        else if (*at == '"' || *at == '\\')
            pel_json_print(json, "\\%c", *at);
        else if (*at == '\n')
            pel_json_print(json, "\\n");
        else if ((unsigned char)*at < ' ' || *at == '<' || *at == 0x7f)
            pel_json_print(json, "\\u%04x", (unsigned)*at);
        else
            append(json, at, length);
        at += length > 0 ? length : 1;
    }
    append(json, "\"", 1);
}

void pel_json_number(pel_json *json, double number)
{
    char text[PEL_NUMBER_SIZE];
    if (isfinite(number))
        append(json, text, pel_number_print(text, number));
    else
        append(json, "null", 4);
}

void pel_json_numbers(pel_json *json, const double *numbers, int32_t count)
{
    append(json, "[", 1);
    for (int32_t i = 0; i < count; i++) {
        if (i > 0)
            append(json, ",", 1);
        pel_json_number(json, numbers[i]);
    }
    append(json, "]", 1);
}

void pel_json_free(pel_json *json)
{
    pel_free(json->text);
    *json = (pel_json){0};
}
