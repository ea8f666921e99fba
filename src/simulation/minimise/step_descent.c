/* The method `descent`: L-BFGS (solve/descent.h) in the frame of constraint/frame.h. If all bodies are held and nothing
   touches, the factored Hessian is the preconditioner. */
#include "base/assert.h"
#include "base/pool.h"
#include "base/status.h"
#include "constraint/constraint.h"
#include "minimise/free_body.h"
#include "minimise/rounds.h"
#include "minimise/step_newton.h"

static pel_status run_minimiser(pel_minimise_context *context, const pel_descent_problem *problem,
                                pel_descent_result *result, pel_error *error)
{
    pel_sim *sim = context->sim;
    pel_descent_problem own = *problem;
    if (sim->minimise->newton != NULL && sim->minimise->count == 0 && pel_sim_newton_approximate(context))
        own.precondition = pel_sim_newton_precondition;
    pel_descent_run(sim->minimise->minimiser, &own, sim->minimise->position, result);
    return pel_pool_check(sim->pool, error);
}

static pel_status create(pel_sim *sim, pel_error *error)
{
    pel_status status = pel_minimise_create(sim, run_minimiser, error);
    if (status == PEL_OK)
        status = pel_descent_create(sim->model->vertex_count, &sim->minimise->minimiser, error);
    /* a matrix pattern is valid for one surface */
    if (status == PEL_OK && sim->active == NULL && !sim->solver.gradient_only)
        status = pel_sim_newton_create(sim, false, error);
    if (status == PEL_OK && sizeof(pel_real) < sizeof(double))
        status = pel_tangent_create(sim->model, &sim->minimise->tangent, error);
    return status;
}

static void follow_surface(pel_sim *sim)
{
    pel_minimise_follow_surface(sim);
    if (sim->minimise->tangent != NULL)
        pel_tangent_rebuild(sim->minimise->tangent);
}

static void get_held_force(const pel_sim *sim, int32_t v, double force[3])
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    pel_vec3_copy(pel_descent_force(sim->minimise->minimiser) + 3 * (size_t)v, force);
}

static void advise(const pel_sim *sim, pel_error *error)
{
    (void)sim;
    pel_fail_remedy(error, "make the loads smaller, or let them grow over more steps (keys)");
}

const pel_stepper pel_step_descent_kind = {
    .is_at_end = true,
    .seeks_rest = true,
    .moves_tools = true,
    .create = create,
    .check_start = pel_minimise_check_start,
    .minimises = true,
    .descends = true,
    .energy_remedy = "raise solver.iterations, or let loads and tools move over more steps",
    .step = pel_minimise_step,
    .read_tools = pel_minimise_read_tools,
    .follow_surface = follow_surface,
    .get_held_force = get_held_force,
    .mark_contacts = pel_minimise_contacts_mark,
    .accept = pel_minimise_accept,
    .get_solver = pel_minimise_get_solver,
    .advise = advise,
};
