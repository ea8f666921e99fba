/* The method `implicit`: m a + c v = F at the end of a step, solved by Newton's method (theory page, section 16).

   In a step inertia and drag are springs of the vertices to points. With x and v at its begin, x' and v' one step
   before and the unknown positions y, each scheme has the form

     u = rate (y - anchor),     m rate (u - carried) + c u = F(y)

     implicit Euler   rate 1/dt,       anchor x,                 carried v,                 x_1 = y,       v_1 = u
     BDF2             rate 3/(2 dt),   anchor (4 x - x') / 3,    carried (4 v - v') / 3,    x_1 = y,       v_1 = u
     midpoint         rate 2/dt,       anchor x,                 carried v,                 x_1 = 2 y - x, v_1 = 2 u - v

   Forces that change in time act at the time of y: in the middle of the step under the midpoint rule, else at its end.
   The midpoint rule keeps the energy where nothing takes it away and steps resolve what moves; BDF2 damps what a step
   cannot follow, of what slides and rests as well; Euler begins, and follows a collision, which makes the velocities
   jump. Damping along volumetric springs is c (u . e) e, with e as it is where the step begins. */
#include "base/memory.h"
#include "base/status.h"
#include "sim/contact.h"
#include "sim/hold.h"
#include "sim/step_newton.h"

#include <string.h>

/* of the jump of what touches; sheets that fall flat have 0.7 and more, two balls that deform each other 0.02 to 0.3,
 * what slides 1e-5
 */
#define JUMP_SHARE 0.3
#define PUSH_SHARE 2.5e-3
/* one that spreads over two steps looks like a steady acceleration in the second */
enum { COLLISION_STEPS = 2 };
/* A motion of fewer than four steps a period. The midpoint rule keeps the energy of small ones; of large ones, as of a
   sheet that crumples while it swings, it makes energy. */
#define FAST_SHARE 1.0
enum { UNRESOLVED_STEPS = 10 };

static const pel_implicit_scheme euler = {1, {1, 0}, {1, 0}, 1};
static const pel_implicit_scheme bdf2 = {1.5, {4.0 / 3, -1.0 / 3}, {4.0 / 3, -1.0 / 3}, 1};
static const pel_implicit_scheme midpoint = {2, {1, 0}, {1, 0}, 2};

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

/* marks the vertices that something pressed in this step, or (mark = 0) no vertex */
static void mark_touched(const pel_sim *sim, int32_t mark)
{
    const pel_sim_descent *descent = sim->descent;
    for (int32_t c = 0; c < descent->count; c++) {
        const pel_descent_contact *constraint = &descent->constraints[c];
        for (int i = 0; i < 4; i++)
            if (constraint->load > 0 && constraint->weights[i] != 0)
                descent->constraint_of_vertex[constraint->vertices[i]] = mark;
    }
}

/* m |v_1 - 2 v + v'|^2 over m (|v_1 - v|^2 + |v - v'|^2) of the vertices of a body: changes of velocities that go on
   are 0 of it, changes that turn back in the next step 2, a motion of four steps a period 1, in whatever frame it is
   seen. jump: of the vertices that touch; push: the square of the impulse on them over their mass, of which a step may
   leave 1e-3 (descent.c): what rests changes by no more than that. */
typedef struct turn_measure {
    double jump, all, change, push;
    bool touches;
} turn_measure;

/* N, sum of the loads of contacts on a body */
static double load_on(const pel_sim *sim, int32_t body)
{
    const pel_sim_descent *descent = sim->descent;
    double load = 0;
    for (int32_t c = 0; c < descent->count; c++) {
        const pel_descent_contact *constraint = &descent->constraints[c];
        for (int i = 0; i < 4; i++)
            if (sim->model->body_of_slice[constraint->vertices[i] / PEL_WIDTH] == body)
                load += constraint->load * fabs(constraint->weights[i]);
    }
    return load;
}

static turn_measure measure_turn(const pel_sim *sim, int32_t body)
{
    const pel_state *state = sim->state;
    turn_measure turn = {0};
    double touched_mass = 0, impulse = load_on(sim, body) * sim->step.dt;
    for (int32_t v = sim->model->bodies[body].slice_begin * PEL_WIDTH; v < pel_body_place_end(sim->model, body); v++) {
        bool is_touched = sim->descent->constraint_of_vertex[v] != 0;
        double mass = (double)sim->model->mass[v], sum = 0;
        for (int k = 0; k < 3; k++) {
            double last = (double)(state->velocity_next[v][k] - state->velocity[v][k]);
            double before = (double)(state->velocity[v][k] - state->older_velocity[v][k]);
            turn.change += mass * (last * last + before * before);
            sum += mass * (last - before) * (last - before);
        }
        turn.all += sum;
        turn.jump += is_touched ? sum : 0;
        turn.touches |= is_touched;
        touched_mass += is_touched ? mass : 0;
    }
    turn.push = touched_mass > 0 ? impulse * impulse / touched_mass : 0;
    return turn;
}

/* Which groups of bodies collide in the step: the velocities of what touches in one of their bodies have jumped. And
   whether what changes the velocities of a body is too fast for the steps. */
static void look_at_turns(const pel_sim *sim)
{
    pel_sim_newton *newton = sim->descent->newton;
    bool knows = sim->state->older_is_known;
    newton->collides = newton->is_unresolved = false;
    mark_touched(sim, 1);
    memset(newton->collided, 0, (size_t)sim->model->body_count);
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const turn_measure turn = measure_turn(sim, b);
        bool jumps = turn.jump > JUMP_SHARE * turn.change && turn.jump > PUSH_SHARE * turn.push;
        bool collides = turn.touches && (!knows || jumps);
        newton->collided[pel_sim_newton_group(sim, b)] |= collides;
        newton->collides |= collides;
        newton->is_unresolved |= knows && turn.all > FAST_SHARE * turn.change;
    }
    mark_touched(sim, 0);
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

const pel_implicit_scheme *pel_sim_implicit_scheme(const pel_sim *sim)
{
    const pel_state *state = sim->state;
    if (sim->tool_count == 0 && !volume_moves(sim) && !pel_holds_move(sim) && sim->contacts == NULL &&
        !sim->descent->newton->is_damped && state->unresolved == 0)
        return &midpoint;
    return state->older_is_known && state->collision == 0 ? &bdf2 : &euler;
}

/* N s/m */
static double drag_of(const pel_sim *sim, int32_t v)
{
    const double *factors = sim->state->factors[sim->model->body_of_slice[v / PEL_WIDTH]];
    return factors[PEL_SPRING_DAMPING] * (double)sim->model->damping[v] +
           sim->solver.drag * (double)sim->model->mass[v];
}

static double anchor_of(const pel_state *state, const pel_implicit_scheme *s, int32_t v, int k)
{
    double older = s->position[1] != 0 ? s->position[1] * (double)state->older_position[v][k] : 0;
    return s->position[0] * (double)state->position[v][k] + older;
}

static double carried_of(const pel_state *state, const pel_implicit_scheme *s, int32_t v, int k)
{
    double older = s->velocity[1] != 0 ? s->velocity[1] * (double)state->older_velocity[v][k] : 0;
    return s->velocity[0] * (double)state->velocity[v][k] + older;
}

/* Damping along volumetric springs, in the direction that these have where the step begins. */
static void set_radial(pel_sim *sim, const pel_implicit_scheme *s)
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
static void set_points(pel_sim *sim, const pel_implicit_scheme *s)
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
static void finish(pel_sim *sim, const pel_implicit_scheme *s)
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

/* m v of the group of a body: the mean change that finish_collisions makes */
static void mean_change(const pel_sim *sim, int32_t group, double change[3])
{
    const pel_state *state = sim->state;
    double mass = 0;
    pel_vec3_set(change, 0, 0, 0);
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        if (pel_sim_newton_group(sim, sim->model->body_of_slice[v / PEL_WIDTH]) != group)
            continue;
        mass += (double)sim->model->mass[v];
        for (int k = 0; k < 3; k++) {
            double way = sim->descent->newton->unknowns[3 * v + k] - (double)state->position[v][k];
            change[k] += (double)sim->model->mass[v] * (way / sim->step.dt - (double)state->velocity_next[v][k]);
        }
    }
    pel_vec3_scale(change, mass > 0 ? 1 / mass : 0, change);
}

/* A history that a collision has cut off would throw back what came to rest: the velocities of groups that collide are
   those of the way gone. A group that nothing holds keeps its momentum. */
static void finish_collisions(pel_sim *sim)
{
    const pel_sim_newton *newton = sim->descent->newton;
    pel_state *state = sim->state;
    for (int32_t group = 0; group < sim->model->body_count; group++) {
        double mean[3] = {0, 0, 0};
        if (!newton->collided[group])
            continue;
        if (!pel_sim_newton_group_is_held(sim, group))
            mean_change(sim, group, mean);
        for (int32_t v = 0; v < sim->model->vertex_count; v++) {
            bool moves = state->position[v][3] > 0 || (sim->held != NULL && sim->held[v]);
            if (!moves || pel_sim_newton_group(sim, sim->model->body_of_slice[v / PEL_WIDTH]) != group)
                continue;
            for (int k = 0; k < 3; k++) {
                double way = newton->unknowns[3 * v + k] - (double)state->position[v][k];
                state->velocity_next[v][k] = (pel_real)(way / sim->step.dt - mean[k]);
            }
        }
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
    const pel_implicit_scheme *s = pel_sim_implicit_scheme(sim);
    set_points(sim, s);
    sim->descent->force_time = 1 / s->end;
    set_radial(sim, s);
    pel_sim_newton_begin(sim);
    pel_status status = pel_sim_descent_step(sim, result, error);
    if (status != PEL_OK)
        return status;
    sim->parts.is_refused = !sim->descent->result.converged && pel_parts_can_halve(sim);
    sim->descent->newton->has_stepped = true;
    finish(sim, s);
    look_at_turns(sim);
    if (s == &bdf2 && sim->descent->newton->collides)
        finish_collisions(sim);
    result->diverged |= !pel_sim_all_inside(sim);
    return PEL_OK;
}

/* the state that was the present one is now one step before; velocities have changed places */
static void accept(pel_sim *sim)
{
    pel_state *state = sim->state;
    size_t count = (size_t)sim->model->vertex_count;
    memcpy(state->older_position, state->position_before, count * sizeof *state->older_position);
    memcpy(state->older_velocity, state->velocity_next, count * sizeof *state->older_velocity);
    state->older_is_known = true;
    if (sim->descent->newton->collides)
        state->collision = COLLISION_STEPS;
    else if (state->collision > 0)
        state->collision--;
    if (sim->descent->newton->is_unresolved)
        state->unresolved = UNRESOLVED_STEPS;
    else if (state->unresolved > 0)
        state->unresolved--;
    pel_sim_descent_accept(sim);
}

static void set_time(pel_sim *sim, double before)
{
    pel_state_move_history(sim->model, sim->state, before, sim->step.dt);
}

/* after restitution, whose impulse is a jump */
static void restart(pel_sim *sim, int32_t body)
{
    (void)body;
    sim->state->collision = COLLISION_STEPS;
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
    .restart = restart,
    .get_solver = pel_sim_descent_get_solver,
    .set_time = set_time,
    .accept = accept,
    .advise = advise,
};
