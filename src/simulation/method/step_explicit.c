/* Euler's method on m a = F (paper A's baseline): forward, or symplectic, which is the leapfrog. */
#include "method/step_explicit.h"

#include "adapt/refine.h"
#include "attach/tie.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "boundary/wind.h"
#include "math/functions.h"
#include "solve/shell_stability.h"
#include "stage/accessors.h"
#include "stage/shells.h"

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

static pel_status refuse_dt(const pel_sim *sim, double limit, pel_error *error)
{
    pel_fail(error, PEL_UNSTABLE, "dt %.6g is unstable on this mesh: the limit is %.6g", sim->step.dt, limit);
    pel_fail_remedy(error, "use at most %.4g, or a softer material%s", SAFE_SHARE * limit,
                    has_gas(sim) ? ", or a gas of lower pressure" : "");
    return PEL_UNSTABLE;
}

pel_status pel_sim_refine_stability(const pel_sim *sim, pel_stability *stability, pel_error *error)
{
    if (sim->shells == NULL)
        return pel_stability_refine(sim->model, stability, error);
    return pel_shell_stability_refine(sim->model, sim->state, sim->shells, sim->pool, stability, error);
}

static pel_status check_dt_here(pel_sim *sim, pel_error *error)
{
    pel_stability stability;
    pel_stability_bound(sim->model, &stability);
    pel_shell_stability_bound(sim->shells, &stability);
    bool symplectic = sim->solver.symplectic;
    if (sim->step.dt <= pel_stability_dt(&stability, stability.stiffness_bound, symplectic))
        return PEL_OK;
    pel_status status = pel_sim_refine_stability(sim, &stability, error);
    if (status != PEL_OK)
        return status;
    double limit = pel_stability_dt(&stability, stability.stiffness, symplectic);
    if (sim->step.dt <= limit)
        return PEL_OK;
    if (limit > 0)
        return refuse_dt(sim, limit, error);
    return pel_refuse(error, PEL_UNSTABLE, "give the springs a damping above 0, or use the symplectic integrator",
                      "forward Euler is unstable at every dt without damping");
}

/* on the base and, where a body refines, on its finest level too */
static pel_status check_dt(pel_sim *sim, pel_error *error)
{
    pel_status status = check_dt_here(sim, error);
    if (status != PEL_OK || sim->active == NULL)
        return status;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        pel_refine_everywhere(sim, b, true);
    status = check_dt_here(sim, error);
    for (int32_t b = 0; b < sim->model->body_count; b++)
        pel_refine_everywhere(sim, b, false);
    if (status == PEL_UNSTABLE && error != NULL) {
        double limit = sim->step.dt;
        pel_fail_remedy(error,
                        "the finest level of detail needs a smaller dt than %g: make it smaller, or use fewer "
                        "levels, or the quasi-static method",
                        limit);
    }
    return status;
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

static pel_status step(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    (void)error;
    double dt = sim->step.dt;
    pel_wind_begin(sim);
    const pel_gains gains = {sim->step.symplectic ? dt * dt : 0, dt};
    pel_step_explicit(sim->model, sim->state, &sim->step, result);
    const pel_span span = pel_loads_kick_span(sim, pel_sim_time(sim));
    result->diverged |= !pel_loads_apply(sim, span, gains);
    pel_shells_apply(sim, span, gains);
    pel_wind_apply(sim, gains.position / gains.velocity);
    pel_ties_apply(sim, gains.position / gains.velocity);
    if (sim->shells != NULL || sim->solver.drag > 0)
        correct_velocities(sim);
    result->way_is_known &=
        !pel_loads_exist(sim) && sim->shells == NULL && sim->ties == NULL && !(sim->solver.drag > 0);
    result->diverged |= sim->shells != NULL && !pel_sim_all_inside(sim);
    return PEL_OK;
}

static void advise(const pel_sim *sim, pel_error *error)
{
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
