/* Forces of the caller on vertices, and the forces of bodies and loads. */
#include "boundary/forces.h"

#include "base/memory.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "boundary/wind.h"
#include "stage/shells.h"

pel_status pel_sim_make_forces(pel_sim *sim, bool has_forces, pel_error *error)
{
    size_t count = (size_t)sim->model->vertex_count;
    if (has_forces == (sim->loads->external != NULL))
        return PEL_OK;
    if (!has_forces) {
        pel_free(sim->loads->external);
        sim->loads->external = NULL;
        return PEL_OK;
    }
    pel_record *made = pel_allocate_aligned(count, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    sim->loads->external = made;
    return PEL_OK;
}

/* J, of mid-edge bending */
static double edge_energy(const pel_sim *sim)
{
    pel_tangent_input input = {.span = pel_instant(pel_sim_time(sim)), .state = sim->state};
    pel_tangent *tangent = pel_sim_settle_edges(sim, &input.unknowns);
    return tangent != NULL ? pel_tangent_evaluate(tangent, &input, sim->pool, NULL).edges : 0;
}

/* forces of eq. and of shells with the loads at the present time, into sim->force; once for each state */
void pel_sim_compute_forces(pel_sim *sim)
{
    const pel_state *state = sim->state;
    if (sim->present.has_force)
        return;
    sim->present.has_force = true;
    sim->present.has_energies = false;
    pel_body_forces(sim->model, state, state->velocity, sim->pool, sim->force);
    pel_loads_add(sim, pel_instant(pel_sim_time(sim)), state->position, sim->force);
    pel_wind_add_present(sim, sim->force);
    pel_shell_forces_follow(sim->shells, state->position);
    sim->present.shell_energy = pel_shell_forces_add(sim->shells, state->position, pel_instant(pel_sim_time(sim)),
                                                     PEL_SHELL_ALL, sim->pool, sim->force);
    sim->present.shell_energy.bending += edge_energy(sim);
}

/* ---- snapshots ---- */

void pel_forces_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->loads->external != NULL)
        pel_transfer_vertices(at, sim->loads->external, (size_t)sim->model->vertex_count, sizeof *sim->loads->external);
}
