/* Text of YAML scalars in one line or folded over several (flow scalars), from their source between the quotes.
   libfyaml 0.7.12 can do this too, but loses letters and memory when a line has more than eight escapes. */
#ifndef PEL_KEYS_SCALAR_H
#define PEL_KEYS_SCALAR_H

#include "keys/arena.h"

/* The text of a scalar of `size` bytes; quote is ' or " or 0 for plain text. *length does not count the terminating
   zero. Null if out of memory. Escapes must be valid; unknown ones are dropped. */
char *pel_scene_decode_scalar(pel_arena *arena, const char *source, size_t size, char quote, size_t *length);

#endif
