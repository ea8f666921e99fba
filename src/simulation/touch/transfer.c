/* What snapshots contain of contacts. */
#include "touch/transfer.h"

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
