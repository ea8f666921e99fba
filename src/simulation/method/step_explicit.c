/* Euler's method on m a = F (paper A's baseline): forward, or symplectic, which is the leapfrog. */
#include "method/step_explicit.h"

#include "adapt/refine.h"
#include "attach/joint.h"
#include "attach/tie.h"
#include "base/memory.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "boundary/wind.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "method/meet.h"
#include "solve/shell_stability.h"
#include "stage/accessors.h"
#include "stage/rigids.h"
#include "stage/shells.h"
#include "tool/grip.h"
#include "tool/tools.h"

#include <math.h>
#include <string.h>

/* share of the stability limit that a remedy names */
#define SAFE_SHARE 0.9

/* an enclosed gas is as stiff as its pressure */
static bool has_gas(const pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        if (shell != NULL && shell->pressure.kind == PEL_PRESSURE_GAS)
            return true;
    }
    return false;
}

static pel_status refuse_dt(const pel_sim *sim, double limit, const char *level, pel_error *error)
{
    pel_fail(error, PEL_UNSTABLE, "dt %.6g is unstable on %s: the limit is %.6g", sim->step.dt, level, limit);
    pel_fail_remedy(error, "use at most %.4g, or a softer material%s%s", SAFE_SHARE * limit,
                    has_gas(sim) ? ", or a gas of lower pressure" : "",
                    sim->active != NULL ? ", or fewer levels of detail" : "");
    return PEL_UNSTABLE;
}

pel_status pel_sim_refine_stability(const pel_sim *sim, pel_stability *stability, pel_error *error)
{
    if (sim->shells == NULL)
        return pel_stability_refine(sim->model, stability, error);
    return pel_shell_stability_refine(sim->model, sim->state, sim->shells, sim->pool, stability, error);
}

/* from below where that is enough */
static pel_status find_limit(const pel_sim *sim, double enough, double *limit, pel_error *error)
{
    pel_stability stability;
    pel_stability_bound(sim->model, &stability);
    pel_shell_stability_bound(sim->shells, &stability);
    *limit = pel_stability_dt(&stability, stability.stiffness_bound, sim->solver.symplectic);
    if (*limit >= enough)
        return PEL_OK;
    pel_status status = pel_sim_refine_stability(sim, &stability, error);
    *limit = pel_stability_dt(&stability, stability.stiffness, sim->solver.symplectic);
    return status;
}

/* on the base and, where a body refines, everywhere on its finest level */
static pel_status find_limits(pel_sim *sim, double enough, double limits[2], pel_error *error)
{
    limits[1] = HUGE_VAL;
    pel_status status = find_limit(sim, enough, &limits[0], error);
    if (status != PEL_OK || sim->active == NULL)
        return status;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        pel_refine_everywhere(sim, b, true);
    status = find_limit(sim, enough, &limits[1], error);
    for (int32_t b = 0; b < sim->model->body_count; b++)
        pel_refine_everywhere(sim, b, false);
    return status;
}

pel_status pel_explicit_limit(pel_sim *sim, double *limit, pel_error *error)
{
    double limits[2];
    pel_status status = find_limits(sim, HUGE_VAL, limits, error);
    *limit = status == PEL_OK ? pel_min(limits[0], limits[1]) : 0;
    return status;
}

static pel_status check_dt(pel_sim *sim, pel_error *error)
{
    double limits[2];
    pel_status status = find_limits(sim, sim->step.dt, limits, error);
    if (status != PEL_OK || sim->step.dt <= pel_min(limits[0], limits[1]))
        return status;
    if (!(pel_min(limits[0], limits[1]) > 0))
        return pel_refuse(error, PEL_UNSTABLE, "give the springs a damping above 0, or use the symplectic integrator",
                          "forward Euler is unstable at every dt without damping");
    if (sim->step.dt > limits[0])
        return refuse_dt(sim, limits[0], "this mesh", error);
    return refuse_dt(sim, limits[1], "the finest level of detail", error);
}

/* Leapfrog: velocities belong to the middle of a step. The first kick is half as long, as they belong to its begin, and
   drag acts for half a step before and after each kick. */
static void correct_velocities(pel_sim *sim)
{
    pel_state *state = sim->state;
    double dt = sim->step.dt, half_drag = pel_exp(-0.5 * sim->solver.drag * dt);
    bool first = state->step == 0 && sim->shells != NULL && sim->solver.symplectic;
    pel_real kept = (pel_real)(first ? half_drag : half_drag * half_drag);
    pel_real kick = (pel_real)(first ? 0.5 : half_drag), step = (pel_real)dt;
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        pel_record change = state->velocity_next[v] - state->velocity[v];
        pel_record velocity = kept * state->velocity[v] + kick * change;
        if (sim->solver.symplectic) {
            pel_record next = state->position[v] + step * velocity;
            next[3] = state->position_next[v][3];
            state->position_next[v] = next;
        }
        state->velocity_next[v] = velocity;
    }
}

/* by all forces but those of ties where these are solved on predicted positions */
static void move_by_forces(pel_sim *sim, pel_step_result *result)
{
    double dt = sim->step.dt;
    pel_wind_begin(sim);
    const pel_gains gains = {sim->step.symplectic ? dt * dt : 0, dt};
    pel_step_explicit(sim->model, sim->state, &sim->step, result);
    const pel_span span = pel_loads_kick_span(sim, pel_sim_time(sim));
    result->diverged |= !pel_loads_apply(sim, span, gains);
    pel_shells_apply(sim, span, gains);
    pel_wind_apply(sim, gains.position / gains.velocity);
    if (!pel_sim_is_projected(sim))
        pel_ties_apply(sim, gains.position / gains.velocity);
    if (sim->shells != NULL || sim->solver.drag > 0)
        correct_velocities(sim);
    result->way_is_known &= !pel_loads_exist(sim) && sim->shells == NULL && sim->ties == NULL && sim->rigids == NULL &&
                            !(sim->solver.drag > 0);
    result->diverged |= sim->shells != NULL && !pel_sim_all_inside(sim);
}

static pel_status step(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    (void)error;
    move_by_forces(sim, result);
    return PEL_OK;
}

/* ---- beside rigid bodies ---- */

static pel_status create_rigid(pel_sim *sim, pel_error *error)
{
    if (!sim->solver.symplectic)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "use the symplectic integrator, or method xpbd or implicit",
                          "forward Euler has no rigid bodies");
    sim->contact_in_loop = true;
    sim->predicted = pel_allocate_aligned((size_t)sim->model->vertex_count, sizeof *sim->predicted);
    return sim->predicted != NULL ? check_dt(sim, error) : pel_fail_memory(error);
}

static pel_status record_pins(pel_sim *sim, pel_error *error)
{
    sim->pin_force = pel_allocate_aligned((size_t)sim->model->vertex_count, sizeof *sim->pin_force);
    return sim->pin_force != NULL ? PEL_OK : pel_fail_memory(error);
}

static void get_pin_force(const pel_sim *sim, int32_t v, double force[3])
{
    pel_vertex_position(sim->pin_force, v, force);
}

static void move_rigid(pel_sim *sim)
{
    double dt = sim->step.dt;
    memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
    pel_loads_add(sim, (pel_span){.time = pel_sim_time(sim), .ahead = dt}, sim->state->position, sim->force);
    pel_wind_add(sim, sim->force);
    pel_rigids_kick(sim, sim->state->position, dt, pel_wind_forces(sim));
    pel_rigids_drift(sim, dt);
}

/* what contacts, ties and joints have moved got its velocity from them */
static void take_velocities(pel_sim *sim)
{
    pel_state *state = sim->state;
    const pel_real rate = (pel_real)(1 / sim->step.dt);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        if (state->position_next[v][3] > 0)
            state->velocity_next[v] += pel_record_with(rate * (state->position_next[v] - sim->predicted[v]), 0);
}

/* Forces of elements predict positions; on these contacts, ties and joints act as in a substep of xpbd, so that neither
   the stiffness of a layer nor the mass of a body bounds dt. */
static pel_status step_rigid(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    const pel_meeting meeting = {
        .end = pel_sim_next_time(sim), .length = sim->step.dt, .tau = sim->step.dt, .start = sim->state->position};
    pel_tools_begin(sim, meeting.end);
    pel_rigids_begin(sim);
    pel_joints_begin(sim);
    pel_status status = pel_meet_find(sim, pel_sim_has_loop_contacts(sim), error);
    if (status != PEL_OK)
        return status;
    size_t size = (size_t)sim->model->vertex_count * sizeof *sim->predicted;
    pel_meet_recall(sim, sim->step.dt);
    pel_tools_place(sim, 1);
    move_by_forces(sim, result);
    pel_tools_carry(sim);
    move_rigid(sim);
    memcpy(sim->predicted, sim->state->position_next, size);
    if (sim->pin_force != NULL)
        memset(sim->pin_force, 0, size);
    pel_meet_begin(sim, &meeting);
    pel_meet_sweep(sim, &meeting);
    pel_meet_tally(sim, &meeting, sim->pin_force);
    take_velocities(sim);
    pel_rigids_finish(sim, sim->step.dt, sim->pin_force, true);
    pel_meet_end(sim);
    result->diverged |= !pel_sim_all_inside(sim);
    return PEL_OK;
}

/* at the last good state: 0 where that is not known */
static double limit_now(const pel_sim *sim)
{
    pel_stability stability;
    double stiffness = 0;
    pel_stability_bound(sim->model, &stability);
    if (sim->shells != NULL)
        pel_shell_stability_now(sim->model, sim->state, sim->shells, sim->pool, &stiffness);
    return stiffness > 0 ? pel_stability_dt(&stability, stiffness, sim->solver.symplectic) : 0;
}

bool pel_explicit_advise(const pel_sim *sim, pel_error *error)
{
    const double limit = limit_now(sim);
    if (!(limit > 0 && limit < sim->step.dt))
        return false;
    pel_fail_remedy(error, "use solver.dt: %.2g: as the body is stretched now, the limit is %.3g, below dt %g",
                    SAFE_SHARE * limit, limit, sim->step.dt);
    return true;
}

static void advise(const pel_sim *sim, pel_error *error)
{
    if (!pel_explicit_advise(sim, error))
        pel_fail_remedy(error, "make solver dt (%g) smaller, or the loads, or raise the spring damping", sim->step.dt);
}

const pel_stepper pel_step_explicit_kind = {
    .has_velocity = true,
    .is_explicit = true,
    .bounds_motion = true,
    .can_refill = true,
    .create = check_dt,
    .step = step,
    .advise = advise,
};

const pel_stepper pel_step_explicit_rigid_kind = {
    .has_velocity = true,
    .is_explicit = true,
    .has_substeps = true,
    .moves_tools = true,
    .moves_rigid = true,
    .bounds_motion = true,
    .create = create_rigid,
    .step = step_rigid,
    .record_held = record_pins,
    .get_held_force = get_pin_force,
    .advise = advise,
};
