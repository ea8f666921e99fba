#include "sim/sim.h"

#include "base/memory.h"
#include "base/status.h"
#include "pellicle/parallel.h"
#include "sim/contact.h"
#include "sim/descent.h"
#include "sim/tool.h"
#include "sim/tool_solid.h"

#include <stdio.h>
#include <string.h>

enum { SIM_COOKIE = 0x73696d21 };

/* below this many chunks (of 512 vertices) threads cost more than they give */
enum { CHUNKS_WORTH_THREADS = 4 };

/* positions farther than this many model sizes from the model count as diverged */
#define BOUND_SIZES 1e3

pel_sim_def pel_sim_def_default(void)
{
    return (pel_sim_def){
        .solver = {.method = PEL_METHOD_QUASI_STATIC, .dt = 0.01, .symplectic = true, .second_order = PEL_AUTO},
        .contact = {.self = true, .between = true, .relative_thickness = 1e-4},
        .cookie = SIM_COOKIE,
    };
}

/* ---- creation ---- */

pel_status pel_sim_check_def(const pel_sim_def *def, pel_error *error)
{
    if (def->cookie != SIM_COOKIE)
        return pel_fail(error, PEL_BAD_ARGUMENT, "sim def was not made by pel_sim_def_default()");
    if (def->model == NULL)
        return pel_fail(error, PEL_BAD_ARGUMENT, "sim has no model");
    const pel_solver_def *solver = &def->solver;
    if (!(solver->dt > 0 && isfinite(solver->dt))) {
        pel_fail(error, PEL_BAD_ARGUMENT, "solver dt is %g", solver->dt);
        pel_fail_remedy(error, "give a time step above 0");
        return PEL_BAD_ARGUMENT;
    }
    if (!(solver->alpha >= 0 && isfinite(solver->alpha))) {
        pel_fail(error, PEL_BAD_ARGUMENT, "solver alpha is %g", solver->alpha);
        pel_fail_remedy(error, "give a number above 0, or leave it out for a safe one");
        return PEL_BAD_ARGUMENT;
    }
    if (solver->method > PEL_METHOD_DESCENT)
        return pel_fail(error, PEL_BAD_ARGUMENT, "solver method %d is unknown", (int)solver->method);
    if (solver->iterations < 0 || solver->substeps < 0 || solver->max_substeps < 0) {
        pel_fail(error, PEL_BAD_ARGUMENT, "solver iterations or substeps are below 0");
        pel_fail_remedy(error, "give at least 1, or 0 for the usual number of the method");
        return PEL_BAD_ARGUMENT;
    }
    if (!(solver->drag >= 0 && isfinite(solver->drag))) {
        pel_fail(error, PEL_BAD_ARGUMENT, "solver drag is %g", solver->drag);
        pel_fail_remedy(error, "give a finite number of at least 0");
        return PEL_BAD_ARGUMENT;
    }
    if (def->thread_count < 0 || def->load_count < 0 || def->tool_count < 0)
        return pel_fail(error, PEL_BAD_ARGUMENT, "a count is below 0");
    return PEL_OK;
}

static double position_bound(const pel_model *model)
{
    double size = 0, far = 0;
    for (int32_t b = 0; b < model->body_count; b++)
        size = fmax(size, model->bodies[b].diameter);
    for (int32_t v = 0; v < model->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            far = fmax(far, fabs((double)model->rest[v][i]));
    return 2 * far + BOUND_SIZES * size;
}

/* a pool when the largest body has work for more than one thread */
static pel_status start_threads(pel_sim *sim, int thread_count, pel_error *error)
{
    int32_t most = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        int32_t end = sim->active != NULL ? sim->active->bodies[b].fine_limit / PEL_WIDTH : body->slice_end;
        int32_t chunk_count = pel_slice_chunk_count(body->slice_begin, end);
        most = chunk_count > most ? chunk_count : most;
    }
    sim->chunk_longest = pel_allocate((size_t)most, sizeof *sim->chunk_longest);
    if (sim->chunk_longest == NULL)
        return pel_fail_memory(error);
    sim->step.longest = sim->chunk_longest;
    int threads = thread_count > 0 ? thread_count : pel_thread_limit();
    if (threads == 1 || most < CHUNKS_WORTH_THREADS)
        return PEL_OK;
    pel_status status = pel_pool_create(threads, &sim->pool, error);
    sim->step.pool = sim->pool;
    return status;
}

static pel_status build(pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    sim->model = sim->given = def->model;
    sim->solver = def->solver;
    sim->stepper = pel_stepper_of(def->solver.method);
    pel_substeps_configure(sim, def);
    if (pel_model_refines(def->model)) {
        pel_status refines = pel_active_create(def->model, &sim->active, error);
        if (refines != PEL_OK)
            return refines;
        sim->model = &sim->active->model;
    }
    sim->step = (pel_step){
        .dt = def->solver.dt,
        .keep_velocity = def->solver.keep_velocity,
        .symplectic = def->solver.symplectic,
        .bound = position_bound(def->model),
    };
    sim->force = pel_allocate_aligned((size_t)sim->model->vertex_count, sizeof *sim->force);
    if (sim->force == NULL)
        return pel_fail_memory(error);
    pel_status status = start_threads(sim, def->thread_count, error);
    if (status == PEL_OK)
        status = pel_state_create(sim->model, pel_sim_has_velocity(sim), &sim->state, error);
    if (status == PEL_OK)
        status = pel_refine_create(sim, error);
    if (status == PEL_OK)
        status = pel_shells_create(sim, error);
    if (status == PEL_OK)
        pel_weights_start(sim);
    if (status == PEL_OK)
        status = sim->stepper->create(sim, error);
    if (status == PEL_OK && sim->active != NULL)
        status = pel_refine_start(sim, error);
    if (status == PEL_OK)
        pel_substeps_follow(sim);
    if (status == PEL_OK)
        status = pel_loads_create(sim, def->loads, def->load_count, error);
    if (status == PEL_OK)
        status = pel_tools_create(sim, def->tools, def->tool_count, error);
    if (status == PEL_OK)
        status = pel_supports_create(sim, error);
    if (status == PEL_OK)
        status = pel_solids_create(sim, error);
    if (status == PEL_OK)
        status = pel_contacts_create(sim, &def->contact, error);
    if (status == PEL_OK && sim->stepper->check_start != NULL)
        status = sim->stepper->check_start(sim, error);
    if (status == PEL_OK)
        status = pel_ledger_create(sim, error);
    if (status == PEL_OK)
        status = pel_parts_create(sim, error);
    if (status == PEL_OK)
        sim->fingerprint = pel_sim_fingerprint(sim);
    return status;
}

pel_status pel_sim_create(const pel_sim_def *def, pel_sim **sim, pel_error *error)
{
    *sim = NULL;
    pel_status status = pel_sim_check_def(def, error);
    if (status != PEL_OK)
        return status;
    pel_sim *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    status = build(made, def, error);
    if (status == PEL_OK)
        *sim = made;
    else
        pel_sim_destroy(made);
    return status;
}

void pel_sim_destroy(pel_sim *sim)
{
    if (sim == NULL)
        return;
    pel_ledger_destroy(sim);
    pel_parts_destroy(sim);
    pel_contacts_destroy(sim);
    pel_solids_destroy(sim);
    pel_supports_destroy(sim);
    pel_tools_destroy(sim);
    pel_loads_destroy(sim);
    pel_refine_destroy(sim);
    pel_sim_descent_destroy(sim);
    pel_relax_destroy(sim->relax);
    pel_projector_destroy(sim->projector);
    pel_substeps_destroy(sim);
    pel_shells_destroy(sim);
    pel_active_destroy(sim->active);
    pel_state_destroy(sim->state);
    pel_free(sim->force);
    pel_free(sim->chunk_longest);
    pel_pool_destroy(sim->pool);
    pel_free(sim);
}

/* ---- step ---- */

/* keyed material numbers at the time of the step */
static void update_factors(pel_sim *sim, double time)
{
    for (int32_t b = 0; b < sim->model->body_count; b++)
        for (int p = 0; p < PEL_PARAMETER_COUNT; p++) {
            const pel_curve *curve = &sim->model->bodies[b].curves[p];
            if (curve->key_count > 0)
                sim->state->factors[b][p] = pel_curve_value(curve->keys, curve->key_count, time);
        }
}

/* the first vertex of the new positions that is out of the bound, or -1 */
static int32_t first_outside(const pel_sim *sim)
{
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        if (!pel_sim_is_inside(sim, v))
            return v;
    return -1;
}

bool pel_sim_all_inside(const pel_sim *sim)
{
    return first_outside(sim) < 0;
}

static pel_status report_divergence(const pel_sim *sim, pel_error *error)
{
    const pel_model *model = sim->model;
    int32_t bad = first_outside(sim);
    /* it was rounding that went beyond the bound */
    if (bad < 0)
        bad = model->vertex_count - 1;
    const pel_body *body = &model->bodies[model->body_of_slice[bad / PEL_WIDTH]];
    pel_fail(error, PEL_DIVERGED, "body '%s' diverged in step %lld (t = %g s)", body->name,
             (long long)sim->state->step + 1, pel_sim_time(sim) + sim->step.dt);
    pel_fail_element(error, "vertex", model->mesh_vertex[bad]);
    sim->stepper->advise(sim, error);
    return PEL_DIVERGED;
}

/* the new positions and velocities become the present ones */
static void accept(pel_state *state)
{
    pel_record *oldest = state->position_before, *velocity = state->velocity;
    state->position_before = state->position;
    state->position = state->position_next;
    state->position_next = oldest;
    state->velocity = state->velocity_next;
    state->velocity_next = velocity;
}

static void mark_contacts(pel_sim *sim)
{
    if (sim->tool_count == 0 && sim->contacts == NULL)
        return;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        int32_t first = body->slice_begin * PEL_WIDTH, count = body->slice_end * PEL_WIDTH - first;
        if (sim->parts.at == 0)
            memset(sim->state->contact + first, 0, (size_t)count);
    }
    for (int32_t i = 0; i < sim->tool_count; i++)
        for (int32_t k = 0; k < sim->tools[i].touch_count; k++)
            sim->state->contact[sim->tools[i].touches[k].vertex] = 1;
    if (sim->contacts != NULL)
        pel_contacts_mark(sim);
    if (sim->stepper->mark_contacts != NULL)
        sim->stepper->mark_contacts(sim);
}

double pel_sim_longest_edge(const pel_sim *sim)
{
    return pel_longest_spring(sim->model, sim->state->position_next, sim->pool, sim->chunk_longest);
}

/* what follows once the new positions and velocities are final */
static void accept_part(pel_sim *sim, double next)
{
    bool is_last = pel_parts_are_last(sim);
    pel_supports_read(sim);
    mark_contacts(sim);
    pel_ledger_step(sim, next);
    accept(sim->state);
    pel_tools_end_step(sim, next);
    sim->state->step += is_last;
    if (is_last)
        pel_weights_follow(sim);
    if (sim->stepper->accept != NULL)
        sim->stepper->accept(sim);
    pel_parts_accept(sim);
}

/* a part that failed, or is refused, leaves the state before it */
static pel_status step_part(pel_sim *sim, pel_error *error)
{
    const pel_stepper *stepper = sim->stepper;
    double time = pel_sim_time(sim), next = pel_sim_next_time(sim);
    update_factors(sim, stepper->is_at_end ? next : time);
    pel_step_result result = {0};
    pel_status status = stepper->step(sim, &result, error);
    /* nothing bounds how far some methods go: what tools look for goes by the new edges */
    if (status == PEL_OK && !result.diverged && !stepper->bounds_motion &&
        (sim->tool_count > 0 || sim->contacts != NULL))
        result.longest = pel_sim_longest_edge(sim);
    if (status == PEL_OK && result.diverged)
        status = report_divergence(sim, error);
    /* a surface that never cuts itself cannot turn inside out */
    if (status == PEL_OK && !pel_sim_has_self_contact(sim))
        status = pel_shells_check_volume(sim, error);
    if (status != PEL_OK && stepper->moves_tools)
        pel_tools_return(sim);
    if (status == PEL_OK && sim->contacts != NULL)
        status = pel_contacts_apply(sim, next, result.longest, error);
    /* a shorter part has fewer pairs, and does not go that far */
    bool is_too_long = status == PEL_BAD_ARGUMENT || status == PEL_DIVERGED;
    if (sim->parts.is_refused || (is_too_long && pel_parts_can_halve(sim))) {
        pel_parts_halve(sim);
        return PEL_OK;
    }
    if (status != PEL_OK)
        return status;
    if (sim->contacts == NULL && sim->tool_count > 0) {
        if (!stepper->moves_tools)
            pel_tools_move(sim, next);
        pel_tools_press(sim, result.longest, false);
        pel_tools_read(sim, next);
    }
    accept_part(sim, next);
    return PEL_OK;
}

pel_status pel_sim_step(pel_sim *sim, pel_error *error)
{
    pel_ledger_start(sim);
    sim->force_is_present = false;
    if (sim->tool_search != NULL)
        sim->tool_search->is_fitted = false;
    /* before the tools, so that they push new vertices out as well */
    if (sim->active != NULL)
        pel_refine_step(sim);
    if (sim->contacts != NULL) {
        pel_status ready = pel_contacts_begin_step(sim, error);
        if (ready != PEL_OK)
            return ready;
    }
    pel_parts_begin(sim);
    pel_status status = PEL_OK;
    while (status == PEL_OK && sim->parts.at < PEL_PART_LIMIT)
        status = step_part(sim, error);
    pel_parts_end(sim, status);
    return status;
}

/* ---- plain questions ---- */

double pel_sim_time(const pel_sim *sim)
{
    return ((double)sim->state->step + (double)sim->parts.at / PEL_PART_LIMIT) * sim->solver.dt;
}

double pel_sim_next_time(const pel_sim *sim)
{
    return ((double)sim->state->step + (double)(sim->parts.at + sim->parts.step_size) / PEL_PART_LIMIT) *
           sim->solver.dt;
}

int64_t pel_sim_step_count(const pel_sim *sim)
{
    return sim->state->step;
}

size_t pel_sim_step_bytes(const pel_sim *sim)
{
    const pel_model *model = sim->model;
    size_t slots = 0, slices = 0, with_stiffness = 0;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b];
        slices += (size_t)(body->slice_end - body->slice_begin);
        for (int32_t s = body->slice_begin; s < body->slice_end; s++) {
            size_t own = (size_t)(model->slot_end[s] - model->slot_begin[s]);
            slots += own;
            with_stiffness += body->uniform_spring < 0 ? own : 0;
        }
    }
    /* position, rest and new position; with velocities the older or both velocity records, and the damping numbers */
    size_t records = 3, numbers = 0;
    if (pel_sim_has_velocity(sim) || sim->solver.keep_velocity) {
        records += pel_sim_has_velocity(sim) ? 2 : 1;
        numbers = 2;
    }
    return slots * (sizeof *model->neighbours + sizeof *model->rest_lengths) +
           with_stiffness * sizeof *model->stiffnesses +
           slices * PEL_WIDTH * (records * sizeof(pel_record) + numbers * sizeof(pel_real)) +
           slices * sizeof *model->slot_begin;
}

const pel_model *pel_sim_model(const pel_sim *sim)
{
    return sim->given;
}

double pel_sim_alpha(const pel_sim *sim)
{
    return pel_sim_has_velocity(sim) ? 0 : sim->step.alpha;
}

double pel_sim_alpha_limit(const pel_sim *sim)
{
    return sim->alpha_limit;
}

int32_t pel_sim_tool_count(const pel_sim *sim)
{
    return sim->tool_count;
}

const char *pel_sim_tool_name(const pel_sim *sim, int32_t tool)
{
    return sim->tools[tool].name;
}

void pel_sim_get_tool(const pel_sim *sim, int32_t tool, pel_tool_reading *reading)
{
    const pel_tool *t = &sim->tools[tool];
    memcpy(reading->position, t->pose.position, sizeof reading->position);
    memcpy(reading->rotation, t->pose.rotation, sizeof reading->rotation);
    memcpy(reading->force, t->force, sizeof reading->force);
    memcpy(reading->torque, t->torque, sizeof reading->torque);
    reading->contact_count = t->contact_count;
    reading->held_count = t->held_count;
    reading->lost_count = t->tally.lost_count;
    reading->lost_time = t->tally.lost_time;
    reading->is_held_back = t->is_held_back;
    reading->held_back_count = t->tally.held_back_count;
    reading->held_back_time = t->tally.held_back_time;
}
