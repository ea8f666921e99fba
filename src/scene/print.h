/* A checked tree of values as YAML text. */
#ifndef PEL_SCENE_PRINT_H
#define PEL_SCENE_PRINT_H

#include "scene/value.h"

/* The scene with a comment line that gives the program's version; null when out of memory (the error is filled). */
const char *pel_scene_print(pel_scene_reader *reader, const pel_scene_value *root);

#endif
