/* The energy ledger. Work of a step from x0 (time t0) to x1 (t1):

     gravity   sum m g . (x1 - x0), exact
     loads     mean force times displacement, sum (f(t0) + f(t1)) / 2 . (x1 - x0)
     pressure  with a potential U(V, t): the mean of U(V0, t) - U(V1, t) at t0 and t1; else the mean of the forces at
               both ends times the displacement
     tools     -(F . dp + T . theta): F and T on the tool, about its position; dp and theta its translation and rotation
     material  keyed stiffness: energy at x0 with the new numbers less that with the old; active fibres likewise
     damping   drag and damping of vertices: of the leapfrog with the velocity in the middle of the step, exactly as the
               step takes it; of substeps (T0 + T1) tanh(rate dt), which is exact for an exponential decay

   For the leapfrog with velocities brought to the time of the positions (v + dt/2 a) these sums are the discrete energy
   balance but for a term dt^2 m (a1^2 - a0^2) / 8 (Hairer, Lubich, Wanner 2003, section 1), which stays bounded. */
#include "sim/ledger.h"

#include "base/lane.h"
#include "base/memory.h"
#include "base/status.h"
#include "force/pressure.h"
#include "sim/sim.h"
#include "solve/shell_stability.h"

#include <math.h>
#include <string.h>

/* share of the energy that was supplied, from which an excess counts */
#define EXCESS_SHARE 0.05
/* rounding errors of a position, in units of the last place */
#define ROUNDING_ERRORS 8

/* ---- sums over vertices ---- */

typedef struct vertex_sums {
    const pel_sim *sim;
    double drag_gain; /* of m v1^2 (explicit) or m (v0^2 + v1^2) (substeps), in half */
    bool has_weight, has_drag, has_damping;
} vertex_sums;

static double sum_of(pel_record a)
{
    return (double)a[0] + (double)a[1] + (double)a[2];
}

static void add_weight(const pel_sim *sim, int32_t first, int32_t end, pel_ledger_chunk *chunk)
{
    const pel_state *state = sim->state;
    pel_record shift = pel_wide_splat(0);
    for (int32_t v = first; v < end; v++)
        shift += sim->model->mass[v] * (state->position_next[v] - state->position[v]);
    for (int c = 0; c < 3; c++)
        chunk->weight_shift[c] = (double)shift[c];
}

/* drag of the solver, the same for all vertices */
static double drag_sum(const pel_sim *sim, int32_t first, int32_t end)
{
    const pel_state *state = sim->state;
    const pel_real older = pel_sim_is_explicit(sim) ? 0 : 1;
    pel_record square = pel_wide_splat(0);
    for (int32_t v = first; v < end; v++) {
        pel_record before = state->velocity[v], after = state->velocity_next[v];
        square += sim->model->mass[v] * (after * after + older * (before * before));
    }
    return sum_of(square);
}

/* damping rate [1/s] along the volumetric spring */
static double radial_rate(const pel_sim *sim, int32_t v, const double *factors, double *along_square)
{
    const pel_model *model = sim->model;
    double radial = factors[PEL_VOLUMETRIC_DAMPING] * (double)model->volumetric_damping[v];
    pel_record offset = sim->state->position[v] - model->rest[v], mean = sim->state->velocity_next[v];
    mean += sim->state->velocity[v];
    double along = sum_of(offset * mean) / 2, square = sum_of(offset * offset);
    *along_square = radial > 0 && square > 0 ? along * along / square : 0;
    return radial;
}

/* damping of single vertices, with that of the solver where substeps act on both */
static double damping_of(const vertex_sums *sums, int32_t v, const double *factors)
{
    const pel_sim *sim = sums->sim;
    const pel_state *state = sim->state;
    pel_record before = state->velocity[v], after = state->velocity_next[v];
    double dt = sim->step.dt, mass = (double)sim->model->mass[v], along_square;
    double damping = factors[PEL_SPRING_DAMPING] * (double)sim->model->damping[v];
    double radial = dt * radial_rate(sim, v, factors, &along_square) * along_square;
    if (pel_sim_is_explicit(sim))
        return 0.5 * dt * damping * sum_of(after * (before + after)) + radial;
    double rate = sim->solver.drag + damping / mass, plain = sums->drag_gain;
    double kinetic = 0.5 * mass * sum_of(before * before + after * after);
    return kinetic * (tanh(rate * dt) - plain) + radial;
}

static void sum_chunk(void *context, int32_t index)
{
    const vertex_sums *sums = context;
    const pel_sim *sim = sums->sim;
    const pel_model *model = sim->model;
    int32_t chunk_size = PEL_SLICE_CHUNK * PEL_WIDTH, first = index * chunk_size, end = first + chunk_size;
    end = end < model->vertex_count ? end : model->vertex_count;
    pel_ledger_chunk chunk = {0};
    if (sums->has_weight)
        add_weight(sim, first, end, &chunk);
    if (sums->has_drag)
        chunk.damping = 0.5 * sums->drag_gain * drag_sum(sim, first, end);
    for (int32_t v = first; sums->has_damping && v < end; v++)
        if (model->inverse_mass[v] > 0)
            chunk.damping += damping_of(sums, v, sim->state->factors[model->body_of_slice[v / PEL_WIDTH]]);
    sim->ledger.chunks[index] = chunk;
}

static void add_vertices(pel_sim *sim)
{
    const double *gravity = sim->model->gravity;
    bool moves = pel_sim_has_velocity(sim);
    double drag = sim->solver.drag * sim->step.dt;
    vertex_sums sums = {
        .sim = sim,
        .has_weight = gravity[0] != 0 || gravity[1] != 0 || gravity[2] != 0,
        .has_drag = moves && drag > 0,
        .has_damping = moves && sim->ledger.has_damping,
        /* half of the drag acts before the velocity in the middle of the step, half behind it */
        .drag_gain = pel_sim_is_explicit(sim) ? exp(drag) - exp(-drag) : tanh(drag),
    };
    int32_t chunk_count = pel_slice_chunk_count(0, sim->model->slice_count);
    if (!sums.has_weight && !sums.has_drag && !sums.has_damping)
        return;
    pel_pool_run(sim->pool, chunk_count, sum_chunk, &sums);
    for (int32_t i = 0; i < chunk_count; i++) {
        const pel_ledger_chunk *chunk = &sim->ledger.chunks[i];
        sim->ledger.sums.work_gravity += pel_vec3_dot(gravity, chunk->weight_shift);
        sim->ledger.sums.dissipated_drag += chunk->damping;
    }
}

/* ---- pressure ---- */

static double potential_work(pel_sim *sim, int32_t b, double time, double next)
{
    const pel_body *body = &sim->model->bodies[b];
    double *known = &sim->ledger.volumes[b];
    /* an event of refinement changes the volume between two steps */
    double before =
        isnan(*known) || body->front != NULL ? pel_body_volume(sim->model, b, sim->state->position) : *known;
    double after = pel_body_volume(sim->model, b, sim->state->position_next), work = 0;
    *known = after;
    const double times[2] = {time, next};
    for (int i = 0; i < 2; i++)
        work += 0.5 * (pel_pressure_potential(body->shell, times[i], before, body->rest_volume) -
                       pel_pressure_potential(body->shell, times[i], after, body->rest_volume));
    return work;
}

/* pressures without a potential, of all bodies */
static double follower_work(pel_sim *sim, double time, double next)
{
    const pel_state *state = sim->state;
    double work = 0;
    memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
    pel_shell_forces_add(sim->shells, state->position, time, PEL_SHELL_FOLLOWER, sim->pool, sim->force);
    pel_shell_forces_add(sim->shells, state->position_next, next, PEL_SHELL_FOLLOWER, sim->pool, sim->force);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        work += 0.5 * sum_of(sim->force[v] * (state->position_next[v] - state->position[v]));
    return work;
}

static void add_pressure(pel_sim *sim, double time, double next)
{
    bool follows = false;
    double work = 0;
    for (int32_t b = 0; sim->shells != NULL && b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        if (body->shell == NULL || body->shell->pressure.kind == PEL_PRESSURE_NONE)
            continue;
        if (pel_pressure_is_conservative(body))
            work += potential_work(sim, b, time, next);
        else
            follows = true;
    }
    sim->ledger.sums.work_pressure += work + (follows ? follower_work(sim, time, next) : 0);
}

/* ---- material that changes in time ---- */

static double spring_energy(const pel_sim *sim, int32_t b)
{
    const pel_body *body = &sim->model->bodies[b];
    double sum = 0;
    for (int32_t slice = body->slice_begin; slice < body->slice_end; slice++) {
        pel_wide spring, volumetric;
        pel_slice_energy(sim->model, sim->state, slice, &spring, &volumetric);
        for (int lane = 0; lane < PEL_WIDTH; lane++)
            if (sim->model->mesh_vertex[slice * PEL_WIDTH + lane] >= 0)
                sum += (double)spring[lane] + (double)volumetric[lane];
    }
    return sum;
}

/* springs whose keyed stiffness is another one than in the step before */
static double stiffening_work(pel_sim *sim, int32_t b)
{
    double *present = sim->state->factors[b], *before = sim->ledger.factors[b], kept[PEL_PARAMETER_COUNT];
    if (memcmp(present, before, sizeof kept) == 0)
        return 0;
    double energy = spring_energy(sim, b);
    memcpy(kept, present, sizeof kept);
    memcpy(present, before, sizeof kept);
    double work = energy - spring_energy(sim, b);
    memcpy(present, kept, sizeof kept);
    memcpy(before, kept, sizeof kept);
    return work;
}

static bool has_keyed_fibres(const pel_sim *sim)
{
    for (int32_t b = 0; sim->shells != NULL && b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        for (int32_t r = 0; shell != NULL && r < shell->region_count; r++)
            if (shell->regions[r].rest_length.key_count > 0)
                return true;
    }
    return false;
}

static void add_material(pel_sim *sim, double time, double next)
{
    double work = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        work += stiffening_work(sim, b);
    if (has_keyed_fibres(sim)) {
        /* a minimisation has the new rest length from its start, the other methods from the end of the step */
        const pel_record *at = sim->descent != NULL ? sim->state->position : sim->state->position_next;
        work += pel_shell_forces_add(sim->shells, at, next, PEL_SHELL_FIBRES, sim->pool, NULL).fibres -
                pel_shell_forces_add(sim->shells, at, time, PEL_SHELL_FIBRES, sim->pool, NULL).fibres;
    }
    sim->ledger.sums.work_material += work;
}

/* ---- tools ---- */

/* rotation vector from one unit quaternion to another, the shorter way */
static void rotation_between(const double a[4], const double b[4], double rotation[3])
{
    const double back[3] = {-a[0], -a[1], -a[2]};
    double axis[3], scalar = a[3] * b[3] - pel_vec3_dot(back, b), cross[3];
    pel_vec3_cross(b, back, cross);
    for (int i = 0; i < 3; i++)
        axis[i] = b[3] * back[i] + a[3] * b[i] + cross[i];
    double sine = pel_vec3_length(axis), angle = 2 * atan2(sine, fabs(scalar));
    pel_vec3_scale(axis, sine > 0 ? (scalar < 0 ? -angle : angle) / sine : 0, rotation);
}

/* Readings of methods with velocities are impulses over dt, means of the step; the others are forces at its end. */
static void add_tools(pel_sim *sim)
{
    double share = pel_sim_has_velocity(sim) ? 1 : 0.5;
    for (int32_t t = 0; t < sim->tool_count; t++) {
        pel_tool_reading *before = &sim->ledger.tools[t], now;
        double force[3], torque[3], shift[3], rotation[3];
        pel_sim_get_tool(sim, t, &now);
        for (int i = 0; i < 3; i++) {
            force[i] = share * now.force[i] + (1 - share) * before->force[i];
            torque[i] = share * now.torque[i] + (1 - share) * before->torque[i];
        }
        pel_vec3_subtract(now.position, before->position, shift);
        rotation_between(before->rotation, now.rotation, rotation);
        sim->ledger.sums.work_tools -= pel_vec3_dot(force, shift) + pel_vec3_dot(torque, rotation);
        *before = now;
    }
}

/* ---- the step ---- */

/* most energy that start and works have supplied by now */
static void follow_supply(pel_sim_ledger *sums)
{
    double supplied = fabs(sums->elastic_start) + fabs(sums->kinetic_start) + fabs(sums->work_tools) +
                      fabs(sums->work_loads) + fabs(sums->work_pressure) + fabs(sums->work_gravity) +
                      fabs(sums->work_material) + fabs(sums->work_setters);
    sums->supplied = fmax(sums->supplied, supplied);
}

void pel_ledger_step(pel_sim *sim, double next)
{
    double time = pel_sim_time(sim);
    add_vertices(sim);
    sim->ledger.sums.work_loads += pel_loads_work(sim, time, next);
    add_pressure(sim, time, next);
    add_material(sim, time, next);
    add_tools(sim);
    follow_supply(&sim->ledger.sums);
}

static double kinetic_energy(const pel_sim *sim, const pel_sim_measures *measures)
{
    return pel_sim_has_velocity(sim) ? measures->kinetic_energy : 0;
}

void pel_ledger_start(pel_sim *sim)
{
    pel_sim_measures now = {0};
    if (sim->ledger.is_started)
        return;
    sim->ledger.is_started = true;
    pel_sim_sum_energies(sim, &now);
    sim->ledger.sums.elastic_start = now.elastic_energy;
    sim->ledger.sums.kinetic_start = kinetic_energy(sim, &now);
    follow_supply(&sim->ledger.sums);
}

double pel_ledger_energy(pel_sim *sim)
{
    pel_sim_measures now = {0};
    if (!sim->ledger.is_started)
        return 0;
    pel_sim_sum_energies(sim, &now);
    return now.elastic_energy + kinetic_energy(sim, &now);
}

void pel_ledger_book_change(pel_sim *sim, double energy_before)
{
    for (int32_t b = 0; b < sim->model->body_count; b++)
        sim->ledger.volumes[b] = (double)NAN;
    if (!sim->ledger.is_started)
        return;
    sim->ledger.sums.work_setters += pel_ledger_energy(sim) - energy_before;
    follow_supply(&sim->ledger.sums);
}

void pel_sim_get_ledger(pel_sim *sim, pel_sim_ledger *ledger)
{
    pel_sim_measures now = {0};
    *ledger = sim->ledger.sums;
    pel_sim_sum_energies(sim, &now);
    ledger->elastic = now.elastic_energy;
    ledger->kinetic = kinetic_energy(sim, &now);
    if (!sim->ledger.is_started) {
        ledger->elastic_start = ledger->elastic;
        ledger->kinetic_start = ledger->kinetic;
    }
    double work = ledger->work_tools + ledger->work_loads + ledger->work_pressure + ledger->work_gravity +
                  ledger->work_material + ledger->work_setters;
    double gained = ledger->elastic + ledger->kinetic - ledger->elastic_start - ledger->kinetic_start;
    double left = gained - work + ledger->dissipated_drag;
    ledger->dissipated_solver = fmax(-left, 0);
    ledger->energy_error = fmax(left, 0);
    ledger->tolerance = EXCESS_SHARE * ledger->supplied + sim->ledger.rounding;
}

/* ---- creation ---- */

/* half the largest stiffness times the square of the rounding of positions */
static double rounding_of(const pel_sim *sim)
{
    const pel_model *model = sim->model;
    pel_stability stability;
    double farthest = 0, mass = 0;
    pel_stability_bound(model, &stability);
    pel_shell_stability_bound(sim->shells, &stability);
    for (int32_t v = 0; v < model->vertex_count; v++) {
        mass += (double)model->mass[v];
        for (int c = 0; c < 3; c++)
            farthest = fmax(farthest, fabs((double)model->rest[v][c]));
    }
    double shift = ROUNDING_ERRORS * (double)PEL_REAL_EPSILON * farthest;
    return 0.5 * mass * stability.stiffness_bound * shift * shift;
}

static bool has_damping(const pel_model *model)
{
    for (int32_t v = 0; v < model->vertex_count; v++)
        if (model->damping[v] > 0 || model->volumetric_damping[v] > 0)
            return true;
    return false;
}

void pel_ledger_follow(pel_sim *sim)
{
    for (int32_t t = 0; t < sim->tool_count; t++)
        pel_sim_get_tool(sim, t, &sim->ledger.tools[t]);
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        memcpy(sim->ledger.factors[b], sim->state->factors[b], sizeof *sim->ledger.factors);
        sim->ledger.volumes[b] = (double)NAN;
    }
}

pel_status pel_ledger_create(pel_sim *sim, pel_error *error)
{
    pel_ledger *ledger = &sim->ledger;
    size_t body_count = (size_t)sim->model->body_count;
    ledger->tools = pel_allocate((size_t)sim->tool_count, sizeof *ledger->tools);
    ledger->factors = pel_allocate(body_count, sizeof *ledger->factors);
    ledger->volumes = pel_allocate(body_count, sizeof *ledger->volumes);
    ledger->chunks = pel_allocate((size_t)pel_slice_chunk_count(0, sim->model->slice_count), sizeof *ledger->chunks);
    if (ledger->tools == NULL || ledger->factors == NULL || ledger->volumes == NULL || ledger->chunks == NULL)
        return pel_fail_memory(error);
    ledger->has_damping = has_damping(sim->given);
    ledger->rounding = rounding_of(sim);
    pel_ledger_follow(sim);
    return PEL_OK;
}

void pel_ledger_destroy(pel_sim *sim)
{
    pel_free(sim->ledger.tools);
    pel_free(sim->ledger.factors);
    pel_free(sim->ledger.volumes);
    pel_free(sim->ledger.chunks);
}
