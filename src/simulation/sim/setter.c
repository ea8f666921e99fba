/* Setters between two steps. */
#include "base/status.h"
#include "boundary/loads.h"
#include "contact/set.h"
#include "math/pose.h"
#include "math/vec3.h"
#include "method/softness.h"
#include "observe/ledger.h"
#include "stage/rigids.h"
#include "stage/surface_view.h"
#include "tool/tool.h"

#include <string.h>

static pel_status check_values(const double *values, int32_t vertex_count, const char *name, pel_error *error)
{
    for (int32_t v = 0; v < vertex_count; v++)
        for (int c = 0; c < 3; c++)
            if (!isfinite(values[3 * (size_t)v + (size_t)c])) {
                pel_fail(error, PEL_BAD_ARGUMENT, "%s is not finite", name);
                pel_fail_element(error, "vertex", v);
                return PEL_BAD_ARGUMENT;
            }
    return PEL_OK;
}

static pel_status check_body(const pel_sim *sim, int32_t body, pel_error *error)
{
    if (body >= 0 && body < sim->model->body_count)
        return PEL_OK;
    return pel_fail(error, PEL_BAD_ARGUMENT, "body %d does not exist", (int)body);
}

pel_status pel_sim_set_positions(pel_sim *sim, int32_t body, const double *positions, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(positions, error);
    pel_status status = check_body(sim, body, error);
    if (status == PEL_OK)
        status = check_values(positions, pel_output_count(sim, body), "position", error);
    if (status != PEL_OK)
        return status;
    double energy_before = pel_ledger_energy(sim);
    sim->present.has_force = false;
    sim->state_number++;
    sim->state->older_is_known = false;
    sim->substeps->now.is_stale = true;
    int32_t count = pel_output_count(sim, body);
    for (int32_t v = 0; v < count; v++)
        for (int c = 0; c < 3; c++) {
            int32_t i = pel_output_model_index(sim, body, v);
            sim->state->position[i][c] = (pel_real)positions[3 * (size_t)v + (size_t)c];
            /* a displaced body starts at rest */
            sim->state->position_before[i][c] = sim->state->position[i][c];
        }
    pel_rigids_follow_positions(sim, body);
    /* present intersections are ignored until they separate */
    if (sim->contacts != NULL)
        sim->contacts->tangles.is_known = false;
    pel_ledger_book_change(sim, energy_before);
    return PEL_OK;
}

pel_status pel_sim_set_velocities(pel_sim *sim, int32_t body, const double *velocities, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(velocities, error);
    pel_status status = check_body(sim, body, error);
    if (status == PEL_OK)
        status = check_values(velocities, pel_output_count(sim, body), "velocity", error);
    if (status != PEL_OK)
        return status;
    pel_state *state = sim->state;
    double energy_before = pel_ledger_energy(sim);
    sim->present.has_force = false;
    sim->state->older_is_known = false;
    int32_t count = pel_output_count(sim, body);
    for (int32_t v = 0; v < count; v++)
        for (int c = 0; c < 3; c++) {
            int32_t i = pel_output_model_index(sim, body, v);
            double value = sim->model->inverse_mass[i] > 0 ? velocities[3 * (size_t)v + (size_t)c] : 0;
            if (state->velocity != NULL)
                state->velocity[i][c] = (pel_real)value;
            else
                state->position_before[i][c] = (pel_real)((double)state->position[i][c] - sim->step.dt * value);
        }
    pel_rigids_follow_velocities(sim, body);
    pel_ledger_book_change(sim, energy_before);
    return PEL_OK;
}

pel_status pel_sim_set_load_force(pel_sim *sim, int32_t load, const double force[3], pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(force, error);
    if (load < 0 || load >= sim->loads->count)
        return pel_fail(error, PEL_BAD_ARGUMENT, "load %d does not exist", (int)load);
    if (!isfinite(force[0]) || !isfinite(force[1]) || !isfinite(force[2]))
        return pel_fail(error, PEL_BAD_ARGUMENT, "force of load %d is not finite", (int)load);
    sim->present.has_force = false;
    memcpy(sim->loads->items[load].force, force, sizeof sim->loads->items[load].force);
    /* the copy of this sim; changes to come start from it */
    memcpy((double *)(uintptr_t)sim->def.loads[load].force, force, sizeof sim->def.loads[load].force);
    return PEL_OK;
}

pel_status pel_sim_set_tool_pose(pel_sim *sim, int32_t tool, const double position[3], const double rotation[4],
                                 pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(position, error);
    if (tool < 0 || tool >= sim->tools->count)
        return pel_fail(error, PEL_BAD_ARGUMENT, "tool %d does not exist", (int)tool);
    PEL_REFUSE_NULL(rotation, error);
    double square = 0;
    for (int i = 0; i < 4; i++)
        square += rotation[i] * rotation[i];
    if (!isfinite(position[0]) || !isfinite(position[1]) || !isfinite(position[2]) || !(fabs(square - 1) < 1e-6)) {
        pel_fail(error, PEL_BAD_ARGUMENT,
                 "position of tool '%s' is not finite or its rotation is not a unit quaternion",
                 sim->tools->items[tool].name);
        return PEL_BAD_ARGUMENT;
    }
    /* a pose that is set turns the tool by the shorter arc */
    static const double none[3] = {0};
    pel_tool *t = &sim->tools->items[tool];
    const pel_pose *last = t->driven ? &t->driven_pose : &t->pose;
    double turn[3];
    pel_rotation_between(last->rotation, rotation, none, turn);
    pel_vec3_add(last->spin, turn, t->driven_pose.spin);
    t->driven = true;
    t->is_leading = false;
    memcpy(t->driven_pose.position, position, sizeof t->driven_pose.position);
    memcpy(t->driven_pose.rotation, rotation, sizeof t->driven_pose.rotation);
    return PEL_OK;
}
