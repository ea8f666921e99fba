/* Sorting without allocation. */
#ifndef PEL_BASE_SORT_H
#define PEL_BASE_SORT_H

#include <stdint.h>

/* moves the root of the heap values[root .. count - 1] down to its place */
static inline void pel_heap_sink(int32_t *values, int32_t root, int32_t count)
{
    int32_t value = values[root];
    for (int32_t child = 2 * root + 1; child < count; child = 2 * root + 1) {
        if (child + 1 < count && values[child + 1] > values[child])
            child++;
        if (values[child] <= value)
            break;
        values[root] = values[child];
        root = child;
    }
    values[root] = value;
}

/* ascending, in place (heap sort) */
static inline void pel_sort_int32(int32_t *values, int32_t count)
{
    for (int32_t root = count / 2 - 1; root >= 0; root--)
        pel_heap_sink(values, root, count);
    for (int32_t last = count - 1; last > 0; last--) {
        int32_t largest = values[0];
        values[0] = values[last];
        values[last] = largest;
        pel_heap_sink(values, 0, last);
    }
}

#endif
