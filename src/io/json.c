#include "io/json.h"

#include "base/memory.h"

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

void pel_json_string(pel_json *json, const char *text)
{
    char letter[7];
    append(json, "\"", 1);
    while (*text != '\0') {
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
