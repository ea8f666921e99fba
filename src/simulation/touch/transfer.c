/* What snapshots contain of contacts. */
#include "touch/transfer.h"

#include "base/memory.h"
#include "touch/contact.h"

void pel_touch_transfer_forces(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_contact_forces *forces = (pel_contact_forces *)(uintptr_t)&sim->contact_forces;
    int32_t vertex_count = (int32_t)(size_t)sim->model->vertex_count;
    for (int32_t begin = 0; forces->is_kept && begin < vertex_count; begin += PEL_FORCE_PAGE) {
        pel_record page[PEL_FORCE_PAGE];
        int32_t count = vertex_count - begin < PEL_FORCE_PAGE ? vertex_count - begin : PEL_FORCE_PAGE;
        pel_contact_forces_read(forces, begin, count, page);
        pel_transfer(at, page, (size_t)count * sizeof *page);
        if (at->load)
            pel_contact_forces_write(forces, begin, count, page);
    }
}

/* rows of bodies, columns of bodies and tools */
void pel_touch_transfer_pairs(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    const pel_contact_forces *forces = &sim->contact_forces;
    size_t count = (size_t)sim->model->body_count * (size_t)forces->group_count;
    if (forces->is_kept)
        pel_transfer(at, forces->pair, count * sizeof *forces->pair);
    if (sim->touch->collisions != NULL)
        pel_transfer(at, sim->touch->collisions, count * sizeof *sim->touch->collisions);
}

void pel_touch_transfer_statistics(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->contacts == NULL)
        return;
    pel_transfer(at, &sim->contacts->statistics, sizeof sim->contacts->statistics);
    pel_transfer(at, &sim->contacts->substep, sizeof sim->contacts->substep);
}

/* the statistics continue if the collider does */
void pel_touch_transfer_collider(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_contact_set *contacts = sim->contacts;
    if (contacts == NULL)
        return;
    pel_memory_part parts[PEL_COLLIDER_PARTS];
    pel_collider_memory(contacts->collider, parts);
    pel_transfer(at, sim->touch->revisions, (size_t)sim->model->body_count * sizeof *sim->touch->revisions);
    for (int i = 0; i < PEL_COLLIDER_PARTS; i++)
        pel_transfer(at, parts[i].data, parts[i].size);
}

/* ---- lists of the present length ---- */

static void load_tangles(pel_cursor *at, pel_tangles *tangles, int64_t count)
{
    tangles->count = 0;
    tangles->is_known = false;
    if (!pel_reserve((void **)&tangles->pairs, &tangles->capacity, (size_t)count, sizeof *tangles->pairs))
        at->is_full = true;
    else
        tangles->count = count;
}

/* The exact test would find the same pairs only where nothing was moved after it. */
void pel_touch_transfer_tangles(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->contacts == NULL)
        return;
    pel_tangles *tangles = &sim->contacts->tangles;
    int64_t count = tangles->is_known ? tangles->count : 0;
    uint8_t is_known = tangles->is_known;
    pel_transfer(at, &is_known, sizeof is_known);
    pel_transfer_count(at, &count, sizeof *tangles->pairs);
    if (at->load)
        load_tangles(at, tangles, count);
    if (at->is_full)
        return;
    pel_transfer(at, tangles->pairs, (size_t)count * sizeof *tangles->pairs);
    if (at->load)
        tangles->is_known = is_known == 1 && !at->is_short;
}

/* of a pair that has them */
typedef struct layer_numbers {
    double load, earlier, drag[3], slack, compliance;
} layer_numbers;

/* of any pair: that it was known decides what it starts with */
typedef struct layer_name {
    int32_t first, second;
    uint32_t traits;
} layer_name;

/* of a pair that is asleep: it is not found again */
typedef struct layer_place {
    int32_t points[4], obstacle, unused;
    double weights[4], normal[3], friction;
} layer_place;

/* the ring of the pair stands from LAYER_RING on */
enum { LAYER_EDGES = 1, LAYER_HAS_NUMBERS = 2, LAYER_IS_ASLEEP = 4, LAYER_RING = 8 };

static bool has_numbers(const pel_contact_key *key)
{
    return key->load > 0 || key->earlier > 0 || key->slack > 0 || key->drag[0] != 0 || key->drag[1] != 0 ||
           key->drag[2] != 0;
}

static void save_layer(pel_cursor *at, const pel_contact_set *set, int32_t c)
{
    const pel_contact_key *key = &set->keys[c];
    const pel_contact *contact = &set->list.contacts[c];
    bool sleeps = pel_contact_sleeps(set, key->points);
    layer_name name = {key->first, key->second,
                       (key->edge_edge ? LAYER_EDGES : 0u) | (has_numbers(key) ? LAYER_HAS_NUMBERS : 0u) |
                           (sleeps ? LAYER_IS_ASLEEP : 0u) | (uint32_t)LAYER_RING * key->ring};
    layer_numbers numbers = {
        .load = key->load, .earlier = key->earlier, .slack = key->slack, .compliance = (double)contact->compliance};
    layer_place place = {.obstacle = key->obstacle, .friction = (double)contact->friction};
    pel_vec3_copy(key->drag, numbers.drag);
    for (int i = 0; i < 4; i++) {
        place.points[i] = key->points[i];
        place.weights[i] = (double)contact->weights[i];
    }
    for (int k = 0; k < 3; k++)
        place.normal[k] = (double)contact->normal[k];
    pel_transfer(at, &name, sizeof name);
    if (has_numbers(key))
        pel_transfer(at, &numbers, sizeof numbers);
    if (sleeps)
        pel_transfer(at, &place, sizeof place);
}

static void take_place(const pel_contact_set *set, const layer_place *place, pel_contact_key *key, pel_contact *contact)
{
    key->obstacle = place->obstacle;
    contact->friction = (pel_real)place->friction;
    for (int i = 0; i < 4; i++) {
        key->points[i] = place->points[i];
        contact->vertices[i] = place->points[i] < set->vertex_count ? place->points[i] : 0;
        contact->weights[i] = (pel_real)place->weights[i];
    }
    for (int k = 0; k < 3; k++)
        contact->normal[k] = (pel_real)place->normal[k];
}

/* damaged ones take no place */
static bool is_place(const pel_contact_set *set, const layer_place *place)
{
    bool is_whole = place->obstacle >= -1 && place->obstacle < set->def.obstacle_count;
    for (int i = 0; i < 4; i++)
        is_whole &= place->points[i] >= 0 && place->points[i] < set->point_count && isfinite(place->weights[i]);
    return is_whole && isfinite(place->normal[0] + place->normal[1] + place->normal[2] + place->friction);
}

static void load_layer(pel_cursor *at, const pel_contact_set *set, pel_contact_key *key, pel_contact *contact)
{
    layer_name name = {0};
    layer_numbers numbers = {0};
    layer_place place = {.obstacle = -1};
    pel_transfer(at, &name, sizeof name);
    if ((name.traits & LAYER_HAS_NUMBERS) != 0)
        pel_transfer(at, &numbers, sizeof numbers);
    if ((name.traits & LAYER_IS_ASLEEP) != 0)
        pel_transfer(at, &place, sizeof place);
    *key = (pel_contact_key){.edge_edge = (name.traits & LAYER_EDGES) != 0,
                             .first = name.first,
                             .second = name.second,
                             .obstacle = -1,
                             .border = PEL_NO_BORDER,
                             .ring = (uint8_t)(name.traits / LAYER_RING % 4),
                             .slack = numbers.slack,
                             .load = numbers.load,
                             .earlier = numbers.earlier};
    pel_vec3_copy(numbers.drag, key->drag);
    *contact = (pel_contact){.compliance = (pel_real)numbers.compliance};
    if ((name.traits & LAYER_IS_ASLEEP) != 0 && is_place(set, &place))
        take_place(set, &place, key, contact);
}

void pel_touch_transfer_layers(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_contact_set *set = sim->contacts;
    if (set == NULL || !set->def.has_layers)
        return;
    uint8_t was_widened = set->was_widened, has_home = set->has_home;
    int64_t count = set->list.count;
    pel_transfer(at, &set->margin, sizeof set->margin);
    pel_transfer(at, &set->horizon, sizeof set->horizon);
    pel_transfer(at, &was_widened, sizeof was_widened);
    pel_transfer(at, &has_home, sizeof has_home);
    pel_transfer_count(at, &count, sizeof(layer_name));
    if (at->load) {
        set->was_widened = was_widened == 1;
        set->has_home = has_home == 1;
        int32_t expected = count > INT32_MAX ? 0 : (int32_t)count;
        at->is_short |= count > INT32_MAX;
        at->is_full |= !pel_contact_set_expect(set, expected);
        set->list.count = at->is_full ? 0 : expected;
    }
    for (int32_t c = 0; c < set->list.count; c++) {
        if (at->load)
            load_layer(at, set, &set->keys[c], &set->list.contacts[c]);
        else
            save_layer(at, set, c);
    }
    if (has_home == 1)
        pel_transfer(at, set->home, (size_t)set->point_count * sizeof *set->home);
}

bool pel_touch_restore(const pel_sim *sim)
{
    return sim->contacts == NULL || pel_contact_set_restore(sim->contacts);
}
