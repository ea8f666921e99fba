#include "stage/growth.h"

#include "stage/accessors.h"
#include "stage/stepper.h"

#include <math.h>

/* step of the central difference of the energy, as a share of the part */
#define SHARE_STEP 0.01

bool pel_growth_follow(pel_sim *sim, double share)
{
    const double now = pel_sim_time(sim), next = pel_sim_next_time(sim);
    bool grows = false;
    for (int32_t b = 0; sim->state->plastic.flows != NULL && b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        if (shell == NULL || shell->growth_course.key_count == 0)
            continue;
        const double from = pel_shell_growth(shell, now), to = pel_shell_growth(shell, next);
        if (from == to)
            continue;
        pel_shell_grow(shell, from + share * (to - from), sim->state->plastic_next.flows);
        grows = true;
    }
    if (grows)
        pel_shell_forces_set_plastic(sim->shells, &sim->state->plastic_next);
    return grows;
}

static double energy_at(pel_sim *sim, const pel_record *position, double share)
{
    pel_growth_follow(sim, share);
    return pel_shell_forces_add(sim->shells, position, pel_instant(0), PEL_SHELL_MEMBRANE, sim->pool, NULL).membrane;
}

/* derivative of the energy by the share of the part, at fixed positions */
static double energy_rate(pel_sim *sim, const pel_record *position, double share)
{
    return (energy_at(sim, position, share + SHARE_STEP) - energy_at(sim, position, share - SHARE_STEP)) /
           (2 * SHARE_STEP);
}

void pel_growth_begin(pel_sim *sim)
{
    const pel_record *position = sim->state->position;
    sim->growth_work = sim->growth_size = 0;
    if (!pel_growth_follow(sim, 0))
        return;
    sim->growth_size = fabs(energy_at(sim, position, 1) - energy_at(sim, position, 0));
    sim->growth_work = 0.5 * energy_rate(sim, position, 0);
    /* minimisations in time go by the midpoint rule: the shape at the end, from the start on, would bring energy */
    const double end = sim->stepper->has_velocity ? 0.5 : 1;
    pel_growth_follow(sim, sim->stepper->is_at_end ? end : 0);
}

void pel_growth_end(pel_sim *sim)
{
    if (!pel_growth_follow(sim, 1))
        return;
    sim->growth_work += 0.5 * energy_rate(sim, sim->state->position_next, 1);
    pel_growth_follow(sim, 1);
}
