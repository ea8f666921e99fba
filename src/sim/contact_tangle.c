/* Pairs of triangles that intersect from the start on. They are left alone: contact and guard pass over their vertices
   and edges against each other, until the triangles have parted. After every step the exact test finds what is left;
   what the guard watches cannot be among it. */
#include "sim/contact.h"

#include "base/memory.h"
#include "base/sort.h"
#include "base/status.h"
#include "sim/tool.h"

#include <stdio.h>
#include <string.h>

enum { PAIR_LIMIT = 1 << 20, FIRST_PAIRS = 64, NAMED_PAIRS = 3, NAME_ROOM = PEL_NAME_SIZE + 32 };

/* ---- search ---- */

static bool may_meet(const pel_sim *sim, pel_pair pair)
{
    const pel_sim_contacts *contacts = sim->contacts;
    int32_t a = contacts->group_of_point[contacts->triangles[pair.first][0]];
    int32_t b = contacts->group_of_point[contacts->triangles[pair.second][0]];
    return contacts->may_meet[a * (sim->model->body_count + sim->tool_count) + b];
}

/* takes out the pairs of what does not touch anyway */
static void drop_strangers(const pel_sim *sim, pel_tangles *tangles)
{
    int64_t kept = 0;
    for (int64_t i = 0; i < tangles->count; i++) {
        tangles->pairs[kept] = tangles->pairs[i];
        kept += may_meet(sim, tangles->pairs[i]);
    }
    tangles->count = kept;
}

static pel_status find_pairs(const pel_sim *sim, pel_tangles *tangles, pel_error *error)
{
    pel_mesh mesh = pel_contact_mesh(sim);
    for (int64_t room = tangles->capacity > 0 ? (int64_t)tangles->capacity : FIRST_PAIRS;; room = tangles->count) {
        if (room > PAIR_LIMIT) {
            pel_fail(error, PEL_BAD_ARGUMENT, "more than %d pairs of triangles intersect", (int)PAIR_LIMIT);
            pel_fail_remedy(error, "pull the surfaces apart first");
            return PEL_BAD_ARGUMENT;
        }
        if (!pel_reserve((void **)&tangles->pairs, &tangles->capacity, (size_t)room, sizeof *tangles->pairs))
            return pel_fail_memory(error);
        pel_status status = pel_mesh_self_intersections(&mesh, tangles->pairs, (int32_t)room, &tangles->count, error);
        if (status != PEL_OK || tangles->count <= room)
            return status;
    }
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

static pel_status make_keys(pel_sim_contacts *contacts, pel_error *error)
{
    pel_tangles *tangles = &contacts->tangles;
    size_t count = 0;
    if (!pel_reserve((void **)&tangles->keys, &tangles->key_capacity, 9 * (size_t)tangles->count,
                     sizeof *tangles->keys))
        return pel_fail_memory(error);
    for (int64_t i = 0; i < tangles->count; i++)
        for (int c = 0; c < 9; c++)
            tangles->keys[count++] = make_key(contacts->triangles[tangles->pairs[i].first][c / 3],
                                              contacts->triangles[tangles->pairs[i].second][c % 3]);
    sort_keys(tangles->keys, count);
    return PEL_OK;
}

pel_status pel_tangles_find(pel_sim *sim, pel_error *error)
{
    pel_tangles *tangles = &sim->contacts->tangles;
    pel_status status = find_pairs(sim, tangles, error);
    tangles->is_known = false;
    if (status != PEL_OK) {
        tangles->count = 0;
        return status;
    }
    drop_strangers(sim, tangles);
    sim->contacts->statistics.tangled = tangles->count;
    status = make_keys(sim->contacts, error);
    tangles->is_known = status == PEL_OK;
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

bool pel_tangles_have(const pel_sim_contacts *contacts, const pel_collision *collision)
{
    int first_count = collision->edge_edge ? 2 : 1;
    for (int i = 0; i < first_count; i++)
        for (int k = first_count; k < 4; k++)
            if (!has_key(&contacts->tangles, make_key(collision->vertices[i], collision->vertices[k])))
                return false;
    return true;
}

/* ---- refusal ---- */

static void describe(const pel_sim *sim, int32_t triangle, char *text, size_t size)
{
    const pel_sim_contacts *contacts = sim->contacts;
    int32_t group = contacts->group_of_point[contacts->triangles[triangle][0]], first = triangle;
    while (first > 0 && contacts->group_of_point[contacts->triangles[first - 1][0]] == group)
        first--;
    bool is_body = group < sim->model->body_count;
    snprintf(text, size, "%s '%s' %d", is_body ? "body" : "tool",
             is_body ? sim->model->bodies[group].name : sim->tools[group - sim->model->body_count].name,
             (int)(triangle - first));
}

static pel_status refuse_pairs(const pel_sim *sim, pel_error *error)
{
    const pel_tangles *tangles = &sim->contacts->tangles;
    char list[400] = "", first[NAME_ROOM], second[NAME_ROOM];
    for (int64_t i = 0; i < tangles->count && i < NAMED_PAIRS; i++) {
        size_t length = strlen(list);
        describe(sim, tangles->pairs[i].first, first, sizeof first);
        describe(sim, tangles->pairs[i].second, second, sizeof second);
        snprintf(list + length, sizeof list - length, "%s%s and %s", i > 0 ? "; " : "", first, second);
    }
    pel_fail(error, PEL_BAD_ARGUMENT, "%lld pairs of triangles intersect at the start: %s%s", (long long)tangles->count,
             list, tangles->count > NAMED_PAIRS ? "; ..." : "");
    pel_fail_remedy(error, "pull them apart, or accept them with contact: { start: tangled }");
    return PEL_BAD_ARGUMENT;
}

/* a tool that is a surface must not cut a body, nor be inside a closed one */
static pel_status refuse_tools(const pel_sim *sim, pel_error *error)
{
    const pel_sim_contacts *contacts = sim->contacts;
    int32_t body_count = sim->model->body_count;
    for (int64_t i = 0; i < contacts->tangles.count; i++) {
        const pel_pair *pair = &contacts->tangles.pairs[i];
        int32_t first = contacts->group_of_point[contacts->triangles[pair->first][0]];
        int32_t second = contacts->group_of_point[contacts->triangles[pair->second][0]];
        int32_t tool = (first > second ? first : second) - body_count;
        if (tool >= 0)
            return pel_tool_refuse_inside(sim, tool, first < second ? first : second, error);
    }
    for (int32_t i = 0; i < sim->tool_count; i++)
        for (int32_t b = 0; b < body_count; b++)
            if (sim->tools[i].mesh != NULL && sim->tools[i].press && pel_tool_acts_on(&sim->tools[i], b) &&
                sim->model->bodies[b].closed &&
                pel_tool_is_enclosed(sim, contacts->start[contacts->tools[i].point_begin], b))
                return pel_tool_refuse_inside(sim, i, b, error);
    return PEL_OK;
}

pel_status pel_tangles_refuse(const pel_sim *sim, pel_error *error)
{
    pel_status status = refuse_tools(sim, error);
    if (status == PEL_OK && sim->contacts->tangles.count > 0 && !sim->contacts->def.allow_tangled)
        status = refuse_pairs(sim, error);
    return status;
}

pel_status pel_sim_intersections(pel_sim *sim, int64_t *count, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(count, error);
    *count = 0;
    if (sim->contacts == NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "contact is not enabled");
    pel_tangles tangles = {0};
    pel_contact_present_points(sim);
    pel_status status = pel_contact_surface_update(sim, error);
    if (status == PEL_OK)
        status = find_pairs(sim, &tangles, error);
    if (status == PEL_OK) {
        drop_strangers(sim, &tangles);
        *count = tangles.count;
    }
    pel_free(tangles.pairs);
    return status;
}
