/* Snapshots: a header with the fingerprint of the model and sim that it was made with and a checksum, then all that the
   steps to come depend on: first what has the same size in all snapshots of one sim, then lists whose length is that of
   the state. */
#include "sim/snapshot.h"

#include "adapt/criterion.h"
#include "adapt/refine.h"
#include "adapt/transfer.h"
#include "attach/joint.h"
#include "attach/tie.h"
#include "base/assert.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/forces.h"
#include "boundary/hold.h"
#include "boundary/loads.h"
#include "method/softness.h"
#include "minimise/rounds.h"
#include "minimise/step_modes.h"
#include "minimise/step_newton.h"
#include "minimise/step_path.h"
#include "model/shell.h"
#include "observe/ledger.h"
#include "sim/parts.h"
#include "sim/sim.h"
#include "sim/topology.h"
#include "stage/plastic.h"
#include "stage/shells.h"
#include "stage/surface_view.h"
#include "tool/reading.h"
#include "tool/solid.h"
#include "tool/support.h"
#include "tool/tools.h"
#include "touch/contact.h"
#include "touch/sleep.h"
#include "touch/thickness.h"
#include "touch/transfer.h"

#include <stdio.h>
#include <string.h>

enum { SNAPSHOT_VERSION = 27 };

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

/* in the order of the format */
static void transfer_sim(pel_cursor *at, const pel_sim *sim)
{
    static pel_transfer_part *const before[] = {pel_transfer_motion, pel_transfer_history, pel_substeps_transfer,
                                                pel_parts_transfer,  pel_transfer_marks,   pel_transfer_factors,
                                                pel_transfer_plastic};
    static pel_transfer_part *const after[] = {pel_contacts_transfer_limits,
                                               pel_supports_transfer,
                                               pel_touch_transfer_forces,
                                               pel_touch_transfer_pairs,
                                               pel_transfer_held,
                                               pel_forces_transfer,
                                               pel_touch_transfer_statistics,
                                               pel_touch_transfer_collider,
                                               pel_sleep_transfer,
                                               pel_minimise_transfer,
                                               pel_sim_path_transfer,
                                               pel_sim_modes_transfer,
                                               pel_ledger_transfer,
                                               pel_tear_transfer,
                                               pel_ties_transfer,
                                               pel_joints_transfer};
    for (size_t i = 0; i < sizeof before / sizeof *before; i++)
        before[i](at, sim, 0);
    for (int32_t b = 0; b < sim->model->body_count; b++)
        pel_transfer_bending(at, sim, b);
    for (int32_t l = 0; l < sim->loads->count; l++)
        pel_load_transfer(at, sim, l);
    for (int32_t t = 0; t < sim->tools->count; t++)
        pel_tool_transfer(at, sim, t);
    for (size_t i = 0; i < sizeof after / sizeof *after; i++)
        after[i](at, sim, 0);
}

static pel_transfer_part *const list_parts[] = {pel_touch_transfer_tangles, pel_touch_transfer_layers,
                                                pel_solids_transfer};

static void transfer_lists(pel_cursor *at, const pel_sim *sim)
{
    for (size_t i = 0; i < sizeof list_parts / sizeof *list_parts; i++)
        list_parts[i](at, sim, 0);
}

static void transfer_fronts(pel_cursor *at, const pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (sim->model->bodies[b].front != NULL)
            pel_refine_transfer(at, sim, b);
}

size_t pel_snapshot_lists_size(const pel_sim *sim)
{
    pel_cursor place = {.at = 0};
    transfer_lists(&place, sim);
    return place.at;
}

/* without lists: no snapshot is smaller */
static size_t least_size(const pel_sim *sim)
{
    pel_cursor place = {.at = sizeof(header)};
    pel_topology_transfer(&place, sim, 0);
    transfer_fronts(&place, sim);
    transfer_sim(&place, sim);
    return place.at;
}

size_t pel_sim_save_size(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    return least_size(sim) + pel_snapshot_lists_size(sim);
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
        .fingerprint = pel_house_of(sim)->fingerprint,
        .step = sim->state->step,
        .has_forces = sim->loads->external != NULL,
    };
    memcpy(bytes, &head, sizeof head);
    pel_cursor place = {.bytes = bytes, .at = sizeof head};
    pel_topology_transfer(&place, sim, 0);
    transfer_fronts(&place, sim);
    transfer_sim(&place, sim);
    transfer_lists(&place, sim);
    PEL_ASSERT(place.at == head.size);
    return place.at;
}

bool pel_snapshot_is_valid(const pel_sim *sim, const void *bytes)
{
    header head;
    memcpy(&head, bytes, sizeof head);
    return memcmp(head.magic, "PELSNAP", sizeof head.magic) == 0 && head.version == SNAPSHOT_VERSION &&
           head.real_size == sizeof(pel_real) && head.size == pel_sim_save_size(sim) && head.step >= 0 &&
           memcmp(&head.fingerprint, &pel_house_of(sim)->fingerprint, sizeof head.fingerprint) == 0 &&
           head.checksum == checksum_of(bytes, (size_t)head.size);
}

void pel_snapshot_keep(const pel_sim *sim, void *bytes)
{
    (void)save(sim, bytes);
}

void pel_sim_save(const pel_sim *sim, void *bytes)
{
    if (sim == NULL || bytes == NULL)
        return;
    pel_snapshot_seal(bytes, save(sim, bytes));
    PEL_ASSERT_WHOLE(pel_snapshot_is_valid(sim, bytes));
}

static const char damage_remedy[] = "load another one before the next step";

/* whether it is whole, and of this version */
static pel_status check_whole(const void *bytes, size_t size, header *head, pel_error *error)
{
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
    return PEL_OK;
}

pel_status pel_snapshot_refuse_other(const pel_sim *sim, const void *bytes, pel_status status, pel_error *error)
{
    header head;
    char parts[sizeof error->what];
    memcpy(&head, bytes, sizeof head);
    pel_fingerprint_compare(&head.fingerprint, &pel_house_of(sim)->fingerprint, parts, sizeof parts);
    if (parts[0] == '\0')
        return status;
    return pel_refuse(error, PEL_BAD_FORMAT, "load it into a sim that was made from the same defs",
                      "the snapshot was made with other: %s", parts);
}

/* whether it is of the same defs; the surface has to be that of the snapshot */
static pel_status check_defs(pel_sim *sim, const void *bytes, size_t size, const header *head, pel_error *error)
{
    pel_status status = pel_snapshot_refuse_other(sim, bytes, PEL_OK, error);
    if (status == PEL_OK)
        status = pel_sim_make_forces(sim, head->has_forces != 0, error);
    if (status == PEL_OK && size < least_size(sim))
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
    pel_cursor place = {
        .bytes = (unsigned char *)(uintptr_t)bytes, .at = sizeof head, .load = true, .size = (size_t)head.size};
    sim->present.has_force = false;
    sim->state_number++;
    pel_minimise_forget(sim);
    pel_topology_transfer(&place, sim, 0);
    transfer_fronts(&place, sim);
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (sim->model->bodies[b].front != NULL && !pel_refine_restore(sim, b))
            return pel_refuse(error, PEL_BAD_FORMAT, damage_remedy,
                              "the snapshot is damaged: its surface does not match its positions");
    sim->contact_forces.is_short = false;
    transfer_sim(&place, sim);
    transfer_lists(&place, sim);
    sim->tools->held_is_listed = false;
    pel_contact_records_forget(&sim->contact_forces);
    sim->state->step = head.step;
    for (int32_t l = 0; l < sim->loads->count; l++)
        memcpy((double *)(uintptr_t)sim->def.loads[l].force, sim->loads->items[l].force,
               sizeof sim->loads->items[l].force);
    rest_unused_places(sim);
    pel_plastic_begin(sim);
    pel_shell_forces_set_load_factor(sim->shells, sim->state->load_factor);
    sim->touch->is_loaded = sim->contacts != NULL;
    sim->touch->is_carried = false;
    /* first, so that readings of tools are complete even if other data are damaged */
    bool has_tools = pel_tools_restore(sim);
    bool has_pairs = pel_touch_restore(sim) && pel_sleep_restore(sim) && !place.is_short && place.at == place.size;
    pel_ledger_follow(sim);
    if (sim->contact_forces.is_short || place.is_full)
        return pel_fail_memory(error);
    if (!has_tools)
        return pel_refuse(error, PEL_BAD_FORMAT, damage_remedy,
                          "the snapshot is damaged: a tool holds or touches a vertex that does not exist");
    if (!has_pairs)
        return pel_refuse(error, PEL_BAD_FORMAT, damage_remedy,
                          "the snapshot is damaged: its pairs in contact are out of range");
    if (!pel_parts_restore(sim))
        return pel_refuse(error, PEL_BAD_FORMAT, damage_remedy,
                          "the snapshot is damaged: its parts of a step are out of range");
    if (sim->stepper->is_compliant && !pel_substeps_restore(sim))
        return pel_refuse(error, PEL_BAD_FORMAT, damage_remedy,
                          "the snapshot is damaged: its number of substeps is out of range");
    return PEL_OK;
}

pel_status pel_snapshot_load(pel_sim *sim, const void *bytes, size_t size, pel_error *error)
{
    header head;
    bool has_surfaces;
    pel_status status = pel_snapshot_check(sim, bytes, size, &has_surfaces, error);
    if (status != PEL_OK)
        return status;
    memcpy(&head, bytes, sizeof head);
    if (!has_surfaces)
        return pel_refuse(error, PEL_BAD_FORMAT, "use another one", "the snapshot is of another surface");
    status = check_defs(sim, bytes, size, &head, error);
    return status == PEL_OK ? restore(sim, bytes, error) : status;
}

pel_status pel_snapshot_check(const pel_sim *sim, const void *bytes, size_t size, bool *has_surfaces, pel_error *error)
{
    header head;
    pel_status status = check_whole(bytes, size, &head, error);
    pel_cursor place = {.bytes = (unsigned char *)(uintptr_t)bytes, .at = sizeof head, .load = true, .size = size};
    *has_surfaces = status == PEL_OK && pel_topology_is_present(&place, sim);
    return status;
}

pel_status pel_snapshot_read_surfaces(const pel_sim *sim, const void *bytes, size_t size, pel_surfaces *surfaces,
                                      pel_error *error)
{
    header head;
    pel_cursor place = {.bytes = (unsigned char *)(uintptr_t)bytes, .at = sizeof head, .load = true, .size = size};
    pel_status status = check_whole(bytes, size, &head, error);
    return status == PEL_OK ? pel_surfaces_read(surfaces, sim, &place, error) : status;
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
    /* after a cut; else null */
    int32_t *places;             /* (vertices of `to`) of each one in `from`, -1 = none */
    int32_t *place_of, *scratch; /* (vertices of `from`) where each one is in `to`; zeros */
} carrier;

/* nothing where the two have another layout */
static void carry(carrier *c, pel_transfer_part *part, int32_t from, int32_t to)
{
    pel_cursor old_size = {.at = 0}, new_size = {.at = 0};
    part(&old_size, c->from, from);
    part(&new_size, c->to, to);
    bool fits = c->places != NULL ? new_size.at > 0 : old_size.at == new_size.at;
    if (!fits || old_size.at == 0)
        return;
    if (old_size.at > c->capacity) {
        pel_free(c->bytes);
        c->bytes = pel_allocate(old_size.at, 1);
        c->capacity = c->bytes != NULL ? old_size.at : 0;
        c->is_full |= c->bytes == NULL;
    }
    if (c->bytes == NULL)
        return;
    pel_cursor save = {.bytes = c->bytes};
    pel_cursor load = {.bytes = c->bytes,
                       .load = true,
                       .size = old_size.at,
                       .places = c->places,
                       .place_count = (size_t)c->from->model->vertex_count};
    part(&save, c->from, from);
    part(&load, c->to, to);
}

static pel_status carry_surfaces(carrier *c, pel_error *error)
{
    for (int32_t b = 0; b < c->to->model->body_count; b++) {
        if (c->to->model->bodies[b].front == NULL)
            continue;
        pel_status status = pel_refine_check_room(c->from, c->to, b, error);
        if (status != PEL_OK)
            return status;
        carry(c, pel_refine_transfer, b, b);
        if (c->is_full)
            return pel_fail_memory(error);
        if (!pel_refine_restore(c->to, b))
            return pel_fail(error, PEL_BAD_ARGUMENT, "the refined surface does not fit the change");
    }
    return PEL_OK;
}

/* inverse masses come from the new model; pinned vertices keep their positions */
static void take_mobility(const carrier *c)
{
    pel_sim *sim = c->to;
    pel_state *state = sim->state;
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        int32_t place = c->places != NULL ? c->places[v] : v;
        pel_real mobility = sim->model->inverse_mass[v], old = place >= 0 ? c->from->model->inverse_mass[place] : 0;
        state->position[v][3] = state->position_before[v][3] = mobility;
        /* a cut divides masses, and each copy goes on as its vertex did */
        if (mobility != old && c->places == NULL)
            state->older_is_known = false;
        if (mobility > 0 || !(old > 0))
            continue;
        state->position_before[v] = state->position[v];
        if (state->velocity != NULL)
            state->velocity[v] = (pel_record){0};
    }
}

/* held vertices at their new places, then their copies */
static void hold_copies(carrier *c, pel_tool *tool)
{
    int32_t count = tool->held_count, *own = c->place_of;
    int32_t *holder = c->scratch; /* by old place: number among the held ones plus 1 */
    for (int32_t i = 0; i < count; i++)
        holder[tool->held[i]] = i + 1;
    for (int32_t v = 0; v < c->to->model->vertex_count; v++) {
        int32_t place = c->places[v], i = place >= 0 ? holder[place] : 0;
        if (i == 0 || own[place] == v)
            continue;
        tool->held[tool->held_count] = v;
        pel_vec3_copy(tool->anchors[i - 1], tool->anchors[tool->held_count++]);
    }
    for (int32_t i = 0; i < count; i++) {
        holder[tool->held[i]] = 0;
        tool->held[i] = own[tool->held[i]];
    }
}

/* A tool that waits for its first step is at its keys, which may have changed. Held vertices stay held. */
static void carry_tool(carrier *c, int32_t from, int32_t to)
{
    pel_tool *tool = &c->to->tools->items[to];
    pel_pose start = tool->pose;
    carry(c, pel_tool_transfer, from, to);
    if (c->from->state->step == 0)
        tool->pose = start;
    if (c->places != NULL && tool->held_count > 0)
        hold_copies(c, tool);
    for (int32_t i = 0; i < tool->held_count; i++) {
        int32_t v = tool->held[i];
        c->to->held[v] = 1;
        c->to->state->position[v][3] = 0;
    }
}

/* features have the same numbers in both, and those of the old one are of its present surface */
static bool has_same_features(const pel_sim *from, const pel_sim *to)
{
    const pel_contact_set *a = from->contacts, *b = to->contacts;
    bool is_same = a != NULL && b != NULL && a->point_count == b->point_count &&
                   a->obstacle_triangle_count == b->obstacle_triangle_count && a->def.has_layers && b->def.has_layers &&
                   from->tools->count == to->tools->count && pel_contacts_are_of_present(from);
    for (int32_t t = 0; is_same && t < to->tools->count; t++)
        is_same = strcmp(from->tools->items[t].name, to->tools->items[t].name) == 0;
    return is_same;
}

/* pairs keep their loads */
static pel_status carry_lists(const pel_sim *from, pel_sim *to, pel_error *error)
{
    if (has_same_features(from, to)) {
        if (!pel_contact_set_take_over(to->contacts, from->contacts))
            return pel_fail_memory(error);
        memcpy(to->touch->revisions, from->touch->revisions,
               (size_t)to->model->body_count * sizeof *to->touch->revisions);
        to->touch->is_carried = true;
    }
    return pel_solids_take_over(to, from, error);
}

/* the places of vertices before and after a cut */
static pel_status find_places(carrier *c, const pel_surfaces *surfaces, pel_error *error)
{
    const pel_model *old = c->from->model, *new = c->to->model;
    if (surfaces == NULL)
        return PEL_OK;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(c->places, new->vertex_count), PEL_ROOM(c->place_of, old->vertex_count),
                          PEL_ROOM(c->scratch, old->vertex_count)))
        return pel_fail_memory(error);
    for (int32_t v = 0; v < new->vertex_count; v++)
        c->places[v] = -1;
    for (int32_t b = 0; b < new->body_count; b++)
        for (int32_t v = new->bodies[b].mesh->vertex_count - 1; v >= 0; v--) {
            int32_t source = surfaces->sources[b] != NULL ? surfaces->sources[b][v] : v;
            int32_t place = old->bodies[b].model_index[source];
            c->places[new->bodies[b].model_index[v]] = place;
            c->place_of[place] = new->bodies[b].model_index[v];
        }
    return PEL_OK;
}

/* a mean of records at the places of a move, for the vertex and the copies that the cut makes of it */
static void blend(const pel_surfaces *surfaces, int32_t body, const pel_vertex_move *move, const carrier *c,
                  const pel_record *from, pel_record *to)
{
    const pel_body *old = &c->from->given->bodies[body], *new = &c->to->given->bodies[body];
    pel_record sum = (pel_real)move->own * from[old->model_index[move->vertex]];
    for (int i = 0; i < 3; i++)
        sum += (pel_real)move->weights[i] * from[old->model_index[move->corners[i]]];
    for (int32_t v = move->vertex; v < new->mesh->vertex_count;) {
        if (surfaces->sources[body][v] == move->vertex)
            for (int i = 0; i < 3; i++)
                to[new->model_index[v]][i] = sum[i];
        v = v < old->mesh->vertex_count ? old->mesh->vertex_count : v + 1;
    }
}

/* vertices that moved over the surface take on the motion of it there */
static void carry_moves(const carrier *c, const pel_surfaces *surfaces)
{
    const pel_state *from = c->from->state;
    pel_state *to = c->to->state;
    for (int32_t b = 0; b < surfaces->body_count; b++)
        for (int32_t i = 0; i < surfaces->move_counts[b]; i++) {
            const pel_vertex_move *move = &surfaces->moves[b][i];
            blend(surfaces, b, move, c, from->position, to->position);
            blend(surfaces, b, move, c, from->position_before, to->position_before);
            if (from->velocity != NULL)
                blend(surfaces, b, move, c, from->velocity, to->velocity);
            to->older_is_known = false;
        }
}

/* the caller's forces are divided like loads */
static void divide_forces(const carrier *c, const pel_surfaces *surfaces)
{
    pel_record *external = c->to->loads->external;
    for (int32_t b = 0; external != NULL && b < surfaces->body_count; b++) {
        const pel_body *old = &c->from->given->bodies[b], *new = &c->to->given->bodies[b];
        for (int32_t v = 0; surfaces->sources[b] != NULL && v < new->mesh->vertex_count; v++)
            external[new->model_index[v]] *=
                (pel_real)(pel_vertex_share(new, v) / pel_vertex_share(old, surfaces->sources[b][v]));
    }
}

/* without those of pairs and contact points, which find their forces anew after a cut */
static void carry_parts(carrier *c)
{
    static pel_transfer_part *const parts[] = {pel_parts_transfer,    pel_transfer_marks,
                                               pel_supports_transfer, pel_touch_transfer_pairs,
                                               pel_forces_transfer,   pel_touch_transfer_statistics,
                                               pel_minimise_transfer, pel_ledger_transfer,
                                               pel_tear_transfer,     pel_ties_transfer};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        carry(c, parts[i], 0, 0);
    if (c->places != NULL) {
        pel_minimise_forget_contacts(c->to);
        return;
    }
    carry(c, pel_touch_transfer_forces, 0, 0);
    carry(c, pel_transfer_plastic, 0, 0);
    pel_plastic_begin(c->to);
}

/* Those of the start stay; before the first step a change is of the start. */
static pel_status carry_limits(carrier *c, bool stay, pel_error *error)
{
    if (stay)
        carry(c, pel_contacts_transfer_limits, 0, 0);
    return stay || c->to->contacts == NULL ? PEL_OK : pel_contacts_limit_by_start(c->to, error);
}

pel_status pel_snapshot_carry(const pel_sim *from, pel_sim *to, const pel_surfaces *surfaces, pel_error *error)
{
    carrier c = {.from = from, .to = to};
    bool has_run = from->state->step > 0;
    pel_status status = find_places(&c, surfaces, error);
    if (status == PEL_OK)
        status = carry_surfaces(&c, error);
    if (status == PEL_OK)
        status = carry_limits(&c, has_run || surfaces != NULL, error);
    if (status == PEL_OK) {
        carry(&c, pel_transfer_motion, 0, 0);
        /* its presence depends on tools and contact */
        carry(&c, pel_transfer_history, 0, 0);
        take_mobility(&c);
        if (surfaces != NULL)
            carry_moves(&c, surfaces);
        for (int32_t t = 0; t < to->tools->count; t++) {
            int32_t old = pel_sim_find_tool(from, to->tools->items[t].name);
            if (old >= 0)
                carry_tool(&c, old, t);
        }
        carry_parts(&c);
        if (surfaces != NULL)
            divide_forces(&c, surfaces);
        else
            pel_supports_release(from, to);
        pel_substeps_carry(from, to);
        for (int32_t b = 0; b < to->model->body_count; b++) {
            const pel_shell *old = from->model->bodies[b].shell, *new = to->model->bodies[b].shell;
            if (old != NULL && new != NULL && old->bending_weight == new->bending_weight)
                carry(&c, pel_transfer_bending, b, b);
        }
        to->state->older_is_known &= from->solver.substeps == to->solver.substeps;
        to->state->step = from->state->step;
        if (to->contacts != NULL && has_run) {
            to->contacts->tangles.is_known = false;
            to->touch->revisions[0] = -1;
        }
        rest_unused_places(to);
        status = surfaces == NULL ? carry_lists(from, to, error) : PEL_OK;
    }
    if (status == PEL_OK && (c.is_full || to->contact_forces.is_short))
        status = pel_fail_memory(error);
    PEL_FREE_ALL(c.bytes, c.places, c.place_of, c.scratch);
    return status;
}
