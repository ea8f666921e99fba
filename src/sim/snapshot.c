/* Snapshots: a header, the state's arrays, then each tool's place, held vertices and last reading. The size is fixed
   for one sim, so that it can be written without allocation. */
#include "base/hash.h"
#include "base/status.h"
#include "model/shell.h"
#include "sim/contact.h"
#include "sim/descent.h"

#include <string.h>

enum { SNAPSHOT_VERSION = 5 };

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

static uint64_t hash_records(uint64_t hash, const pel_sim *sim, int32_t body, const pel_record *records)
{
    int32_t count = pel_row_count(sim, body);
    for (int32_t r = 0; r < count; r++) {
        int32_t place = pel_row_place(sim, body, r);
        for (int c = 0; c < 3; c++)
            hash = hash_double(hash, (double)records[place][c]);
    }
    return hash;
}

uint64_t pel_sim_hash(const pel_sim *sim)
{
    uint64_t hash = pel_hash_word(PEL_HASH_START, (uint64_t)sim->state->step);
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_state *state = sim->state;
        hash = hash_records(hash, sim, b, state->position);
        hash = hash_records(hash, sim, b, state->velocity != NULL ? state->velocity : state->position_before);
    }
    return hash;
}

static uint64_t hash_shell(uint64_t hash, const pel_shell *shell)
{
    const pel_membrane_material *material = &shell->material;
    const pel_pressure_def *pressure = &shell->pressure;
    const double numbers[] = {shell->has_membrane,       (double)material->kind, material->young,
                              material->poisson,         material->thickness,    material->mooney_ratio,
                              material->extension_limit, material->stiffening,   (double)shell->bending,
                              shell->bending_weight,     (double)pressure->kind, (double)pressure->form,
                              pressure->value,           pressure->gamma,        pressure->outside.value,
                              pressure->target.value,    pressure->bulk,         (double)shell->hinge_count,
                              shell->strain_limit};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        hash = hash_double(hash, numbers[i]);
    for (int32_t h = 0; h < shell->hinge_count; h++)
        hash = hash_double(hash_double(hash, shell->hinges[h].stiffness), shell->hinges[h].rest_angle);
    for (int32_t r = 0; r < shell->region_count; r++) {
        const pel_shell_region *region = &shell->regions[r];
        hash = pel_hash_word(hash, (uint64_t)region->def.mode * 64 + (uint64_t)region->def.kind);
        hash = hash_double(hash_double(hash, region->def.stiffness), region->def.strength);
        hash = pel_hash_word(hash, (uint64_t)region->fibre_count);
    }
    return hash;
}

uint64_t pel_sim_fingerprint(const pel_sim *sim)
{
    const pel_model *model = sim->given;
    uint64_t hash = pel_hash_word(PEL_HASH_START, (uint64_t)model->vertex_count);
    hash = pel_hash_bytes(hash, model->mesh_vertex, (size_t)model->vertex_count * sizeof *model->mesh_vertex);
    hash = pel_hash_bytes(hash, model->rest, (size_t)model->vertex_count * sizeof *model->rest);
    hash = pel_hash_bytes(hash, model->triangles, (size_t)model->triangle_count * sizeof *model->triangles);
    hash = hash_double(hash_double(hash, sim->step.dt), sim->step.alpha);
    hash = pel_hash_word(hash, (uint64_t)sim->solver.method * 4 + (uint64_t)sim->solver.keep_velocity * 2 +
                                   (uint64_t)sim->solver.symplectic);
    if (pel_sim_is_projected(sim)) {
        hash = pel_hash_word(hash, (uint64_t)sim->solver.iterations * 2 + (sim->solver.second_order == PEL_YES));
        hash = hash_double(pel_hash_word(hash, (uint64_t)sim->solver.substeps), sim->solver.drag);
        hash = pel_hash_word(hash, (uint64_t)sim->solver.max_substeps * 2 + (uint64_t)sim->substeps.is_automatic);
    }
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_body_detail *detail = model->bodies[b].detail;
        if (model->bodies[b].shell != NULL)
            hash = hash_shell(hash, model->bodies[b].shell);
        if (detail == NULL)
            continue;
        const pel_refine_def *def = &detail->def;
        const double measures[] = {def->above, def->below, def->curvature_above, def->curvature_below, def->near_tools};
        for (size_t i = 0; i < sizeof measures / sizeof *measures; i++)
            hash = hash_double(hash, measures[i]);
        const int32_t numbers[] = {def->levels,        def->rings,        def->dwell,
                                   def->interval,      def->budget,       (int32_t)def->springs,
                                   def->region_levels, def->region_count, def->everywhere};
        hash = pel_hash_bytes(hash, numbers, sizeof numbers);
        hash = pel_hash_bytes(hash, def->region, (size_t)def->region_count * sizeof *def->region);
    }
    if (sim->contacts != NULL) {
        const pel_contact_def *def = &sim->contacts->def;
        hash = hash_double(hash, sim->contacts->thickness);
        for (int32_t i = 0; i < sim->model->body_count + sim->tool_count; i++)
            hash = hash_double(hash_double(hash, sim->contacts->friction_of_group[i]),
                               sim->contacts->thickness_of_group[i]);
        for (int32_t i = 0; i < sim->model->body_count; i++)
            hash = hash_double(hash, model->bodies[i].restitution);
        for (int32_t i = 0; i < sim->tool_count; i++)
            hash = hash_double(hash, sim->tools[i].restitution);
        hash = hash_double(hash, def->restitution);
        hash = pel_hash_word(hash, (uint64_t)def->method * 8 + (uint64_t)def->response * 4 + (uint64_t)def->self * 2 +
                                       (uint64_t)def->between);
        hash = pel_hash_word(hash, (uint64_t)def->sweeps << 32 | (uint64_t)(uint32_t)sim->contacts->limit);
    }
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

/* the criterion's memory, and which vertex has which place; the front follows from the marks */
static void transfer_refinement(cursor *at, const pel_sim *sim, int32_t body)
{
    const pel_active_body *own = &sim->active->bodies[body];
    pel_refine_body *refine = &sim->refine[body];
    const pel_front *front = own->front;
    size_t fine = (size_t)front->forest->levels[front->forest->depth]->vertex_count;
    size_t coarse = (size_t)front->forest->levels[0]->vertex_count;
    transfer(at, refine->mark_counts, (size_t)front->red_limit * sizeof *refine->mark_counts);
    transfer(at, refine->heat, fine * sizeof *refine->heat);
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

/* what transfer_refinement read has its numbers in range */
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

/* what transfer_tool read has its numbers in range */
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
    if (is_size && now->calm >= 0 && now->patience >= PEL_LEAST_PATIENCE && now->patience <= PEL_MOST_PATIENCE)
        return true;
    *now = (pel_parts_now){.size = PEL_PART_LIMIT, .patience = PEL_LEAST_PATIENCE};
    return false;
}

/* the front, places and loads of what transfer_refinement read */
static bool restore_refinement(pel_sim *sim, int32_t body)
{
    pel_active_body *own = &sim->active->bodies[body];
    pel_refine_body *refine = &sim->refine[body];
    if (!is_whole(sim, body))
        return false;
    for (int32_t node = 0; node < own->front->red_limit; node++)
        pel_front_mark(own->front, node, refine->mark_counts[node] > 0);
    if (pel_front_close(own->front) > own->triangle_limit)
        return false;
    pel_active_commit(sim->active, body, sim->state);
    refine->row_revision = -1;
    if (!pel_active_set_places(sim->active, body, refine->queue))
        return false;
    pel_active_rebuild(sim->active, body, sim->state);
    pel_loads_rebuild(sim, body);
    pel_tool_search_rebuild(sim->tool_search, body);
    pel_shells_follow(sim, body);
    pel_criterion_forget(sim, body);
    return true;
}

static void transfer_sim(cursor *at, const pel_sim *sim)
{
    pel_state *state = sim->state;
    size_t count = (size_t)sim->model->vertex_count;
    transfer(at, state->position, count * sizeof *state->position);
    transfer(at, state->position_before, count * sizeof *state->position_before);
    if (state->velocity != NULL)
        transfer(at, state->velocity, count * sizeof *state->velocity);
    if (state->older_position != NULL) {
        transfer(at, state->older_position, count * sizeof *state->older_position);
        transfer(at, state->older_velocity, count * sizeof *state->older_velocity);
        transfer(at, &state->older_is_known, sizeof state->older_is_known);
    }
    if (sim->stepper->is_compliant)
        transfer(at, (pel_substeps_now *)(uintptr_t)&sim->substeps.now, sizeof sim->substeps.now);
    if (sim->contacts != NULL && pel_sim_is_projected(sim))
        transfer(at, (pel_parts_now *)(uintptr_t)&sim->parts.now, sizeof sim->parts.now);
    transfer(at, state->contact, count * sizeof *state->contact);
    transfer(at, state->factors, (size_t)sim->model->body_count * sizeof *state->factors);
    transfer(at, state->bending, (size_t)sim->model->body_count * sizeof *state->bending);
    for (int32_t l = 0; l < sim->load_count; l++)
        transfer(at, sim->loads[l].force, sizeof sim->loads[l].force);
    for (int32_t t = 0; t < sim->tool_count; t++)
        transfer_tool(at, &sim->tools[t], count);
    if (sim->supports != NULL)
        transfer(at, sim->supports, (size_t)sim->model->body_count * sizeof *sim->supports);
    const pel_contact_forces *forces = &sim->contact_forces;
    if (forces->vertex != NULL) {
        transfer(at, forces->vertex, count * sizeof *forces->vertex);
        transfer(at, forces->pair, (size_t)sim->model->body_count * (size_t)forces->group_count * sizeof *forces->pair);
    }
    if (sim->collisions != NULL)
        transfer(at, sim->collisions,
                 (size_t)sim->model->body_count * (size_t)forces->group_count * sizeof *sim->collisions);
    if (sim->held != NULL)
        transfer(at, sim->held, count * sizeof *sim->held);
    if (sim->contacts != NULL)
        transfer(at, &sim->contacts->statistics, sizeof sim->contacts->statistics);
    if (sim->descent != NULL)
        transfer(at, &sim->descent->acted, sizeof sim->descent->acted);
    /* the cursor writes to the sim only while it loads */
    pel_ledger *ledger = (pel_ledger *)(uintptr_t)&sim->ledger;
    transfer(at, &ledger->sums, sizeof ledger->sums);
    transfer(at, &ledger->gravity_level, sizeof ledger->gravity_level);
    transfer(at, &ledger->is_started, sizeof ledger->is_started);
}

static void transfer_fronts(cursor *at, const pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (sim->model->bodies[b].front != NULL)
            transfer_refinement(at, sim, b);
}

size_t pel_sim_save_size(const pel_sim *sim)
{
    cursor place = {.at = sizeof(header)};
    transfer_fronts(&place, sim);
    transfer_sim(&place, sim);
    return place.at;
}

void pel_sim_save(const pel_sim *sim, void *bytes)
{
    header head = {
        .magic = "PELSNAP",
        .version = SNAPSHOT_VERSION,
        .real_size = sizeof(pel_real),
        .fingerprint = sim->fingerprint,
        .step = sim->state->step,
    };
    memcpy(bytes, &head, sizeof head);
    cursor place = {.bytes = bytes, .at = sizeof head};
    transfer_fronts(&place, sim);
    transfer_sim(&place, sim);
}

static pel_status refuse(pel_error *error, const char *what, const char *remedy)
{
    pel_fail(error, PEL_BAD_FORMAT, "%s", what);
    pel_fail_remedy(error, "%s", remedy);
    return PEL_BAD_FORMAT;
}

static pel_status check_header(const pel_sim *sim, const header *head, size_t size, pel_error *error)
{
    if (memcmp(head->magic, "PELSNAP", sizeof head->magic) != 0)
        return refuse(error, "not a snapshot", "give what pel_sim_save has filled");
    if (head->version != SNAPSHOT_VERSION || head->real_size != sizeof(pel_real))
        return refuse(error, "snapshot of another version or precision of the program",
                      "load it with the program that saved it");
    if (head->fingerprint != sim->fingerprint || size != pel_sim_save_size(sim))
        return refuse(error, "snapshot of another model, solver or set of tools",
                      "load it into a sim that was made from the same defs");
    return PEL_OK;
}

pel_status pel_sim_load(pel_sim *sim, const void *bytes, size_t size, pel_error *error)
{
    static const char damage_remedy[] = "load another one before the next step";
    header head;
    if (size < sizeof head)
        return refuse(error, "snapshot is cut short", "give all pel_sim_save_size bytes of it");
    memcpy(&head, bytes, sizeof head);
    pel_status status = check_header(sim, &head, size, error);
    if (status != PEL_OK)
        return status;
    /* the bytes are only read: the cursor copies out of them */
    cursor place = {.bytes = (unsigned char *)(uintptr_t)bytes, .at = sizeof head, .load = true};
    sim->force_is_present = false;
    transfer_fronts(&place, sim);
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (sim->model->bodies[b].front != NULL && !restore_refinement(sim, b))
            return refuse(error, "snapshot is damaged: its surface does not fit its places", damage_remedy);
    transfer_sim(&place, sim);
    sim->state->step = head.step;
    if (sim->contacts != NULL)
        sim->contacts->tangles.is_known = false;
    /* first, so that readings of tools are whole whatever else is damaged */
    bool has_tools = restore_tools(sim);
    pel_ledger_follow(sim);
    if (!has_tools)
        return refuse(error, "snapshot is damaged: a tool holds or touches what is not there", damage_remedy);
    if (!restore_parts(sim))
        return refuse(error, "snapshot is damaged: its parts of a step are out of range", damage_remedy);
    if (sim->stepper->is_compliant && !pel_substeps_restore(sim))
        return refuse(error, "snapshot is damaged: its number of substeps is out of range", damage_remedy);
    return PEL_OK;
}
