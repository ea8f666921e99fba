#include "keys/arena.h"

#include "base/memory.h"

#include <stdint.h>
#include <string.h>

/* a piece starts at a multiple of ALIGNMENT; a block has at least BLOCK_SIZE bytes */
enum { ALIGNMENT = 16, BLOCK_SIZE = 16384 };

struct pel_arena_block {
    struct pel_arena_block *next;
    size_t size, used; /* bytes after this header */
    size_t padding;
};

_Static_assert(sizeof(struct pel_arena_block) % ALIGNMENT == 0, "pieces start behind the header");

static struct pel_arena_block *new_block(pel_arena *arena, size_t bytes)
{
    size_t size = bytes < BLOCK_SIZE ? BLOCK_SIZE : bytes;
    struct pel_arena_block *block = pel_allocate(sizeof *block + size, 1);
    if (block == NULL)
        return NULL;
    block->size = size;
    block->next = arena->blocks;
    arena->blocks = block;
    return block;
}

void *pel_arena_take(pel_arena *arena, size_t count, size_t size)
{
    if (count > (SIZE_MAX / 2) / size)
        return NULL;
    size_t bytes = (count * size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    struct pel_arena_block *block = arena->blocks;
    if (block == NULL || block->size - block->used < bytes)
        block = new_block(arena, bytes);
    if (block == NULL)
        return NULL;
    void *piece = (char *)(block + 1) + block->used;
    block->used += bytes;
    return piece;
}

char *pel_arena_text(pel_arena *arena, const char *text, size_t length)
{
    char *copy = pel_arena_take(arena, length + 1, 1);
    if (copy != NULL)
        memcpy(copy, text, length);
    return copy;
}

void pel_arena_free(pel_arena *arena)
{
    while (arena->blocks != NULL) {
        struct pel_arena_block *next = arena->blocks->next;
        pel_free(arena->blocks);
        arena->blocks = next;
    }
}
