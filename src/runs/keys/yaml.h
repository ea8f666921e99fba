/* YAML 1.2 (and so JSON) text -> tree of values, through libfyaml. */
#ifndef PEL_KEYS_YAML_H
#define PEL_KEYS_YAML_H

#include "keys/value.h"

/* Parses one document. source names the text in messages; with_lines false omits line and column (overrides and
   defaults). Aliases are expanded; tags, several documents, and keys that are not text are refused. Text without any
   value gives an empty map. Null on failure. */
pel_scene_value *pel_scene_yaml_parse(pel_scene_reader *reader, const char *source, const char *text, size_t size,
                                      bool with_lines);

#endif
