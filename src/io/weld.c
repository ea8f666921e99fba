#include "io/weld.h"

#include "base/memory.h"

#include <string.h>

static size_t hash_position(const double position[3])
{
    uint64_t hash = 0;
    for (int i = 0; i < 3; i++) {
        double value = position[i] + 0.0; /* -0 becomes 0 */
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        hash = (hash ^ bits) * UINT64_C(0xbf58476d1ce4e5b9);
        hash ^= hash >> 31;
    }
    hash *= UINT64_C(0x94d049bb133111eb);
    return (size_t)(hash ^ (hash >> 29));
}

/* the slot of this position: its vertex's, or the empty one where it belongs */
static int32_t *find_slot(const pel_weld *weld, const pel_builder *builder, const double position[3])
{
    size_t mask = weld->slot_count - 1, at = hash_position(position) & mask;
    for (; weld->slots[at] != 0; at = (at + 1) & mask) {
        const double *other = builder->positions[weld->slots[at] - 1];
        if (other[0] == position[0] && other[1] == position[1] && other[2] == position[2])
            break;
    }
    return &weld->slots[at];
}

/* doubles the table */
static bool grow(pel_weld *weld, const pel_builder *builder)
{
    pel_weld larger = {.slot_count = weld->slot_count == 0 ? 64 : 2 * weld->slot_count};
    larger.slots = pel_allocate(larger.slot_count, sizeof *larger.slots);
    if (larger.slots == NULL)
        return false;
    for (size_t v = 0; v < builder->vertex_count; v++)
        *find_slot(&larger, builder, builder->positions[v]) = (int32_t)v + 1;
    pel_weld_free(weld);
    *weld = larger;
    return true;
}

bool pel_weld_vertex(pel_weld *weld, pel_builder *builder, const double position[3], int32_t *vertex)
{
    if (2 * builder->vertex_count >= weld->slot_count && !grow(weld, builder))
        return false;
    int32_t *slot = find_slot(weld, builder, position);
    if (*slot == 0) {
        if (builder->vertex_count >= INT32_MAX || !pel_builder_add_vertex(builder, position))
            return false;
        *slot = (int32_t)builder->vertex_count;
    }
    *vertex = *slot - 1;
    return true;
}

void pel_weld_free(pel_weld *weld)
{
    pel_free(weld->slots);
    weld->slots = NULL;
    weld->slot_count = 0;
}
