/* Memory that is allocated in pieces and freed together: all data of one scene. */
#ifndef PEL_KEYS_ARENA_H
#define PEL_KEYS_ARENA_H

#include <stddef.h>

/* all zero = empty */
typedef struct pel_arena {
    struct pel_arena_block *blocks; /* the newest first */
} pel_arena;

/* count zeroed elements of size bytes; null when out of memory */
void *pel_arena_take(pel_arena *arena, size_t count, size_t size);
/* copy of length bytes with a terminating zero; null when out of memory */
char *pel_arena_text(pel_arena *arena, const char *text, size_t length);
/* frees all pieces; the arena is empty again */
void pel_arena_free(pel_arena *arena);

#endif
