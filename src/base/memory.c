#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void *pel_allocate(size_t count, size_t size)
{
    return calloc(count > 0 ? count : 1, size);
}

void *pel_allocate_aligned(size_t count, size_t size)
{
    enum { ALIGNMENT = 64 };
    if (count == 0)
        count = 1;
    if (count > (SIZE_MAX - ALIGNMENT) / size)
        return NULL;
    size_t bytes = (count * size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    void *block = aligned_alloc(ALIGNMENT, bytes);
    if (block != NULL)
        memset(block, 0, bytes);
    return block;
}

void *pel_reallocate(void *block, size_t count, size_t size)
{
    if (count == 0)
        count = 1;
    if (count > SIZE_MAX / size)
        return NULL;
    return realloc(block, count * size);
}

void pel_free(void *block)
{
    free(block);
}

char *pel_copy_string(const char *text)
{
    size_t size = strlen(text) + 1;
    char *copy = pel_allocate(size, 1);
    if (copy != NULL)
        memcpy(copy, text, size);
    return copy;
}

int pel_reserve(void **array, size_t *capacity, size_t needed, size_t size)
{
    if (needed <= *capacity)
        return 1;
    size_t grown = *capacity < 16 ? 16 : *capacity;
    while (grown < needed) {
        if (grown > SIZE_MAX / 2)
            return 0;
        grown *= 2;
    }
    void *block = pel_reallocate(*array, grown, size);
    if (block == NULL)
        return 0;
    *array = block;
    *capacity = grown;
    return 1;
}
