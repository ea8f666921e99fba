/* The method `implicit`: m a + c v = F at the end of a step, solved by Newton's method (theory page, section 16).

   In a step inertia and drag are springs of the vertices to points. With x and v at its begin, x' and v' one step
   before and the unknown positions y, each scheme has the form

     u = rate (y - anchor),     m rate (u - carried) + c u = F(y)

     implicit Euler   rate 1/dt,       anchor x,                 carried v,                 x_1 = y,       v_1 = u
     BDF2             rate 3/(2 dt),   anchor (4 x - x') / 3,    carried (4 v - v') / 3,    x_1 = y,       v_1 = u
     midpoint         rate 2/dt,       anchor x,                 carried v,                 x_1 = 2 y - x, v_1 = 2 u - v

   Forces that change in time act at the time of y: in the middle of the step under the midpoint rule, else at its end.
   The midpoint rule keeps the energy where nothing takes it away; BDF2 damps what a step cannot follow; Euler begins,
   and follows what touches. Damping along volumetric springs is c (u . e) e, with e as it is where the step begins. */
#include "base/memory.h"
#include "base/status.h"
#include "sim/contact.h"
#include "sim/hold.h"
#include "sim/step_newton.h"

#include <string.h>

typedef struct scheme {
    double rate;                     /* times dt */
    double position[2], velocity[2]; /* anchor and carried: at the start of the step, one step before */
    double end;                      /* x_1 = end y + (1 - end) x, v_1 = end u + (1 - end) v */
} scheme;

static const scheme euler = {1, {1, 0}, {1, 0}, 1};
static const scheme bdf2 = {1.5, {4.0 / 3, -1.0 / 3}, {4.0 / 3, -1.0 / 3}, 1};
static const scheme midpoint = {2, {1, 0}, {1, 0}, 2};

static bool has_radial_damping(const pel_sim *sim)
{
    bool any = false;
    for (int32_t v = 0; v < sim->given->vertex_count; v++)
        any |= sim->given->volumetric_damping[v] > 0;
    return any;
}

static bool has_damping(const pel_sim *sim)
{
    bool any = sim->solver.drag > 0;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        any |= sim->model->damping[v] > 0 || sim->model->volumetric_damping[v] > 0;
    return any;
}

static bool touches(const pel_sim *sim)
{
    const pel_sim_descent *descent = sim->descent;
    for (int32_t c = 0; c < descent->count; c++)
        if (descent->constraints[c].load > 0)
            return true;
    return false;
}

/* The midpoint rule meets a volume that is driven in the middle of each step only: its pressure would ring. */
static bool volume_moves(const pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        if (shell != NULL && shell->pressure.kind == PEL_PRESSURE_VOLUME && shell->pressure.target.key_count > 0)
            return true;
    }
    return false;
}

static const scheme *choose_scheme(const pel_sim *sim)
{
    if (sim->tool_count == 0 && !volume_moves(sim) && !pel_holds_move(sim) && sim->contacts == NULL &&
        !sim->descent->newton->is_damped)
        return &midpoint;
    return sim->state->older_is_known ? &bdf2 : &euler;
}

/* N s/m */
static double drag_of(const pel_sim *sim, int32_t v)
{
    const double *factors = sim->state->factors[sim->model->body_of_slice[v / PEL_WIDTH]];
    return factors[PEL_SPRING_DAMPING] * (double)sim->model->damping[v] +
           sim->solver.drag * (double)sim->model->mass[v];
}

static double anchor_of(const pel_state *state, const scheme *s, int32_t v, int k)
{
    double older = s->position[1] != 0 ? s->position[1] * (double)state->older_position[v][k] : 0;
    return s->position[0] * (double)state->position[v][k] + older;
}

static double carried_of(const pel_state *state, const scheme *s, int32_t v, int k)
{
    double older = s->velocity[1] != 0 ? s->velocity[1] * (double)state->older_velocity[v][k] : 0;
    return s->velocity[0] * (double)state->velocity[v][k] + older;
}

/* Damping along volumetric springs, in the direction that these have where the step begins. */
static void set_radial(pel_sim *sim, const scheme *s)
{
    pel_sim_newton *newton = sim->descent->newton;
    double rate = s->rate / sim->step.dt;
    for (int32_t v = 0; newton->radial != NULL && v < sim->model->vertex_count; v++) {
        const double *factors = sim->state->factors[sim->model->body_of_slice[v / PEL_WIDTH]];
        double damping = factors[PEL_VOLUMETRIC_DAMPING] * (double)sim->model->volumetric_damping[v];
        double *along = newton->radial[v], x[3], rest[3];
        pel_vertex_position(sim->state->position, v, x);
        pel_vertex_position(sim->model->rest, v, rest);
        pel_vec3_subtract(x, rest, along);
        double length = pel_vec3_length(along);
        bool acts = damping > 0 && length > 0 && sim->model->inverse_mass[v] > 0;
        pel_vec3_scale(along, acts ? sqrt(damping * rate) / length : 0, along);
        along[3] = 0;
        for (int k = 0; k < 3; k++)
            along[3] += along[k] * anchor_of(sim->state, s, v, k);
    }
}

/* the springs that inertia and drag are */
static void set_points(pel_sim *sim, const scheme *s)
{
    pel_sim_newton *newton = sim->descent->newton;
    double rate = s->rate / sim->step.dt;
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        double inertia = (double)sim->model->mass[v] * rate, drag = drag_of(sim, v), sum = inertia + drag;
        newton->point_stiffness[v] = sim->model->inverse_mass[v] > 0 ? sum * rate : 0;
        for (int k = 0; k < 3; k++) {
            double anchor = anchor_of(sim->state, s, v, k), carried = carried_of(sim->state, s, v, k);
            newton->points[v][k] = sum > 0 ? anchor + inertia * carried / (sum * rate) : anchor;
        }
    }
}

/* positions and velocities at the end of the step */
static void finish(pel_sim *sim, const scheme *s)
{
    const pel_sim_newton *newton = sim->descent->newton;
    pel_state *state = sim->state;
    double rate = s->rate / sim->step.dt;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            double y = newton->unknowns[3 * v + k], u = rate * (y - anchor_of(state, s, v, k));
            bool moves = state->position[v][3] > 0 || (sim->held != NULL && sim->held[v]);
            double velocity = s->end * u + (1 - s->end) * (double)state->velocity[v][k];
            state->velocity_next[v][k] = moves ? (pel_real)velocity : 0;
            if (s->end != 1 && moves)
                state->position_next[v][k] = (pel_real)(s->end * y + (1 - s->end) * (double)state->position[v][k]);
        }
}

static pel_status create(pel_sim *sim, pel_error *error)
{
    pel_status status = pel_sim_descent_create(sim, pel_sim_newton_minimise, error);
    if (status == PEL_OK)
        status = pel_sim_newton_create(sim, true, error);
    if (status != PEL_OK)
        return status;
    sim->descent->newton->is_damped = has_damping(sim);
    if (has_radial_damping(sim)) {
        sim->descent->newton->radial = pel_allocate((size_t)sim->model->vertex_count, sizeof(double[4]));
        status = sim->descent->newton->radial != NULL ? PEL_OK : pel_fail_memory(error);
    }
    return status == PEL_OK ? pel_state_add_history(sim->model, sim->state, error) : status;
}

static pel_status step(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    const scheme *s = choose_scheme(sim);
    set_points(sim, s);
    sim->descent->force_time = 1 / s->end;
    set_radial(sim, s);
    pel_sim_newton_begin(sim);
    pel_status status = pel_sim_descent_step(sim, result, error);
    if (status != PEL_OK)
        return status;
    sim->parts.is_refused = !sim->descent->result.converged && pel_parts_can_halve(sim);
    finish(sim, s);
    result->diverged |= !pel_sim_all_inside(sim);
    return PEL_OK;
}

/* the state that was the present one is now one step before, of no use after a step in which something touched;
   velocities have changed places */
static void accept(pel_sim *sim)
{
    pel_state *state = sim->state;
    size_t count = (size_t)sim->model->vertex_count;
    memcpy(state->older_position, state->position_before, count * sizeof *state->older_position);
    memcpy(state->older_velocity, state->velocity_next, count * sizeof *state->older_velocity);
    state->older_is_known = !touches(sim);
    pel_sim_descent_accept(sim);
}

static void set_time(pel_sim *sim, double before)
{
    pel_state_move_history(sim->model, sim->state, before, sim->step.dt);
}

static void advise(const pel_sim *sim, pel_error *error)
{
    pel_fail_remedy(error, "make solver dt (%g) smaller, or the loads", sim->step.dt);
}

const pel_stepper pel_step_implicit_kind = {
    .has_velocity = true,
    .is_at_end = true,
    .turns_edges = true,
    .moves_tools = true,
    .divides = true,
    .create = create,
    .step = step,
    .read_tools = pel_sim_newton_read_tools,
    .settle_edges = pel_sim_newton_settle_edges,
    .follow_surface = pel_sim_newton_follow_surface,
    .get_held_force = pel_sim_newton_held_force,
    .mark_contacts = pel_descent_contacts_mark,
    .set_time = set_time,
    .accept = accept,
    .advise = advise,
};
