/* The energy ledger. Work of a step from x0 (time t0) to x1 (t1):

     gravity   sum m g . (x1 - x0), exact; over several steps together while masses are constant
     loads     force over the step, as the method takes it (loads.c), times the displacement x1 - x0
     pressure  with a potential U(V): U(V0) - U(V1) with the pressure over the step; else the mean of the forces at
               both ends times the displacement
     tools     -(F . dp + T . theta): F and T on the tool, about its position; dp and theta its translation and rotation
               (where it was held back, also the ways of surfaces off it, which it still pushed, times their loads);
               where F is not known, what closes the balance of the step, at most |F| |dp| + |T| |theta|
     material  keyed stiffness: energy at x0 with the new numbers less that with the old; active fibres likewise
     damping   drag and damping of vertices: of the leapfrog with the velocity in the middle of the step, exactly as the
               step takes it; of substeps (T0 + T1) tanh(rate dt), which is exact for an exponential decay; of the
               material by the rates of strain of its stages (implicit), or their mean over the step

   For the leapfrog with velocities brought to the time of the positions (v + dt/2 a) these sums are the discrete energy
   balance up to a term dt^2 m (a1^2 - a0^2) / 8 (Hairer, Lubich, Wanner 2003, section 1), which stays bounded. */
#include "observe/ledger.h"

#include "base/lane.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/hold.h"
#include "boundary/loads.h"
#include "contact/set.h"
#include "force/pressure.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "observe/observe.h"
#include "solve/shell_stability.h"
#include "stage/rigids.h"
#include "tool/follow.h"
#include "tool/tool.h"

#include <math.h>
#include <string.h>

/* share of the energy that was supplied, from which an excess counts */
#define EXCESS_SHARE 0.05
/* steps after which the work of gravity is booked */
enum { GRAVITY_INTERVAL = 8 };
/* rounding errors of a position, in units of the last place; over thousands of sweeps, as a share of its size */
#define ROUNDING_ERRORS 8
#define ROUNDING_SHARE 1e-12

/* ---- sums over vertices ---- */

typedef struct vertex_sums {
    const pel_sim *sim;
    const pel_record *from, *to; /* of moments */
    double drag_gain;            /* of m v1^2 (explicit) or m (v0^2 + v1^2) (substeps), in half */
    bool damps;                  /* dissipation; else moments */
} vertex_sums;

static double sum_of(pel_record a)
{
    return (double)a[0] + (double)a[1] + (double)a[2];
}

static void sum_moments(const vertex_sums *sums, int32_t first, int32_t end, pel_ledger_chunk *chunk)
{
    pel_record shift = {0};
    for (int32_t v = first; v < end; v++)
        shift += sums->sim->model->mass[v] * (sums->to[v] - sums->from[v]);
    for (int c = 0; c < 3; c++)
        chunk->moment[c] = (double)shift[c];
}

/* drag of the solver, the same for all vertices, under substeps */
static double drag_sum(const vertex_sums *sums, int32_t first, int32_t end)
{
    const pel_state *state = sums->sim->state;
    pel_record square = {0};
    for (int32_t v = first; v < end; v++) {
        pel_record before = state->velocity[v], after = state->velocity_next[v];
        square += sums->sim->model->mass[v] * (after * after + before * before);
    }
    return 0.5 * sums->drag_gain * sum_of(square);
}

typedef struct slice_motion {
    pel_wide3 before, after; /* velocities */
} slice_motion;

/* damping along the volumetric springs of a slice, with the mean velocity, over the step [J] */
static pel_wide radial_loss(const pel_sim *sim, int32_t slice, const double *factors, const slice_motion *motion)
{
    const pel_wide *radial = (const pel_wide *)sim->model->volumetric_damping;
    const pel_wide3 *v = &motion->before, *w = &motion->after;
    pel_wide3 x = pel_slice_load(sim->state->position, slice).position;
    pel_wide3 rest = pel_slice_load(sim->model->rest, slice).position;
    pel_wide3 e = {x.x - rest.x, x.y - rest.y, x.z - rest.z}, twice = {v->x + w->x, v->y + w->y, v->z + w->z};
    pel_wide along = pel_wide3_dot(e, twice), square = pel_wide3_dot(e, e) + pel_wide_splat(PEL_REAL_TINY);
    double gain = 0.25 * sim->step.dt * factors[PEL_VOLUMETRIC_DAMPING];
    return pel_wide_splat((pel_real)gain) * radial[slice] * along * along / square;
}

/* leapfrog: drag and damping of the vertices of a slice, but for that along volumetric springs */
static pel_wide leapfrog_loss(const vertex_sums *sums, int32_t slice, const double *factors, const slice_motion *motion)
{
    const pel_sim *sim = sums->sim;
    const pel_wide *mass = (const pel_wide *)sim->model->mass, *damping = (const pel_wide *)sim->model->damping;
    pel_wide before = damping[slice] * pel_wide_splat((pel_real)(0.5 * sim->step.dt * factors[PEL_SPRING_DAMPING]));
    pel_wide after = before + mass[slice] * pel_wide_splat((pel_real)(0.5 * sums->drag_gain));
    return after * pel_wide3_dot(motion->after, motion->after) + before * pel_wide3_dot(motion->after, motion->before);
}

/* substeps: damping of a vertex beyond the drag of the solver */
static double substep_loss(const vertex_sums *sums, int32_t v, const double *factors)
{
    const pel_sim *sim = sums->sim;
    pel_record before = sim->state->velocity[v], after = sim->state->velocity_next[v];
    double mass = (double)sim->model->mass[v];
    double damping = factors[PEL_SPRING_DAMPING] * (double)sim->model->damping[v];
    if (!(damping > 0) || !(mass > 0))
        return 0;
    double kinetic = 0.5 * mass * sum_of(before * before + after * after);
    return kinetic * (pel_tanh((sim->solver.drag + damping / mass) * sim->step.dt) - sums->drag_gain);
}

static double damping_sum(const vertex_sums *sums, int32_t slice_begin, int32_t slice_end)
{
    const pel_sim *sim = sums->sim;
    bool is_explicit = pel_sim_is_explicit(sim), has_damping = sim->ledger->has_damping;
    bool is_radial = sim->ledger->has_radial_damping;
    pel_wide sum = pel_wide_splat(0);
    double loss = 0;
    for (int32_t slice = slice_begin; slice < slice_end && (is_explicit || has_damping || is_radial); slice++) {
        const double *factors = sim->state->factors[sim->model->body_of_slice[slice]];
        slice_motion motion = {pel_slice_load(sim->state->velocity, slice).position,
                               pel_slice_load(sim->state->velocity_next, slice).position};
        if (is_explicit)
            sum += leapfrog_loss(sums, slice, factors, &motion);
        if (is_radial)
            sum += radial_loss(sim, slice, factors, &motion);
        for (int32_t lane = 0; !is_explicit && has_damping && lane < PEL_WIDTH; lane++)
            loss += substep_loss(sums, slice * PEL_WIDTH + lane, factors);
    }
    return pel_wide_sum(sum) + loss;
}

static void sum_chunk(void *context, int32_t index)
{
    const vertex_sums *sums = context;
    const pel_sim *sim = sums->sim;
    int32_t begin = index * PEL_SLICE_CHUNK, end = begin + PEL_SLICE_CHUNK;
    end = end < sim->model->slice_count ? end : sim->model->slice_count;
    pel_ledger_chunk chunk = {0};
    if (!sums->damps)
        sum_moments(sums, begin * PEL_WIDTH, end * PEL_WIDTH, &chunk);
    else if (!pel_sim_is_explicit(sim) && sums->drag_gain > 0)
        chunk.damping = drag_sum(sums, begin * PEL_WIDTH, end * PEL_WIDTH);
    if (sums->damps)
        chunk.damping += damping_sum(sums, begin, end);
    sim->ledger->chunks[index] = chunk;
}

/* the sum over all chunks, in their order */
static pel_ledger_chunk sum_vertices(pel_sim *sim, vertex_sums *sums)
{
    int32_t chunk_count = pel_slice_chunk_count(0, sim->model->slice_count);
    pel_ledger_chunk sum = {0};
    pel_pool_run(sim->pool, chunk_count, sum_chunk, sums);
    for (int32_t i = 0; i < chunk_count; i++) {
        sum.damping += sim->ledger->chunks[i].damping;
        pel_vec3_add(sum.moment, sim->ledger->chunks[i].moment, sum.moment);
    }
    return sum;
}

static void add_dissipation(pel_sim *sim)
{
    double drag = sim->solver.drag * sim->step.dt;
    sim->ledger->sums.dissipated_drag += sim->viscous_loss;
    sim->ledger->sums.dissipated_plastic += sim->plastic_loss;
    if (!pel_sim_has_velocity(sim) || !(drag > 0 || sim->ledger->has_damping || sim->ledger->has_radial_damping))
        return;
    /* half of the drag acts before the velocity in the middle of the step, half after it */
    double gain = pel_sim_is_explicit(sim) ? pel_exp(drag) - pel_exp(-drag) : pel_tanh(drag);
    vertex_sums sums = {.sim = sim, .drag_gain = gain, .damps = true};
    sim->ledger->sums.dissipated_drag += sum_vertices(sim, &sums).damping;
    /* the gain of the explicit method is of one of both energies */
    if (sim->rigids != NULL)
        sim->ledger->sums.dissipated_drag +=
            (pel_sim_is_explicit(sim) ? 0.5 : 1) * gain *
            (pel_rigids_extra_energy(sim, sim->state->rigids, sim->state->velocity) +
             pel_rigids_extra_energy(sim, sim->state->rigids_next, sim->state->velocity_next));
}

/* ---- gravity ---- */

static bool has_gravity(const pel_sim *sim)
{
    const double *g = sim->model->gravity;
    return g[0] != 0 || g[1] != 0 || g[2] != 0;
}

/* work of gravity from some positions to others, with the present masses */
static double gravity_work(pel_sim *sim, const pel_record *from, const pel_record *to)
{
    if (!has_gravity(sim))
        return 0;
    vertex_sums sums = {.sim = sim, .from = from, .to = to};
    return pel_vec3_dot(sim->model->gravity, sum_vertices(sim, &sums).moment);
}

/* Work since it was last booked. Where masses stay with their vertices this is a difference of potentials, and need not
   be asked for in every step; where a body refines each step is booked by itself. */
static double unbooked_gravity(pel_sim *sim, const pel_record *position)
{
    return sim->active == NULL ? gravity_work(sim, sim->model->rest, position) - sim->ledger->gravity_level : 0;
}

static void book_gravity(pel_sim *sim, const pel_record *position)
{
    double work = unbooked_gravity(sim, position);
    sim->ledger->sums.work_gravity += work;
    sim->ledger->gravity_level += work;
}

static void add_gravity(pel_sim *sim)
{
    double factor = 0.5 * (sim->state->load_factor_before + sim->state->load_factor);
    if (sim->active != NULL || sim->solver.path == PEL_PATH_ARC_LENGTH)
        sim->ledger->sums.work_gravity += factor * gravity_work(sim, sim->state->position, sim->state->position_next);
    else if (sim->state->step % GRAVITY_INTERVAL == GRAVITY_INTERVAL - 1)
        book_gravity(sim, sim->state->position_next);
}

/* ---- pressure ---- */

static double potential_work(pel_sim *sim, int32_t b, const pel_span spans[2])
{
    const pel_body *body = &sim->model->bodies[b];
    double *known = &sim->ledger->volumes[b];
    /* an event of refinement changes the volume between two steps */
    double before =
        isnan(*known) || body->front != NULL ? pel_body_volume(sim->model, b, sim->state->position) : *known;
    bool is_moved = sim->contacts != NULL || sim->tools->count > 0;
    double checked = sim->checked_volumes[b], work = 0;
    double after = is_moved || isnan(checked) ? pel_body_volume(sim->model, b, sim->state->position_next) : checked;
    sim->checked_volumes[b] = (double)NAN;
    *known = after;
    const double factors[2] = {sim->state->load_factor_before, sim->state->load_factor};
    const bool falls = pel_loads_begin_at_once(sim) &&
                       pel_pressure_difference(body->shell, spans[0], factors[0], before, body->rest_volume) != 0;
    for (int i = falls; i < 2; i++)
        work +=
            (falls ? 1 : 0.5) * (pel_pressure_potential(body->shell, spans[i], factors[i], before, body->rest_volume) -
                                 pel_pressure_potential(body->shell, spans[i], factors[i], after, body->rest_volume));
    return work;
}

/* N, sets sim->force to the pressures without a potential on the positions at the start of the step */
static double find_followers(pel_sim *sim, pel_span span, double load_factor)
{
    double square = 0;
    memset(sim->force, 0, (size_t)sim->model->vertex_count * sizeof *sim->force);
    pel_shell_forces_set_load_factor(sim->shells, load_factor);
    pel_shell_forces_add(sim->shells, sim->state->position, span, PEL_SHELL_FOLLOWER, sim->pool, sim->force);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        square += sum_of(sim->force[v] * sim->force[v]);
    return sqrt(square);
}

/* pressures without a potential, of all bodies */
static double follower_work(pel_sim *sim, const pel_span spans[2])
{
    const pel_state *state = sim->state;
    double work = 0;
    if (find_followers(sim, spans[0], state->load_factor_before) > 0 && pel_loads_begin_at_once(sim))
        find_followers(sim, spans[1], state->load_factor);
    pel_shell_forces_set_load_factor(sim->shells, state->load_factor);
    pel_shell_forces_add(sim->shells, state->position_next, spans[1], PEL_SHELL_FOLLOWER, sim->pool, sim->force);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        work += 0.5 * sum_of(sim->force[v] * (state->position_next[v] - state->position[v]));
    return work;
}

static void add_pressure(pel_sim *sim, double time, double next)
{
    bool follows = false;
    double work = 0;
    pel_span spans[2];
    /* pressures that move or follow a surface within the step have no potential */
    if (sim->loads->pressed != NULL) {
        sim->ledger->sums.work_pressure += sim->loads->pressure_work;
        return;
    }
    pel_loads_find_spans(sim, time, next, spans);
    for (int32_t b = 0; sim->shells != NULL && b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        follows |= !pel_shell_has_potential(body);
        if (body->shell == NULL || body->shell->pressure.kind == PEL_PRESSURE_NONE)
            continue;
        if (pel_pressure_is_conservative(body))
            work += potential_work(sim, b, spans);
    }
    sim->ledger->sums.work_pressure += work + (follows ? follower_work(sim, spans) : 0);
}

/* ---- material that changes in time ---- */

static double spring_energy(const pel_sim *sim, int32_t b)
{
    const pel_body *body = &sim->model->bodies[b];
    double sum = 0;
    for (int32_t slice = body->slice_begin; slice < body->slice_end; slice++)
        sum = pel_slice_energy_add(sim->model, sim->state, slice, true, sum);
    return sum;
}

/* springs whose keyed stiffness is another one than in the step before */
static double stiffening_work(pel_sim *sim, int32_t b)
{
    double *present = sim->state->factors[b], *before = sim->ledger->factors[b], kept[PEL_PARAMETER_COUNT];
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
            if (shell->regions[r].course.key_count > 0)
                return true;
    }
    return false;
}

static void add_material(pel_sim *sim, double time, double next)
{
    double work = sim->growth_work;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        work += stiffening_work(sim, b);
    if (has_keyed_fibres(sim)) {
        /* a minimisation has the new rest length from its start, the other methods from the end of the step */
        const pel_record *at = sim->stepper->is_at_end ? sim->state->position : sim->state->position_next;
        work += pel_shell_forces_add(sim->shells, at, pel_instant(next), PEL_SHELL_FIBRES, sim->pool, NULL).fibres -
                pel_shell_forces_add(sim->shells, at, pel_instant(time), PEL_SHELL_FIBRES, sim->pool, NULL).fibres;
    }
    sim->ledger->sums.work_material += work;
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
    double sine = pel_vec3_length(axis), angle = 2 * pel_atan2(sine, fabs(scalar));
    pel_vec3_scale(axis, sine > 0 ? (scalar < 0 ? -angle : angle) / sine : 0, rotation);
}

/* Gaps that stay open where a tool cannot go on close while it stands, which is work too: the mean load of the step
   times the ways along normals that surfaces go off the tool [J]. A step goes to rest in tries, whose first loads also
   drag what settles: each takes back what the one before has booked. */
static double closing_work(pel_sim *sim, int32_t t)
{
    const pel_tool *tool = &sim->tools->items[t];
    const pel_contact_forces *forces = &sim->contact_forces;
    pel_closing *closing = &sim->ledger->closings[t];
    double load_before = 0, load = 0, approach = 0;
    if (!sim->stepper->is_static || !forces->is_kept || !(tool->is_held_back || tool->stride < 1))
        return 0;
    for (int32_t b = 0; b < forces->body_count; b++) {
        const int32_t at = b * forces->group_count + forces->body_count + t;
        load_before += forces->pair[at].load_size;
        load += forces->pair_next[at].load_size;
        approach += forces->pair_next[at].approach;
    }
    if (!closing->is_open || closing->step != sim->state->step)
        *closing = (pel_closing){.is_open = true, .step = sim->state->step, .load = load_before};
    double booked = closing->booked;
    closing->way -= load > 0 ? approach / load : 0;
    closing->booked = 0.5 * (closing->load + load) * closing->way;
    return closing->booked - booked;
}

/* how a tool went in the step, with the force and torque that its work is of */
typedef struct tool_motion {
    pel_tool_reading now;
    double force[3], torque[3], shift[3], rotation[3];
    double work; /* J, by these */
    bool is_known;
} tool_motion;

/* J, that tools are known to have put into what they touch: what one puts in another one may take out */
static double given_by_all(const pel_sim *sim)
{
    double sum = 0;
    for (int32_t t = 0; t < sim->tools->count; t++)
        sum += sim->ledger->given[t];
    return sum;
}

/* Readings of methods with velocities are impulses over dt, means of the step; the others are forces at its end. What
   layers have stored in steps whose force was not known is not known either: until the tool touches nothing, neither is
   what it takes out beyond what tools are known to have put in since they touched. */
static void find_motion(const pel_sim *sim, int32_t t, tool_motion *motion)
{
    const pel_tool_reading *before = &sim->ledger->tools[t];
    double share = pel_sim_has_velocity(sim) ? 1 : 0.5;
    pel_sim_get_tool(sim, t, &motion->now);
    for (int i = 0; i < 3; i++) {
        motion->force[i] = share * motion->now.force[i] + (1 - share) * before->force[i];
        motion->torque[i] = share * motion->now.torque[i] + (1 - share) * before->torque[i];
    }
    pel_vec3_subtract(motion->now.position, before->position, motion->shift);
    rotation_between(before->rotation, motion->now.rotation, motion->rotation);
    motion->work = -pel_vec3_dot(motion->force, motion->shift) - pel_vec3_dot(motion->torque, motion->rotation);
    const pel_tool *tool = &sim->tools->items[t];
    bool takes_more = motion->work < 0 && motion->work + sim->ledger->unsure.given < 0;
    motion->is_known = !tool->is_held_back && !tool->is_doubtful && !(sim->ledger->owes[t] && takes_more);
}

static void add_tools(pel_sim *sim)
{
    for (int32_t t = 0; t < sim->tools->count; t++) {
        tool_motion motion;
        find_motion(sim, t, &motion);
        double closing = closing_work(sim, t);
        if (motion.is_known) {
            sim->ledger->sums.work_tools += closing + motion.work;
            sim->ledger->given[t] += closing + motion.work;
        } else
            sim->ledger->unsure.most += fabs(closing);
        bool touches = motion.now.contact_count > 0 || motion.now.held_count > 0;
        sim->ledger->given[t] = touches ? sim->ledger->given[t] : 0;
        sim->ledger->owes[t] = touches && (sim->ledger->owes[t] || !motion.is_known);
        sim->ledger->tools[t] = motion.now;
    }
    sim->ledger->sums.work_tools += pel_tools_follow_work(sim) + sim->tie_work;
}

static double remainder_at_present(pel_sim *sim)
{
    sim->present.has_force = false;
    double remainder = pel_ledger_remainder(sim);
    sim->present.has_force = false;
    return remainder;
}

/* the most work that tools whose forces are not known can have done in the step, and the balance before it */
static void begin_unsure(pel_sim *sim)
{
    pel_unsure_work *unsure = &sim->ledger->unsure;
    *unsure = (pel_unsure_work){.given = given_by_all(sim)};
    for (int32_t t = 0; t < sim->tools->count && !sim->ledger->is_unread; t++) {
        tool_motion motion;
        find_motion(sim, t, &motion);
        if (motion.is_known)
            continue;
        unsure->is_open = true;
        unsure->most += pel_vec3_length(motion.force) * pel_vec3_length(motion.shift) +
                        pel_vec3_length(motion.torque) * pel_vec3_length(motion.rotation);
    }
    if (unsure->is_open)
        unsure->remainder = remainder_at_present(sim);
}

/* ---- the step ---- */

/* most energy that start and works have supplied by now */
static void follow_supply(pel_sim_ledger *sums)
{
    double supplied = fabs(sums->elastic_start) + fabs(sums->kinetic_start) + fabs(sums->work_tools) +
                      fabs(sums->work_loads) + fabs(sums->work_pressure) + fabs(sums->work_gravity) +
                      fabs(sums->work_material) + fabs(sums->work_setters);
    sums->supplied = pel_max(sums->supplied, supplied);
}

/* a body that follows its growth freely takes no net work, so that this would measure no error */
static void follow_growth(pel_sim *sim)
{
    sim->ledger->sums.supplied += pel_max(0, sim->growth_size - fabs(sim->growth_work));
}

void pel_ledger_step(pel_sim *sim, double next)
{
    double time = pel_sim_time(sim);
    begin_unsure(sim);
    add_gravity(sim);
    add_dissipation(sim);
    double h = pel_sim_projects_elements(sim) && !sim->solver.second_order ? sim->step.dt / sim->solver.substeps : 0;
    sim->ledger->sums.work_loads += pel_loads_work(sim, time, next, h) + sim->loads->edge_load_work;
    sim->ledger->sums.work_tools += pel_holds_work(sim, next);
    add_pressure(sim, time, next);
    add_material(sim, time, next);
    add_tools(sim);
    follow_supply(&sim->ledger->sums);
    follow_growth(sim);
}

void pel_ledger_end_step(pel_sim *sim)
{
    pel_unsure_work *unsure = &sim->ledger->unsure;
    if (!unsure->is_open)
        return;
    unsure->is_open = false;
    double change = remainder_at_present(sim) - unsure->remainder;
    double work = pel_max(-unsure->most, pel_min(unsure->most, change));
    sim->ledger->sums.work_tools += work;
    sim->ledger->sums.work_estimated += fabs(work);
    follow_supply(&sim->ledger->sums);
}

static double kinetic_energy(const pel_sim *sim, const pel_sim_measures *measures)
{
    return pel_sim_has_velocity(sim) ? measures->kinetic_energy : 0;
}

void pel_ledger_start(pel_sim *sim)
{
    pel_sim_measures now = {0};
    if (sim->ledger->is_started)
        return;
    sim->ledger->is_started = true;
    if (sim->ledger->is_unread)
        return;
    pel_sim_sum_energies(sim, &now);
    sim->ledger->sums.elastic_start = now.elastic_energy;
    sim->ledger->sums.kinetic_start = kinetic_energy(sim, &now);
    sim->ledger->gravity_level = gravity_work(sim, sim->model->rest, sim->state->position);
    follow_supply(&sim->ledger->sums);
}

double pel_ledger_energy(pel_sim *sim)
{
    pel_sim_measures now = {0};
    if (!sim->ledger->is_started)
        return 0;
    book_gravity(sim, sim->state->position);
    pel_sim_sum_energies(sim, &now);
    return now.elastic_energy + kinetic_energy(sim, &now);
}

/* energy [J] that a change between two steps added; gravity continues from the new position at no cost */
static double find_change(pel_sim *sim, double energy_before)
{
    /* a surface that refines while the simulation is made has no volumes yet */
    for (int32_t b = 0; sim->ledger->volumes != NULL && b < sim->model->body_count; b++)
        sim->ledger->volumes[b] = (double)NAN;
    if (!sim->ledger->is_started)
        return 0;
    sim->ledger->gravity_level = gravity_work(sim, sim->model->rest, sim->state->position);
    return pel_ledger_energy(sim) - energy_before;
}

void pel_ledger_book_change(pel_sim *sim, double energy_before)
{
    sim->ledger->sums.work_setters += find_change(sim, energy_before);
    follow_supply(&sim->ledger->sums);
}

void pel_ledger_book_cut(pel_sim *sim, double energy_before)
{
    sim->ledger->sums.dissipated_fracture -= find_change(sim, energy_before);
}

void pel_ledger_book_remesh(pel_sim *sim, double energy_before)
{
    sim->ledger->sums.dissipated_remesh -= find_change(sim, energy_before);
}

void pel_ledger_book_tear(pel_sim *sim, double energy)
{
    sim->ledger->sums.dissipated_fracture += energy;
}

double pel_ledger_remainder(pel_sim *sim)
{
    pel_sim_ledger ledger;
    pel_sim_get_ledger(sim, &ledger);
    return ledger.energy_error - ledger.dissipated_solver;
}

void pel_sim_get_ledger(pel_sim *sim, pel_sim_ledger *ledger)
{
    if (sim == NULL || ledger == NULL)
        return;
    pel_sim_measures now = {0};
    *ledger = sim->ledger->sums;
    pel_sim_sum_energies(sim, &now);
    ledger->elastic = now.elastic_energy;
    ledger->kinetic = kinetic_energy(sim, &now);
    if (sim->ledger->is_started) {
        ledger->work_gravity += unbooked_gravity(sim, sim->state->position);
        follow_supply(ledger);
    } else {
        ledger->elastic_start = ledger->elastic;
        ledger->kinetic_start = ledger->kinetic;
    }
    double work = ledger->work_tools + ledger->work_loads + ledger->work_pressure + ledger->work_gravity +
                  ledger->work_material + ledger->work_setters;
    double gained = ledger->elastic + ledger->kinetic - ledger->elastic_start - ledger->kinetic_start;
    /* modes are drawn: nothing supplies their energy */
    double left = sim->modes != NULL ? 0
                                     : gained - work + ledger->dissipated_drag + ledger->dissipated_fracture +
                                           ledger->dissipated_remesh + ledger->dissipated_plastic;
    ledger->dissipated_solver = pel_max(-left, 0);
    ledger->energy_error = pel_max(left, 0);
    const double h = sim->step.dt / pel_max(1, sim->solver.substeps);
    const double of_velocities = h > 0 ? sim->ledger->rounding_moment / (h * h) : 0;
    ledger->tolerance = EXCESS_SHARE * ledger->supplied + sim->ledger->rounding + of_velocities;
}

/* ---- creation ---- */

/* J, of the work against enclosed gases: their pressure is large at rest too */
static double gas_energy(const pel_model *model)
{
    double sum = 0;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_shell *shell = model->bodies[b].shell;
        if (shell != NULL && shell->pressure.kind == PEL_PRESSURE_GAS)
            sum += shell->pressure.value * fabs(model->bodies[b].rest_volume);
    }
    return sum;
}

/* J, of Young's modulus of tetrahedra over their volume: their energies are differences of numbers of this size */
static double solid_energy(const pel_model *model)
{
    double sum = 0;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_shell *shell = model->bodies[b].shell;
        pel_rest_tetra rest;
        for (int32_t t = 0; shell != NULL && t < shell->tetrahedron_count; t++)
            sum += pel_filled_rest(shell, model->rest, t, &rest);
    }
    return sum;
}

/* half the largest stiffness times the square of the rounding of positions, the weight times that rounding and the
   slack of contacts inside the solve, the same share of the energy of gases, and the rounding of that of solids.
   *moment [J s2]: half the mass times the square of the first rounding */
static double rounding_of(const pel_sim *sim, double *moment)
{
    const pel_model *model = sim->model;
    pel_stability stability;
    double farthest = 0, mass = 0;
    pel_stability_bound(model, &stability);
    pel_shell_stability_bound(sim->shells, &stability);
    for (int32_t v = 0; v < model->vertex_count; v++) {
        mass += (double)model->mass[v];
        for (int c = 0; c < 3; c++)
            farthest = pel_max(farthest, fabs((double)model->rest[v][c]));
    }
    double share = pel_max(ROUNDING_ERRORS * (double)PEL_REAL_EPSILON, ROUNDING_SHARE), shift = share * farthest;
    double weight = mass * sqrt(pel_vec3_dot(model->gravity, model->gravity));
    double slack = sim->contacts != NULL && sim->contact_in_loop ? PEL_SLACK_SHARE * sim->contacts->largest : 0;
    *moment = 0.5 * mass * shift * shift;
    return 0.5 * mass * stability.stiffness_bound * shift * shift + weight * (shift + slack) +
           share * gas_energy(model) + ROUNDING_ERRORS * (double)PEL_REAL_EPSILON * solid_energy(model);
}

static bool has_any(const pel_real *numbers, int32_t count)
{
    for (int32_t v = 0; v < count; v++)
        if (numbers[v] > 0)
            return true;
    return false;
}

void pel_ledger_follow(pel_sim *sim)
{
    for (int32_t t = 0; t < sim->tools->count; t++)
        pel_sim_get_tool(sim, t, &sim->ledger->tools[t]);
    memset(sim->ledger->closings, 0, (size_t)sim->tools->count * sizeof *sim->ledger->closings);
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        memcpy(sim->ledger->factors[b], sim->state->factors[b], sizeof *sim->ledger->factors);
        sim->ledger->volumes[b] = sim->checked_volumes[b] = (double)NAN;
    }
}

void pel_ledger_refill(pel_sim *sim)
{
    pel_ledger *ledger = sim->ledger;
    ledger->has_damping = has_any(sim->given->damping, sim->given->vertex_count);
    ledger->has_radial_damping = has_any(sim->given->volumetric_damping, sim->given->vertex_count);
    ledger->rounding = rounding_of(sim, &ledger->rounding_moment);
}

pel_status pel_ledger_create(pel_sim *sim, pel_error *error)
{
    pel_ledger *ledger = sim->ledger;
    size_t body_count = (size_t)sim->model->body_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(ledger->tools, sim->tools->count), PEL_ROOM(ledger->closings, sim->tools->count),
                          PEL_ROOM(ledger->owes, sim->tools->count), PEL_ROOM(ledger->given, sim->tools->count),
                          PEL_ROOM(ledger->factors, body_count), PEL_ROOM(ledger->volumes, body_count),
                          PEL_ROOM(sim->checked_volumes, body_count),
                          PEL_ROOM(ledger->chunks, pel_slice_chunk_count(0, sim->model->slice_count))))
        return pel_fail_memory(error);
    pel_ledger_refill(sim);
    pel_ledger_follow(sim);
    return PEL_OK;
}

void pel_ledger_destroy(pel_sim *sim)
{
    PEL_FREE_ALL(sim->ledger->tools, sim->ledger->closings, sim->ledger->owes, sim->ledger->given, sim->ledger->factors,
                 sim->ledger->volumes, sim->checked_volumes, sim->ledger->chunks);
}

/* ---- snapshots ---- */

void pel_ledger_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_ledger *ledger = sim->ledger;
    pel_transfer(at, &ledger->sums, sizeof ledger->sums);
    pel_transfer(at, &ledger->gravity_level, sizeof ledger->gravity_level);
    pel_transfer(at, &ledger->is_started, sizeof ledger->is_started);
    pel_transfer(at, ledger->owes, (size_t)sim->tools->count);
    pel_transfer(at, ledger->given, (size_t)sim->tools->count * sizeof *ledger->given);
}
