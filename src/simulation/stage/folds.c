#include "stage/folds.h"

#include "stage/transfer.h"

#include <string.h>

static size_t size_of(const pel_sim *sim)
{
    return sim->state->folds != NULL ? (size_t)pel_model_fold_count(sim->model) * sizeof *sim->state->folds : 0;
}

void pel_folds_begin(pel_sim *sim)
{
    pel_state *state = sim->state;
    const size_t size = size_of(sim);
    sim->fold_loss = 0;
    if (size == 0 || memcmp(state->folds, state->folds_next, size) == 0)
        return;
    memcpy(state->folds_next, state->folds, size);
    pel_shell_forces_fold(sim->shells, state->folds_next);
}

void pel_folds_follow(pel_sim *sim, const pel_record *position)
{
    sim->fold_loss += pel_shell_forces_slip(sim->shells, position, sim->state->folds_next);
}

void pel_folds_accept(pel_sim *sim)
{
    const size_t size = size_of(sim);
    if (size > 0)
        memcpy(sim->state->folds, sim->state->folds_next, size);
}

void pel_transfer_folds(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (size_of(sim) > 0)
        pel_transfer(at, sim->state->folds, size_of(sim));
}
