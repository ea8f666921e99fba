/* A checked tree of values as YAML text. */
#ifndef PEL_KEYS_PRINT_H
#define PEL_KEYS_PRINT_H

#include "keys/value.h"

/* The scene with a comment line that gives the program's version; null when out of memory (the error is filled). */
const char *pel_scene_print(pel_scene_reader *reader, const pel_scene_value *root);

/* Other names for the mesh files of a scene: from[i] becomes to[i] (count). */
typedef struct pel_scene_names {
    const char *const *from, *const *to;
    int32_t count;
} pel_scene_names;

/* The same with these names (null = their own), as a new text (pel_free); null when out of memory. */
char *pel_scene_print_renamed(const pel_scene_value *root, const pel_scene_names *names);

#endif
