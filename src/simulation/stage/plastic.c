#include "stage/plastic.h"

#include "base/hash.h"
#include "stage/transfer.h"

#include <string.h>

static size_t fold_size(const pel_sim *sim)
{
    return sim->state->plastic.folds != NULL ? (size_t)pel_model_fold_count(sim->model) * sizeof(pel_fold) : 0;
}

static size_t flow_size(const pel_sim *sim)
{
    return sim->state->plastic.flows != NULL ? (size_t)pel_model_flow_count(sim->model) * sizeof(pel_flow) : 0;
}

/* returns whether they differed */
static bool copy(void *to, const void *from, size_t size)
{
    const bool differs = size > 0 && memcmp(to, from, size) != 0;
    if (differs)
        memcpy(to, from, size);
    return differs;
}

void pel_plastic_begin(pel_sim *sim)
{
    pel_state *state = sim->state;
    sim->plastic_loss = 0;
    const bool folds = copy(state->plastic_next.folds, state->plastic.folds, fold_size(sim));
    const bool flows = copy(state->plastic_next.flows, state->plastic.flows, flow_size(sim));
    if (folds || flows)
        pel_shell_forces_set_plastic(sim->shells, &state->plastic_next);
}

void pel_plastic_follow(pel_sim *sim, const pel_record *position)
{
    if (fold_size(sim) + flow_size(sim) > 0)
        sim->plastic_loss += pel_shell_forces_slip(sim->shells, position, &sim->state->plastic_next);
}

void pel_plastic_accept(pel_sim *sim)
{
    copy(sim->state->plastic.folds, sim->state->plastic_next.folds, fold_size(sim));
    copy(sim->state->plastic.flows, sim->state->plastic_next.flows, flow_size(sim));
}

uint64_t pel_plastic_hash(const pel_sim *sim, uint64_t hash)
{
    hash = pel_hash_block(hash, sim->state->plastic_next.folds, fold_size(sim));
    return pel_hash_block(hash, sim->state->plastic_next.flows, flow_size(sim));
}

void pel_transfer_plastic(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (fold_size(sim) > 0)
        pel_transfer(at, sim->state->plastic.folds, fold_size(sim));
    if (flow_size(sim) > 0)
        pel_transfer(at, sim->state->plastic.flows, flow_size(sim));
}
