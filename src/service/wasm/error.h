/* A failure as JSON. */
#ifndef PEL_WASM_ERROR_H
#define PEL_WASM_ERROR_H

#include "io/json.h"

/* writes an object: status, message, what, remedy, file, line, column */
void pel_wasm_put_error(pel_json *json, const pel_error *error);

#endif
