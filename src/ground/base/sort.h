/* Sorting in place, without allocation (heap sort). */
#ifndef PEL_BASE_SORT_H
#define PEL_BASE_SORT_H

#include <stddef.h>
#include <stdint.h>

/* Defines `static inline void name(type *values, size_t count)`, which sorts by the order `is_before(const type *,
   const type *)`. */
#define PEL_DEFINE_SORT(name, type, is_before)                                                                         \
    static inline void name##_sink(type *values, size_t root, size_t count)                                            \
    {                                                                                                                  \
        type moving = values[root];                                                                                    \
        for (size_t child; (child = 2 * root + 1) < count; root = child) {                                             \
            if (child + 1 < count && is_before(&values[child], &values[child + 1]))                                    \
                child++;                                                                                               \
            if (!is_before(&moving, &values[child]))                                                                   \
                break;                                                                                                 \
            values[root] = values[child];                                                                              \
        }                                                                                                              \
        values[root] = moving;                                                                                         \
    }                                                                                                                  \
                                                                                                                       \
    static inline void name(type *values, size_t count)                                                                \
    {                                                                                                                  \
        for (size_t i = count / 2; i > 0; i--)                                                                         \
            name##_sink(values, i - 1, count);                                                                         \
        for (size_t i = count; i > 1; i--) {                                                                           \
            type last = values[i - 1];                                                                                 \
            values[i - 1] = values[0];                                                                                 \
            values[0] = last;                                                                                          \
            name##_sink(values, 0, i - 1);                                                                             \
        }                                                                                                              \
    }

static inline int pel_int32_is_before(const int32_t *a, const int32_t *b)
{
    return *a < *b;
}

PEL_DEFINE_SORT(pel_sort_numbers, int32_t, pel_int32_is_before)

/* ascending */
static inline void pel_sort_int32(int32_t *values, int32_t count)
{
    pel_sort_numbers(values, (size_t)count);
}

#endif
