/* Compares a tree of values with the table and completes it. */
#ifndef PEL_KEYS_VALIDATE_H
#define PEL_KEYS_VALIDATE_H

#include "keys/table.h"
#include "keys/value.h"

/* Refuses unknown keys, keys given twice, wrong forms, numbers out of range, missing keys and two of several
   alternatives (PEL_BAD_SCENE at the place of the first one found). Then every value has its form and number, defaults
   are filled in, keys without value are removed and entries are in the order of the table. */
pel_status pel_scene_check(pel_scene_reader *reader, pel_scene_value *root);

/* Refuses (PEL_BAD_SCENE) a map that is a scene, a study or a fit by its keys, where another one of these is wanted:
   the remedy names the command for it. */
pel_status pel_scene_check_kind(pel_scene_reader *reader, const pel_scene_value *root, const char *wanted);

/* Makes a value a number or a vector, as if it had stood in the scene. */
pel_status pel_scene_value_set_number(pel_scene_reader *reader, pel_scene_value *value, double number);
pel_status pel_scene_value_set_vector(pel_scene_reader *reader, pel_scene_value *value, const double vector[3]);

/* A plain scalar that YAML reads as no value. */
bool pel_scene_value_is_null(const pel_scene_value *value);

/* Whether a row's condition (needs, needs_word) is fulfilled in a map. */
bool pel_scene_row_applies(const pel_def_row *row, const pel_scene_value *map);

/* "unknown WHAT 'name'" at a place; the remedy tells the nearest of the known names, or all of them. */
pel_status pel_scene_fail_name(pel_scene_reader *reader, const pel_scene_place *place, const char *what,
                               const char *name, const char *const *known, size_t known_count);
/* The same for a key of the map with that prefix of the table; the remedy tells the maps that have it. */
pel_status pel_scene_fail_key(pel_scene_reader *reader, const pel_scene_place *place, const char *prefix,
                              const char *key, const char *const *known, size_t known_count);
/* The same of the word of a key; a word of another key of this name is told with that key. */
pel_status pel_scene_fail_word(pel_scene_reader *reader, const pel_scene_value *value, const char *const *known,
                               size_t known_count);

#endif
