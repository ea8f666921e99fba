#include "sim/change.h"

#include "base/memory.h"
#include "base/status.h"
#include "blade/check.h"
#include "boundary/forces.h"
#include "def/vertices.h"
#include "sim/own_def.h"
#include "sim/sim.h"
#include "sim/snapshot.h"
#include "stage/accessors.h"
#include "stage/rigids.h"
#include "tool/pose.h"
#include "tool/reading.h"
#include "tool/start.h"
#include "touch/lips.h"
#include "touch/tangle.h"

pel_status pel_change_begin(const pel_sim *sim, pel_change *change, pel_error *error)
{
    *change = (pel_change){.model = sim->given->def, .sim = sim->def};
    pel_status status = pel_def_copy(&change->copies, PEL_DEF_MODEL, &change->model, error);
    return status == PEL_OK ? pel_sim_def_copy(&change->copies, &change->sim, error) : status;
}

void pel_change_end(pel_change *change)
{
    pel_copies_free(&change->copies);
}

/* loads, supports and tools that name vertices of the body */
static bool follow_sim(pel_change *change, int32_t body, const pel_vertex_sources *vertices)
{
    pel_load_def *loads = (pel_load_def *)(uintptr_t)change->sim.loads;
    pel_support_def *supports = (pel_support_def *)(uintptr_t)change->sim.supports;
    pel_tool_def *tools = (pel_tool_def *)(uintptr_t)change->sim.tools;
    bool is_made = true;
    for (int32_t l = 0; is_made && l < change->sim.load_count; l++)
        if (loads[l].body == body)
            is_made = pel_list_follows(&change->copies, &loads[l].vertices, &loads[l].vertex_count, &loads[l].weights,
                                       vertices);
    for (int32_t s = 0; is_made && s < change->sim.support_count; s++)
        if (supports[s].body == body)
            is_made = pel_def_follow_vertices(&change->copies, PEL_DEF_SUPPORT, &supports[s], vertices, NULL) == PEL_OK;
    for (int32_t t = 0; is_made && t < change->sim.tool_count; t++)
        if (tools[t].body == body)
            is_made = pel_def_follow_vertices(&change->copies, PEL_DEF_TOOL, &tools[t], vertices, NULL) == PEL_OK;
    return is_made;
}

pel_status pel_change_surfaces(pel_change *change, const pel_surfaces *surfaces, pel_error *error)
{
    for (int32_t b = 0; b < surfaces->body_count; b++) {
        if (surfaces->meshes[b] == NULL)
            continue;
        pel_body_def *def = pel_change_body(change, b);
        int32_t count = surfaces->meshes[b]->vertex_count;
        const pel_vertex_sources vertices = {surfaces->kept_counts[b], count, surfaces->sources[b]};
        if (pel_def_follow_vertices(&change->copies, PEL_DEF_BODY, def, &vertices, error) != PEL_OK ||
            !follow_sim(change, b, &vertices))
            return pel_fail_memory(error);
        bool has_copies = false;
        for (int32_t v = 0; v < count; v++)
            has_copies |= surfaces->origins[b][v] != v;
        def->mesh = surfaces->meshes[b];
        def->origins = has_copies ? surfaces->origins[b] : NULL;
        def->origin_count = has_copies ? count : 0;
        if (surfaces->released[b] == NULL)
            continue;
        def->released = surfaces->released[b];
        def->released_count = surfaces->released_counts[b];
    }
    change->changes_model = true;
    change->surfaces = surfaces;
    return PEL_OK;
}

/* The meshes of a model are already turned outward: counts and hashes refer to the given meshes. */
static pel_status make_model(const pel_model *old, const pel_model_def *def, pel_model **model, pel_error *error)
{
    pel_status status = pel_model_create(def, model, error);
    if (status != PEL_OK)
        return status;
    (*model)->fingerprint.parts[PEL_PART_MESH] = old->fingerprint.parts[PEL_PART_MESH];
    for (int32_t b = 0; b < old->body_count; b++)
        (*model)->bodies[b].turned_count = old->bodies[b].turned_count;
    return PEL_OK;
}

/* tools that were added stand where their keys are now, and must not be in a body */
static pel_status start_tools(const pel_sim *old, pel_sim *sim, pel_error *error)
{
    bool any = false;
    for (int32_t t = 0; t < sim->tools->count; t++) {
        pel_tool *tool = &sim->tools->items[t];
        if (pel_sim_find_tool(old, tool->name) >= 0)
            continue;
        any = true;
        tool->pose = tool->pose_before = pel_tool_pose_at(tool, pel_sim_time(sim));
        pel_status status =
            tool->blade != NULL ? pel_blade_check_start(sim, t, error) : pel_tool_check_start(sim, t, error);
        if (status != PEL_OK)
            return status;
    }
    if (!any || sim->contacts == NULL)
        return PEL_OK;
    pel_contacts_place_start(sim);
    sim->touch->revisions[0] = -1;
    pel_status status = pel_contacts_update_surface(sim, error);
    if (status == PEL_OK)
        status = pel_tangles_find(sim->contacts, error);
    return status == PEL_OK ? pel_contacts_refuse_tangles(sim, error) : status;
}

/* lips part, and no triangles intersect that did not before */
static pel_status open_lips(pel_sim *old, pel_sim *sim, pel_error *error)
{
    if (sim->contacts == NULL)
        return PEL_OK;
    pel_status status = pel_lips_part(sim, error);
    return status == PEL_OK ? pel_contacts_check_lips(old, sim, error) : status;
}

/* the state of the old one, and the change of energy */
static pel_status go_on(pel_sim *old, pel_sim *sim, const pel_change *change, pel_error *error)
{
    const pel_surfaces *surfaces = change->surfaces;
    double energy_before = pel_ledger_energy(old);
    pel_status status = pel_sim_make_forces(sim, old->loads->external != NULL, error);
    if (status == PEL_OK)
        status = pel_snapshot_carry(old, sim, surfaces, error);
    if (status != PEL_OK)
        return status;
    /* another mass has other momenta at the same velocities */
    for (int32_t b = 0; change->changes_model && b < sim->model->body_count; b++)
        pel_rigids_follow_velocities(sim, b);
    pel_sim_update_factors(sim, pel_sim_time(sim));
    status = surfaces != NULL ? open_lips(old, sim, error) : start_tools(old, sim, error);
    if (status != PEL_OK)
        return status;
    pel_ledger_follow(sim);
    if (surfaces != NULL && surfaces->is_tear)
        pel_ledger_book_remesh(sim, energy_before);
    else if (surfaces != NULL || change->is_release)
        pel_ledger_book_cut(sim, energy_before);
    else
        pel_ledger_book_change(sim, energy_before);
    return PEL_OK;
}

/* to another place, from which the rooms are reached again */
static void move(pel_house *from, pel_house *to)
{
    *to = *from;
    pel_house_link(to);
}

/* makes it in the place of the old one, so that addresses stay */
static pel_status remake(pel_house *house, pel_house *old, const pel_change *change, pel_model *model, pel_error *error)
{
    pel_sim *sim = &house->sim;
    pel_sim_def def = change->sim;
    def.model = model != NULL ? model : sim->given;
    const pel_ledger ledger = house->ledger;
    move(house, old);
    *house = (pel_house){.sim.goes_on = true, .sim.is_opened = change->surfaces != NULL && change->state == NULL};
    pel_status status = pel_sim_build(house, &def, error);
    sim->cuts_done = change->surfaces != NULL ? change->surfaces->cuts_done : old->sim.cuts_done;
    sim->cut_revision = old->sim.cut_revision + (change->surfaces != NULL);
    if (status == PEL_OK)
        status = change->state != NULL ? pel_snapshot_load(sim, change->state, change->state_size, error)
                                       : go_on(&old->sim, sim, change, error);
    if (status != PEL_OK) {
        pel_sim_release(house);
        move(old, house);
        house->ledger = ledger;
        return status;
    }
    house->own_model = model != NULL ? model : old->own_model;
    if (model == NULL)
        old->own_model = NULL;
    pel_sim_release(old);
    return PEL_OK;
}

pel_status pel_change_apply(pel_sim *sim, const pel_change *change, pel_error *error)
{
    pel_model *model = NULL;
    pel_status status = change->changes_model ? make_model(sim->given, &change->model, &model, error) : PEL_OK;
    if (status != PEL_OK)
        return status;
    pel_house *old = pel_allocate(1, sizeof *old);
    status = old != NULL ? remake(pel_house_of(sim), old, change, model, error) : pel_fail_memory(error);
    pel_free(old);
    if (status != PEL_OK)
        pel_model_destroy(model);
    return status;
}
