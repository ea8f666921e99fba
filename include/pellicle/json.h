/* Pellicle: writing JSON text, into a file or a growing buffer. Inside an object every item has a key; inside an array,
   and outermost, the key is null. Commas, blanks and lines follow from the order of the calls:
       pel_json json = {.file = stdout, .style = PEL_JSON_INDENTED};
       pel_json_open(&json, NULL, '{');
       pel_json_number(&json, "dt", 0.01);
       pel_json_close(&json, '}');
   A failed allocation is remembered, so the calls need no checks. Text becomes valid UTF-8 and has '<' escaped, so that
   it is safe inside HTML. */
#ifndef PELLICLE_JSON_H
#define PELLICLE_JSON_H

#include "base.h"

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* May change between two calls. */
typedef enum pel_json_style {
    PEL_JSON_COMPACT, /* {"a":1,"b":2} */
    PEL_JSON_SPACED,  /* {"a": 1, "b": 2} */
    PEL_JSON_INDENTED /* each item on a line of its own, and a line end after the outermost bracket */
} pel_json_style;

typedef struct pel_json {
    FILE *file; /* where the text goes; null = into the buffer */
    pel_json_style style;
    char *text; /* (length, then a zero) the buffer; null while it is empty */
    size_t length, capacity;
    int depth;
    bool is_filled; /* the open object or array has an item */
    bool failed;    /* out of memory: the text is not whole */
} pel_json;

/* '{' or '[' */
PEL_API void pel_json_open(pel_json *json, const char *key, char bracket);
/* '}' or ']' */
PEL_API void pel_json_close(pel_json *json, char bracket);
/* null text = null */
PEL_API void pel_json_text(pel_json *json, const char *key, const char *text);
/* Shortest digits that read back to the same bits in any locale; null for NaN and infinity. */
PEL_API void pel_json_number(pel_json *json, const char *key, double number);
PEL_API void pel_json_integer(pel_json *json, const char *key, int64_t number);
PEL_API void pel_json_bool(pel_json *json, const char *key, bool value);
PEL_API void pel_json_null(pel_json *json, const char *key);
/* an array of numbers in one line */
PEL_API void pel_json_numbers(pel_json *json, const char *key, const double *numbers, int32_t count);

/* Frees the buffer. */
PEL_API void pel_json_free(pel_json *json);

#ifdef __cplusplus
}
#endif
#endif
