#include "minimise/step_path.h"

#include "base/memory.h"
#include "base/status.h"
#include "boundary/fluid.h"
#include "boundary/follower.h"
#include "boundary/hold.h"
#include "boundary/loads.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "minimise/free_body.h"
#include "minimise/rounds.h"
#include "minimise/step_newton.h"
#include "stage/accessors.h"
#include "tool/tool.h"

#include <string.h>

/* of the load factor, in the first step */
#define FIRST_CHANGE 0.05
/* systems of a step whose length is right; lengths change by these factors at most */
#define GOOD_ITERATIONS 6.0
#define SHRINK 0.5
#define GROWTH 1.6
/* of the size of the bodies, that a step is long at most */
#define MOST_SHARE 0.05
/* shorter steps after one that does not converge; steps that meet the factor 1 */
enum { MOST_HALVINGS = 8, MOST_MEETINGS = 30 };
#define MEETING_ERROR 1e-9
/* of the slope, at a limit point: the factor there is 1e-6 of its change in the step too small */
#define LIMIT_ERROR 1e-3
/* of the load factor, at a crossing; halvings that find it */
#define CROSSING_ERROR 1e-3
enum { MOST_CROSSING_HALVINGS = 16 };
/* of the load factor, beyond a crossing, to look for another branch; of the way there, the length of the next step */
#define LEAST_BEYOND 0.01
#define MOST_BEYOND 0.1
#define BEYOND_GROWTH 3.0
#define BRANCH_STEP 0.5

pel_status pel_sim_path_create(pel_sim *sim, pel_error *error)
{
    pel_sim_path *made = sim->path = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    size_t count = (size_t)pel_newton_pattern(sim->newton)->unknown_count;
    made->path.direction = pel_allocate(count, sizeof *made->path.direction);
    if (made->path.direction == NULL)
        return pel_fail_memory(error);
    made->path.first_change = FIRST_CHANGE;
    made->path.most_length = sim->solver.arc_length > 0 ? sim->solver.arc_length : MOST_SHARE * sim->minimise->size;
    sim->state->load_factor = sim->state->load_factor_before = 0;
    pel_shell_forces_set_load_factor(sim->shells, 0);
    return PEL_OK;
}

void pel_sim_path_destroy(pel_sim *sim)
{
    if (sim->path == NULL)
        return;
    pel_free(sim->path->path.direction);
    pel_free(sim->path);
}

/* ---- refused features ---- */

static bool is_keyed(const pel_sim *sim)
{
    bool any = false;
    for (int32_t l = 0; l < sim->loads->count; l++)
        any |=
            sim->loads->items[l].key_count > 0 || sim->loads->items[l].from > 0 || isfinite(sim->loads->items[l].until);
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        any |= shell != NULL && (shell->outside.key_count > 0 || shell->target.key_count > 0);
    }
    for (int32_t h = 0; sim->holds != NULL && h < sim->holds->hold_count; h++)
        any |= sim->holds->holds[h].key_count > 0;
    return any;
}

static void set_factor(pel_sim *sim, double factor)
{
    sim->state->load_factor = factor;
    pel_shell_forces_set_load_factor(sim->shells, factor);
}

pel_status pel_sim_path_check(pel_sim *sim, pel_error *error)
{
    if (sim->tools->count > 0 || sim->contacts != NULL) {
        pel_fail(error, PEL_BAD_ARGUMENT, "a path by arc length does not support %s",
                 sim->tools->count > 0 ? "tools" : "contact");
        pel_fail_remedy(error, "remove the %s, or use path: time", sim->tools->count > 0 ? "tools" : "contact");
        return PEL_BAD_ARGUMENT;
    }
    if (is_keyed(sim))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "remove the keys: all loads grow together from 0 to their full size",
                          "a path by arc length finds the load factor, but a load, pressure or support has "
                          "keys, from or until");
    if (!pel_loads_act(sim))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "add loads, or use path: time, which moves supports by their keys",
                          "no load, gravity or pressure acts that a path by arc length could follow");
    /* at rest no load acts yet */
    set_factor(sim, 1);
    pel_status status = pel_minimise_check_start(sim, error);
    set_factor(sim, 0);
    if (status == PEL_OK)
        status = pel_fluids_refuse(sim, "a path by arc length", error);
    return status == PEL_OK ? pel_followers_refuse(sim, "a path by arc length needs", error) : status;
}

/* ---- a step ---- */

/* the unknowns of the state, with the loads at factor 1 */
static pel_newton_frames gather_full_load(pel_sim *sim, double time)
{
    double factor = sim->state->load_factor;
    set_factor(sim, 1);
    pel_newton_frames frames = pel_sim_newton_gather(sim, pel_instant(time), true);
    set_factor(sim, factor);
    return frames;
}

static pel_newton_problem make_problem(pel_sim *sim)
{
    pel_sim_newton *newton = sim->minimise->newton;
    pel_newton_problem problem = {
        .span = pel_instant(pel_sim_next_time(sim)), .state = sim->state, .force = newton->loads};
    double factor = sim->state->load_factor;
    set_factor(sim, 1);
    problem.tolerance = pel_minimise_tolerance(sim, problem.span.time);
    set_factor(sim, factor);
    problem.frames = gather_full_load(sim, problem.span.time);
    problem.tolerance =
        pel_hypot(problem.tolerance, pel_minimise_held_share() * pel_newton_moment_force(sim->newton, newton->loads));
    problem.held_share = pel_minimise_held_share();
    problem.short_move = pel_minimise_short_move(sim);
    problem.fixed = newton->fixed;
    problem.target = newton->target;
    problem.iterations = sim->solver.iterations > 0 ? sim->solver.iterations : PEL_STATIC_ITERATIONS;
    problem.load_factor = &sim->state->load_factor;
    return problem;
}

/* from the state before to the present one, along x, y, z */
static void find_direction(const pel_sim *sim)
{
    double *direction = sim->path->path.direction;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            direction[3 * v + k] = (double)sim->state->position[v][k] - (double)sim->state->position_before[v][k];
}

/* a shorter step where one does not converge */
static pel_status follow(pel_sim *sim, const pel_newton_problem *problem, pel_newton_result *result, pel_error *error)
{
    pel_newton_path *path = &sim->path->path;
    pel_sim_newton *newton = sim->minimise->newton;
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < MOST_HALVINGS; i++) {
        int32_t before = sim->minimise->result.iterations;
        status = pel_newton_follow(sim->newton, problem, newton->unknowns, path, result, error);
        sim->minimise->result.iterations = before + result->iterations;
        if (result->converged)
            return status;
        path->length *= SHRINK;
        path->first_change *= SHRINK;
    }
    return status;
}

/* what a shorter step from the same start ends at */
typedef double path_excess(const pel_newton_path *path);

static double over_full_load(const pel_newton_path *path)
{
    return path->factor - 1;
}

static double slope_of(const pel_newton_path *path)
{
    return path->slope;
}

/* an end of the interval of lengths in which a step meets a zero */
typedef struct path_end {
    double length, excess;
} path_end;

/* A shorter step from the same start, with the factor there: regula falsi from the step that was just gone, where an
   end that stays counts half (Illinois; Dowell, Jarratt 1971). */
static pel_status meet(pel_sim *sim, const pel_newton_problem *problem, double start, path_excess *excess_of,
                       path_end low, double tolerance, pel_newton_result *result, pel_error *error)
{
    pel_newton_path *path = &sim->path->path;
    pel_sim_newton *newton = sim->minimise->newton;
    path_end high = {path->length, excess_of(path)};
    bool was_low = false;
    pel_status status = PEL_OK;
    for (int i = 0; result->converged && i < MOST_MEETINGS && fabs(excess_of(path)) > tolerance; i++) {
        path->length = low.length + (high.length - low.length) * low.excess / (low.excess - high.excess);
        path->factor = start;
        newton->goes_on = false;
        gather_full_load(sim, problem->span.time);
        find_direction(sim);
        status = pel_newton_follow(sim->newton, problem, newton->unknowns, path, result, error);
        sim->minimise->result.iterations += result->iterations;
        if (status != PEL_OK)
            return status;
        double excess = excess_of(path);
        bool is_low = excess * low.excess > 0;
        *(is_low ? &low : &high) = (path_end){path->length, excess};
        if (i > 0 && is_low == was_low)
            (is_low ? &high : &low)->excess *= 0.5;
        was_low = is_low;
    }
    result->converged &= fabs(excess_of(path)) <= tolerance;
    return status;
}

static pel_status meet_full_load(pel_sim *sim, const pel_newton_problem *problem, double start,
                                 pel_newton_result *result, pel_error *error)
{
    return meet(sim, problem, start, over_full_load, (path_end){0, start - 1}, MEETING_ERROR, result, error);
}

/* A step that passes a limit point ends at it. Where none is found (a slope that jumps: a bifurcation) it stays. */
static pel_status meet_limit(pel_sim *sim, const pel_newton_problem *problem, double start, pel_newton_result *result,
                             pel_error *error)
{
    pel_sim_path *own = sim->path;
    double before = own->slope, beyond = own->path.slope, length = own->path.length;
    own->slope = beyond;
    if (!(before * beyond < 0))
        return PEL_OK;
    double tolerance = LIMIT_ERROR * pel_max(fabs(before), fabs(beyond));
    pel_status status = meet(sim, problem, start, slope_of, (path_end){0, before}, tolerance, result, error);
    if (status != PEL_OK)
        return status;
    if (result->converged && own->limit_count < PEL_LIMIT_POINTS)
        own->limits[own->limit_count++] = (pel_limit_point){sim->state->step + 1, own->path.factor,
                                                            before > 0 ? PEL_LIMIT_MAXIMUM : PEL_LIMIT_MINIMUM};
    if (result->converged)
        return PEL_OK;
    own->path.length = length;
    own->path.factor = start;
    sim->minimise->newton->goes_on = false;
    gather_full_load(sim, problem->span.time);
    find_direction(sim);
    return follow(sim, problem, result, error);
}

static bool has_limit(const pel_sim_path *own)
{
    int32_t i = 0;
    while (i < own->limit_count && own->limits[i].kind == PEL_LIMIT_BIFURCATION)
        i++;
    return i < own->limit_count;
}

/* before a limit point the balance loses its stability only where another path crosses */
static bool is_beyond_crossing(const pel_sim_path *own)
{
    return !has_limit(own) && own->path.slope > 0 && !own->path.is_stable;
}

/* A step that passes a crossing ends shortly beyond it, which halving finds. */
static pel_status meet_crossing(pel_sim *sim, const pel_newton_problem *problem, double start,
                                pel_newton_result *result, pel_error *error)
{
    pel_newton_path *path = &sim->path->path;
    double low = 0, high = path->length, low_factor = start, high_factor = path->factor;
    pel_status status = PEL_OK;
    for (int i = 0; i <= MOST_CROSSING_HALVINGS && status == PEL_OK; i++) {
        bool is_near = i == MOST_CROSSING_HALVINGS ||
                       high_factor - low_factor <= CROSSING_ERROR * pel_max(fabs(high_factor), fabs(low_factor));
        if (is_near && path->factor == high_factor)
            return PEL_OK;
        path->length = is_near ? high : 0.5 * (low + high);
        path->factor = start;
        sim->minimise->newton->goes_on = false;
        gather_full_load(sim, problem->span.time);
        find_direction(sim);
        status = follow(sim, problem, result, error);
        if (is_near || !result->converged)
            return status;
        bool is_high = is_beyond_crossing(sim->path);
        *(is_high ? &high : &low) = path->length;
        *(is_high ? &high_factor : &low_factor) = path->factor;
    }
    return status;
}

/* root of the mean square of the displacements from the state at the start of the step to the unknowns */
static double way_of(const pel_sim *sim)
{
    const double *unknowns = sim->minimise->newton->unknowns;
    double square = 0, mass = 0;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3 && sim->model->mesh_vertex[v] >= 0; k++) {
            double own = (double)sim->model->mass[v], way = unknowns[3 * v + k] - (double)sim->state->position[v][k];
            square += own * way * way;
            mass += own / 3;
        }
    return sqrt(square / mass);
}

/* The crossing of a step that began stable is met and counted. */
static pel_status cross(pel_sim *sim, const pel_newton_problem *problem, double start, pel_newton_result *result,
                        pel_error *error)
{
    pel_sim_path *own = sim->path;
    /* the first step has no direction yet that a shorter one could take */
    pel_status status = sim->state->step > 0 ? meet_crossing(sim, problem, start, result, error) : PEL_OK;
    if (status != PEL_OK || !result->converged)
        return status;
    if (own->path.factor < 1)
        own->ended = PEL_PATH_GOES_ON;
    if (own->limit_count < PEL_LIMIT_POINTS)
        own->limits[own->limit_count++] =
            (pel_limit_point){sim->state->step + 1, own->path.factor, PEL_LIMIT_BIFURCATION};
    return PEL_OK;
}

/* the last step ended at a crossing that the scene says to leave along the lowest mode */
static bool leaves(const pel_sim *sim)
{
    const pel_sim_path *own = sim->path;
    if (sim->solver.branch != PEL_BRANCH_LOWEST || !own->is_unstable || own->limit_count == 0)
        return false;
    const pel_limit_point *last = &own->limits[own->limit_count - 1];
    return last->kind == PEL_LIMIT_BIFURCATION && last->step == sim->state->step;
}

/* From a crossing to the minimum of the energy beside the path, under loads that are a little larger: at the crossing
   itself the energy is flat. result->converged: there is one. */
static pel_status leave(pel_sim *sim, const pel_newton_problem *problem, double start, pel_newton_result *result,
                        pel_error *error)
{
    pel_sim_path *own = sim->path;
    pel_status status = PEL_OK;
    result->converged = false;
    for (double beyond = LEAST_BEYOND; beyond <= MOST_BEYOND && status == PEL_OK; beyond *= BEYOND_GROWTH) {
        double factor = pel_min(start * (1 + beyond), 1);
        sim->minimise->newton->goes_on = false;
        gather_full_load(sim, problem->span.time);
        set_factor(sim, factor);
        status = pel_newton_run(sim->newton, problem, sim->minimise->newton->unknowns, result, error);
        sim->minimise->result.iterations += result->iterations;
        result->converged &= !result->unstable;
        if (status != PEL_OK || !result->converged)
            continue;
        own->path.factor = factor;
        own->path.iterations = (int32_t)GOOD_ITERATIONS;
        own->path.length = pel_min(BRANCH_STEP * way_of(sim), own->path.most_length);
        own->slope = (double)NAN;
        own->is_unstable = false;
        own->ended = factor == 1 ? PEL_PATH_END_FULL_LOAD : PEL_PATH_GOES_ON;
        return PEL_OK;
    }
    sim->minimise->newton->goes_on = false;
    set_factor(sim, start);
    gather_full_load(sim, problem->span.time);
    return status;
}

static void take(pel_sim *sim, const pel_newton_result *result)
{
    const pel_sim_newton *newton = sim->minimise->newton;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3 && sim->model->mesh_vertex[v] >= 0; k++)
            sim->state->position_next[v][k] = (pel_real)newton->unknowns[3 * v + k];
    pel_descent_result *own = &sim->minimise->result;
    own->evaluations = 2 * own->iterations + 1;
    own->energy = result->energy;
    own->residual = result->residual;
    own->held_force = result->held_force;
    own->converged = result->converged;
    own->unstable = result->unstable;
}

static void adapt_length(pel_sim *sim)
{
    pel_newton_path *path = &sim->path->path;
    double change = sqrt(GOOD_ITERATIONS / pel_max(path->iterations, 1));
    path->length *= pel_min(pel_max(change, SHRINK), GROWTH);
    path->length = pel_min(path->length, path->most_length);
}

/* start from equilibrium without loads: bodies may be prestressed, or supports displaced */
static pel_status begin(pel_sim *sim, const pel_newton_problem *problem, pel_newton_result *result, pel_error *error)
{
    pel_sim_newton *newton = sim->minimise->newton;
    return pel_newton_run(sim->newton, problem, newton->unknowns, result, error);
}

/* the equilibrium beside the leading simulation, which has taken its step along the path */
static pel_status step_beside(pel_sim *sim, const pel_newton_problem *problem, pel_error *error)
{
    pel_newton_result result;
    double factor;
    pel_status status = pel_newton_run_beside(sim->newton, problem, sim->minimise->newton->lead,
                                              sim->minimise->newton->unknowns, &factor, &result, error);
    if (status != PEL_OK)
        return status;
    take(sim, &result);
    set_factor(sim, factor);
    return PEL_OK;
}

/* the limit point or the full load that a step passes, whichever comes first: it ends there */
static pel_status meet_marks(pel_sim *sim, const pel_newton_problem *problem, double start, pel_newton_result *result,
                             pel_error *error)
{
    pel_sim_path *own = sim->path;
    pel_status status = PEL_OK;
    if (sim->state->step > 0)
        status = meet_limit(sim, problem, start, result, error);
    else
        own->slope = own->path.slope;
    if (status != PEL_OK || !result->converged || !(start < 1 && own->path.factor >= 1))
        return status;
    own->ended = PEL_PATH_END_FULL_LOAD;
    if (own->limit_count > 0 && own->limits[own->limit_count - 1].step == sim->state->step + 1)
        own->limit_count--;
    return sim->state->step > 0 ? meet_full_load(sim, problem, start, result, error) : PEL_OK;
}

/* a length along the path, to the first point that it is to end at */
static pel_status advance(pel_sim *sim, const pel_newton_problem *problem, double start, pel_newton_result *result,
                          pel_error *error)
{
    pel_sim_path *own = sim->path;
    pel_status status = PEL_OK;
    if (own->path.length > 0)
        find_direction(sim);
    else
        status = begin(sim, problem, result, error);
    if (status == PEL_OK && result->converged)
        status = follow(sim, problem, result, error);
    double length = own->path.length;
    if (status == PEL_OK && result->converged)
        status = meet_marks(sim, problem, start, result, error);
    bool was_unstable = own->is_unstable;
    own->is_unstable = status == PEL_OK && result->converged && is_beyond_crossing(own);
    if (own->is_unstable && !was_unstable)
        status = cross(sim, problem, start, result, error);
    own->path.length = length;
    if (status == PEL_OK && !result->converged)
        own->ended = PEL_PATH_END_LOST;
    bool is_left = sim->solver.branch == PEL_BRANCH_LOWEST && own->is_unstable && !was_unstable;
    result->unstable = result->converged && own->is_unstable && !is_left;
    return status;
}

pel_status pel_sim_path_step(pel_sim *sim, pel_step_result *step, pel_error *error)
{
    pel_sim_path *own = sim->path;
    pel_state *state = sim->state;
    pel_newton_result result = {.converged = true};
    pel_status status = PEL_OK;
    *step = (pel_step_result){.diverged = false};
    memcpy(state->position_next, state->position, (size_t)sim->model->vertex_count * sizeof *state->position);
    state->load_factor_before = state->load_factor;
    sim->minimise->result = (pel_descent_result){.converged = own->ended != PEL_PATH_END_LOST};
    if (own->ended != PEL_PATH_GOES_ON)
        return PEL_OK;
    pel_sim_newton_begin(sim);
    pel_shell_forces_follow(sim->shells, state->position);
    const pel_newton_problem problem = make_problem(sim);
    if (sim->minimise->newton->lead != NULL)
        return step_beside(sim, &problem, error);
    double start = own->path.factor = state->load_factor;
    bool left = leaves(sim);
    if (left) {
        status = leave(sim, &problem, start, &result, error);
        left = result.converged;
        result.converged = true;
    }
    if (status == PEL_OK && !left)
        status = advance(sim, &problem, start, &result, error);
    if (status != PEL_OK)
        return status;
    take(sim, &result);
    adapt_length(sim);
    set_factor(sim, own->path.factor);
    step->diverged = !pel_sim_all_inside(sim);
    return PEL_OK;
}

/* ---- questions ---- */

double pel_sim_load_factor(const pel_sim *sim)
{
    if (sim == NULL)
        return 0;
    return sim->state->load_factor;
}

pel_path pel_sim_path_kind(const pel_sim *sim)
{
    if (sim == NULL)
        return (pel_path)0;
    return sim->solver.path;
}

pel_path_end pel_sim_get_path_end(const pel_sim *sim)
{
    if (sim == NULL)
        return (pel_path_end)0;
    return sim->path != NULL ? (pel_path_end)sim->path->ended : PEL_PATH_GOES_ON;
}

int32_t pel_sim_get_limit_points(const pel_sim *sim, pel_limit_point *points)
{
    if (sim == NULL || sim->path == NULL)
        return 0;
    if (points != NULL)
        memcpy(points, sim->path->limits, (size_t)sim->path->limit_count * sizeof *points);
    return sim->path->limit_count;
}

/* ---- snapshots ---- */

void pel_sim_path_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->path == NULL)
        return;
    pel_state *state = sim->state;
    pel_newton_path *path = &sim->path->path;
    pel_transfer(at, &path->length, sizeof path->length);
    pel_transfer(at, &path->first_change, sizeof path->first_change);
    pel_transfer(at, &path->stiffness, sizeof path->stiffness);
    pel_transfer(at, &sim->path->ended, sizeof sim->path->ended);
    pel_transfer(at, &sim->path->slope, sizeof sim->path->slope);
    pel_transfer(at, &sim->path->is_unstable, sizeof sim->path->is_unstable);
    pel_transfer(at, &sim->path->limit_count, sizeof sim->path->limit_count);
    pel_transfer(at, sim->path->limits, sizeof sim->path->limits);
    pel_transfer(at, &state->load_factor, sizeof state->load_factor);
    pel_transfer(at, &state->load_factor_before, sizeof state->load_factor_before);
}
