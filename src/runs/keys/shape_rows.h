/* The parameters of the generated shapes (pellicle/shape.h) as rows of the scene table. */
#ifndef PEL_KEYS_SHAPE_ROWS_H
#define PEL_KEYS_SHAPE_ROWS_H

#include "keys/table.h"

/* names of all shapes, null-terminated; null when out of memory */
const char *const *pel_scene_shape_words(pel_arena *arena);
/* number of parameters of all shapes together */
size_t pel_scene_shape_row_count(void);
/* Writes pel_scene_shape_row_count() rows `prefix.parameter` that require `shape: NAME`. False if out of memory. */
bool pel_scene_shape_rows(pel_arena *arena, const char *prefix, pel_def_row *rows);

#endif
