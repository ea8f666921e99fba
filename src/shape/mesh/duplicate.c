#include "mesh/duplicate.h"

#include "base/memory.h"

static void sorted_corners(const int32_t triangle[3], int32_t sorted[3])
{
    int32_t a = triangle[0], b = triangle[1], c = triangle[2];
    int32_t low = a < b ? a : b, high = a < b ? b : a;
    sorted[0] = low < c ? low : c;
    sorted[2] = high > c ? high : c;
    sorted[1] = low < c ? (high < c ? high : c) : low;
}

static bool same_corners(const int32_t triangle[3], const int32_t sorted[3])
{
    int32_t other[3];
    sorted_corners(triangle, other);
    return other[0] == sorted[0] && other[1] == sorted[1] && other[2] == sorted[2];
}

static uint64_t hash_corners(const int32_t sorted[3])
{
    uint64_t hash = 0x9e3779b97f4a7c15u;
    for (int i = 0; i < 3; i++) {
        hash = (hash ^ (uint32_t)sorted[i]) * 0xff51afd7ed558ccdu;
        hash ^= hash >> 32;
    }
    return hash;
}

pel_status pel_find_duplicate_triangles(const int32_t (*triangles)[3], int32_t triangle_count, const uint8_t *skip,
                                        int32_t *first_like)
{
    size_t size = 16;
    while (size < 2 * (size_t)triangle_count)
        size *= 2;
    /* open addressing; holds triangle + 1 */
    int32_t *table = pel_allocate(size, sizeof *table);
    if (table == NULL)
        return PEL_OUT_OF_MEMORY;
    for (int32_t t = 0; t < triangle_count; t++) {
        int32_t sorted[3];
        first_like[t] = -1;
        if (skip != NULL && skip[t])
            continue;
        sorted_corners(triangles[t], sorted);
        size_t slot = hash_corners(sorted) & (size - 1);
        while (table[slot] != 0 && !same_corners(triangles[table[slot] - 1], sorted))
            slot = (slot + 1) & (size - 1);
        if (table[slot] == 0)
            table[slot] = t + 1;
        first_like[t] = table[slot] - 1;
    }
    pel_free(table);
    return PEL_OK;
}
