/* Derivatives of a function of the positions by the numbers of the model, from one adjoint solution (solve/newton.h).

   With m the multipliers and the gradient g = dE/dx - F: a load F changes f by m . dF, a number p of the elements by
   -m . dg/dp. Vertices that are held where they were at rest go along with their rest positions. In a step of the
   method implicit x_1 = e y + (1 - e) x_0 with the unknowns y of the step, whose matrix has the inertia in it. */
#include "base/memory.h"
#include "base/status.h"
#include "force/pressure.h"
#include "sim/edge_load.h"
#include "sim/follower.h"
#include "sim/step_newton.h"

#include <string.h>

/* scratch */
typedef struct work {
    pel_sim *sim;
    const pel_adjoint *def;
    pel_newton_problem problem;
    double end;                                /* x_1 over y */
    double *unknowns, *gradient, *multipliers; /* (unknown_count) */
    double *held, *rest;                       /* (unknown_count) */
    pel_tangent_derivative *bodies;            /* (body_count) */
} work;

static pel_status refuse(pel_error *error, const char *what, const char *remedy)
{
    pel_fail(error, PEL_BAD_ARGUMENT, "%s", what);
    pel_fail_remedy(error, "%s", remedy);
    return PEL_BAD_ARGUMENT;
}

static pel_status check_rest(const pel_sim *sim, pel_error *error)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        bool has_volume = body->shell != NULL && (body->shell->pressure.kind == PEL_PRESSURE_GAS ||
                                                  body->shell->pressure.kind == PEL_PRESSURE_VOLUME);
        bool has_hinges = body->shell != NULL && body->shell->bending != PEL_BENDING_MIDEDGE &&
                          body->shell->bending != PEL_BENDING_OFF;
        if (body->plain_spring != 0 || body->has_volumetric || has_volume || has_hinges ||
            (body->shell != NULL && body->shell->region_count > 0))
            return refuse(
                error, "derivatives by rest positions are those of membranes and mid-edge bending",
                "remove springs, fibres, enclosed gas and target volume, use bending model midedge, or do not "
                "ask for rest_positions");
    }
    return PEL_OK;
}

static pel_status check(const pel_sim *sim, const pel_adjoint *def, pel_error *error)
{
    if (!sim->stepper->turns_edges || sim->modes != NULL)
        return refuse(error, "derivatives are those of the methods static and implicit",
                      "use one of them, without an analysis");
    if (sim->tool_count > 0 || sim->contacts != NULL)
        return refuse(error, "derivatives are those of bodies without tools and contact", "remove tools and contact");
    if (def->positions == NULL)
        return refuse(error, "the derivative of the function by the positions is missing", "fill positions");
    if (sim->state->step == 0)
        return refuse(error, "there is no state to take derivatives of yet", "step first");
    for (int32_t b = 0; b < sim->model->body_count; b++)
        if (sim->model->bodies[b].shell != NULL && !pel_pressure_is_conservative(&sim->model->bodies[b]))
            return refuse(error, "pressure on a part of a surface, or in the form vertex-normal, has no potential",
                          "use the consistent form on a closed body");
    if (sim->follower_count > 0)
        return pel_followers_refuse(sim, "derivatives need", error);
    return def->rest_positions != NULL ? check_rest(sim, error) : PEL_OK;
}

/* ---- the problem of the present state ---- */

/* the unknowns y of the last step, with edges as they bend least */
static void take_state(work *a)
{
    pel_sim *sim = a->sim;
    const pel_state *state = sim->state;
    const double *settled;
    pel_sim_settle_edges(sim, &settled);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            double now = (double)state->position[v][k], before = (double)state->position_before[v][k];
            sim->descent->newton->unknowns[3 * v + k] = (now - (1 - a->end) * before) / a->end;
        }
}

static void make_problem(work *a)
{
    pel_sim *sim = a->sim;
    pel_sim_newton *newton = sim->descent->newton;
    bool is_dynamic = newton->point_stiffness != NULL;
    double time = pel_sim_time(sim) - (1 - sim->descent->force_time) * sim->step.dt;
    a->end = is_dynamic ? 1 / sim->descent->force_time : 1;
    take_state(a);
    memcpy(a->unknowns, newton->unknowns, (size_t)pel_newton_pattern(newton->newton)->unknown_count * sizeof(double));
    a->problem = (pel_newton_problem){
        .time = time,
        .state = sim->state,
        .force = newton->loads,
        .load_factor = &sim->state->load_factor,
        .point_stiffness = newton->point_stiffness,
        .points = (const double(*)[3])newton->points,
        .fixed = newton->fixed,
        .target = newton->target,
        .is_dynamic = is_dynamic,
    };
    memcpy(sim->state->position_next, sim->state->position,
           (size_t)sim->model->vertex_count * sizeof *sim->state->position);
    a->problem.frames = pel_sim_newton_gather_at(sim, time, !is_dynamic);
}

/* ---- results ---- */

/* rows of vertices as the caller has them */
static void for_each_row(const pel_sim *sim, const double *from, double scale, double *rows)
{
    size_t row = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        for (int32_t r = 0; r < pel_output_count(sim, b); r++, row++) {
            const double *x = from + 3 * (size_t)pel_output_model_index(sim, b, r);
            for (int k = 0; k < 3; k++)
                rows[3 * row + (size_t)k] = scale * x[k];
        }
}

static void take_gradient(work *a)
{
    const pel_sim *sim = a->sim;
    size_t row = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        for (int32_t r = 0; r < pel_output_count(sim, b); r++, row++)
            for (int k = 0; k < 3; k++)
                a->gradient[3 * (size_t)pel_output_model_index(sim, b, r) + (size_t)k] =
                    a->end * a->def->positions[3 * row + (size_t)k];
}

/* by a factor on each load, and by gravity */
static void give_loads(const work *a)
{
    const pel_sim *sim = a->sim;
    size_t edges = 3 * (size_t)sim->model->vertex_count;
    for (int32_t l = 0; a->def->loads != NULL && l < sim->load_count; l++)
        a->def->loads[l] = pel_load_product(sim, l, a->problem.time, a->multipliers) +
                           pel_edge_load_product(sim, l, a->problem.time, a->multipliers + edges);
    for (int k = 0; a->def->gravity != NULL && k < 3; k++) {
        a->def->gravity[k] = 0;
        for (int32_t v = 0; v < sim->model->vertex_count; v++)
            a->def->gravity[k] += sim->state->load_factor * (double)sim->model->mass[v] * a->multipliers[3 * v + k];
    }
}

/* bending that goes with young and thickness, as left out in the def */
static bool bending_follows(const pel_shell *shell)
{
    pel_membrane_material material = shell->material;
    const pel_shell_triangle *first = &shell->triangles[0];
    if (!shell->has_membrane || (shell->parts == NULL && shell->hinge_count == 0))
        return false;
    double stiffness = shell->parts != NULL ? shell->parts[0].stiffness : shell->hinges[0].stiffness;
    double own = pel_bending_stiffness(first->young, pel_membrane_law_of(&material).poisson, first->thickness);
    return fabs(stiffness - own) <= 1e-9 * own;
}

static void give_materials(const work *a)
{
    for (int32_t b = 0; b < a->sim->model->body_count; b++) {
        const pel_tangent_derivative *sum = &a->bodies[b];
        const pel_shell *shell = a->sim->model->bodies[b].shell;
        double bending = shell != NULL && bending_follows(shell) ? sum->bending : 0, poisson = 0;
        if (bending != 0) {
            pel_membrane_material material = shell->material;
            poisson = pel_membrane_law_of(&material).poisson;
        }
        a->def->materials[b] = (pel_adjoint_material){
            .young = -sum->membrane - bending,
            .thickness = -sum->membrane - 3 * bending,
            .poisson = -sum->poisson - bending * 2 * poisson / (1 - poisson * poisson),
            .bending = -sum->bending,
            .pressure = -sum->pressure,
        };
    }
}

/* elements, and what is held where it was at rest */
static void give_rest(const work *a)
{
    for (int32_t i = 0; i < 3 * a->sim->model->vertex_count; i++)
        a->rest[i] = a->held[i] - a->rest[i];
    for_each_row(a->sim, a->rest, 1, a->def->rest_positions);
}

/* ---- all ---- */

static bool make_room(work *a)
{
    size_t count = (size_t)pel_newton_pattern(a->sim->descent->newton->newton)->unknown_count;
    double **vectors[] = {&a->unknowns, &a->gradient, &a->multipliers, &a->held, &a->rest};
    bool room = true;
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        room &= (*vectors[i] = pel_allocate(count, sizeof **vectors[i])) != NULL;
    a->bodies = pel_allocate((size_t)a->sim->model->body_count, sizeof *a->bodies);
    return room && a->bodies != NULL;
}

static void release(work *a)
{
    double *vectors[] = {a->unknowns, a->gradient, a->multipliers, a->held, a->rest};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        pel_free(vectors[i]);
    pel_free(a->bodies);
}

static pel_status solve(work *a, pel_error *error)
{
    const pel_adjoint *def = a->def;
    pel_newton *newton = a->sim->descent->newton->newton;
    make_problem(a);
    take_gradient(a);
    pel_status status =
        pel_newton_adjoint(newton, &a->problem, a->unknowns, a->gradient, a->multipliers, a->held, error);
    if (status != PEL_OK)
        return status;
    if (def->forces != NULL)
        for_each_row(a->sim, a->multipliers, 1, def->forces);
    give_loads(a);
    if (def->materials != NULL || def->rest_positions != NULL)
        pel_tangent_derivatives(pel_newton_tangent(newton), a->multipliers, a->bodies,
                                def->rest_positions != NULL ? a->rest : NULL);
    if (def->materials != NULL)
        give_materials(a);
    if (def->rest_positions != NULL)
        give_rest(a);
    return PEL_OK;
}

pel_status pel_sim_adjoint(pel_sim *sim, const pel_adjoint *def, pel_error *error)
{
    PEL_REFUSE_NULL(sim, error);
    PEL_REFUSE_NULL(def, error);
    pel_status status = check(sim, def, error);
    if (status != PEL_OK)
        return status;
    work a = {.sim = sim, .def = def};
    status = make_room(&a) ? solve(&a, error) : pel_fail_memory(error);
    release(&a);
    return status;
}
