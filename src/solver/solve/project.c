#include "solve/project.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "sweep/sweep.h"

#include <math.h>
#include <string.h>

/* vertices of one chunk of a loop over vertices */
enum { VERTEX_CHUNK = 2048 };

/* ---- creation ---- */

static pel_status make_multipliers(const pel_batches *batches)
{
    for (int32_t b = 0; b < batches->model->body_count; b++)
        for (int32_t i = 0; i < batches->bodies[b].batch_count; i++) {
            pel_batch *batch = &batches->bodies[b].batches[i];
            size_t count = (size_t)batch->capacity * PEL_BLOCK * (size_t)batch->multiplier_count;
            if (!batch->is_projected || count == 0 || batch->multipliers != NULL)
                continue;
            batch->multipliers = pel_allocate_aligned(count, sizeof *batch->multipliers);
            if (batch->multipliers == NULL)
                return PEL_OUT_OF_MEMORY;
        }
    return PEL_OK;
}

static pel_status build(pel_projector *projector, pel_error *error)
{
    const pel_model *model = projector->model;
    const pel_solver_def *solver = &projector->solver;
    size_t count = (size_t)model->vertex_count;
    projector->base = pel_allocate_aligned(count, sizeof *projector->base);
    projector->restraints = pel_allocate(count, sizeof *projector->restraints);
    const size_t body_count = (size_t)model->body_count;
    bool made = PEL_ALLOCATE_ALL(PEL_ROOM(projector->orders, body_count), PEL_ROOM(projector->held_orders, body_count),
                                 PEL_ROOM(projector->is_pressed, body_count)) &&
                projector->base != NULL && projector->restraints != NULL;
    if (solver->second_order) {
        projector->touches = pel_allocate((size_t)model->body_count, sizeof *projector->touches);
        projector->touched = pel_allocate((size_t)model->body_count, sizeof *projector->touched);
        projector->older_position = pel_allocate_aligned(count, sizeof *projector->older_position);
        projector->older_velocity = pel_allocate_aligned(count, sizeof *projector->older_velocity);
        made &= projector->older_position != NULL && projector->older_velocity != NULL && projector->touches != NULL &&
                projector->touched != NULL;
    }
    if (made && solver->method == PEL_METHOD_XPBD && solver->iterations > 1)
        made = make_multipliers(projector->batches) == PEL_OK;
    if (made && solver->method == PEL_METHOD_XPBD)
        made = pel_spin_create(model, &projector->spin) == PEL_OK;
    return made ? PEL_OK : pel_fail_memory(error);
}

pel_status pel_projector_create(pel_batches *batches, const pel_solver_def *solver, pel_projector **projector,
                                pel_error *error)
{
    *projector = NULL;
    pel_projector *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->model = batches->model;
    made->batches = batches;
    made->solver = *solver;
    made->whole_dt = solver->dt;
    made->substep = made->whole_substep = solver->dt / solver->substeps;
    pel_status status = build(made, error);
    if (status == PEL_OK)
        *projector = made;
    else
        pel_projector_destroy(made);
    return status;
}

void pel_projector_destroy(pel_projector *projector)
{
    if (projector == NULL)
        return;
    PEL_FREE_ALL(projector->base, projector->restraints, projector->older_position, projector->older_velocity,
                 projector->reaction, projector->is_fixed, projector->touches, projector->touched, projector->orders,
                 projector->held_orders, projector->is_pressed);
    pel_spin_destroy(projector->spin);
    pel_free(projector);
}

void pel_projector_set_substeps(pel_projector *projector, pel_state *state, int32_t substeps)
{
    pel_projector_set_time(projector, state, projector->solver.dt, substeps);
}

void pel_projector_set_time(pel_projector *projector, pel_state *state, double dt, int32_t substeps)
{
    double substep = dt / substeps;
    if (state != NULL)
        pel_state_move_history(projector->model, state, projector->substep, substep);
    projector->solver.dt = dt;
    projector->solver.substeps = substeps;
    projector->substep = substep;
}

/* ---- sweeps ---- */

typedef struct sweep_job {
    const pel_projector *projector;
    pel_record *positions;
    int32_t first; /* bundle of the phase */
} sweep_job;

static void sweep_bundle(void *context, int32_t chunk)
{
    const sweep_job *job = context;
    const pel_batches *batches = job->projector->batches;
    const pel_bundle *bundle = &batches->bundles[job->first + chunk];
    const pel_body_batches *body = &batches->bodies[bundle->body];
    if (job->projector->is_asleep != NULL && job->projector->is_asleep[bundle->body])
        return;
    pel_batch_sweep *const *kernels = job->projector->is_plain ? pel_project_plain : pel_project_wide;
    for (int32_t i = 0; i < body->batch_count; i++) {
        const pel_batch *batch = &body->batches[i];
        if (batch->is_on)
            kernels[batch->kind](batch, batch->bundle_begin[bundle->number], batch->bundle_begin[bundle->number + 1],
                                 job->positions);
    }
}

void pel_project_sweep(const pel_projector *projector, pel_record *positions)
{
    pel_spin_begin(projector->spin, projector->has_past ? NULL : projector->base, positions, projector->pool);
    for (int phase = 0; phase < PEL_PHASE_COUNT; phase++) {
        const int32_t *begin = &projector->batches->phase_begin[phase];
        sweep_job job = {projector, positions, begin[0]};
        pel_pool_run(projector->pool, begin[1] - begin[0], sweep_bundle, &job);
    }
    pel_spin_end(projector->spin, positions, projector->pool);
}

static void forget_multipliers(const pel_projector *projector)
{
    for (int32_t b = 0; b < projector->model->body_count; b++)
        for (int32_t i = 0; i < projector->batches->bodies[b].batch_count; i++) {
            const pel_batch *batch = &projector->batches->bodies[b].batches[i];
            size_t count = (size_t)batch->block_count * PEL_BLOCK * (size_t)batch->multiplier_count;
            if (batch->multipliers != NULL)
                memset(batch->multipliers, 0, count * sizeof *batch->multipliers);
        }
}

/* ---- vertices ---- */

typedef struct vertex_job {
    pel_projector *projector;
    pel_state *state;
    pel_record *force;
    const uint8_t *is_held; /* see pel_boundary */
    bool first;             /* substep of the step */
    bool is_moving;         /* velocities are still to be taken from the substep before */
    pel_real tau[PEL_ORDER_COUNT];
    pel_real rate[PEL_ORDER_COUNT]; /* of velocities by ways, drag included */
    pel_real drag[PEL_ORDER_COUNT]; /* of all vertices, where none has its own, see pel_restraint */
} vertex_job;

/* y and u of a vertex, see project.h */
typedef struct launch {
    pel_record base, velocity;
} launch;

/* tau in substeps, and ways over velocities; tau of a start is the square root of a half */
static const double tau_shares[PEL_ORDER_COUNT] = {1, 2.0 / 3, 0.70710678118654752};
static const double span_shares[PEL_ORDER_COUNT] = {1, 2.0 / 3, 0.5};

static double tau_of(const pel_projector *projector, pel_substep_order order)
{
    return order == PEL_ORDER_PAST ? 2 * projector->substep / 3 : tau_shares[order] * projector->substep;
}

static double span_of(const pel_projector *projector, pel_substep_order order)
{
    return order == PEL_ORDER_PAST ? 2 * projector->substep / 3 : span_shares[order] * projector->substep;
}

static pel_substep_order order_of(const pel_projector *projector, int32_t v)
{
    return (pel_substep_order)projector->orders[projector->model->body_of_slice[v / PEL_WIDTH]];
}

static launch second_order_launch(const vertex_job *job, int32_t v, pel_record x, pel_record speed)
{
    const pel_substep_order order = order_of(job->projector, v);
    pel_projector *projector = job->projector;
    const pel_state *state = job->state;
    pel_record x1 = job->first ? state->older_position[v] : projector->older_position[v];
    pel_record v1 = job->first ? state->older_velocity[v] : projector->older_velocity[v];
    projector->older_position[v] = x;
    projector->older_velocity[v] = speed;
    if (order == PEL_ORDER_START)
        return (launch){x + (pel_real)(0.5 * projector->substep) * speed, (pel_real)tau_shares[order] * speed};
    if (order == PEL_ORDER_PLAIN)
        return (launch){x, speed};
    const pel_real third = (pel_real)(1.0 / 3);
    return (launch){third * (4 * x - x1), third * (4 * speed - v1)};
}

/* The drag of everything [1/s] as far as it is taken up by the mass. In second order it has to be: a factor on the
   velocities, of which the last two count, would act one and a half times. */
static double massive_drag(const pel_projector *projector)
{
    return projector->solver.second_order ? projector->solver.drag : 0;
}

/* s, times drag the part of the mass that it adds: tau to the last bit where ways over velocities are tau as well */
static double drag_time(const pel_projector *projector, pel_substep_order order)
{
    return tau_of(projector, order) * (tau_of(projector, order) / span_of(projector, order));
}

/* drag or a volumetric spring of its own */
static bool is_held(const pel_model *model, int32_t v)
{
    return model->damping[v] + model->rest[v][3] + model->volumetric_damping[v] > 0;
}

/* Drag and volumetric spring as a larger mass, see project.h; `along` is the damping along the spring, implicit. They
   are the same in all substeps of one length. */
static pel_restraint restraint_of(const pel_projector *projector, int32_t v, const double *factors)
{
    const pel_model *model = projector->model;
    const pel_real w = model->inverse_mass[v];
    const pel_substep_order order = order_of(projector, v);
    const double tau = tau_of(projector, order), time = drag_time(projector, order);
    double rate = factors[PEL_SPRING_DAMPING] * (double)(model->damping[v] * w);
    if (projector->air != NULL)
        rate += (double)(projector->air[v][3] * w);
    double radial = factors[PEL_VOLUMETRIC_DAMPING] * (double)model->volumetric_damping[v];
    radial = radial > 0 ? time * (double)w * radial : 0;
    pel_real drag = (pel_real)((rate + massive_drag(projector)) * time);
    pel_real spring = (pel_real)(factors[PEL_VOLUMETRIC_STIFFNESS] * (double)(model->rest[v][3] * w) * tau * tau);
    return (pel_restraint){drag, spring, 1 / (1 + drag + spring), (pel_real)(radial / (1 + radial))};
}

/* v -= (1 - 1 / (1 + tau w d')) (v.e) e / |e|^2 */
static pel_record damp_along(pel_record velocity, pel_record offset, double share)
{
    double along = 0, square = 0;
    for (int i = 0; i < 3; i++) {
        along += (double)velocity[i] * (double)offset[i];
        square += (double)offset[i] * (double)offset[i];
    }
    double change = square > 0 ? share * along / square : 0;
    return velocity - (pel_real)change * offset;
}

static pel_record hold_back(const vertex_job *job, int32_t v, pel_record x, const launch *from, pel_record push)
{
    const pel_restraint r = job->projector->restraints[v];
    const pel_record rest = job->projector->model->rest[v];
    const pel_real tau = job->tau[order_of(job->projector, v)];
    pel_record velocity = from->velocity;
    if (r.along > 0)
        velocity = damp_along(velocity, x - rest, (double)r.along);
    return r.share * (from->base + tau * velocity + push + r.drag * from->base + r.spring * rest);
}

/* of the substep that ends at x */
static pel_record velocity_of(const vertex_job *job, int32_t v, pel_substep_order order, pel_record x)
{
    return pel_record_with(job->rate[order] * (x - job->projector->base[v]), 0);
}

/* is_plain: not the first substep, of first order, without restraints and reactions; a constant at each call, so that
   the branches vanish */
static inline __attribute__((always_inline)) void predict_vertex(const vertex_job *job, int32_t v, bool is_plain)
{
    pel_projector *projector = job->projector;
    pel_state *state = job->state;
    bool held = job->is_held != NULL && job->is_held[v], first = !is_plain && job->first;
    const pel_substep_order order = is_plain ? PEL_ORDER_PLAIN : order_of(projector, v);
    pel_real w = held ? 0 : projector->model->inverse_mass[v], tau = job->tau[order];
    pel_record x = first ? state->position[v] : state->position_next[v], speed;
    if (is_plain || job->is_moving)
        speed = velocity_of(job, v, order, x);
    else
        speed = first ? state->velocity[v] : state->velocity_next[v];
    launch from = {x, speed};
    if (!is_plain && state->older_position != NULL)
        from = second_order_launch(job, v, x, speed);
    if (!(w > 0))
        from = (launch){x, speed - speed};
    pel_record force = job->force[v], push = tau * tau * w * force;
    pel_record next = from.base + tau * from.velocity + push;
    if (!is_plain && projector->reaction != NULL && projector->is_fixed[v])
        projector->reaction[v] += force;
    job->force[v] = (pel_record){0};
    if (!is_plain && projector->is_held && w > 0) {
        next = hold_back(job, v, x, &from, push);
        w *= projector->restraints[v].share;
    } else if (!is_plain && job->drag[order] > 0 && w > 0) {
        const pel_real share = 1 / (1 + job->drag[order]);
        next = share * (next + job->drag[order] * from.base);
        w *= share;
    }
    state->position_next[v] = pel_record_with(next, w);
    projector->base[v] = from.base;
}

static int32_t vertex_chunk_end(const vertex_job *job, int32_t chunk)
{
    int32_t first = chunk * VERTEX_CHUNK, count = job->projector->model->vertex_count;
    return count - first < VERTEX_CHUNK ? count : first + VERTEX_CHUNK;
}

static void restraint_chunk(void *context, int32_t chunk)
{
    const vertex_job *job = context;
    const pel_projector *projector = job->projector;
    for (int32_t v = chunk * VERTEX_CHUNK; v < vertex_chunk_end(job, chunk); v++)
        projector->restraints[v] =
            restraint_of(projector, v, job->state->factors[projector->model->body_of_slice[v / PEL_WIDTH]]);
}

/* a vertex of a body that sleeps: nothing moves it in this substep */
static void keep_vertex(const vertex_job *job, int32_t v)
{
    pel_projector *projector = job->projector;
    pel_record x = job->first ? job->state->position[v] : job->state->position_next[v];
    job->state->position_next[v] = pel_record_with(x, 0);
    projector->base[v] = x;
    job->force[v] = (pel_record){0};
    if (job->state->older_position == NULL)
        return;
    projector->older_position[v] = x;
    projector->older_velocity[v] = (pel_record){0};
}

static void predict_chunk(void *context, int32_t chunk)
{
    const vertex_job *job = context;
    const pel_projector *projector = job->projector;
    bool is_plain = job->is_moving && projector->reaction == NULL && !projector->is_held;
    for (int32_t v = chunk * VERTEX_CHUNK; v < vertex_chunk_end(job, chunk); v++) {
        if (projector->is_asleep != NULL && projector->is_asleep[projector->model->body_of_slice[v / PEL_WIDTH]])
            keep_vertex(job, v);
        else if (is_plain)
            predict_vertex(job, v, true);
        else
            predict_vertex(job, v, false);
    }
}

static void measure_velocity_chunk(void *context, int32_t chunk)
{
    const vertex_job *job = context;
    const pel_projector *projector = job->projector;
    for (int32_t v = chunk * VERTEX_CHUNK; v < vertex_chunk_end(job, chunk); v++) {
        job->state->velocity_next[v] = velocity_of(job, v, order_of(projector, v), job->state->position_next[v]);
        if (job->is_held == NULL || !job->is_held[v])
            job->state->position_next[v][3] = projector->model->inverse_mass[v];
    }
}

/* Second order: what a contact stops has no smooth past. The velocity of a body that touches anything is the way of the
   substep, and the next one begins as if it had always moved so. Otherwise the past would throw it back from what it
   ran into. All of the body: were it a part, momentum would not stay. */
static void forget_past(pel_projector *projector, pel_state *state, int32_t body)
{
    const pel_model *model = projector->model;
    const pel_real rate = (pel_real)(1 / projector->substep);
    int32_t end = pel_body_place_end(model, body);
    for (int32_t v = model->bodies[body].slice_begin * PEL_WIDTH; v < end; v++) {
        if (!(state->position_next[v][3] > 0))
            continue;
        pel_record velocity = rate * (state->position_next[v] - projector->older_position[v]);
        velocity[3] = 0;
        state->velocity_next[v] = projector->older_velocity[v] = velocity;
    }
}

static void mark_touching_bodies(pel_projector *projector, const pel_contact_list *contacts)
{
    for (int32_t c = 0; c < contacts->count; c++) {
        const pel_contact *contact = &contacts->contacts[c];
        for (int i = 0; i < 4 && contact->multiplier > 0; i++)
            if (contact->weights[i] != 0)
                projector->touches[projector->model->body_of_slice[contact->vertices[i] / PEL_WIDTH]] = 1;
    }
}

/* ---- steps ---- */

void pel_projector_begin(pel_projector *projector, const pel_state *state, double time)
{
    pel_solver_def whole = projector->solver;
    whole.dt = projector->whole_dt;
    whole.substeps = (int32_t)(whole.dt / projector->solver.dt * projector->solver.substeps + 0.5);
    projector->is_held = projector->air != NULL;
    projector->are_held_known = false;
    if (projector->touched != NULL)
        memset(projector->touched, 0, (size_t)projector->model->body_count);
    for (int32_t v = 0; !projector->is_held && v < projector->model->vertex_count; v++)
        projector->is_held = is_held(projector->model, v);
    for (int32_t b = 0; b < projector->model->body_count; b++)
        pel_project_body_begin(projector->batches, b, &whole, state, time);
}

/* Where contacts press, the past is forgotten in each substep. To go on in second order would let all forces act at 4/9
   while surfaces touch, and whole while they part: energy would appear. Pairs need one length of time for both sides,
   so that what touches goes by first order on both. */
void pel_project_choose_orders(pel_projector *projector, const pel_state *state, pel_substep_place place)
{
    const bool is_known = !(place & PEL_SUBSTEP_FIRST) || state->older_is_known;
    projector->has_past = false;
    projector->tau = 0;
    for (int32_t b = 0; b < projector->model->body_count; b++) {
        const bool is_plain = !projector->solver.second_order || projector->is_pressed[b];
        const pel_substep_order order = is_plain ? PEL_ORDER_PLAIN : is_known ? PEL_ORDER_PAST : PEL_ORDER_START;
        projector->orders[b] = (uint8_t)order;
        projector->has_past |= order == PEL_ORDER_PAST;
        projector->tau = pel_max(projector->tau, tau_of(projector, order));
    }
}

static void set_time(pel_projector *projector, const pel_state *state)
{
    double ratio = pel_min(projector->substep / projector->whole_substep, 1);
    pel_project_time time = {.share = ratio * ratio,
                             .ratio = projector->substep / projector->whole_dt,
                             .iterations = projector->solver.iterations,
                             .substep = projector->substep,
                             .before = pel_project_substep_start(projector)};
    for (int32_t b = 0; b < projector->model->body_count; b++) {
        time.tau = tau_of(projector, (pel_substep_order)projector->orders[b]);
        pel_project_body_set_time(&projector->model->bodies[b], &projector->batches->bodies[b], state->factors[b],
                                  &time);
    }
}

static vertex_job make_job(pel_projector *projector, pel_state *state, pel_record *force, const pel_boundary *boundary,
                           pel_substep_place place)
{
    bool first = place & PEL_SUBSTEP_FIRST;
    double drag = projector->solver.drag - massive_drag(projector);
    vertex_job job = {
        .projector = projector,
        .state = state,
        .force = force,
        .is_held = boundary->is_held,
        .first = first,
        .is_moving = !first && !projector->solver.second_order,
    };
    for (int i = 0; i < PEL_ORDER_COUNT; i++) {
        const pel_substep_order order = (pel_substep_order)i;
        job.tau[order] = (pel_real)tau_of(projector, order);
        job.rate[order] = (pel_real)(pel_exp(-drag * projector->substep) / span_of(projector, order));
        job.drag[order] = (pel_real)(massive_drag(projector) * drag_time(projector, order));
    }
    return job;
}

static void run_over_vertices(pel_projector *projector, pel_chunk_function *function, vertex_job *job)
{
    pel_pool_run(projector->pool, (projector->model->vertex_count + VERTEX_CHUNK - 1) / VERTEX_CHUNK, function, job);
}

const pel_record *pel_project_substep_start(const pel_projector *projector)
{
    return projector->solver.second_order ? projector->older_position : projector->base;
}

void pel_project_predict(pel_projector *projector, pel_state *state, pel_record *force, const pel_boundary *boundary,
                         pel_substep_place place)
{
    set_time(projector, state);
    if (projector->reaction != NULL && place & PEL_SUBSTEP_FIRST)
        memset(projector->reaction, 0, (size_t)projector->model->vertex_count * sizeof *projector->reaction);
    vertex_job job = make_job(projector, state, force, boundary, place);
    const size_t body_count = (size_t)projector->model->body_count;
    bool is_known = projector->are_held_known && memcmp(projector->orders, projector->held_orders, body_count) == 0;
    if (projector->is_held && !is_known)
        run_over_vertices(projector, restraint_chunk, &job);
    projector->are_held_known = true;
    memcpy(projector->held_orders, projector->orders, body_count);
    run_over_vertices(projector, predict_chunk, &job);
    for (int32_t i = 0; i < boundary->held_count; i++) {
        const double *x = boundary->target[i];
        state->position_next[boundary->held[i]] = (pel_record){(pel_real)x[0], (pel_real)x[1], (pel_real)x[2], 0};
    }
    forget_multipliers(projector);
}

/* held vertices have the velocity of their path, which drag does not change */
static void set_held_velocities(const pel_projector *projector, pel_state *state, const pel_boundary *boundary)
{
    const pel_record *start = pel_project_substep_start(projector);
    const pel_real rate = (pel_real)(1 / projector->substep);
    for (int32_t i = 0; i < boundary->held_count; i++) {
        int32_t v = boundary->held[i];
        pel_record velocity = rate * (state->position_next[v] - start[v]);
        velocity[3] = 0;
        state->velocity_next[v] = velocity;
    }
}

void pel_project_finish(pel_projector *projector, pel_state *state, const pel_contact_list *const *contacts,
                        int list_count, const pel_boundary *boundary, pel_substep_place place)
{
    /* the next substep takes the velocities of first order on the way */
    if (!(place & PEL_SUBSTEP_LAST) && !projector->solver.second_order)
        return;
    vertex_job job = make_job(projector, state, NULL, boundary, place);
    run_over_vertices(projector, measure_velocity_chunk, &job);
    set_held_velocities(projector, state, boundary);
    if (!projector->solver.second_order)
        return;
    int32_t body_count = projector->model->body_count;
    memset(projector->touches, 0, (size_t)body_count);
    for (int i = 0; i < list_count; i++)
        if (contacts[i] != NULL)
            mark_touching_bodies(projector, contacts[i]);
    for (int32_t b = 0; b < body_count; b++)
        if (projector->touches[b]) {
            forget_past(projector, state, b);
            projector->touched[b] = 1;
        }
}

/* ---- reactions ---- */

static pel_status record_batch(pel_projector *projector, pel_batch *batch)
{
    batch->reaction = projector->reaction;
    batch->has_fixed = pel_allocate((size_t)batch->capacity, sizeof *batch->has_fixed);
    return batch->has_fixed != NULL ? PEL_OK : PEL_OUT_OF_MEMORY;
}

pel_status pel_projector_record_reactions(pel_projector *projector, pel_error *error)
{
    size_t count = (size_t)projector->model->vertex_count;
    if (projector->reaction != NULL)
        return PEL_OK;
    bool made = PEL_ALLOCATE_ALL(PEL_ROOM_ALIGNED(projector->reaction, count), PEL_ROOM(projector->is_fixed, count));
    for (int32_t b = 0; b < projector->model->body_count; b++)
        for (int32_t i = 0; made && i < projector->batches->bodies[b].batch_count; i++)
            made = !projector->batches->bodies[b].batches[i].is_projected ||
                   record_batch(projector, &projector->batches->bodies[b].batches[i]) == PEL_OK;
    if (!made)
        return pel_fail_memory(error);
    pel_projector_hold(projector, NULL);
    return PEL_OK;
}

void pel_projector_hold(pel_projector *projector, const uint8_t *is_held)
{
    const pel_model *model = projector->model;
    if (projector->reaction == NULL)
        return;
    for (int32_t v = 0; v < model->vertex_count; v++)
        projector->is_fixed[v] = !(model->inverse_mass[v] > 0) || (is_held != NULL && is_held[v]);
    for (int32_t b = 0; b < model->body_count; b++)
        pel_project_body_mark_fixed(&projector->batches->bodies[b], projector->is_fixed);
}

bool pel_projector_limited(const pel_projector *projector, double *share)
{
    const pel_batches *batches = projector->batches;
    double limited = 0, count = 0;
    for (int32_t b = 0; b < projector->model->body_count; b++)
        for (int32_t i = 0; i < batches->bodies[b].batch_count; i++) {
            const pel_batch *batch = &batches->bodies[b].batches[i];
            if (!batch->is_projected || !pel_batch_is_push(batch))
                continue;
            for (int32_t e = 0; e < batch->block_count * PEL_BLOCK; e++) {
                if (e % PEL_BLOCK >= batch->lane_counts[e / PEL_BLOCK])
                    continue;
                limited += (double)*pel_batch_number(batch, e, PEL_NORMAL_LIMITED);
                count++;
            }
        }
    const pel_solver_def *solver = &projector->solver;
    *share = count > 0 ? limited / (count * solver->iterations * solver->substeps) : 0;
    return count > 0;
}

void pel_projector_restart(const pel_projector *projector, pel_state *state, int32_t body)
{
    const pel_real substep = (pel_real)projector->substep;
    int32_t end = pel_body_place_end(projector->model, body);
    if (state->older_position == NULL)
        return;
    for (int32_t v = projector->model->bodies[body].slice_begin * PEL_WIDTH; v < end; v++) {
        state->older_position[v] = state->position[v] - substep * state->velocity[v];
        state->older_velocity[v] = state->velocity[v];
    }
}

void pel_projector_accept(pel_projector *projector, pel_state *state)
{
    if (state->older_position == NULL)
        return;
    pel_record *position = state->older_position, *velocity = state->older_velocity;
    state->older_position = projector->older_position;
    state->older_velocity = projector->older_velocity;
    state->older_is_known = true;
    memcpy(state->touched, projector->touched, (size_t)projector->model->body_count);
    projector->older_position = position;
    projector->older_velocity = velocity;
    /* what touched anything has no smooth past, see forget_past */
    for (int32_t b = 0; b < projector->model->body_count; b++) {
        int32_t begin = projector->model->bodies[b].slice_begin * PEL_WIDTH;
        if (memchr(state->contact + begin, 1, (size_t)(pel_body_place_end(projector->model, b) - begin)) != NULL)
            pel_projector_restart(projector, state, b);
    }
}
