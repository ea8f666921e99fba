/* Snapshots: a header with the fingerprint of the model and sim that it was made with and a checksum, then all that the
   steps to come depend on. The size is fixed for one sim, so that it can be written without allocation. */
#include "base/hash.h"
#include "base/memory.h"
#include "base/status.h"
#include "model/shell.h"
#include "sim/contact.h"
#include "sim/hold.h"
#include "sim/step_modes.h"
#include "sim/step_path.h"

#include <string.h>

enum { SNAPSHOT_VERSION = 12 };

typedef struct header {
    char magic[8];
    uint32_t version, real_size;
    uint64_t size; /* bytes of the whole */
    pel_fingerprint fingerprint;
    int64_t step;
    uint64_t has_forces; /* of the caller */
    uint64_t checksum;   /* of the whole, with 0 in its place */
} header;

static uint64_t hash_double(uint64_t hash, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return pel_hash_word(hash, bits);
}

static uint64_t hash_records(uint64_t hash, const pel_sim *sim, int32_t body, const pel_record *records)
{
    int32_t count = pel_output_count(sim, body);
    for (int32_t r = 0; r < count; r++) {
        int32_t place = pel_output_model_index(sim, body, r);
        for (int c = 0; c < 3; c++)
            hash = hash_double(hash, (double)records[place][c]);
    }
    return hash;
}

uint64_t pel_sim_hash(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    uint64_t hash = pel_hash_word(PEL_HASH_START, (uint64_t)sim->state->step);
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_state *state = sim->state;
        hash = hash_records(hash, sim, b, state->position);
        hash = hash_records(hash, sim, b, state->velocity != NULL ? state->velocity : state->position_before);
    }
    return hash;
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

/* the criterion's memory, and which vertex has which place; the front follows from the marks */
static void transfer_refinement(cursor *at, const pel_sim *sim, int32_t body)
{
    const pel_refined_body *own = &sim->active->bodies[body];
    pel_refine_body *refine = &sim->refine[body];
    const pel_front *front = own->front;
    size_t fine = (size_t)front->forest->levels[front->forest->depth]->vertex_count;
    size_t coarse = (size_t)front->forest->levels[0]->vertex_count;
    transfer(at, refine->mark_counts, (size_t)front->red_limit * sizeof *refine->mark_counts);
    transfer(at, refine->requests, fine * sizeof *refine->requests);
    transfer(at, refine->warm_step, fine * sizeof *refine->warm_step);
    transfer(at, refine->strengths, fine * sizeof *refine->strengths);
    transfer(at, refine->asked_level, coarse * sizeof *refine->asked_level);
    int32_t *lists[] = {refine->candidates, refine->leaving, refine->hot, refine->hot_place};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        transfer(at, lists[i], fine * sizeof *lists[i]);
    transfer(at, &refine->candidate_count, sizeof refine->candidate_count);
    transfer(at, &refine->waiting_count, sizeof refine->waiting_count);
    transfer(at, &refine->leaving_count, sizeof refine->leaving_count);
    transfer(at, &refine->hot_count, sizeof refine->hot_count);
    transfer(at, &refine->part, sizeof refine->part);
    transfer(at, &refine->revision, sizeof refine->revision);
    /* loading, the places wait in the scratch of the walks until the front is there */
    size_t places = (size_t)(own->fine_limit - own->fine_begin);
    transfer(at, at->load ? refine->queue : sim->model->mesh_vertex + own->fine_begin, places * sizeof(int32_t));
}

static bool is_list(const int32_t *list, int32_t count, size_t limit)
{
    if (count < 0 || (size_t)count > limit)
        return false;
    for (int32_t i = 0; i < count; i++)
        if (list[i] < 0 || (size_t)list[i] >= limit)
            return false;
    return true;
}

/* checks the ranges of the numbers read by transfer_refinement */
static bool is_whole(const pel_sim *sim, int32_t body)
{
    const pel_lod_forest *forest = sim->active->bodies[body].front->forest;
    const pel_refine_body *refine = &sim->refine[body];
    size_t fine = (size_t)forest->levels[forest->depth]->vertex_count;
    return is_list(refine->candidates, refine->candidate_count, fine) && refine->waiting_count >= 0 &&
           refine->waiting_count <= refine->candidate_count && is_list(refine->leaving, refine->leaving_count, fine) &&
           is_list(refine->hot, refine->hot_count, fine) && is_list(refine->hot_place, (int32_t)fine, fine);
}

static bool is_flag(const bool *flag)
{
    unsigned char byte;
    memcpy(&byte, flag, sizeof byte);
    return byte <= 1;
}

/* checks the ranges of the numbers read by transfer_tool */
static bool is_whole_tool(const pel_sim *sim, const pel_tool *tool)
{
    const pel_model *model = sim->model;
    if (!is_flag(&tool->driven) || !is_flag(&tool->blocked) || !is_flag(&tool->is_held_back) ||
        (unsigned)tool->phase > PEL_GRASP_DONE || tool->plane_count < 0 || tool->plane_count > PEL_PLANE_LIMIT)
        return false;
    for (int32_t p = 0; p < tool->plane_count; p++)
        if (tool->planes[p].triangle < 0 || tool->planes[p].triangle >= model->triangle_begin[model->body_count])
            return false;
    return tool->grasp ? is_list(tool->held, tool->held_count, (size_t)model->vertex_count) : tool->held_count == 0;
}

/* false, and nothing touched or held, when a tool is not whole */
static bool restore_tools(pel_sim *sim)
{
    bool whole = true;
    for (int32_t t = 0; t < sim->tool_count; t++)
        whole = whole && is_whole_tool(sim, &sim->tools[t]);
    for (int32_t t = 0; !whole && t < sim->tool_count; t++) {
        pel_tool *tool = &sim->tools[t];
        tool->held_count = tool->plane_count = 0;
        tool->driven = tool->blocked = tool->is_held_back = false;
        tool->phase = PEL_GRASP_DONE;
    }
    return whole;
}

static bool restore_parts(pel_sim *sim)
{
    pel_parts_now *now = &sim->parts.now;
    bool is_size = now->size > 0 && now->size <= PEL_PART_LIMIT && (now->size & (now->size - 1)) == 0;
    if (is_size && now->calm >= 0 && now->patience >= PEL_LEAST_PATIENCE && now->patience <= PEL_MOST_PATIENCE) {
        now->size = sim->parts.can_halve ? now->size : PEL_PART_LIMIT;
        return true;
    }
    *now = (pel_parts_now){.size = PEL_PART_LIMIT, .patience = PEL_LEAST_PATIENCE};
    return false;
}

/* rebuilds front, places and loads after transfer_refinement */
static bool restore_refinement(pel_sim *sim, int32_t body)
{
    pel_refined_body *own = &sim->active->bodies[body];
    pel_refine_body *refine = &sim->refine[body];
    if (!is_whole(sim, body))
        return false;
    for (int32_t node = 0; node < own->front->red_limit; node++)
        pel_front_mark(own->front, node, refine->mark_counts[node] > 0);
    if (pel_front_close(own->front) > own->triangle_limit)
        return false;
    pel_refined_commit(sim->active, body, sim->state);
    refine->output_revision = -1;
    if (!pel_refined_set_places(sim->active, body, refine->queue))
        return false;
    pel_refined_rebuild(sim->active, body, sim->state);
    pel_loads_rebuild(sim, body);
    pel_tool_search_rebuild(sim->tool_search, body);
    pel_shells_follow(sim, body);
    pel_refine_criterion_forget(sim, body);
    return true;
}

/* ---- parts of the state, of a body or tool where they are of one; each may be carried over by itself ---- */

typedef void transfer_part(cursor *at, const pel_sim *sim, int32_t index);

static size_t vertex_count_of(const pel_sim *sim)
{
    return (size_t)sim->model->vertex_count;
}

static void transfer_motion(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_state *state = sim->state;
    size_t count = vertex_count_of(sim);
    transfer(at, state->position, count * sizeof *state->position);
    transfer(at, state->position_before, count * sizeof *state->position_before);
    if (state->velocity != NULL)
        transfer(at, state->velocity, count * sizeof *state->velocity);
}

static void transfer_history(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_state *state = sim->state;
    size_t count = vertex_count_of(sim);
    if (state->older_position != NULL) {
        transfer(at, state->older_position, count * sizeof *state->older_position);
        transfer(at, state->older_velocity, count * sizeof *state->older_velocity);
        transfer(at, &state->older_is_known, sizeof state->older_is_known);
        transfer(at, &state->collision, sizeof state->collision);
        transfer(at, &state->unresolved, sizeof state->unresolved);
    }
}

/* the cursor writes to the sim only while it loads, also where it is const */
static void transfer_substeps(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->stepper->is_compliant)
        transfer(at, (pel_substeps_now *)(uintptr_t)&sim->substeps.now, sizeof sim->substeps.now);
}

static void transfer_parts(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->parts.divides)
        transfer(at, (pel_parts_now *)(uintptr_t)&sim->parts.now, sizeof sim->parts.now);
}

static void transfer_marks(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    transfer(at, sim->state->contact, vertex_count_of(sim) * sizeof *sim->state->contact);
}

static void transfer_factors(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    transfer(at, sim->state->factors, (size_t)sim->model->body_count * sizeof *sim->state->factors);
}

static void transfer_bending(cursor *at, const pel_sim *sim, int32_t body)
{
    transfer(at, &sim->state->bending[body], sizeof *sim->state->bending);
}

static void transfer_load(cursor *at, const pel_sim *sim, int32_t load)
{
    transfer(at, sim->loads[load].force, sizeof sim->loads[load].force);
}

static void transfer_tool(cursor *at, const pel_sim *sim, int32_t index)
{
    pel_tool *tool = &sim->tools[index];
    size_t vertex_count = vertex_count_of(sim);
    transfer(at, &tool->pose, sizeof tool->pose);
    transfer(at, &tool->driven_pose, sizeof tool->driven_pose);
    transfer(at, &tool->driven, sizeof tool->driven);
    transfer(at, &tool->blocked, sizeof tool->blocked);
    transfer(at, &tool->is_held_back, sizeof tool->is_held_back);
    transfer(at, &tool->tally, sizeof tool->tally);
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

static void transfer_supports(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->reactions != NULL)
        transfer(at, sim->reactions, vertex_count_of(sim) * sizeof *sim->reactions);
    for (int32_t h = 0; h < pel_sim_support_count(sim); h++) {
        transfer(at, &sim->holds->holds[h].reading, sizeof sim->holds->holds[h].reading);
        transfer(at, sim->holds->holds[h].booked_force, sizeof sim->holds->holds[h].booked_force);
        transfer(at, sim->holds->holds[h].booked_way, sizeof sim->holds->holds[h].booked_way);
    }
    if (sim->holds != NULL)
        transfer(at, &sim->holds->booked_energy, sizeof sim->holds->booked_energy);
}

static void transfer_vertex_forces(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_contact_forces *forces = (pel_contact_forces *)(uintptr_t)&sim->contact_forces;
    int32_t vertex_count = (int32_t)vertex_count_of(sim);
    for (int32_t begin = 0; forces->is_kept && begin < vertex_count; begin += PEL_FORCE_PAGE) {
        pel_record page[PEL_FORCE_PAGE];
        int32_t count = vertex_count - begin < PEL_FORCE_PAGE ? vertex_count - begin : PEL_FORCE_PAGE;
        pel_contact_forces_read(forces, begin, count, page);
        transfer(at, page, (size_t)count * sizeof *page);
        if (at->load)
            pel_contact_forces_write(forces, begin, count, page);
    }
}

/* rows of bodies, columns of bodies and tools */
static void transfer_pairs(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    const pel_contact_forces *forces = &sim->contact_forces;
    size_t count = (size_t)sim->model->body_count * (size_t)forces->group_count;
    if (forces->is_kept)
        transfer(at, forces->pair, count * sizeof *forces->pair);
    if (sim->collisions != NULL)
        transfer(at, sim->collisions, count * sizeof *sim->collisions);
}

static void transfer_held(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->held != NULL)
        transfer(at, sim->held, vertex_count_of(sim) * sizeof *sim->held);
}

static void transfer_external(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->external != NULL)
        transfer(at, sim->external, vertex_count_of(sim) * sizeof *sim->external);
}

static void transfer_statistics(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->contacts == NULL)
        return;
    transfer(at, &sim->contacts->statistics, sizeof sim->contacts->statistics);
    transfer(at, &sim->contacts->substep, sizeof sim->contacts->substep);
}

/* the statistics continue if the collider does */
static void transfer_collider(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_contact_set *contacts = sim->contacts;
    if (contacts == NULL)
        return;
    pel_memory_part parts[PEL_COLLIDER_PARTS];
    pel_collider_memory(contacts->collider, parts);
    transfer(at, sim->contact.revisions, (size_t)sim->model->body_count * sizeof *sim->contact.revisions);
    for (int i = 0; i < PEL_COLLIDER_PARTS; i++)
        transfer(at, parts[i].data, parts[i].size);
}

static void transfer_descent(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->descent == NULL)
        return;
    transfer(at, &sim->descent->acted, sizeof sim->descent->acted);
    transfer(at, &sim->descent->tool_way, sizeof sim->descent->tool_way);
    transfer(at, &sim->descent->accepted, sizeof sim->descent->accepted);
}

static void transfer_modes(cursor *at, const pel_sim *sim)
{
    if (sim->modes == NULL)
        return;
    transfer(at, sim->modes->values, (size_t)sim->solver.mode_count * sizeof *sim->modes->values);
    transfer(at, &sim->modes->count, sizeof sim->modes->count);
}

static void transfer_path(cursor *at, const pel_sim *sim)
{
    if (sim->path == NULL)
        return;
    pel_state *state = sim->state;
    pel_newton_path *path = &sim->path->path;
    transfer(at, &path->length, sizeof path->length);
    transfer(at, &path->first_change, sizeof path->first_change);
    transfer(at, &path->stiffness, sizeof path->stiffness);
    transfer(at, &sim->path->ended, sizeof sim->path->ended);
    transfer(at, &state->load_factor, sizeof state->load_factor);
    transfer(at, &state->load_factor_before, sizeof state->load_factor_before);
}

static void transfer_ledger(cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    /* the cursor writes to the sim only while it loads */
    pel_ledger *ledger = (pel_ledger *)(uintptr_t)&sim->ledger;
    transfer(at, &ledger->sums, sizeof ledger->sums);
    transfer(at, &ledger->gravity_level, sizeof ledger->gravity_level);
    transfer(at, &ledger->is_started, sizeof ledger->is_started);
}

static void transfer_sim(cursor *at, const pel_sim *sim)
{
    transfer_motion(at, sim, 0);
    transfer_history(at, sim, 0);
    transfer_substeps(at, sim, 0);
    transfer_parts(at, sim, 0);
    transfer_marks(at, sim, 0);
    transfer_factors(at, sim, 0);
    for (int32_t b = 0; b < sim->model->body_count; b++)
        transfer_bending(at, sim, b);
    for (int32_t l = 0; l < sim->load_count; l++)
        transfer_load(at, sim, l);
    for (int32_t t = 0; t < sim->tool_count; t++)
        transfer_tool(at, sim, t);
    transfer_supports(at, sim, 0);
    transfer_vertex_forces(at, sim, 0);
    transfer_pairs(at, sim, 0);
    transfer_held(at, sim, 0);
    transfer_external(at, sim, 0);
    transfer_statistics(at, sim, 0);
    transfer_collider(at, sim, 0);
    transfer_descent(at, sim, 0);
    transfer_path(at, sim);
    transfer_modes(at, sim);
    transfer_ledger(at, sim, 0);
}

static void transfer_fronts(cursor *at, const pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (sim->model->bodies[b].front != NULL)
            transfer_refinement(at, sim, b);
}

size_t pel_sim_save_size(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    cursor place = {.at = sizeof(header)};
    transfer_fronts(&place, sim);
    transfer_sim(&place, sim);
    return place.at;
}

static uint64_t checksum_of(const void *bytes, size_t size)
{
    header head;
    memcpy(&head, bytes, sizeof head);
    head.checksum = 0;
    uint64_t hash = pel_hash_block(PEL_HASH_START, &head, sizeof head);
    return pel_hash_block(hash, (const unsigned char *)bytes + sizeof head, size - sizeof head);
}

void pel_snapshot_seal(void *bytes, size_t size)
{
    uint64_t checksum = checksum_of(bytes, size);
    memcpy((unsigned char *)bytes + offsetof(header, checksum), &checksum, sizeof checksum);
}

/* returns its size */
static size_t save(const pel_sim *sim, void *bytes)
{
    header head = {
        .magic = "PELSNAP",
        .version = SNAPSHOT_VERSION,
        .real_size = sizeof(pel_real),
        .size = pel_sim_save_size(sim),
        .fingerprint = sim->fingerprint,
        .step = sim->state->step,
        .has_forces = sim->external != NULL,
    };
    memcpy(bytes, &head, sizeof head);
    cursor place = {.bytes = bytes, .at = sizeof head};
    transfer_fronts(&place, sim);
    transfer_sim(&place, sim);
    return place.at;
}

void pel_snapshot_keep(const pel_sim *sim, void *bytes)
{
    (void)save(sim, bytes);
}

void pel_sim_save(const pel_sim *sim, void *bytes)
{
    if (sim != NULL && bytes != NULL)
        pel_snapshot_seal(bytes, save(sim, bytes));
}

static const char damage_remedy[] = "load another one before the next step";

static pel_status check_snapshot(pel_sim *sim, const void *bytes, size_t size, header *head, pel_error *error)
{
    char parts[sizeof error->what];
    if (size < sizeof head->magic || memcmp(bytes, "PELSNAP", sizeof head->magic) != 0)
        return pel_refuse(error, PEL_BAD_FORMAT, "give what save has filled", "not a snapshot");
    memset(head, 0, sizeof *head);
    memcpy(head, bytes, size < sizeof *head ? size : sizeof *head);
    if (head->version != SNAPSHOT_VERSION)
        return pel_refuse(error, PEL_BAD_FORMAT, "load it with the version of the program that saved it",
                          "the snapshot has version %u of the format, not %d", head->version, (int)SNAPSHOT_VERSION);
    if (size < sizeof *head || size < head->size)
        return pel_refuse(error, PEL_BAD_FORMAT, "give all of its bytes", "the snapshot is cut short");
    if (head->real_size != sizeof(pel_real))
        return pel_refuse(error, PEL_BAD_FORMAT, "load it with a program of that precision",
                          "the snapshot is of %s precision", head->real_size == sizeof(float) ? "single" : "double");
    if (head->size != size || head->checksum != checksum_of(bytes, size))
        return pel_refuse(error, PEL_BAD_FORMAT, "use another one", "the snapshot is damaged");
    pel_fingerprint_compare(&head->fingerprint, &sim->fingerprint, parts, sizeof parts);
    if (parts[0] != '\0')
        return pel_refuse(error, PEL_BAD_FORMAT, "load it into a sim that was made from the same defs",
                          "the snapshot was made with other: %s", parts);
    pel_status status = pel_sim_make_forces(sim, head->has_forces != 0, error);
    if (status == PEL_OK && size != pel_sim_save_size(sim))
        return pel_refuse(error, PEL_BAD_FORMAT, "use another one", "the snapshot is damaged");
    return status;
}

/* places that are not in use are the same in all arrays that change places from step to step (clear_place) */
static void rest_unused_places(pel_sim *sim)
{
    pel_state *state = sim->state;
    size_t size = (size_t)sim->model->vertex_count * sizeof *state->position;
    memcpy(state->position_next, state->position, size);
    if (state->velocity != NULL)
        memcpy(state->velocity_next, state->velocity, size);
}

/* a snapshot whose header fits the simulation */
static pel_status restore(pel_sim *sim, const void *bytes, pel_error *error)
{
    header head;
    memcpy(&head, bytes, sizeof head);
    /* the bytes are only read: the cursor copies out of them */
    cursor place = {.bytes = (unsigned char *)(uintptr_t)bytes, .at = sizeof head, .load = true};
    sim->force_is_present = false;
    sim->state_number++;
    if (sim->descent != NULL)
        sim->descent->stray_body = -1;
    if (sim->descent != NULL && sim->descent->newton != NULL)
        sim->descent->newton->has_stepped = false;
    transfer_fronts(&place, sim);
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (sim->model->bodies[b].front != NULL && !restore_refinement(sim, b))
            return pel_refuse(error, PEL_BAD_FORMAT, damage_remedy,
                              "the snapshot is damaged: its surface does not match its positions");
    sim->contact_forces.is_short = false;
    transfer_sim(&place, sim);
    sim->held_is_listed = false;
    pel_contact_records_forget(&sim->contact_forces);
    sim->state->step = head.step;
    for (int32_t l = 0; l < sim->load_count; l++)
        memcpy((double *)(uintptr_t)sim->def.loads[l].force, sim->loads[l].force, sizeof sim->loads[l].force);
    rest_unused_places(sim);
    pel_shell_forces_set_load_factor(sim->shells, sim->state->load_factor);
    if (sim->contacts != NULL) {
        sim->contacts->tangles.is_known = false;
        sim->contact.is_loaded = true;
    }
    /* first, so that readings of tools are complete even if other data are damaged */
    bool has_tools = restore_tools(sim);
    pel_ledger_follow(sim);
    if (!has_tools)
        return pel_refuse(error, PEL_BAD_FORMAT, damage_remedy,
                          "the snapshot is damaged: a tool holds or touches a vertex that does not exist");
    if (!restore_parts(sim))
        return pel_refuse(error, PEL_BAD_FORMAT, damage_remedy,
                          "the snapshot is damaged: its parts of a step are out of range");
    if (sim->stepper->is_compliant && !pel_substeps_restore(sim))
        return pel_refuse(error, PEL_BAD_FORMAT, damage_remedy,
                          "the snapshot is damaged: its number of substeps is out of range");
    return sim->contact_forces.is_short ? pel_fail_memory(error) : PEL_OK;
}

pel_status pel_sim_load(pel_sim *sim, const void *bytes, size_t size, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(bytes, error);
    header head;
    pel_status status = check_snapshot(sim, bytes, size, &head, error);
    return status == PEL_OK ? restore(sim, bytes, error) : status;
}

pel_status pel_snapshot_rewind(pel_sim *sim, const void *bytes, pel_error *error)
{
    header head;
    memcpy(&head, bytes, sizeof head);
    pel_status status = pel_sim_make_forces(sim, head.has_forces != 0, error);
    return status == PEL_OK ? restore(sim, bytes, error) : status;
}

/* ---- from one simulation to another ---- */

/* room for one part at a time */
typedef struct carrier {
    const pel_sim *from;
    pel_sim *to;
    unsigned char *bytes;
    size_t capacity;
    bool is_full; /* memory is out */
} carrier;

/* nothing where the two have another layout */
static void carry(carrier *c, transfer_part *part, int32_t from, int32_t to)
{
    cursor old_size = {.at = 0}, new_size = {.at = 0};
    part(&old_size, c->from, from);
    part(&new_size, c->to, to);
    if (old_size.at != new_size.at || old_size.at == 0)
        return;
    if (old_size.at > c->capacity) {
        pel_free(c->bytes);
        c->bytes = pel_allocate(old_size.at, 1);
        c->capacity = c->bytes != NULL ? old_size.at : 0;
        c->is_full |= c->bytes == NULL;
    }
    if (c->bytes == NULL)
        return;
    cursor save = {.bytes = c->bytes}, load = {.bytes = c->bytes, .load = true};
    part(&save, c->from, from);
    part(&load, c->to, to);
}

static void transfer_front(cursor *at, const pel_sim *sim, int32_t body)
{
    transfer_refinement(at, sim, body);
}

/* The places of fine vertices are laid out once: as many as the budget needs, or, from some budget on, as all levels
   have. From there on a budget can change as long as the surface fits it. */
static pel_status refuse_room(const pel_refined_body *now, pel_error *error)
{
    const pel_lod_forest *forest = now->front->forest;
    const int32_t base = forest->levels[0]->vertex_count, all = forest->levels[forest->depth]->vertex_count - base;
    const int32_t least = forest->levels[0]->triangle_count + all / 2;
    const bool is_less = now->fine_limit - now->fine_begin < all;
    pel_fail(error, PEL_BAD_ARGUMENT,
             "refine: the simulation has room for %d finer vertices, which cannot change while it runs; the new budget "
             "needs %s",
             (int)(now->fine_limit - now->fine_begin), is_less ? "another number" : "fewer");
    if (is_less)
        pel_fail_remedy(error, "start with the new budget, or with 0 (no limit), from which it can change down to %d",
                        (int)least);
    else
        pel_fail_remedy(error, "give at least %d, or 0 for no limit; start with a lower budget", (int)least);
    return PEL_BAD_ARGUMENT;
}

static pel_status check_room(const pel_sim *from, const pel_sim *to, int32_t body, pel_error *error)
{
    const pel_refined_body *old = &from->active->bodies[body], *new = &to->active->bodies[body];
    const int32_t needed = pel_sim_triangle_count(from, body);
    pel_status status = PEL_OK;
    if (old->fine_limit - old->fine_begin != new->fine_limit - new->fine_begin)
        status = refuse_room(old, error);
    else if (needed > new->triangle_limit) {
        status = pel_fail(error, PEL_BAD_ARGUMENT, "refine: the budget is %d triangles, the surface has %d now",
                          (int)new->triangle_limit, (int)needed);
        pel_fail_remedy(error, "give at least %d, or wait until the surface is coarse again", (int)needed);
    }
    if (status != PEL_OK)
        pel_fail_element(error, "body", body);
    return status;
}

static pel_status carry_surfaces(carrier *c, pel_error *error)
{
    for (int32_t b = 0; b < c->to->model->body_count; b++) {
        if (c->to->model->bodies[b].front == NULL)
            continue;
        pel_status status = check_room(c->from, c->to, b, error);
        if (status != PEL_OK)
            return status;
        carry(c, transfer_front, b, b);
        if (c->is_full)
            return pel_fail_memory(error);
        if (!restore_refinement(c->to, b))
            return pel_fail(error, PEL_BAD_ARGUMENT, "the refined surface does not fit the change");
    }
    return PEL_OK;
}

/* inverse masses come from the new model; pinned vertices keep their positions */
static void take_mobility(const pel_sim *from, pel_sim *sim)
{
    pel_state *state = sim->state;
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        pel_real mobility = sim->model->inverse_mass[v];
        state->position[v][3] = state->position_before[v][3] = mobility;
        if (mobility != from->model->inverse_mass[v])
            state->older_is_known = false;
        if (mobility > 0 || !(from->model->inverse_mass[v] > 0))
            continue;
        state->position_before[v] = state->position[v];
        if (state->velocity != NULL)
            state->velocity[v] = (pel_record){0};
    }
}

/* vertices that are no longer pinned have no reaction */
static void release_pins(const pel_sim *from, const pel_sim *sim)
{
    for (int32_t v = 0; sim->reactions != NULL && v < sim->model->vertex_count; v++)
        if (sim->model->inverse_mass[v] > 0 && !(from->model->inverse_mass[v] > 0))
            memset(sim->reactions[v], 0, sizeof *sim->reactions);
}

/* A tool that waits for its first step is at its keys, which may have changed. Held vertices stay held. */
static void carry_tool(carrier *c, int32_t from, int32_t to)
{
    pel_tool *tool = &c->to->tools[to];
    pel_pose start = tool->pose;
    carry(c, transfer_tool, from, to);
    if (c->from->state->step == 0)
        tool->pose = start;
    for (int32_t i = 0; i < tool->held_count; i++) {
        int32_t v = tool->held[i];
        c->to->held[v] = 1;
        c->to->state->position[v][3] = 0;
    }
}

pel_status pel_snapshot_carry(const pel_sim *from, pel_sim *to, pel_error *error)
{
    carrier c = {.from = from, .to = to};
    bool has_run = from->state->step > 0;
    pel_status status = carry_surfaces(&c, error);
    if (status == PEL_OK) {
        carry(&c, transfer_motion, 0, 0);
        /* its presence depends on tools and contact */
        carry(&c, transfer_history, 0, 0);
        take_mobility(from, to);
        for (int32_t t = 0; t < to->tool_count; t++) {
            int32_t old = pel_sim_find_tool(from, to->tools[t].name);
            if (old >= 0)
                carry_tool(&c, old, t);
        }
        static transfer_part *const parts[] = {transfer_parts,         transfer_marks,   transfer_supports,
                                               transfer_vertex_forces, transfer_pairs,   transfer_external,
                                               transfer_statistics,    transfer_descent, transfer_ledger};
        for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
            carry(&c, parts[i], 0, 0);
        release_pins(from, to);
        pel_substeps_carry(from, to);
        for (int32_t b = 0; b < to->model->body_count; b++) {
            const pel_shell *old = from->model->bodies[b].shell, *new = to->model->bodies[b].shell;
            if (old != NULL && new != NULL && old->bending_weight == new->bending_weight)
                carry(&c, transfer_bending, b, b);
        }
        to->state->older_is_known &= from->solver.substeps == to->solver.substeps;
        to->state->step = from->state->step;
        if (to->contacts != NULL && has_run) {
            to->contacts->tangles.is_known = false;
            to->contact.revisions[0] = -1;
        }
        rest_unused_places(to);
    }
    if (status == PEL_OK && (c.is_full || to->contact_forces.is_short))
        status = pel_fail_memory(error);
    pel_free(c.bytes);
    return status;
}
