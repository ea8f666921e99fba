/* Texts that the table yields. */
#ifndef PEL_KEYS_SCHEMA_API_H
#define PEL_KEYS_SCHEMA_API_H

#include "io/json.h"
#include "keys/table.h"

#include <stdio.h>

/* JSON Schema, draft 7 */
void pel_scene_put_schema(pel_json *json, const pel_scene_table *table);
/* reference page in Markdown */
void pel_scene_put_reference(FILE *file, const pel_scene_table *table);
/* one path a line */
void pel_scene_put_parameters(FILE *file, const pel_scene_table *table);

#endif
