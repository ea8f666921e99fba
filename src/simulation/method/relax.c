/* The quasi-static method on fine vertices: loads and shells between the stages of solve/relax.h. */
#include "method/relax.h"

#include "boundary/loads.h"
#include "solve/relax.h"
#include "solve/shell_stability.h"

#include <string.h>

/* share of the stability limit up to which finer vertices move as those of the base */
#define PLAIN_SHARE 0.9

pel_status pel_sim_relax_create(pel_sim *sim, pel_error *error)
{
    double dt = sim->step.dt, factor = sim->step.alpha * dt * dt;
    pel_stability stability;
    pel_stability_bound(sim->model, &stability);
    /* an alpha beyond the bound by rows is stable on the base as a whole: there is no telling of other rows */
    bool by_rows =
        sim->step.alpha < pel_stability_alpha(&stability, stability.stiffness_bound, dt, sim->solver.keep_velocity);
    sim->active->relaxation = (pel_relaxation){factor, by_rows ? 2 * PLAIN_SHARE : 0, dt, sim->solver.keep_velocity};
    return pel_relax_create(sim->active, &sim->relax, error);
}

/* loads and the forces of shells on fine vertices at given positions */
static void find_outer_forces(pel_sim *sim, const pel_record *positions)
{
    const pel_relax *relax = sim->relax;
    for (int32_t i = 0; i < relax->slice_begin[sim->model->body_count]; i++)
        memset(sim->force + relax->slices[i] * PEL_WIDTH, 0, PEL_WIDTH * sizeof *sim->force);
    pel_loads_add(sim, pel_instant(pel_sim_time(sim)), positions, sim->force);
    pel_shell_forces_follow(sim->shells, positions);
    pel_shell_forces_add(sim->shells, positions, pel_instant(pel_sim_time(sim)), PEL_SHELL_ALL, sim->pool, sim->force);
}

/* bound of the shells on the present surface; it changes with the surface only */
static double shell_rate(pel_sim *sim, bool changed)
{
    if (changed)
        sim->relax->shell_rate = pel_shell_stiffness_bound(sim->shells);
    return sim->relax->shell_rate;
}

bool pel_sim_relax(pel_sim *sim)
{
    pel_relax *relax = sim->relax;
    if (relax == NULL)
        return true;
    bool changed = relax->revision != sim->active->revision;
    if (!pel_relax_follow(relax))
        return true;
    int32_t count = pel_relax_stage_count(relax, shell_rate(sim, changed));
    bool inside = true;
    pel_relax_begin(relax, sim->state, sim->shells != NULL);
    for (int32_t j = 1; inside && j <= count; j++) {
        if (j == 1 || sim->shells != NULL)
            find_outer_forces(sim, pel_relax_positions(relax, sim->state, count, j));
        inside = pel_relax_stage(relax, sim->state, sim->force, sim->held, sim->pool, sim->step.bound, count, j);
    }
    return inside;
}
