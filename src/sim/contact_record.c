/* Records of contacts: what acts between two features in a step, summed over its substeps and parts.

   Every force of a contact is an action (contact_force.c). Actions on the same corners, from the same tool, are one
   record: forces and loads are summed, places are means by the size of the force. A table of open addressing finds the
   record of an action; records stand in the order in which they first acted, so that they do not depend on the table.
 */
#include "base/hash.h"
#include "base/memory.h"
#include "base/status.h"
#include "pellicle/geometry.h"
#include "sim/tool.h"

#include <string.h>

typedef struct contact_entry {
    int32_t vertices[4]; /* places in the model's order; -1 = unused */
    int32_t tool;
    double weights[4]; /* times size, summed */
    double size;       /* N, sum of the sizes of forces */
    double force[3], load[3];
} contact_entry;

typedef struct contact_table {
    contact_entry *entries; /* (count) */
    size_t count, capacity;
    int32_t *slots; /* (slot_count) 1 + number of an entry, 0 = free */
    size_t slot_count;
    bool is_short; /* there was no memory for an entry */
} contact_table;

/* of the last step, and of the present one */
typedef struct pel_contact_records {
    contact_table last, next;
} pel_contact_records;

enum { FIRST_SLOTS = 256, KEY_SIZE = offsetof(contact_entry, tool) + sizeof(int32_t) };

/* ---- the table ---- */

static size_t find_slot(const contact_table *table, const contact_entry *key)
{
    uint64_t hash = pel_hash_block(PEL_HASH_START, key, KEY_SIZE);
    size_t slot = (size_t)(hash ^ hash >> 32) & (table->slot_count - 1);
    while (table->slots[slot] != 0 && memcmp(&table->entries[table->slots[slot] - 1], key, KEY_SIZE) != 0)
        slot = (slot + 1) & (table->slot_count - 1);
    return slot;
}

static bool grow_slots(contact_table *table, size_t count)
{
    int32_t *slots = pel_allocate(count, sizeof *slots);
    if (slots == NULL)
        return false;
    pel_free(table->slots);
    table->slots = slots;
    table->slot_count = count;
    for (size_t i = 0; i < table->count; i++)
        slots[find_slot(table, &table->entries[i])] = (int32_t)(i + 1);
    return true;
}

static void clear(contact_table *table)
{
    table->count = 0;
    table->is_short = false;
    if (table->slot_count > 0)
        memset(table->slots, 0, table->slot_count * sizeof *table->slots);
}

static void add_entry(contact_table *table, const contact_entry *entry, double share)
{
    /* at most half of the slots are taken */
    if (2 * (table->count + 1) > table->slot_count &&
        !grow_slots(table, table->slot_count > 0 ? 2 * table->slot_count : FIRST_SLOTS)) {
        table->is_short = true;
        return;
    }
    size_t slot = find_slot(table, entry);
    if (table->slots[slot] == 0) {
        if (!pel_reserve((void **)&table->entries, &table->capacity, table->count + 1, sizeof *table->entries)) {
            table->is_short = true;
            return;
        }
        contact_entry fresh = {.tool = entry->tool};
        memcpy(fresh.vertices, entry->vertices, sizeof fresh.vertices);
        table->entries[table->count++] = fresh;
        table->slots[slot] = (int32_t)table->count;
    }
    contact_entry *sum = &table->entries[table->slots[slot] - 1];
    sum->size += share * entry->size;
    for (int i = 0; i < 4; i++)
        sum->weights[i] += share * entry->weights[i];
    pel_vec3_along(sum->force, share, entry->force, sum->force);
    pel_vec3_along(sum->load, share, entry->load, sum->load);
}

static void destroy(contact_table *table)
{
    pel_free(table->entries);
    pel_free(table->slots);
}

/* ---- of a step ---- */

pel_status pel_contact_records_create(pel_contact_forces *forces, pel_error *error)
{
    forces->records = pel_allocate(1, sizeof *forces->records);
    return forces->records != NULL ? PEL_OK : pel_fail_memory(error);
}

void pel_contact_records_destroy(pel_contact_forces *forces)
{
    if (forces->records == NULL)
        return;
    destroy(&forces->records->last);
    destroy(&forces->records->next);
    pel_free(forces->records);
}

void pel_contact_records_begin(pel_contact_forces *forces)
{
    if (forces->records != NULL)
        clear(&forces->records->next);
}

void pel_contact_records_forget(pel_contact_forces *forces)
{
    if (forces->records != NULL)
        clear(&forces->records->last);
}

void pel_contact_records_add(pel_contact_forces *forces, const pel_contact_action *action)
{
    double size = pel_vec3_length(action->force), side = 0;
    if (forces->records == NULL || !(size > 0))
        return;
    /* of a pair with a tool the body is the first side */
    for (int i = 0; i < 4; i++)
        side += action->weights[i];
    double sign = action->tool >= 0 && side < 0 ? -1 : 1;
    contact_entry entry = {.tool = action->tool, .size = size};
    for (int i = 0; i < 4; i++) {
        entry.vertices[i] = action->weights[i] != 0 ? action->vertices[i] : -1;
        entry.weights[i] = sign * size * action->weights[i];
    }
    pel_vec3_scale(action->force, sign, entry.force);
    pel_vec3_scale(action->load, sign, entry.load);
    add_entry(&forces->records->next, &entry, 1);
}

void pel_contact_records_accept(pel_contact_forces *forces, double share, bool is_first)
{
    pel_contact_records *records = forces->records;
    if (records == NULL)
        return;
    if (is_first)
        clear(&records->last);
    for (size_t i = 0; i < records->next.count; i++)
        add_entry(&records->last, &records->next.entries[i], share);
    records->last.is_short |= records->next.is_short;
}

/* ---- readings ---- */

int64_t pel_sim_contact_record_count(const pel_sim *sim)
{
    return sim != NULL && sim->contact_forces.records != NULL ? (int64_t)sim->contact_forces.records->last.count : 0;
}

/* signed distance of a point from a tool, and the direction out of it */
static double tool_distance(const pel_tool *tool, const double point[3], double normal[3])
{
    double local[3], best[3] = {0, 0, 0}, least = HUGE_VAL;
    pel_pose_to_local(&tool->pose, point, local);
    if (tool->mesh == NULL) {
        least = pel_solid_distance(&tool->solid, local, best);
        pel_rotate(tool->pose.rotation, best, normal);
        return least;
    }
    for (int32_t t = 0; t < tool->mesh->triangle_count; t++) {
        const int32_t *corners = tool->mesh->triangles[t];
        const double *a = tool->mesh->positions[corners[0]], *b = tool->mesh->positions[corners[1]],
                     *c = tool->mesh->positions[corners[2]];
        double weights[3], away[3];
        double distance = sqrt(pel_closest_point_triangle(local, a, b, c, weights));
        if (distance >= least)
            continue;
        least = distance;
        for (int k = 0; k < 3; k++)
            away[k] = local[k] - weights[0] * a[k] - weights[1] * b[k] - weights[2] * c[k];
        pel_vec3_scale(away, distance > 0 ? 1 / distance : 0, best);
    }
    pel_rotate(tool->pose.rotation, best, normal);
    return least;
}

/* the point of one side, by the sign of its weights */
static void side_point(const pel_sim *sim, const contact_entry *entry, double sign, double point[3])
{
    double x[3];
    pel_vec3_set(point, 0, 0, 0);
    for (int i = 0; i < 4; i++) {
        if (!(sign * entry->weights[i] > 0))
            continue;
        pel_vertex_position(sim->state->position, entry->vertices[i], x);
        pel_vec3_along(point, sign * entry->weights[i] / entry->size, x, point);
    }
}

static void read_corners(const pel_sim *sim, const contact_entry *entry, pel_contact_record *record)
{
    for (int i = 0; i < 4; i++) {
        int32_t place = entry->vertices[i];
        record->vertices[i] = -1;
        record->weights[i] = entry->weights[i] / entry->size;
        if (place < 0)
            continue;
        int32_t body = sim->model->body_of_slice[place / PEL_WIDTH];
        record->bodies[record->weights[i] < 0] = body;
        record->vertices[i] = pel_output_vertex(sim, body, sim->model->mesh_vertex[place]);
    }
}

static void read_record(const pel_sim *sim, const contact_entry *entry, pel_contact_record *record)
{
    double load = pel_vec3_length(entry->load), other[3], out[3] = {0, 0, 0};
    *record = (pel_contact_record){.bodies = {-1, -1}, .tool = entry->tool};
    read_corners(sim, entry, record);
    side_point(sim, entry, 1, record->point);
    pel_vec3_copy(entry->force, record->force);
    pel_vec3_scale(entry->load, load > 0 ? 1 / load : 0, record->normal);
    if (entry->tool >= 0) {
        record->gap = tool_distance(&sim->tools[entry->tool], record->point, out);
        if (!(load > 0))
            pel_vec3_copy(out, record->normal);
        /* the nearest triangle of a mesh has no inside: the normal tells */
        else if (sim->tools[entry->tool].mesh != NULL && pel_vec3_dot(out, record->normal) < 0)
            record->gap = -record->gap;
        return;
    }
    side_point(sim, entry, -1, other);
    pel_vec3_subtract(record->point, other, other);
    record->gap = pel_vec3_dot(other, record->normal);
}

pel_status pel_sim_get_contact_records(const pel_sim *sim, pel_contact_record *records, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    int64_t count = pel_sim_contact_record_count(sim);
    if (count > 0)
        PEL_REFUSE_NULL(records, error);
    if (sim->contact_forces.records != NULL && sim->contact_forces.records->last.is_short)
        return pel_fail_memory(error);
    for (int64_t i = 0; i < count; i++)
        read_record(sim, &sim->contact_forces.records->last.entries[i], &records[i]);
    return PEL_OK;
}
