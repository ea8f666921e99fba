#include "keys/value.h"

#include "base/number.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

pel_scene_value *pel_scene_value_create(pel_scene_reader *reader, pel_scene_value_kind kind, pel_scene_place place)
{
    pel_scene_value *value = pel_arena_take(reader->arena, 1, sizeof *value);
    if (value == NULL) {
        pel_fail_memory(reader->error);
        return NULL;
    }
    value->kind = kind;
    value->text = "";
    value->place = place;
    value->key_place = place;
    return value;
}

pel_scene_value *pel_scene_value_text(pel_scene_reader *reader, const char *text, pel_scene_place place)
{
    pel_scene_value *value = pel_scene_value_create(reader, PEL_SCENE_SCALAR, place);
    if (value == NULL)
        return NULL;
    value->quoted = true;
    value->text = pel_arena_text(reader->arena, text, strlen(text));
    if (value->text != NULL)
        return value;
    pel_fail_memory(reader->error);
    return NULL;
}

void pel_scene_value_append(pel_scene_value *parent, const char *key, pel_scene_value *child)
{
    child->parent = parent;
    child->key = key;
    child->next = NULL;
    if (parent->last != NULL)
        parent->last->next = child;
    else
        parent->first = child;
    parent->last = child;
}

void pel_scene_value_remove(pel_scene_value *child)
{
    pel_scene_value *parent = child->parent, *before = NULL;
    for (pel_scene_value *other = parent->first; other != child; other = other->next)
        before = other;
    if (before != NULL)
        before->next = child->next;
    else
        parent->first = child->next;
    if (parent->last == child)
        parent->last = before;
}

pel_scene_value *pel_scene_value_entry(const pel_scene_value *value, const char *key)
{
    pel_scene_value *child = value->kind == PEL_SCENE_MAP ? value->first : NULL;
    while (child != NULL && strcmp(child->key, key) != 0)
        child = child->next;
    return child;
}

pel_scene_value *pel_scene_value_at(const pel_scene_value *value, const char *path)
{
    while (value != NULL) {
        size_t length = strcspn(path, ".");
        pel_scene_value *child = value->kind == PEL_SCENE_MAP ? value->first : NULL;
        while (child != NULL && (strncmp(child->key, path, length) != 0 || child->key[length] != '\0'))
            child = child->next;
        if (path[length] == '\0')
            return child;
        path += length + 1;
        value = child;
    }
    return NULL;
}

double pel_scene_value_number(const pel_scene_value *value, const char *path)
{
    return pel_scene_value_at(value, path)->number;
}

int32_t pel_scene_value_integer(const pel_scene_value *value, const char *path)
{
    return (int32_t)pel_scene_value_number(value, path);
}

void pel_scene_value_numbers(const pel_scene_value *list, double *numbers)
{
    for (const pel_scene_value *child = list->first; child != NULL; child = child->next)
        *numbers++ = child->number;
}

pel_scene_value *pel_scene_value_element(const pel_scene_value *value, int64_t index)
{
    pel_scene_value *child = value->first;
    while (child != NULL && index-- > 0)
        child = child->next;
    return child;
}

int32_t pel_scene_value_count(const pel_scene_value *value)
{
    int32_t count = 0;
    for (const pel_scene_value *child = value->first; child != NULL; child = child->next)
        count++;
    return count;
}

/* writes the last segment of the path: the key, or the number in the list */
static void segment(const pel_scene_value *value, char *text, size_t size)
{
    if (value->key != NULL) {
        snprintf(text, size, "%s", value->key);
        return;
    }
    int32_t index = 0;
    for (const pel_scene_value *other = value->parent->first; other != value; other = other->next)
        index++;
    snprintf(text, size, "%d", (int)index);
}

const char *pel_scene_value_path(const pel_scene_value *value, char *text, size_t size)
{
    text[0] = '\0';
    if (value->parent == NULL)
        return text;
    pel_scene_value_path(value->parent, text, size);
    size_t length = strlen(text);
    if (length > 0 && length + 1 < size)
        text[length++] = '.';
    segment(value, text + length, size - length);
    return text;
}

pel_status pel_scene_fail(pel_scene_reader *reader, const pel_scene_place *place, const char *format, ...)
{
    char what[sizeof reader->error->what];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    pel_fail(reader->error, PEL_BAD_SCENE, "%s", what);
    pel_fail_place(reader->error, place->source, place->line, place->column);
    return PEL_BAD_SCENE;
}

pel_status pel_scene_fail_at(pel_scene_reader *reader, const pel_scene_place *place)
{
    pel_error *error = reader->error;
    if (error->status == PEL_OUT_OF_MEMORY)
        return error->status;
    if (error->status == PEL_BAD_ARGUMENT)
        error->status = PEL_BAD_SCENE;
    error->element = -1;
    pel_fail_place(error, place->source, place->line, place->column);
    return error->status;
}

static const char *skip_digits(const char *text)
{
    return text + strspn(text, "0123456789");
}

static const char *skip_sign(const char *text)
{
    return *text == '+' || *text == '-' ? text + 1 : text;
}

/* [-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)? */
static bool is_float(const char *text)
{
    const char *start = skip_sign(text);
    const char *end = skip_digits(start);
    bool has_digits = end > start;
    if (*end == '.') {
        const char *fraction = end + 1;
        end = skip_digits(fraction);
        has_digits = has_digits || end > fraction;
    }
    if (!has_digits)
        return false;
    if (*end == 'e' || *end == 'E') {
        const char *exponent = skip_sign(end + 1);
        end = skip_digits(exponent);
        if (end == exponent)
            return false;
    }
    return *end == '\0';
}

/* 0o17 or 0x1F */
static bool parse_prefixed(const char *text, double *number)
{
    if (text[0] != '0' || (text[1] != 'o' && text[1] != 'x'))
        return false;
    int base = text[1] == 'x' ? 16 : 8;
    const char *digits = base == 16 ? "0123456789abcdefABCDEF" : "01234567";
    size_t length = strspn(text + 2, digits);
    if (length == 0 || text[2 + length] != '\0')
        return false;
    *number = (double)strtoull(text + 2, NULL, base);
    return true;
}

bool pel_scene_parse_number(const char *text, double *number)
{
    if (parse_prefixed(text, number))
        return true;
    if (!is_float(text))
        return false;
    return pel_number_parse(text, text + strlen(text), number) != NULL;
}

bool pel_scene_parse_integer(const char *text, double *number)
{
    const char *digits = skip_sign(text);
    if (*digits != '\0' && *skip_digits(digits) == '\0')
        return pel_scene_parse_number(text, number);
    return parse_prefixed(text, number);
}
