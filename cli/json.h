/* A small JSON writer: indented, members in the order of the calls. Inside an object every item needs a key, inside an
   array the key is null. Numbers keep all digits; NaN and infinity become null; text becomes valid UTF-8. */
#ifndef PELLICLE_CLI_JSON_H
#define PELLICLE_CLI_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct cli_json {
    FILE *file;
    int depth;
    bool filled; /* the open object or array has an item already */
} cli_json;

void cli_json_open(cli_json *json, const char *key, char bracket);     /* '{' or '[' */
void cli_json_close(cli_json *json, char bracket);                     /* '}' or ']'; a newline after the outermost */
void cli_json_text(cli_json *json, const char *key, const char *text); /* null text = null */
void cli_json_number(cli_json *json, const char *key, double number);
void cli_json_integer(cli_json *json, const char *key, int64_t number);
void cli_json_bool(cli_json *json, const char *key, bool value);
void cli_json_null(cli_json *json, const char *key);
/* an array of numbers on one line */
void cli_json_numbers(cli_json *json, const char *key, const double *numbers, int count);

#endif
