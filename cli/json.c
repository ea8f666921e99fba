#include "json.h"

#include <pellicle/base.h>

#include <inttypes.h>

static void write_string(FILE *file, const char *text)
{
    char letter[7];
    fputc('"', file);
    while (*text != '\0') {
        text = pel_json_letter(text, letter);
        fputs(letter, file);
    }
    fputc('"', file);
}

static void write_number(FILE *file, double number)
{
    char text[32];
    fputs(pel_json_digits(number, text), file);
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
