#include "sweep/patch.h"

#include "base/memory.h"
#include "base/room.h"

#include <math.h>
#include <string.h>

/* cosine: normals of one patch. They differ by the tilt of a layer over a face, less than a thousandth */
#define SAME_NORMAL (1 - 1e-6)
#define DIAGONAL 0.70710678118654752

bool pel_contact_patches_expect(pel_contact_patches *patches, const pel_contact_list *list, size_t count)
{
    if (list->rigids == NULL)
        return true;
    for (patches->table_size = 1; patches->table_size < 2 * count;)
        patches->table_size *= 2;
    return pel_reserve((void **)&patches->items, &patches->capacity, count, sizeof *patches->items) &&
           pel_reserve((void **)&patches->of, &patches->of_capacity, count, sizeof *patches->of) &&
           pel_reserve((void **)&patches->table, &patches->table_capacity, patches->table_size, sizeof *patches->table);
}

void pel_contact_patches_clear(pel_contact_patches *patches)
{
    PEL_FREE_ALL(patches->items, patches->table, patches->of);
}

/* The bodies of a contact, its normal from the lower to the higher one, the place on one of them, and the gap; false
   where something else than rigid bodies gives way. */
static bool describe(const pel_contact_list *list, const pel_contact *contact, const pel_record *positions,
                     pel_contact_patch *patch, double place[3])
{
    double whole = 0, x[3];
    patch->first = patch->second = -1;
    patch->least = -(double)contact->separation;
    pel_vec3_set(place, 0, 0, 0);
    for (int i = 0; i < 4; i++) {
        double weight = (double)contact->weights[i];
        if (weight == 0)
            continue;
        int32_t body = list->rigids->of_slice[contact->vertices[i] / PEL_WIDTH];
        if (body < 0)
            return false;
        pel_vertex_position(positions, contact->vertices[i], x);
        patch->first = patch->first < 0 ? body : patch->first;
        patch->second = body != patch->first ? body : patch->second;
        for (int k = 0; k < 3; k++)
            patch->least += weight * x[k] * (double)contact->normal[k];
        if (body != patch->first)
            continue;
        whole += weight;
        pel_vec3_along(place, weight, x, place);
    }
    if (whole == 0)
        return false;
    bool is_turned = patch->second < patch->first;
    int32_t first = patch->first;
    patch->first = is_turned ? patch->second : first;
    patch->second = is_turned ? first : patch->second;
    for (int k = 0; k < 3; k++)
        patch->normal[k] = (is_turned ? -1 : 1) * (double)contact->normal[k];
    pel_vec3_scale(place, 1 / whole, place);
    return true;
}

/* the patch that a contact is of, or a new one */
static pel_contact_patch *find_patch(pel_contact_patches *patches, int32_t *count, const pel_contact_patch *own)
{
    size_t mask = patches->table_size - 1;
    size_t at = ((size_t)(own->first + 1) * 0x9e3779b1u + (size_t)(own->second + 1) * 0x85ebca6bu) & mask;
    for (; patches->table[at] >= 0; at = (at + 1) & mask) {
        pel_contact_patch *patch = &patches->items[patches->table[at]];
        if (patch->first == own->first && patch->second == own->second &&
            pel_vec3_dot(patch->normal, own->normal) > SAME_NORMAL)
            return patch;
    }
    patches->table[at] = *count;
    pel_contact_patch *patch = &patches->items[(*count)++];
    *patch = *own;
    patch->nearest = -1;
    int axis = fabs(own->normal[0]) < 0.6 ? 0 : 1;
    pel_vec3_scale(own->normal, -own->normal[axis], patch->across[0]);
    patch->across[0][axis] += 1;
    pel_vec3_normalize(patch->across[0]);
    pel_vec3_cross(own->normal, patch->across[0], patch->across[1]);
    return patch;
}

static void add(pel_contact_patch *patch, int32_t c, const double place[3], double gap)
{
    double u = pel_vec3_dot(patch->across[0], place), v = pel_vec3_dot(patch->across[1], place);
    const double ways[PEL_PATCH_DIRECTIONS / 2] = {u, v, DIAGONAL * (u + v), DIAGONAL * (u - v)};
    bool is_first = patch->nearest < 0;
    for (int d = 0; d < PEL_PATCH_DIRECTIONS; d++) {
        double way = d % 2 == 0 ? ways[d / 2] : -ways[d / 2];
        if (!is_first && !(way > patch->most[d]))
            continue;
        patch->most[d] = way;
        patch->farthest[d] = c;
    }
    if (!is_first && !(gap < patch->least))
        return;
    patch->least = gap;
    patch->nearest = c;
}

static bool holds(const pel_contact_patch *patch, int32_t c)
{
    bool is_one = patch->nearest == c;
    for (int d = 0; d < PEL_PATCH_DIRECTIONS; d++)
        is_one |= patch->farthest[d] == c;
    return is_one;
}

void pel_contact_patches_thin(pel_contact_patches *patches, pel_contact_list *list, int32_t *active,
                              const pel_record *positions)
{
    int32_t count = 0, kept = 0;
    if (list->rigids == NULL || list->active_count == 0)
        return;
    memset(patches->table, -1, patches->table_size * sizeof *patches->table);
    for (int32_t i = 0; i < list->active_count; i++) {
        pel_contact_patch own;
        double place[3];
        patches->of[i] = -1;
        if (!describe(list, &list->contacts[active[i]], positions, &own, place))
            continue;
        pel_contact_patch *patch = find_patch(patches, &count, &own);
        add(patch, active[i], place, own.least);
        patches->of[i] = (int32_t)(patch - patches->items);
    }
    for (int32_t i = 0; i < list->active_count; i++) {
        int32_t c = active[i], p = patches->of[i];
        if (p < 0 || list->contacts[c].multiplier > 0 || holds(&patches->items[p], c))
            active[kept++] = c;
    }
    list->active_count = kept;
}
