#include "wasm/error.h"

#include <string.h>

void pel_wasm_put_error(pel_json *json, const pel_error *error)
{
    char text[1200];
    pel_error_text(error, text, sizeof text);
    pel_json_open(json, NULL, '{');
    pel_json_text(json, "status", pel_status_text(error->status));
    pel_json_text(json, "message", strncmp(text, "error: ", 7) == 0 ? text + 7 : text);
    pel_json_text(json, "what", error->what);
    pel_json_text(json, "remedy", error->remedy);
    pel_json_text(json, "file", error->file);
    pel_json_integer(json, "line", error->line);
    pel_json_integer(json, "column", error->column);
    pel_json_close(json, '}');
}
