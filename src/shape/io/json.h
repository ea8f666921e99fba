/* JSON text in a growing buffer. A failed allocation is remembered, so the calls need no checks:
       pel_json json = {0};
       pel_json_print(&json, "{\"times\":[");
       ...
       if (json.failed) ... */
#ifndef PEL_IO_JSON_H
#define PEL_IO_JSON_H

#include "base/status.h"

typedef struct pel_json {
    char *text;
    size_t length, capacity;
    bool failed; /* out of memory */
} pel_json;

/* as printf; floating-point numbers follow the locale here: see pel_json_number for those */
void pel_json_print(pel_json *json, const char *format, ...) PEL_PRINTF(2, 3);
/* In quotes, always as valid UTF-8; '<' is escaped, so that the text is safe inside HTML. */
void pel_json_string(pel_json *json, const char *text);
/* shortest digits that read back to the same bits; null for NaN and infinity */
void pel_json_number(pel_json *json, double number);
/* the same as an array */
void pel_json_numbers(pel_json *json, const double *numbers, int32_t count);
void pel_json_free(pel_json *json);

#endif
