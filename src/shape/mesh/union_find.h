/* Disjoint sets of numbers 0 .. n - 1; the root of a set is its lowest member, so results do not depend on the order
   of joins. Path halving keeps it near-linear. */
#ifndef PEL_MESH_UNION_FIND_H
#define PEL_MESH_UNION_FIND_H

#include <stdint.h>

static inline void pel_union_find_reset(int32_t *parent, int32_t count)
{
    for (int32_t i = 0; i < count; i++)
        parent[i] = i;
}

static inline int32_t pel_union_find_root(int32_t *parent, int32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static inline void pel_union_find_join(int32_t *parent, int32_t i, int32_t j)
{
    i = pel_union_find_root(parent, i);
    j = pel_union_find_root(parent, j);
    if (i < j)
        parent[j] = i;
    else
        parent[i] = j;
}

#endif
