/* Records of contacts: what acts between two features in a step, summed over its substeps and parts.

   Every force of a contact is an action (force.c). Actions on the same corners, from the same obstacle, are one
   record: forces and loads are summed, places are means by the size of the force. A table of open addressing finds the
   record of an action; records stand in the order in which they first acted, so that they do not depend on the table.
 */
#include "action/force.h"

#include "base/hash.h"
#include "base/memory.h"
#include "base/status.h"
#include "math/vec3.h"

#include <string.h>

enum { FIRST_SLOTS = 256, KEY_SIZE = offsetof(pel_contact_entry, obstacle) + sizeof(int32_t) };

/* ---- the table ---- */

static size_t find_slot(const pel_contact_table *table, const pel_contact_entry *key)
{
    uint64_t hash = pel_hash_block(PEL_HASH_START, key, KEY_SIZE);
    size_t slot = (size_t)(hash ^ hash >> 32) & (table->slot_count - 1);
    while (table->slots[slot] != 0 && memcmp(&table->entries[table->slots[slot] - 1], key, KEY_SIZE) != 0)
        slot = (slot + 1) & (table->slot_count - 1);
    return slot;
}

static bool grow_slots(pel_contact_table *table, size_t count)
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

static void clear(pel_contact_table *table)
{
    table->count = 0;
    table->is_short = false;
    if (table->slot_count > 0)
        memset(table->slots, 0, table->slot_count * sizeof *table->slots);
}

static void add_entry(pel_contact_table *table, const pel_contact_entry *entry, double share)
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
        pel_contact_entry fresh = {.obstacle = entry->obstacle};
        memcpy(fresh.vertices, entry->vertices, sizeof fresh.vertices);
        table->entries[table->count++] = fresh;
        table->slots[slot] = (int32_t)table->count;
    }
    pel_contact_entry *sum = &table->entries[table->slots[slot] - 1];
    sum->size += share * entry->size;
    for (int i = 0; i < 4; i++)
        sum->weights[i] += share * entry->weights[i];
    pel_vec3_along(sum->force, share, entry->force, sum->force);
    pel_vec3_along(sum->load, share, entry->load, sum->load);
}

static void destroy(pel_contact_table *table)
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
    /* of a pair with an obstacle the body is the first side */
    for (int i = 0; i < 4; i++)
        side += action->weights[i];
    double sign = action->obstacle >= 0 && side < 0 ? -1 : 1;
    pel_contact_entry entry = {.obstacle = action->obstacle, .size = size};
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
