/* A step of a simulation, and of others beside it with the matrix at its end (newton/beside.c). */
#include "gradient/step_beside.h"

#include "base/status.h"
#include "boundary/loads.h"
#include "constraint/frame.h"
#include "gradient/adjoint.h"
#include "minimise/step_newton.h"
#include "minimise/step_path.h"
#include "tool/tool.h"

#include <string.h>

static pel_status check_method(const pel_sim *sim, pel_error *error)
{
    const char *what = !sim->stepper->turns_edges || sim->modes != NULL ? "methods other than static and implicit"
                       : sim->tools->count > 0                          ? "tools"
                       : sim->contacts != NULL                          ? "contact"
                       : sim->minimise->newton->viscous != NULL         ? "damping of the material"
                       : sim->loads->fluid_count > 0                    ? "fluids"
                       : sim->loads->wind != NULL                       ? "wind"
                       : sim->rigids != NULL                            ? "rigid bodies"
                       : sim->active != NULL                            ? "refinement"
                       : sim->cuts_done < sim->def.cut_count            ? "cuts"
                       : sim->tear != NULL                              ? "a toughness or seams"
                       : sim->state->plastic.folds != NULL || sim->state->plastic.flows != NULL
                           ? "sheets that yield or grow"
                       : sim->solver.budget > 0 ? "a budget of time"
                                                : NULL;
    if (what == NULL)
        return PEL_OK;
    return pel_refuse(error, PEL_BAD_ARGUMENT, "take derivatives by differences of whole runs",
                      "derivatives along the steps do not support %s", what);
}

static bool match(const pel_sim *sim, const pel_sim *other)
{
    const pel_model *a = sim->model, *b = other->model;
    const pel_newton *own = sim->newton, *its = other->newton;
    bool same = a->vertex_count == b->vertex_count && a->body_count == b->body_count &&
                sim->solver.method == other->solver.method && sim->step.dt == other->step.dt &&
                sim->state->step == other->state->step && (sim->path != NULL) == (other->path != NULL) &&
                pel_newton_pattern(own)->unknown_count == pel_newton_pattern(its)->unknown_count;
    same = same && (sim->path == NULL || sim->path->ended == other->path->ended);
    for (int32_t v = 0; same && v < a->vertex_count; v++)
        same = a->mesh_vertex[v] == b->mesh_vertex[v] &&
               a->body_of_slice[v / PEL_WIDTH] == b->body_of_slice[v / PEL_WIDTH];
    return same;
}

pel_status pel_sim_check_beside(const pel_sim *sim, pel_sim *const *beside, int32_t count, pel_error *error)
{
    pel_status status = check_method(sim, error);
    if (status == PEL_OK && count > 0)
        PEL_REFUSE_NULL(beside, error);
    for (int32_t i = 0; status == PEL_OK && i < count; i++) {
        PEL_REFUSE_NULL(beside[i], error);
        status = check_method(beside[i], error);
        if (status == PEL_OK && (beside[i] == sim || !match(sim, beside[i])))
            return pel_refuse(error, PEL_BAD_ARGUMENT,
                              "make them of scenes that differ by numbers alone, and step them together from the start",
                              "simulations beside each other have other bodies, methods, dt or numbers of steps");
    }
    return status;
}

/* A whole step: parts of two simulations would not match. */
static pel_status step_whole(pel_sim *sim, pel_error *error)
{
    bool could_halve = sim->part.can_halve;
    sim->part.can_halve = false;
    pel_status status = pel_sim_step(sim, error);
    sim->part.can_halve = could_halve;
    return status;
}

static pel_status step_lead(pel_sim *sim, pel_error *error)
{
    pel_status status = step_whole(sim, error);
    return status == PEL_OK ? pel_adjoint_check_step(sim, error) : status;
}

pel_status pel_sim_step_beside(pel_sim *sim, pel_sim *const *beside, int32_t count, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    pel_status status = pel_sim_check_beside(sim, beside, count, error);
    if (status != PEL_OK)
        return status;
    pel_sim_newton *newton = sim->minimise->newton;
    bool has_ended = sim->path != NULL && sim->path->ended != PEL_PATH_GOES_ON;
    newton->leads = count > 0;
    status = step_lead(sim, error);
    newton->leads = false;
    pel_newton_problem problem;
    pel_minimise_context context = {.sim = sim};
    const pel_newton_terms terms = pel_sim_newton_terms(&context);
    pel_newton_lead lead = {
        .newton = sim->newton, .problem = &problem, .path = sim->path != NULL ? &sim->path->path : NULL};
    if (status == PEL_OK && !has_ended && count > 0) {
        pel_adjoint_take_problem(sim, newton->point_stiffness != NULL ? 1 / sim->minimise->acts.time : 1, &problem);
        context.span = problem.span;
        problem.terms = pel_sim_newton_has_terms(sim) ? &terms : NULL;
        lead.unknowns = newton->unknowns;
        status = pel_newton_take_lead(&lead, error);
    }
    for (int32_t i = 0; status == PEL_OK && i < count; i++) {
        pel_sim_newton *other = beside[i]->minimise->newton;
        other->lead = &lead;
        other->scheme = newton->scheme;
        status = step_whole(beside[i], error);
        other->lead = NULL;
        if (beside[i]->path != NULL)
            beside[i]->path->ended = sim->path->ended;
    }
    return status;
}
