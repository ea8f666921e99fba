#include "json.h"

#include <inttypes.h>
#include <math.h>

/* length of the valid UTF-8 sequence at s, 0 when it is none (overlong forms and surrogates are none) */
static int sequence_length(const unsigned char *s)
{
    if (s[0] < 0x80)
        return 1;
    int length = s[0] >= 0xf0 ? 4 : s[0] >= 0xe0 ? 3 : 2;
    if (s[0] < 0xc2 || s[0] > 0xf4)
        return 0;
    for (int i = 1; i < length; ++i) {
        if ((s[i] & 0xc0) != 0x80)
            return 0;
    }
    bool overlong = (s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xf0 && s[1] < 0x90);
    bool beyond = (s[0] == 0xed && s[1] > 0x9f) || (s[0] == 0xf4 && s[1] > 0x8f);
    return overlong || beyond ? 0 : length;
}

static void write_string(FILE *file, const char *text)
{
    fputc('"', file);
    for (const unsigned char *s = (const unsigned char *)text; *s != '\0';) {
        int length = sequence_length(s);
        if (length == 0)
            fputs("\\ufffd", file);
        else if (*s == '"' || *s == '\\')
            fprintf(file, "\\%c", *s);
        else if (*s == '\n')
            fputs("\\n", file);
        else if (*s < 0x20 || *s == 0x7f)
            fprintf(file, "\\u%04x", *s);
        else
            fwrite(s, 1, (size_t)length, file);
        s += length > 0 ? length : 1;
    }
    fputc('"', file);
}

static void write_number(FILE *file, double number)
{
    if (isfinite(number))
        fprintf(file, "%.17g", number);
    else
        fputs("null", file);
}

static void new_line(const cli_json *json)
{
    fprintf(json->file, "\n%*s", 2 * json->depth, "");
}

static void begin_item(cli_json *json, const char *key)
{
    if (json->filled)
        fputc(',', json->file);
    if (json->depth > 0)
        new_line(json);
    json->filled = true;
    if (key != NULL) {
        write_string(json->file, key);
        fputs(": ", json->file);
    }
}

void cli_json_open(cli_json *json, const char *key, char bracket)
{
    begin_item(json, key);
    fputc(bracket, json->file);
    json->depth += 1;
    json->filled = false;
}

void cli_json_close(cli_json *json, char bracket)
{
    json->depth -= 1;
    if (json->filled)
        new_line(json);
    fputc(bracket, json->file);
    json->filled = true;
    if (json->depth == 0)
        fputc('\n', json->file);
}

void cli_json_text(cli_json *json, const char *key, const char *text)
{
    begin_item(json, key);
    if (text != NULL)
        write_string(json->file, text);
    else
        fputs("null", json->file);
}

void cli_json_number(cli_json *json, const char *key, double number)
{
    begin_item(json, key);
    write_number(json->file, number);
}

void cli_json_integer(cli_json *json, const char *key, int64_t number)
{
    begin_item(json, key);
    fprintf(json->file, "%" PRId64, number);
}

void cli_json_bool(cli_json *json, const char *key, bool value)
{
    begin_item(json, key);
    fputs(value ? "true" : "false", json->file);
}

void cli_json_null(cli_json *json, const char *key)
{
    begin_item(json, key);
    fputs("null", json->file);
}

void cli_json_numbers(cli_json *json, const char *key, const double *numbers, int count)
{
    begin_item(json, key);
    fputc('[', json->file);
    for (int i = 0; i < count; ++i) {
        fputs(i > 0 ? ", " : "", json->file);
        write_number(json->file, numbers[i]);
    }
    fputc(']', json->file);
}
