/* The method `static`: each step is the state of rest under the loads at its end, found by Newton's method. */
#include "attach/joint.h"
#include "base/status.h"
#include "boundary/hold.h"
#include "boundary/loads.h"
#include "constraint/constraint.h"
#include "force/pressure.h"
#include "math/extremes.h"
#include "math/pose.h"
#include "minimise/free_body.h"
#include "minimise/rounds.h"
#include "minimise/step_modes.h"
#include "minimise/step_newton.h"
#include "minimise/step_path.h"
#include "stage/rigid_motion.h"
#include "stage/rigids.h"
#include "tool/tool.h"
#include "touch/contact.h"

#include <math.h>

static pel_status create(pel_sim *sim, pel_error *error)
{
    pel_status status = pel_minimise_create(sim, pel_sim_newton_minimise, error);
    if (status == PEL_OK)
        status = pel_sim_newton_create(sim, false, error);
    bool has_modes = sim->solver.analysis != PEL_ANALYSIS_NONE;
    bool is_plain = !has_modes && sim->solver.path != PEL_PATH_ARC_LENGTH;
    if (status == PEL_OK && sim->rigids != NULL && !is_plain)
        return pel_refuse(error, PEL_BAD_ARGUMENT, "leave rigid bodies out, or the analysis and the path",
                          "analyses and paths do not know rigid bodies");
    if (status == PEL_OK && has_modes)
        status = pel_sim_modes_create(sim, error);
    bool has_path = !has_modes && sim->solver.path == PEL_PATH_ARC_LENGTH;
    return status == PEL_OK && has_path ? pel_sim_path_create(sim, error) : status;
}

static bool has_loads(const pel_sim *sim, int32_t body)
{
    bool any = false;
    for (int32_t l = 0; l < sim->loads->count; l++)
        any |= sim->loads->items[l].body == body;
    return any;
}

/* Where supports of its own hold a free body is by chance: it goes back to where its center of mass was. Without loads,
   whose torques tell how it stands, its mean rotation is taken back, too, of displacements of vertices x about the
   center (vertex_count), in sim->force. */
static void recenter(pel_sim *sim, int32_t body, bool turns)
{
    pel_state *state = sim->state;
    const pel_body *own = &sim->model->bodies[body];
    const int32_t begin = own->slice_begin * PEL_WIDTH, end = pel_body_place_end(sim->model, body);
    for (int32_t v = begin; v < end; v++)
        sim->force[v] = state->position_next[v] - state->position[v];
    const pel_rigid_motion motion = pel_rigid_motion_of(sim, body, state->position, sim->force);
    double half[3], turn[4] = {0, 0, 0, 1}, center[3];
    pel_vec3_scale(motion.spin, turns ? -0.5 : 0, half);
    const double scale = 1 / sqrt(1 + pel_vec3_squared_length(half));
    for (int k = 0; k < 3; k++)
        turn[k] = scale * half[k];
    turn[3] = scale;
    pel_vec3_add(motion.center, motion.velocity, center);
    for (int32_t v = begin; v < end; v++) {
        double x[3];
        sim->force[v] = (pel_record){0};
        if (sim->model->mesh_vertex[v] < 0 || !motion.is_free)
            continue;
        pel_vertex_position(state->position_next, v, x);
        pel_vec3_subtract(x, center, x);
        pel_rotate(turn, x, x);
        pel_vec3_add(x, motion.center, x);
        for (int k = 0; k < 3; k++) {
            sim->minimise->newton->unknowns[3 * v + k] = x[k];
            state->position_next[v][k] = (pel_real)x[k];
        }
    }
}

/* a few times: the mean rotation of large displacements is not exact */
static void recenter_free_bodies(pel_sim *sim)
{
    enum { TIMES = 3 };
    bool any = false;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        bool turns = !has_loads(sim, b),
             is_free = sim->contacts == NULL && sim->model->bodies[b].rigid == NULL && pel_sim_newton_is_free(sim, b);
        for (int32_t t = 0; is_free && t < sim->tools->count; t++)
            is_free = !pel_tool_acts_on(&sim->tools->items[t], b);
        for (int i = 0; is_free && i < (turns ? TIMES : 1); i++)
            recenter(sim, b, turns);
        any |= is_free && turns;
    }
    if (any)
        pel_sim_newton_settle_at(sim);
}

/* ---- settling ----

   Where contact alone holds a body it may have to fall, slide or roll before it rests, and Newton's method knows
   contacts only as planes where they are found. Such a step goes there by tries, each a minimum of the energy and of
   springs of stiffness rate x mass from each vertex to where it was (proximal points; Rockafellar 1976). Springs become
   softer while tries go short ways, stiffer where a try fails; what they hold at the end is what is left of the
   balance. */

/* of the mean edge: ways of a first try under gravity, of one that is too long, of one that may become longer, and of
   that where nothing touches yet */
#define FIRST_WAY 0.5
#define LONG_WAY 1.0
#define SHORT_WAY 0.25
#define FALL_WAY 4.0
/* first rate without gravity, of the bound of stiffness over mass */
#define FIRST_SHARE 1e-3
/* of the loads, what springs may hold at the end, and where all tries are spent; where none has failed */
#define LEFT_SHARE 5e-4
#define MOST_LEFT_SHARE 5e-3
#define REST_SHARE 1e-5
/* of the rate: after a short try, after a long one, after one that failed; the bound after that, and how fast it goes
 */
#define SOFTER 0.25
#define STIFFER 4
#define RETRY 8
#define BOUND 2
#define FADING 0.9
enum { MOST_TRIES = 100, MOST_RETRIES = 6, MOST_SLIDES = 6 };

static bool is_plain(const pel_sim *sim)
{
    return sim->modes == NULL && sim->path == NULL && sim->minimise->newton->lead == NULL;
}

static bool may_settle(const pel_sim *sim)
{
    bool any = false;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        any |= pel_sim_newton_is_free(sim, b);
    return any && sim->contacts != NULL;
}

static double first_rate(const pel_sim *sim)
{
    double pull = pel_vec3_length(sim->model->gravity), way = FIRST_WAY * sim->minimise->mean_edge;
    return pull > 0 ? pull / way : FIRST_SHARE * sim->minimise->stiffness;
}

/* m, the longest way in a try; and the force that its springs hold, N, as the loads: roots of sums of squares */
static double find_way(const pel_sim *sim, double *left, double *loads)
{
    const pel_sim_newton *newton = sim->minimise->newton;
    double most = 0, held = 0, sum = 0, x[3], load[3];
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        if (sim->model->mesh_vertex[v] < 0 || !(sim->model->inverse_mass[v] > 0))
            continue;
        pel_vertex_position(sim->state->position, v, x);
        pel_vertex_position(sim->minimise->external, v, load);
        pel_vec3_subtract(x, newton->anchors[v], x);
        double square = pel_vec3_squared_length(x), stiffness = newton->anchor_stiffness[v];
        held += stiffness * stiffness * square;
        sum += pel_vec3_squared_length(load);
        most = pel_max(most, square);
    }
    *left = sqrt(held);
    *loads = sum > 0 ? sqrt(sum) : pel_minimise_contacts_force(sim);
    return sqrt(most);
}

static bool end_settling(pel_sim *sim)
{
    sim->minimise->newton->settling = (pel_settling){0};
    return false;
}

/* After a try: the rate of the next one. False where the step has settled, or all tries are spent. */
static bool settles_on(pel_sim *sim, bool is_good)
{
    pel_settling *settling = &sim->minimise->newton->settling;
    pel_descent_result *result = &sim->minimise->accepted;
    double left, loads, way = find_way(sim, &left, &loads) / sim->minimise->mean_edge, rate = settling->rate;
    double short_way = sim->minimise->count > 0 ? SHORT_WAY : FALL_WAY;
    bool is_at_rest = is_good && left <= (settling->least > 0 ? LEFT_SHARE : REST_SHARE) * loads;
    if (is_at_rest || settling->tries == MOST_TRIES) {
        result->converged = is_good && left <= MOST_LEFT_SHARE * loads;
        result->residual = pel_max(result->residual, left);
        return end_settling(sim);
    }
    settling->least = is_good ? FADING * settling->least : BOUND * rate;
    if (!is_good || way > LONG_WAY + short_way)
        settling->rate = STIFFER * rate;
    else if (way < short_way)
        settling->rate = pel_max(SOFTER * rate, settling->least);
    return true;
}

/* Tries go on until the step has settled. Contacts are planes where they are found: what slides far, or turns, in a
   step at rest is in balance with planes that it has left. */
static bool repeats(pel_sim *sim, int times)
{
    pel_settling *settling = &sim->minimise->newton->settling;
    bool has_stepped_back = sim->contacts != NULL && sim->touch->has_stepped_back;
    if (!is_plain(sim))
        return false;
    settling->tries = times;
    if (settling->rate > 0)
        return settles_on(sim, sim->minimise->accepted.converged && !has_stepped_back);
    return (times <= MOST_SLIDES && pel_minimise_slides(sim)) || end_settling(sim);
}

static void begin_try(pel_sim *sim)
{
    pel_sim_newton *newton = sim->minimise->newton;
    double rate = newton->settling.rate;
    sim->minimise->inertia = rate > 0 ? newton->anchor_stiffness : NULL;
    for (int32_t v = 0; rate > 0 && v < sim->model->vertex_count; v++) {
        newton->anchor_stiffness[v] = rate * (double)sim->model->mass[v];
        pel_vertex_position(sim->state->position, v, newton->anchors[v]);
    }
    pel_rigids_begin(sim);
    pel_joints_begin(sim);
    pel_sim_newton_begin(sim);
}

static pel_status try_step(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    pel_settling *settling = &sim->minimise->newton->settling;
    if (settling->tries == 0 && is_plain(sim) && may_settle(sim))
        settling->rate = first_rate(sim);
    begin_try(sim);
    pel_status status = pel_minimise_step(sim, result, error);
    for (int n = 0; n < MOST_RETRIES && settling->rate > 0 && status == PEL_OK; n++) {
        if (sim->minimise->result.converged)
            break;
        settling->least = BOUND * settling->rate;
        settling->rate *= RETRY;
        sim->minimise->penalty = 0;
        begin_try(sim);
        status = pel_minimise_step(sim, result, error);
    }
    return status;
}

static pel_status step(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    if (sim->modes != NULL)
        return pel_sim_modes_step(sim, result, error);
    if (sim->path != NULL)
        return pel_sim_path_step(sim, result, error);
    pel_status status = try_step(sim, result, error);
    if (status == PEL_OK) {
        recenter_free_bodies(sim);
        pel_joints_take_rows(sim);
    }
    return status;
}

/* bodies that neither contact nor a tool can hold must not be free to move */
static pel_status check_mechanisms(const pel_sim *sim, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t b = 0; status == PEL_OK && b < sim->model->body_count; b++) {
        bool is_touched = sim->contacts != NULL;
        for (int32_t t = 0; t < sim->tools->count; t++)
            is_touched |= pel_tool_acts_on(&sim->tools->items[t], b);
        status = is_touched ? PEL_OK : pel_holds_check_mechanism(sim, b, error);
    }
    return status;
}

/* over the largest pressure of a body that grows alike: supports make it stiffer */
#define PRESSURE_MARGIN 1.1

/* a pressure that nothing balances */
static pel_status check_pressures(const pel_sim *sim, pel_error *error)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        double ratio, largest = pel_pressure_largest(sim->model, b, &ratio);
        double given = body->shell != NULL ? pel_pressure_given(body->shell) : 0;
        if (!(given > PRESSURE_MARGIN * largest))
            continue;
        pel_fail(error, PEL_BAD_ARGUMENT,
                 "body '%s' has no equilibrium at %.4g Pa: the largest pressure that it balances is %.4g Pa, at %.3g "
                 "times its volume",
                 body->name, given, largest, ratio);
        pel_fail_element(error, "body", b);
        pel_fail_remedy(error,
                        "use a smaller pressure, prescribe the volume (pressure: { volume: ... }), or follow the "
                        "equilibria (solver: { path: arc-length })");
        return PEL_BAD_ARGUMENT;
    }
    return PEL_OK;
}

static pel_status check_start(pel_sim *sim, pel_error *error)
{
    pel_status status = sim->modes != NULL  ? pel_sim_modes_check(sim, error)
                        : sim->path != NULL ? pel_sim_path_check(sim, error)
                                            : PEL_OK;
    if (status == PEL_OK)
        status = pel_minimise_check_start(sim, error);
    bool holds = sim->contacts != NULL || sim->tools->count > 0 || sim->path != NULL;
    if (status == PEL_OK && !holds)
        status = check_pressures(sim, error);
    /* free motions are modes of frequency 0 */
    return status == PEL_OK && sim->modes == NULL ? check_mechanisms(sim, error) : status;
}

static void advise(const pel_sim *sim, pel_error *error)
{
    (void)sim;
    pel_fail_remedy(error, "make the loads smaller, or let them grow over more steps (keys)");
}

const pel_stepper pel_step_static_kind = {
    .is_at_end = true,
    .seeks_rest = true,
    .turns_edges = true,
    .moves_tools = true,
    .create = create,
    .check_start = check_start,
    .minimises = true,
    .is_static = true,
    .moves_rigid = true,
    .has_budget = true,
    .energy_remedy = "the work of tools and supports is that of their mean force in a step: give them keys and raise "
                     "solver.steps",
    .step = step,
    .read_tools = pel_minimise_read_tools,
    .settle_edges = pel_sim_newton_settle_edges,
    .follow_surface = pel_sim_newton_follow_surface,
    .get_held_force = pel_sim_newton_held_force,
    .mark_contacts = pel_minimise_contacts_mark,
    .get_solver = pel_minimise_get_solver,
    .accept = pel_minimise_accept,
    .repeats = repeats,
    .advise = advise,
};
