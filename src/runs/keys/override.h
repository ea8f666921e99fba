/* Overrides "a.b=c" as after --set, put into a tree of values before it is checked. */
#ifndef PEL_KEYS_OVERRIDE_H
#define PEL_KEYS_OVERRIDE_H

#include "keys/value.h"

/* Sets the value (YAML after the =) at the path; list elements by number or name; the number after the last adds an
   element. An alternative replaces the others: mesh.file=x removes mesh.shape and its parameters. Messages have "--set
   a.b=c" as their place. */
pel_status pel_scene_override(pel_scene_reader *reader, pel_scene_value *root, const char *text);

#endif
