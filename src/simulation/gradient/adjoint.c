/* Derivatives of a function of the positions by the numbers of the model, from one adjoint solution (newton/newton.h).

   With m the multipliers and the gradient g = dE/dx - F: a load F changes f by m . dF, a number p of the elements by -m
   . dg/dp. Vertices held at their rest positions move with them. In a step of the method implicit x_1 = e y + (1 - e)
   x_0 with the unknowns y of the step, whose matrix includes the inertia. The second stage of a step depends on the
   first one, which has a solution of its own. */
#include "gradient/adjoint.h"

#include "attach/tie.h"
#include "base/memory.h"
#include "base/status.h"
#include "boundary/edge_load.h"
#include "boundary/fluid.h"
#include "boundary/follower.h"
#include "boundary/loads.h"
#include "boundary/wind.h"
#include "constraint/frame.h"
#include "force/pressure.h"
#include "minimise/step_newton.h"
#include "stage/surface_view.h"
#include "tool/tool.h"

#include <string.h>

static pel_status check_rest(const pel_sim *sim, pel_error *error)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        bool has_volume = body->shell != NULL && (body->shell->pressure.kind == PEL_PRESSURE_GAS ||
                                                  body->shell->pressure.kind == PEL_PRESSURE_VOLUME);
        bool has_hinges = body->shell != NULL && body->shell->bending->has_hinges;
        bool is_filled = body->shell != NULL && body->shell->tetrahedron_count > 0;
        if (is_filled || body->plain_spring != 0 || body->has_volumetric || has_volume || has_hinges ||
            (body->shell != NULL && body->shell->region_count > 0))
            return pel_refuse(
                error, PEL_BAD_ARGUMENT,
                "remove volumes, springs, fibres, enclosed gas and target volume, use bending model midedge, or do not "
                "ask for rest_positions",
                "derivatives with respect to rest positions exist only for membranes and mid-edge bending");
    }
    return PEL_OK;
}

pel_status pel_adjoint_check_step(const pel_sim *sim, pel_error *error)
{
    if (sim->minimise->accepted.converged)
        return PEL_OK;
    pel_fail(error, PEL_BAD_ARGUMENT, "the step that ends at %.6g s does not converge: it has no derivatives",
             pel_sim_time(sim));
    pel_fail_remedy(error, "make solver dt (%g) smaller, or the loads", sim->step.dt);
    return PEL_BAD_ARGUMENT;
}

pel_status pel_adjoint_check(const pel_sim *sim, const pel_adjoint *def, pel_error *error)
{
    if (!sim->stepper->turns_edges || sim->modes != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "use one of them, without an analysis",
                          "derivatives exist only for the methods static and implicit");
    if (sim->state->plastic.folds != NULL || sim->state->plastic.flows != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT,
                          "take derivatives by differences of whole runs, or leave `yield` and `rest_scale` out",
                          "what yields or grows has no derivatives");
    if (sim->rigids != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "take derivatives by differences of whole runs",
                          "rigid bodies have no derivatives");
    if (sim->minimise->newton->viscous != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "set `damping` of membranes, bending and springs to 0, or use drag",
                          "damping of the material has no derivatives");
    if (sim->tools->count > 0 || sim->contacts != NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "remove tools and contact",
                          "derivatives exist only without tools and contact");
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        if (def->materials != NULL && shell != NULL && shell->bends_as_membrane && shell->bending->has_hinges &&
            pel_law_is_oriented(pel_membrane_law_traits(shell->law.kind)))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", b,
                                      "use the bending model midedge, or give bending.stiffness",
                                      "hinges of an orthotropic membrane have no derivative by its moduli");
        if (!pel_shell_has_potential(&sim->model->bodies[b]))
            return pel_refuse(error, PEL_BAD_ARGUMENT,
                              "use the consistent form on a closed body, and fibres of another mode",
                              "pressure on a part of a surface or in the form vertex-normal, and fibres of the mode "
                              "normal, have no potential");
    }
    if (sim->loads->fluid_count > 0)
        return pel_fluids_refuse(sim, "a derivative", error);
    if (sim->loads->wind != NULL)
        return pel_wind_refuse(sim, "a derivative", error);
    if (sim->ties != NULL)
        return pel_ties_refuse("a derivative", error);
    if (sim->loads->follower_count > 0)
        return pel_followers_refuse(sim, "derivatives need", error);
    return def->rest_positions != NULL ? check_rest(sim, error) : PEL_OK;
}

/* ---- the problem of the present state ---- */

/* the unknowns y of the last step, with edges as they bend least at these */
static void take_state(pel_sim *sim, double end)
{
    const pel_state *state = sim->state;
    double *unknowns = sim->minimise->newton->unknowns;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            double now = (double)state->position[v][k], before = (double)state->position_before[v][k];
            bool moves = state->position[v][3] > 0;
            unknowns[3 * v + k] = moves ? (now - (1 - end) * before) / end : now;
        }
    pel_sim_newton_settle_at(sim);
}

void pel_adjoint_take_problem(pel_sim *sim, double end, pel_newton_problem *problem)
{
    pel_sim_newton *newton = sim->minimise->newton;
    bool is_dynamic = newton->point_stiffness != NULL;
    double dt = sim->step.dt;
    const pel_span acts = sim->minimise->acts;
    take_state(sim, end);
    *problem = (pel_newton_problem){
        .span = {pel_sim_time(sim) - (1 - 1 / end) * dt, acts.back * dt, acts.ahead * dt, acts.extrapolates},
        .state = sim->state,
        .force = newton->loads,
        .load_factor = &sim->state->load_factor,
        .point_stiffness = newton->point_stiffness,
        .points = (const double(*)[3])newton->points,
        .fixed = newton->fixed,
        .target = newton->target,
        .frames = newton->frames,
        .is_dynamic = is_dynamic,
    };
    memcpy(sim->state->position_next, sim->state->position,
           (size_t)sim->model->vertex_count * sizeof *sim->state->position);
}

/* the same of the first stage of that step, after the whole step's */
static void take_first(pel_sim *sim, const pel_implicit_scheme *first, pel_newton_problem *problem)
{
    pel_sim_newton *newton = sim->minimise->newton;
    const pel_span acts = first->acts;
    double dt = sim->step.dt;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        pel_vertex_position(newton->stage[0], v, newton->unknowns + 3 * (size_t)v);
    pel_sim_newton_settle_at(sim);
    problem->span = (pel_span){pel_sim_time(sim) - (1 - acts.time) * dt, acts.back * dt, acts.ahead * dt, false};
}

/* ---- results ---- */

/* adds to rows of vertices as the caller has them */
static void add_rows(const pel_sim *sim, const double *from, double *rows)
{
    size_t row = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        for (int32_t r = 0; r < pel_output_count(sim, b); r++, row++) {
            const double *x = from + 3 * (size_t)pel_output_model_index(sim, b, r);
            for (int k = 0; k < 3; k++)
                rows[3 * row + (size_t)k] += x[k];
        }
}

static size_t count_rows(const pel_sim *sim)
{
    size_t count = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        count += (size_t)pel_output_count(sim, b);
    return count;
}

static void clear(double *values, size_t count)
{
    if (values != NULL)
        memset(values, 0, count * sizeof *values);
}

static void clear_results(const pel_sim *sim, const pel_adjoint *def)
{
    clear(def->forces, 3 * count_rows(sim));
    clear(def->rest_positions, 3 * count_rows(sim));
    clear(def->loads, (size_t)sim->loads->count);
    clear(def->gravity, 3);
    for (int32_t b = 0; def->materials != NULL && b < sim->model->body_count; b++)
        def->materials[b] = (pel_adjoint_material){0};
}

/* of the positions; where a vertex is held they are its place */
static void take_gradient(pel_adjoint_work *a, double end)
{
    const pel_sim *sim = a->sim;
    size_t row = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        for (int32_t r = 0; r < pel_output_count(sim, b); r++, row++) {
            int32_t v = pel_output_model_index(sim, b, r);
            bool moves = sim->model->inverse_mass[v] > 0;
            for (int k = 0; k < 3; k++)
                a->gradient[3 * (size_t)v + (size_t)k] = (moves ? end : 1) * a->def->positions[3 * row + (size_t)k];
        }
}

/* by a factor on each load, and by gravity */
static void give_loads(const pel_adjoint_work *a)
{
    const pel_sim *sim = a->sim;
    size_t edges = 3 * (size_t)sim->model->vertex_count;
    for (int32_t l = 0; a->def->loads != NULL && l < sim->loads->count; l++)
        a->def->loads[l] += pel_load_product(sim, l, a->problem.span, a->multipliers) +
                            pel_edge_load_product(sim, l, a->problem.span, a->multipliers + edges);
    for (int k = 0; a->def->gravity != NULL && k < 3; k++)
        for (int32_t v = 0; v < sim->model->vertex_count; v++)
            a->def->gravity[k] += sim->state->load_factor * (double)sim->model->mass[v] * a->multipliers[3 * v + k];
}

static void give_materials(const pel_adjoint_work *a)
{
    for (int32_t b = 0; b < a->sim->model->body_count; b++) {
        const pel_tangent_derivative *sum = &a->bodies[b];
        const pel_shell *shell = a->sim->model->bodies[b].shell;
        /* bending follows young and thickness where the def does not set it */
        bool follows = shell != NULL && shell->bends_as_membrane;
        /* of oriented laws the sum by Poisson's ratio has that of bending */
        bool is_known = follows && !pel_law_is_oriented(pel_membrane_law_traits(shell->law.kind));
        double bending = follows ? sum->bending : 0, poisson = is_known ? shell->law.poisson : 0;
        pel_adjoint_material *result = &a->def->materials[b];
        result->young -= sum->membrane + bending;
        result->thickness -= sum->membrane + 3 * bending;
        result->poisson -= sum->poisson + bending * 2 * poisson / (1 - poisson * poisson);
        result->bending -= sum->bending;
        result->pressure -= sum->pressure;
        result->volume -= sum->volume;
    }
}

/* elements, and held vertices at their rest positions */
static void give_rest(const pel_adjoint_work *a)
{
    for (int32_t i = 0; i < 3 * a->sim->model->vertex_count; i++)
        a->rest[i] = a->held[i] - a->rest[i];
    add_rows(a->sim, a->rest, a->def->rest_positions);
}

/* ---- all ---- */

pel_status pel_adjoint_begin(pel_adjoint_work *a, pel_sim *sim, const pel_adjoint *def, pel_error *error)
{
    size_t count = (size_t)pel_newton_pattern(sim->newton)->unknown_count;
    *a = (pel_adjoint_work){.sim = sim, .def = def};
    double **vectors[] = {&a->unknowns, &a->gradient, &a->multipliers, &a->held, &a->rest};
    bool room = true;
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        room &= (*vectors[i] = pel_allocate(count, sizeof **vectors[i])) != NULL;
    a->bodies = pel_allocate((size_t)sim->model->body_count, sizeof *a->bodies);
    if (!room || a->bodies == NULL)
        return pel_fail_memory(error);
    clear_results(sim, def);
    return PEL_OK;
}

void pel_adjoint_end(pel_adjoint_work *a)
{
    double *vectors[] = {a->unknowns, a->gradient, a->multipliers, a->held, a->rest};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        pel_free(vectors[i]);
    pel_free(a->bodies);
}

/* of the problem that was taken */
static pel_status solve(pel_adjoint_work *a, pel_error *error)
{
    const pel_adjoint *def = a->def;
    pel_sim *sim = a->sim;
    pel_newton *newton = sim->newton;
    memcpy(a->unknowns, sim->minimise->newton->unknowns,
           (size_t)pel_newton_pattern(newton)->unknown_count * sizeof(double));
    /* loads and places may have changed since */
    a->problem.frames = pel_sim_newton_gather_at(sim, a->problem.span, !a->problem.is_dynamic);
    pel_minimise_context context = {.sim = sim, .span = a->problem.span};
    const pel_newton_terms terms = pel_sim_newton_terms(&context);
    if (pel_sim_newton_has_terms(sim))
        a->problem.terms = &terms;
    pel_status status =
        pel_newton_adjoint(newton, &a->problem, a->unknowns, a->gradient, a->multipliers, a->held, error);
    a->problem.terms = NULL;
    if (status != PEL_OK)
        return status;
    if (def->forces != NULL)
        add_rows(sim, a->multipliers, def->forces);
    give_loads(a);
    memset(a->bodies, 0, (size_t)sim->model->body_count * sizeof *a->bodies);
    memset(a->rest, 0, 3 * (size_t)sim->model->vertex_count * sizeof *a->rest);
    if (def->materials != NULL || def->rest_positions != NULL)
        pel_tangent_derivatives(pel_newton_tangent(newton), a->multipliers, a->bodies,
                                def->rest_positions != NULL ? a->rest : NULL);
    if (def->materials != NULL)
        give_materials(a);
    if (def->rest_positions != NULL)
        give_rest(a);
    return PEL_OK;
}

pel_status pel_adjoint_solve(pel_adjoint_work *a, double end, pel_error *error)
{
    pel_adjoint_take_problem(a->sim, end, &a->problem);
    return solve(a, error);
}

pel_status pel_adjoint_solve_first(pel_adjoint_work *a, const pel_implicit_scheme *first, pel_error *error)
{
    take_first(a->sim, first, &a->problem);
    return solve(a, error);
}

/* by the unknowns of the first stage, from the multipliers of the second one: its anchor and what it carries */
static void take_gradient_of_first(pel_adjoint_work *a, const pel_implicit_scheme *second)
{
    const pel_sim *sim = a->sim;
    const double *stiffness = sim->minimise->newton->point_stiffness;
    double rate = second->rate / sim->step.dt, rate_of_first = second->first->rate / sim->step.dt;
    memset(a->gradient, 0, (size_t)pel_newton_pattern(sim->newton)->unknown_count * sizeof *a->gradient);
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        double mass = sim->model->inverse_mass[v] > 0 ? (double)sim->model->mass[v] : 0;
        double share = second->position[1] * stiffness[v] + second->velocity[1] * rate_of_first * mass * rate;
        for (int32_t u = 3 * v; mass > 0 && u < 3 * v + 3; u++)
            a->gradient[u] = share * a->multipliers[u];
    }
}

static pel_status check_state(const pel_sim *sim, const pel_adjoint *def, pel_error *error)
{
    pel_status status = pel_adjoint_check(sim, def, error);
    if (status == PEL_OK && def->positions == NULL)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "fill positions",
                          "the derivative of the function with respect to the positions is missing");
    const pel_sim_newton *newton = sim->minimise != NULL ? sim->minimise->newton : NULL;
    bool has_no_step = newton != NULL && newton->point_stiffness != NULL && !newton->has_stepped;
    if (status == PEL_OK && (sim->state->step == 0 || has_no_step))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "step first",
                          "there is no state yet whose derivatives could be computed");
    return status;
}

pel_status pel_sim_adjoint(pel_sim *sim, const pel_adjoint *def, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(def, error);
    pel_status status = check_state(sim, def, error);
    if (status != PEL_OK)
        return status;
    pel_adjoint_work a;
    const pel_implicit_scheme *s = sim->minimise->newton->scheme; /* null in statics */
    double end = s != NULL ? s->end : 1;
    status = pel_adjoint_begin(&a, sim, def, error);
    if (status == PEL_OK) {
        take_gradient(&a, end);
        status = pel_adjoint_solve(&a, end, error);
    }
    if (status == PEL_OK && s != NULL && s->first != NULL) {
        take_gradient_of_first(&a, s);
        status = pel_adjoint_solve_first(&a, s->first, error);
    }
    pel_adjoint_end(&a);
    return status;
}
