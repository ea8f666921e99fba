#include "stage/plastic.h"

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

/* ---- growth ---- */

/* Gives what grows the shape at a part of the way from now to the end of the step in progress; false if nothing does.
 */
static bool grow(pel_sim *sim, double next, double part)
{
    bool grows = false;
    for (int32_t b = 0; sim->state->plastic.flows != NULL && b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        if (shell == NULL || shell->growth_course.key_count == 0)
            continue;
        const double from = pel_shell_growth(shell, pel_sim_time(sim)), to = pel_shell_growth(shell, next);
        pel_shell_grow(shell, from + part * (to - from), sim->state->plastic_next.flows);
        grows |= from != to;
    }
    if (grows)
        pel_shell_forces_set_plastic(sim->shells, &sim->state->plastic_next);
    return grows;
}

static double grown_energy(pel_sim *sim, const pel_record *position, double next, double part)
{
    grow(sim, next, part);
    return pel_shell_forces_add(sim->shells, position, pel_instant(0), PEL_SHELL_MEMBRANE, sim->pool, NULL).membrane;
}

/* of the energy over the part of the way, at positions that stay */
static double growth_rate(pel_sim *sim, const pel_record *position, double next, double part)
{
    const double h = 0.01;
    return (grown_energy(sim, position, next, part + h) - grown_energy(sim, position, next, part - h)) / (2 * h);
}

/* Leapfrog has forces at the start of the step, the other methods those of its end. A minimisation takes the way in
   balance, so that the work is that of the trapezoidal rule, as for leapfrog; substeps start from a jump. */
void pel_plastic_grow(pel_sim *sim, double next)
{
    const pel_stepper *stepper = sim->stepper;
    const pel_record *position = sim->state->position;
    sim->growth_work = 0;
    if (!grow(sim, next, 0))
        return;
    if (stepper->is_at_end || stepper->is_explicit)
        sim->growth_work = 0.5 * growth_rate(sim, position, next, 0);
    else
        sim->growth_work = grown_energy(sim, position, next, 1) - grown_energy(sim, position, next, 0);
    grow(sim, next, stepper->is_explicit ? 0 : 1);
}

void pel_plastic_follow(pel_sim *sim, const pel_record *position)
{
    if (fold_size(sim) + flow_size(sim) > 0)
        sim->plastic_loss += pel_shell_forces_slip(sim->shells, position, &sim->state->plastic_next);
}

void pel_plastic_end(pel_sim *sim, double next)
{
    const pel_stepper *stepper = sim->stepper;
    const pel_record *position = sim->state->position_next;
    if (grow(sim, next, 1) && (stepper->is_at_end || stepper->is_explicit)) {
        sim->growth_work += 0.5 * growth_rate(sim, position, next, 1);
        grow(sim, next, 1);
    }
    pel_plastic_follow(sim, position);
}

void pel_plastic_accept(pel_sim *sim)
{
    copy(sim->state->plastic.folds, sim->state->plastic_next.folds, fold_size(sim));
    copy(sim->state->plastic.flows, sim->state->plastic_next.flows, flow_size(sim));
}

void pel_transfer_plastic(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (fold_size(sim) > 0)
        pel_transfer(at, sim->state->plastic.folds, fold_size(sim));
    if (flow_size(sim) > 0)
        pel_transfer(at, sim->state->plastic.flows, flow_size(sim));
}
