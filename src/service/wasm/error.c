#include "wasm/error.h"

#include <string.h>

static void put_text(pel_json *json, const char *key, const char *text)
{
    pel_json_print(json, "\"%s\":", key);
    pel_json_string(json, text);
    pel_json_print(json, ",");
}

void pel_wasm_put_error(pel_json *json, const pel_error *error)
{
    char text[1200];
    pel_error_text(error, text, sizeof text);
    pel_json_print(json, "{");
    put_text(json, "status", pel_status_text(error->status));
    put_text(json, "message", strncmp(text, "error: ", 7) == 0 ? text + 7 : text);
    put_text(json, "what", error->what);
    put_text(json, "remedy", error->remedy);
    put_text(json, "file", error->file);
    pel_json_print(json, "\"line\":%d,\"column\":%d}", (int)error->line, (int)error->column);
}
