/* The step of position-based methods: loads and pressure at the start of each substep, then what solve/project.h does.
 */
#include "sim/contact.h"
#include "sim/sim.h"

#include <string.h>

pel_status pel_project_create(pel_sim *sim, pel_error *error)
{
    if (!pel_sim_is_projected(sim))
        return PEL_OK;
    pel_solver_def *solver = &sim->solver;
    sim->contact_in_loop = true;
    pel_status status = pel_substeps_create(sim, error);
    if (status == PEL_OK && solver->second_order)
        status = pel_state_add_history(sim->model, sim->state, error);
    if (status == PEL_OK)
        status = pel_projector_create(sim->model, solver, &sim->projector, error);
    if (status == PEL_OK)
        sim->projector->pool = sim->pool;
    return status;
}

void pel_project_follow(pel_sim *sim, int32_t body)
{
    sim->state->older_is_known = false;
    sim->substeps.now.is_stale = true;
    pel_shell_forces_rebuild(sim->shells, body);
    if (sim->projector != NULL)
        pel_projector_follow(sim->projector, body);
}

/* a pressure that the projector does not know */
static bool has_normal_pressure(const pel_sim *sim)
{
    for (int32_t b = 0; sim->shells != NULL && b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        if (shell != NULL && shell->pressure.kind != PEL_PRESSURE_NONE &&
            shell->pressure.form != PEL_PRESSURE_CONSISTENT)
            return true;
    }
    return false;
}

/* adds loads and pressure at a time to sim->force, which is 0: what a substep takes it leaves so */
static void find_forces(pel_sim *sim, double time, bool normal_pressure, const pel_record *positions)
{
    pel_loads_add(sim, time, sim->force);
    if (normal_pressure)
        pel_shell_forces_add(sim->shells, positions, time, PEL_SHELL_PRESSURE, sim->pool, sim->force);
    else
        pel_projector_add_pressure(sim->projector, positions, time, sim->force);
}

pel_status pel_project_step(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    pel_state *state = sim->state;
    pel_substeps_follow(sim);
    pel_contact_list *contacts = pel_sim_has_loop_contacts(sim) ? &sim->contacts->list : NULL;
    pel_status status = contacts != NULL ? pel_contacts_find(sim, 0, error) : PEL_OK;
    if (status != PEL_OK)
        return status;
    double start = pel_sim_time(sim);
    bool normal_pressure = has_normal_pressure(sim);
    pel_projector_begin(sim->projector, state, start);
    /* second order: forces belong to the end of a substep */
    double lead = sim->solver.second_order ? sim->projector->substep : 0;
    memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
    for (int32_t s = 0; s < sim->solver.substeps; s++) {
        int place = (s == 0 ? PEL_SUBSTEP_FIRST : 0) | (s == sim->solver.substeps - 1 ? PEL_SUBSTEP_LAST : 0);
        find_forces(sim, start + lead + s * sim->projector->substep, normal_pressure,
                    s == 0 ? state->position : state->position_next);
        pel_project_substep(sim->projector, state, sim->force, contacts, (pel_substep_place)place);
    }
    result->diverged = !pel_sim_all_inside(sim);
    return PEL_OK;
}
