/* Snapshots: a header, the state's arrays, then each tool's place, held vertices and last reading. The size is fixed
   for one sim, so that it can be written without allocation. */
#include "base/hash.h"
#include "base/status.h"
#include "sim/sim.h"

#include <string.h>

enum { SNAPSHOT_VERSION = 1 };

typedef struct header {
    char magic[8];
    uint32_t version, real_size;
    uint64_t fingerprint; /* of model and solver */
    int64_t step;
} header;

static uint64_t hash_double(uint64_t hash, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return pel_hash_word(hash, bits);
}

static uint64_t hash_records(uint64_t hash, const pel_body *body, const pel_record *records)
{
    for (int32_t v = 0; v < body->mesh->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            hash = hash_double(hash, (double)records[body->slot_of_vertex[v]][c]);
    return hash;
}

uint64_t pel_sim_hash(const pel_sim *sim)
{
    uint64_t hash = pel_hash_word(PEL_HASH_START, (uint64_t)sim->state->step);
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        hash = hash_records(hash, body, sim->state->position);
        hash =
            hash_records(hash, body, sim->state->velocity != NULL ? sim->state->velocity : sim->state->position_before);
    }
    return hash;
}

static uint64_t fingerprint(const pel_sim *sim)
{
    const pel_model *model = sim->model;
    uint64_t hash = pel_hash_word(PEL_HASH_START, (uint64_t)model->vertex_count);
    hash = pel_hash_bytes(hash, model->mesh_vertex, (size_t)model->vertex_count * sizeof *model->mesh_vertex);
    hash = pel_hash_bytes(hash, model->rest, (size_t)model->vertex_count * sizeof *model->rest);
    hash = pel_hash_bytes(hash, model->triangles, (size_t)model->triangle_count * sizeof *model->triangles);
    hash = hash_double(hash_double(hash, sim->step.dt), sim->step.alpha);
    hash = pel_hash_word(hash, (uint64_t)sim->solver.method * 4 + (uint64_t)sim->solver.keep_velocity * 2 +
                                   (uint64_t)sim->solver.symplectic);
    return pel_hash_word(pel_hash_word(hash, (uint64_t)sim->tool_count), (uint64_t)sim->load_count);
}

/* copies bytes in one direction or the other, or only counts them */
typedef struct cursor {
    unsigned char *bytes; /* null = count */
    size_t at;
    bool load;
} cursor;

static void transfer(cursor *at, void *data, size_t size)
{
    if (at->bytes != NULL && at->load)
        memcpy(data, at->bytes + at->at, size);
    else if (at->bytes != NULL)
        memcpy(at->bytes + at->at, data, size);
    at->at += size;
}

static void transfer_tool(cursor *at, pel_tool *tool, size_t vertex_count)
{
    transfer(at, &tool->pose, sizeof tool->pose);
    transfer(at, &tool->driven_pose, sizeof tool->driven_pose);
    transfer(at, &tool->driven, sizeof tool->driven);
    transfer(at, &tool->phase, sizeof tool->phase);
    transfer(at, &tool->held_count, sizeof tool->held_count);
    transfer(at, &tool->contact_count, sizeof tool->contact_count);
    transfer(at, &tool->plane_count, sizeof tool->plane_count);
    transfer(at, tool->planes, PEL_PLANE_LIMIT * sizeof *tool->planes);
    transfer(at, tool->force, sizeof tool->force);
    transfer(at, tool->torque, sizeof tool->torque);
    if (tool->grasp) {
        transfer(at, tool->held, vertex_count * sizeof *tool->held);
        transfer(at, tool->anchors, vertex_count * sizeof *tool->anchors);
    }
}

static void transfer_sim(cursor *at, const pel_sim *sim)
{
    pel_state *state = sim->state;
    size_t count = (size_t)sim->model->vertex_count;
    transfer(at, state->position, count * sizeof *state->position);
    transfer(at, state->position_before, count * sizeof *state->position_before);
    if (state->velocity != NULL)
        transfer(at, state->velocity, count * sizeof *state->velocity);
    transfer(at, state->contact, count * sizeof *state->contact);
    transfer(at, state->factors, (size_t)sim->model->body_count * sizeof *state->factors);
    for (int32_t l = 0; l < sim->load_count; l++)
        transfer(at, sim->loads[l].force, sizeof sim->loads[l].force);
    for (int32_t t = 0; t < sim->tool_count; t++)
        transfer_tool(at, &sim->tools[t], count);
    if (sim->held != NULL)
        transfer(at, sim->held, count * sizeof *sim->held);
}

size_t pel_sim_save_size(const pel_sim *sim)
{
    cursor place = {.at = sizeof(header)};
    transfer_sim(&place, sim);
    return place.at;
}

void pel_sim_save(const pel_sim *sim, void *bytes)
{
    header head = {
        .magic = "PELSNAP",
        .version = SNAPSHOT_VERSION,
        .real_size = sizeof(pel_real),
        .fingerprint = fingerprint(sim),
        .step = sim->state->step,
    };
    memcpy(bytes, &head, sizeof head);
    cursor place = {.bytes = bytes, .at = sizeof head};
    transfer_sim(&place, sim);
}

pel_status pel_sim_load(pel_sim *sim, const void *bytes, size_t size, pel_error *error)
{
    header head;
    if (size < sizeof head)
        return pel_fail(error, PEL_BAD_FORMAT, "snapshot is cut short");
    memcpy(&head, bytes, sizeof head);
    if (memcmp(head.magic, "PELSNAP", sizeof head.magic) != 0)
        return pel_fail(error, PEL_BAD_FORMAT, "not a snapshot");
    if (head.version != SNAPSHOT_VERSION || head.real_size != sizeof(pel_real))
        return pel_fail(error, PEL_BAD_FORMAT, "snapshot of another version or precision of the program");
    if (head.fingerprint != fingerprint(sim) || size != pel_sim_save_size(sim))
        return pel_fail(error, PEL_BAD_FORMAT, "snapshot of another model, solver or set of tools");
    /* the bytes are only read: the cursor copies out of them */
    cursor place = {.bytes = (unsigned char *)(uintptr_t)bytes, .at = sizeof head, .load = true};
    transfer_sim(&place, sim);
    sim->state->step = head.step;
    return PEL_OK;
}
