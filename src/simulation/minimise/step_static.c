/* The method `static`: each step is the state of rest under the loads at its end, found by Newton's method. */
#include "attach/joint.h"
#include "base/status.h"
#include "boundary/hold.h"
#include "boundary/loads.h"
#include "constraint/constraint.h"
#include "force/pressure.h"
#include "math/pose.h"
#include "minimise/free_body.h"
#include "minimise/rounds.h"
#include "minimise/step_modes.h"
#include "minimise/step_newton.h"
#include "minimise/step_path.h"
#include "stage/rigid_motion.h"
#include "stage/rigids.h"
#include "tool/tool.h"

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

static pel_status step(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    if (sim->modes != NULL)
        return pel_sim_modes_step(sim, result, error);
    if (sim->path != NULL)
        return pel_sim_path_step(sim, result, error);
    pel_rigids_begin(sim);
    pel_joints_begin(sim);
    pel_sim_newton_begin(sim);
    pel_status status = pel_minimise_step(sim, result, error);
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

static bool slides(const pel_sim *sim)
{
    return sim->modes == NULL && sim->path == NULL && pel_minimise_slides(sim);
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
    .slides = slides,
    .advise = advise,
};
