/* The calls of pellicle/json.h put items; these put raw text, and the values of items without their commas, where the
   text is written as a whole. */
#ifndef PEL_IO_JSON_H
#define PEL_IO_JSON_H

#include "base/status.h"
#include "pellicle/json.h"

/* as printf; floating-point numbers follow the locale here: see pel_json_put_number for those */
void pel_json_print(pel_json *json, const char *format, ...) PEL_PRINTF(2, 3);
/* begins an item whose value follows as raw text */
void pel_json_key(pel_json *json, const char *key);
/* in quotes */
void pel_json_put_text(pel_json *json, const char *text);
void pel_json_put_number(pel_json *json, double number);
/* an array */
void pel_json_put_numbers(pel_json *json, const double *numbers, int32_t count);

/* The first letter of text (not empty) as it stands in a string, zero-terminated; returns the start of the next one. */
const char *pel_json_letter(const char *text, char escaped[7]);

#endif
