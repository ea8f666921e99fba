/* Pairs that a search within a step need not find again: they stay in the list until the next step. Where surfaces lie
   on each other nearly all that it would find is known. */
#include "contact/set.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"

#include <string.h>

void pel_contact_find_fans(pel_contact_set *set)
{
    const pel_tree *tree = pel_collider_tree(set->collider);
    int32_t ring[PEL_RING_LIMIT];
    memset(set->is_fan, 0, (size_t)set->point_count);
    for (int32_t h = 0; h < 3 * set->triangle_count; h++) {
        uint8_t *own = &set->is_fan[set->triangles[h / 3][h % 3]];
        *own = *own < PEL_RING_LIMIT ? *own + 1 : PEL_RING_LIMIT + 1;
    }
    /* how many triangles there are, then whether they are all of a ring */
    for (int32_t h = 0; h < 3 * set->triangle_count; h++) {
        int32_t corner = set->triangles[h / 3][h % 3];
        if (set->is_fan[corner] > 1)
            set->is_fan[corner] = pel_contact_ring(tree, h / 3, corner, ring) == set->is_fan[corner];
    }
}

pel_status pel_contact_list_known(pel_contact_set *set, pel_error *error)
{
    pel_contact_known *known = &set->known;
    int32_t features[2] = {set->point_count, 3 * set->triangle_count}, c = 0;
    if (!pel_reserve((void **)&known->items, &known->item_capacity, (size_t)set->list.count, sizeof *known->items))
        return pel_fail_memory(error);
    for (int kind = 0; kind < 2; kind++) {
        if (!pel_reserve((void **)&known->begins[kind], &known->begin_capacity[kind], (size_t)features[kind] + 1,
                         sizeof *known->begins[kind]))
            return pel_fail_memory(error);
        int32_t *begins = known->begins[kind], next = 0;
        for (; c < set->list.count && set->keys[c].edge_edge == (kind == 1); c++) {
            const pel_contact_key *key = &set->keys[c];
            while (next <= key->first)
                begins[next++] = c;
            known->items[c][0] = key->second;
            known->items[c][1] = key->ring > 0 && set->is_fan[key->points[key->ring]] ? key->points[key->ring] : -1;
        }
        while (next <= features[kind])
            begins[next++] = c;
    }
    return PEL_OK;
}

bool pel_contact_is_known(const pel_contact_known *known, bool edge_edge, const pel_pair *pair, const int32_t points[4])
{
    const int32_t *begins = known->begins[edge_edge] + pair->first;
    for (int32_t i = begins[0]; i < begins[1]; i++) {
        int32_t corner = known->items[i][1];
        if (known->items[i][0] == pair->second ||
            (corner >= 0 && (corner == points[1] || corner == points[2] || corner == points[3])))
            return true;
    }
    return false;
}
