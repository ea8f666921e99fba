/* All keys of a scene: the table of members (def/row.h), with the keys of meshes, runs and outputs. The checker, the
   defaults, the JSON Schema, the reference page, the reader of the defs and --set are derived from it. */
#ifndef PEL_KEYS_TABLE_H
#define PEL_KEYS_TABLE_H

#include "def/row.h"
#include "keys/arena.h"

typedef struct pel_scene_table {
    const pel_def_row *rows;
    size_t row_count;
    const size_t *parent_lengths; /* (row_count) of the prefix that a row stands directly below */
    const char *const *names;     /* (row_count) name of each row below that prefix; null = none */
    const size_t *siblings;       /* (row_count) the next row with a name and the same prefix; row_count = none */
} pel_scene_table;

/* the rows of the program plus the parameters of every shape of pellicle/shape.h; null when out of memory */
const pel_scene_table *pel_scene_table_create(pel_arena *arena);

/* prefix of the children's paths: the group of the row, else its path; "" for the root */
const char *pel_scene_row_prefix(const pel_def_row *row);
/* the key of a row that stands directly below the prefix, as pel_scene_row_next gives it; "[]" for the element of a
 * list */
const char *pel_scene_row_name(const pel_def_row *row, const char *prefix);
/* the row after `row` (null: the first) directly below a prefix, null after the last */
const pel_def_row *pel_scene_row_next(const pel_scene_table *table, const char *prefix, const pel_def_row *row);
/* the row of that name below a prefix, the first of several; null if there is none */
const pel_def_row *pel_scene_row_find(const pel_scene_table *table, const char *prefix, const char *name);

/* whether a row with a condition is allowed with this key */
bool pel_scene_row_needs(const pel_def_row *row, const char *key);

/* "number or auto" */
const char *pel_scene_form_text(const pel_def_row *row, char *text, size_t size);

#endif
