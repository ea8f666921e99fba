#include "io/json.h"

#include "base/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* most texts are formatted once */
enum { PRINT_ROOM = 240 };

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
    char *end = extend(json, PRINT_ROOM);
    int size = end != NULL ? vsnprintf(end, PRINT_ROOM + 1, format, arguments) : 0;
    if (size > PRINT_ROOM && (end = extend(json, (size_t)size)) != NULL)
        vsnprintf(end, (size_t)size + 1, format, again);
    json->length += end != NULL ? (size_t)size : 0;
    va_end(again);
    va_end(arguments);
}

/* letters of ASCII that stand for themselves */
static size_t plain_length(const char *text)
{
    size_t length = 0;
    while (text[length] >= ' ' && text[length] < 0x7f && strchr("\"\\<", text[length]) == NULL)
        length++;
    return length;
}

void pel_json_string(pel_json *json, const char *text)
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

void pel_json_number(pel_json *json, double number)
{
    char text[32];
    pel_json_digits(number, text);
    append(json, text, strlen(text));
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
