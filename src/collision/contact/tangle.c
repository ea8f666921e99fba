/* Pairs of triangles that intersect from the start on. They are left alone: contact and guard pass over their vertices
   and edges against each other, until the triangles have parted. After every step the exact test finds what is left;
   what the guard watches cannot be among it. */
#include "contact/set.h"

#include "base/memory.h"
#include "base/sort.h"
#include "base/status.h"

enum { PAIR_LIMIT = 1 << 20, FIRST_PAIRS = 64 };

/* ---- search ---- */

static bool may_meet(const pel_contact_set *set, pel_pair pair)
{
    int32_t a = set->group_of_point[set->triangles[pair.first][0]];
    int32_t b = set->group_of_point[set->triangles[pair.second][0]];
    return set->may_meet[a * (set->def.body_count + set->def.obstacle_count) + b];
}

/* takes out the pairs of what does not touch anyway */
static void drop_strangers(const pel_contact_set *set, pel_tangles *tangles)
{
    int64_t kept = 0;
    for (int64_t i = 0; i < tangles->count; i++) {
        tangles->pairs[kept] = tangles->pairs[i];
        kept += may_meet(set, tangles->pairs[i]);
    }
    tangles->count = kept;
}

static pel_status find_pairs(const pel_contact_set *set, pel_tangles *tangles, pel_error *error)
{
    pel_mesh mesh = pel_contact_mesh(set);
    for (int64_t room = tangles->capacity > 0 ? (int64_t)tangles->capacity : FIRST_PAIRS;; room = tangles->count) {
        if (room > PAIR_LIMIT)
            return pel_refuse(error, PEL_BAD_ARGUMENT, "pull the surfaces apart first",
                              "more than %d pairs of triangles intersect", (int)PAIR_LIMIT);
        if (!pel_reserve((void **)&tangles->pairs, &tangles->capacity, (size_t)room, sizeof *tangles->pairs))
            return pel_fail_memory(error);
        pel_status status = pel_mesh_self_intersections(&mesh, tangles->pairs, (int32_t)room, &tangles->count, error);
        if (status != PEL_OK || tangles->count <= room)
            return status;
    }
}

pel_status pel_tangles_list(const pel_contact_set *set, pel_tangles *tangles, pel_error *error)
{
    pel_status status = find_pairs(set, tangles, error);
    if (status == PEL_OK)
        drop_strangers(set, tangles);
    else
        tangles->count = 0;
    return status;
}

/* ---- keys ---- */

static uint64_t make_key(int32_t a, int32_t b)
{
    uint32_t low = (uint32_t)(a < b ? a : b), high = (uint32_t)(a < b ? b : a);
    return (uint64_t)low << 32 | high;
}

static bool is_before(const uint64_t *a, const uint64_t *b)
{
    return *a < *b;
}

PEL_DEFINE_SORT(sort_keys, uint64_t, is_before)

static pel_status make_keys(pel_contact_set *set, pel_error *error)
{
    pel_tangles *tangles = &set->tangles;
    size_t count = 0;
    if (!pel_reserve((void **)&tangles->keys, &tangles->key_capacity, 9 * (size_t)tangles->count,
                     sizeof *tangles->keys))
        return pel_fail_memory(error);
    for (int64_t i = 0; i < tangles->count; i++)
        for (int c = 0; c < 9; c++)
            tangles->keys[count++] = make_key(set->triangles[tangles->pairs[i].first][c / 3],
                                              set->triangles[tangles->pairs[i].second][c % 3]);
    sort_keys(tangles->keys, count);
    return PEL_OK;
}

pel_status pel_tangles_find(pel_contact_set *set, pel_error *error)
{
    pel_tangles *tangles = &set->tangles;
    tangles->is_known = false;
    pel_status status = pel_tangles_list(set, tangles, error);
    if (status != PEL_OK)
        return status;
    set->statistics.tangled = tangles->count;
    status = make_keys(set, error);
    tangles->is_known = status == PEL_OK;
    return status;
}

pel_status pel_tangles_recall(pel_contact_set *set, pel_error *error)
{
    pel_tangles *tangles = &set->tangles;
    for (int64_t i = 0; tangles->is_known && i < tangles->count; i++)
        tangles->is_known = tangles->pairs[i].first >= 0 && tangles->pairs[i].first < set->triangle_count &&
                            tangles->pairs[i].second >= 0 && tangles->pairs[i].second < set->triangle_count;
    if (!tangles->is_known)
        tangles->count = 0;
    pel_status status = make_keys(set, error);
    tangles->is_known &= status == PEL_OK;
    return status;
}

static bool has_key(const pel_tangles *tangles, uint64_t key)
{
    size_t low = 0, high = 9 * (size_t)tangles->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (tangles->keys[middle] < key)
            low = middle + 1;
        else
            high = middle;
    }
    return low < 9 * (size_t)tangles->count && tangles->keys[low] == key;
}

bool pel_tangles_have(const pel_contact_set *set, const pel_collision *collision)
{
    int first_count = collision->edge_edge ? 2 : 1;
    for (int i = 0; i < first_count; i++)
        for (int k = first_count; k < 4; k++)
            if (!has_key(&set->tangles, make_key(collision->vertices[i], collision->vertices[k])))
                return false;
    return true;
}
