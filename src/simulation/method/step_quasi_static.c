/* x += alpha F dt^2 / m (paper A, eq. A-5); fine vertices in stages (relax.c). */
#include "base/status.h"
#include "boundary/loads.h"
#include "method/relax.h"
#include "method/step_explicit.h"
#include "solve/shell_stability.h"
#include "stage/accessors.h"
#include "stage/shells.h"

/* share of the stability limit that the automatic alpha takes */
#define SAFE_SHARE 0.9

static pel_status refuse_alpha(const pel_sim *sim, pel_error *error)
{
    pel_fail(error, PEL_UNSTABLE, "alpha %.6g is unstable on this mesh: the limit is %.6g", sim->step.alpha,
             sim->alpha_limit);
    pel_fail_remedy(error, "use at most %.4g, or leave alpha out for a safe value", SAFE_SHARE * sim->alpha_limit);
    return PEL_UNSTABLE;
}

static double limit_alpha(const pel_sim *sim, const pel_stability *stability, double stiffness)
{
    const pel_solver_def *solver = &sim->solver;
    double limit = pel_stability_alpha(stability, stiffness, solver->dt, solver->keep_velocity);
    /* x' = x - a K x + m (x - x_before) is stable below a K = 2 (1 + m); drag takes from m */
    return solver->keep_velocity ? limit : (1 + solver->momentum) * limit;
}

/* the safe bound decides most cases; only beyond it the true limit is worth its cost */
static pel_status choose_alpha(pel_sim *sim, pel_error *error)
{
    const pel_solver_def *solver = &sim->solver;
    pel_stability stability;
    pel_stability_bound(sim->model, &stability);
    pel_shell_stability_bound(sim->shells, &stability);
    sim->alpha_limit = limit_alpha(sim, &stability, stability.stiffness_bound);
    sim->step.momentum = solver->momentum;
    sim->step.alpha = solver->alpha > 0 ? solver->alpha : SAFE_SHARE * sim->alpha_limit;
    if (!isfinite(sim->step.alpha))
        sim->step.alpha = 1;
    if (sim->step.alpha < sim->alpha_limit)
        return PEL_OK;
    pel_status status = pel_sim_refine_stability(sim, &stability, error);
    if (status != PEL_OK)
        return status;
    sim->alpha_limit = limit_alpha(sim, &stability, stability.stiffness);
    if (sim->step.alpha >= sim->alpha_limit)
        return refuse_alpha(sim, error);
    return PEL_OK;
}

static pel_status create(pel_sim *sim, pel_error *error)
{
    if (sim->active != NULL && sim->solver.momentum > 0)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "leave momentum out, or refine", "momentum in bodies that refine");
    pel_status status = choose_alpha(sim, error);
    return status == PEL_OK && sim->active != NULL ? pel_sim_relax_create(sim, error) : status;
}

static pel_status step(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    (void)error;
    const pel_gains gains = {sim->step.alpha * sim->step.dt * sim->step.dt, 0};
    pel_step_quasi_static(sim->model, sim->state, &sim->step, result);
    const pel_span span = pel_instant(pel_sim_time(sim));
    result->diverged |= !pel_loads_apply(sim, span, gains);
    pel_shells_apply(sim, span, gains);
    result->diverged |= sim->shells != NULL && !pel_sim_all_inside(sim);
    result->diverged |= !pel_sim_relax(sim);
    result->way_is_known &= !pel_loads_exist(sim) && sim->shells == NULL && sim->active == NULL;
    return PEL_OK;
}

static void advise(const pel_sim *sim, pel_error *error)
{
    pel_fail_remedy(error, "make solver alpha (%g) smaller, or the loads", sim->step.alpha);
}

const pel_stepper pel_step_quasi_static_kind = {
    .relaxes = true,
    .bounds_motion = true,
    .can_refill = true,
    .create = create,
    .step = step,
    .advise = advise,
};
