/* Vertices that leave their volumetric springs, between two steps. */
#include "base/status.h"
#include "observe/ledger.h"
#include "sim/change.h"
#include "sim/cut.h"
#include "sim/sim.h"
#include "stage/stepper.h"
#include "tear/growth.h"

#include <math.h>

/* Whether only the vertices themselves, the numbers of the method and the ledger depend on the springs, in a model that
   is the simulation's own: the first release makes it. */
static bool may_release_in_place(const pel_sim *sim)
{
    const pel_house *house = pel_house_of(sim);
    return sim->stepper->can_refill && sim->active == NULL && house->own_model != NULL &&
           house->own_model == sim->given;
}

/* the same bits as making the simulation anew */
static pel_status release_in_place(pel_sim *sim, pel_adhesion *adhesion, int32_t count, pel_error *error)
{
    pel_model *model = pel_house_of(sim)->own_model;
    pel_body_def *def = (pel_body_def *)(uintptr_t)&model->def.bodies[adhesion->body];
    double energy_before = pel_ledger_energy(sim);
    int32_t *list = pel_copies_take(&model->copies, adhesion->list, (size_t)count * sizeof *list);
    if (list == NULL)
        return pel_fail_memory(error);
    for (int32_t i = adhesion->released_count; i < count; i++) {
        int32_t place = model->bodies[adhesion->body].model_index[list[i]];
        model->rest[place][3] = model->volumetric_damping[place] = 0;
        adhesion->strengths[list[i]] = (double)HUGE_VAL;
    }
    def->released = list;
    def->released_count = adhesion->released_count = count;
    pel_status status = sim->stepper->create(sim, error);
    sim->present.has_force = false;
    sim->state_number++;
    pel_ledger_refill(sim);
    pel_ledger_book_cut(sim, energy_before);
    return status;
}

static pel_status release(pel_sim *sim, const pel_adhesion *adhesion, int32_t count, pel_error *error)
{
    pel_change change;
    pel_status status = pel_change_begin(sim, &change, error);
    if (status == PEL_OK) {
        /* the list lives until the old simulation goes, after the new one has its copy */
        pel_body_def *def = pel_change_body(&change, adhesion->body);
        def->released = adhesion->list;
        def->released_count = count;
        change.changes_model = change.is_release = true;
        status = pel_change_apply(sim, &change, error);
    }
    pel_change_end(&change);
    return status;
}

pel_status pel_adhesions_release(pel_sim *sim, bool *has_released, pel_error *error)
{
    pel_status status = PEL_OK;
    *has_released = false;
    /* a body that lets go makes the adhesions anew */
    for (int32_t i = 0; status == PEL_OK && sim->tear != NULL && i < sim->tear->adhesion_count; i++) {
        pel_adhesion *adhesion = &sim->tear->adhesions[i];
        int32_t count = pel_adhesion_look(adhesion, sim);
        if (count == adhesion->released_count)
            continue;
        status = may_release_in_place(sim) ? release_in_place(sim, adhesion, count, error)
                                           : release(sim, adhesion, count, error);
        *has_released |= status == PEL_OK;
    }
    return status;
}
