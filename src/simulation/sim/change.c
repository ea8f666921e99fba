#include "sim/change.h"

#include "base/memory.h"
#include "base/status.h"
#include "boundary/forces.h"
#include "sim/own_def.h"
#include "sim/sim.h"
#include "sim/snapshot.h"
#include "stage/accessors.h"
#include "tool/pose.h"
#include "tool/reading.h"
#include "tool/start.h"
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
        pel_status status = pel_tool_check_start(sim, t, error);
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

/* the state of the old one, and the change of energy */
static pel_status go_on(pel_sim *old, pel_sim *sim, pel_error *error)
{
    double energy_before = pel_ledger_energy(old);
    pel_status status = pel_sim_make_forces(sim, old->loads->external != NULL, error);
    if (status == PEL_OK)
        status = pel_snapshot_carry(old, sim, error);
    if (status != PEL_OK)
        return status;
    pel_sim_update_factors(sim, pel_sim_time(sim));
    status = start_tools(old, sim, error);
    if (status != PEL_OK)
        return status;
    pel_ledger_follow(sim);
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
    *house = (pel_house){.sim.goes_on = true};
    pel_status status = pel_sim_build(house, &def, error);
    if (status == PEL_OK)
        status = change->state != NULL ? pel_sim_load(sim, change->state, change->state_size, error)
                                       : go_on(&old->sim, sim, error);
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
