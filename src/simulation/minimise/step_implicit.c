/* The method `implicit`: m a + c v = F in time, solved by Newton's method (theory page, section 16).

   Inertia and drag act as springs from the vertices to points. With x and v at the start of the step, x' and v' at
   another time and the unknown positions y, each scheme has the form

     u = rate (y - anchor),     m rate (u - carried) + c u = F(y)

     implicit Euler   rate 1/dt,       anchor x,                 carried v,                 x_1 = y,       v_1 = u
     BDF2             rate 3/(2 dt),   anchor (4 x - x') / 3,    carried (4 v - v') / 3,    x_1 = y,       v_1 = u
     midpoint         rate 2/dt,       anchor x,                 carried v,                 x_1 = 2 y - x, v_1 = 2 u - v
     two stages       rate 1/(g dt),   anchor x,                 carried v,                 x' = y,        v' = u
                      rate 1/(g dt),   anchor x + q (x' - x),    carried v + q (v' - v),    x_1 = y,       v_1 = u

   with x', v' one step earlier under BDF2, those of the first stage under two stages, g = 1 - 1/sqrt 2, q = 1/g - 1
   (Alexander 1977). Loads act by their mean over the step, extrapolated to its end under BDF2, so that a free body has
   their impulse in each step.

   The midpoint rule conserves the energy of undamped motion that is nearly linear in a step. If a stiff body turns or
   crumples, it strains the positions at the end of the step and energy appears: such a step is repeated in two stages,
   and the next ones follow. Two stages cost two solves. They damp a motion of frequency w by (w g dt)^4 / 2 of its
   amplitude in a step, and what the step does not resolve at once. BDF2 damps (w dt)^4 / 4 and needs no more than one
   solve: it keeps sliding and resting contact at second order. Euler takes the first step of it and those of a
   collision, where velocities jump, of loads that jump and of grasps that open. Under all but the midpoint rule a free
   body keeps its rotation (step_turn.h). Damping of the material refers to strains as velocities do to positions: the
   rate of a strain s is rate (s(y) - s_0), s_0 the sum of the strains of the states of the anchor with its weights
   (viscous elements, measure/tangent.h). It leaves rigid motion alone, and takes out the weighted sum of its powers at
   the stages. Damping along volumetric springs is c (u . e) e, with e from the start of the step.

   Tried on a cantilever of stiff springs and hinges in the plane (0.2 m of steel 0.5 mm thick, let go with its tip 1.2
   and 12 mm aside, 9 periods of 20 steps; energy at the end over that at the start, and largest): midpoint 1.007 and
   1.042, 338 and 338; generalised alpha with spectral radius 0.8 0.98 and 1.01, 1.11 and 2.64; with 0.5 0.93 and 1.00,
   1.10 and 1.78; BDF2 0.50; two stages 0.96 and 1.00, 0.94 and 1.00. Means of strains in place of strains in the middle
   (Simo, Tarnow 1992) keep it at 1.000 in all of these, but need stresses of two states for each law. */
#include "attach/joint.h"
#include "attach/tie.h"
#include "base/assert.h"
#include "base/lane.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/hold.h"
#include "boundary/loads.h"
#include "boundary/wind.h"
#include "constraint/constraint.h"
#include "force/pressure.h"
#include "math/extremes.h"
#include "minimise/prepared.h"
#include "minimise/rounds.h"
#include "minimise/shorten.h"
#include "minimise/step_newton.h"
#include "minimise/step_turn.h"
#include "stage/accessors.h"
#include "stage/rigids.h"
#include "tool/tools.h"

#include <float.h>
#include <string.h>

/* A body collides if turn_measure.jump exceeds this share of `change`. Measured: sheets that fall flat 0.7 and more,
   two balls that deform each other 0.02 to 0.3, sliding 1e-5. */
#define JUMP_SHARE 0.3
/* And this share of `push`: the solver's tolerance alone makes resting contacts jump by up to 1e-3 of it. */
#define PUSH_SHARE 2.5e-3
/* The second step of a collision that spreads over two looks like a steady acceleration. */
enum { COLLISION_STEPS = 2 };
/* of the momentum that drag takes in a step: what BDF2 takes of a vibration of 40 steps is then less than a tenth of
   that */
#define LIGHT_DRAG 5e-3
/* largest relative loss of energy in a step of the midpoint rule, and gain: gains of many short steps add up */
#define ENERGY_SHARE 0.01
#define GAIN_SHARE 1e-3
/* steps until the midpoint rule is tried again, or two stages after something touched */
enum { UNRESOLVED_STEPS = 50 };

/* g and q of the two stages */
#define STAGE 0.29289321881345248
#define STAGE_SHARE 2.4142135623730950

static const pel_implicit_scheme euler = {1, {1, 0}, {1, 0}, 0, NULL, 1, {1, 1, 0, false}};
static const pel_implicit_scheme bdf2 = {1.5, {4.0 / 3, -1.0 / 3}, {4.0 / 3, -1.0 / 3}, -1, NULL, 1, {1, 1, 0, true}};
static const pel_implicit_scheme midpoint = {2, {1, 0}, {1, 0}, 0, NULL, 2, {0.5, 0.5, 0.5, false}};
static const pel_implicit_scheme first_stage = {
    1 / STAGE, {1, 0}, {1, 0}, 0, NULL, 1, {STAGE, STAGE, 1 - STAGE, false}};
static const pel_implicit_scheme second_stage = {
    1 / STAGE,       {1 - STAGE_SHARE, STAGE_SHARE}, {1 - STAGE_SHARE, STAGE_SHARE}, STAGE, &first_stage, 1,
    {1, 1, 0, false}};

static bool has_radial_damping(const pel_sim *sim)
{
    bool any = false;
    for (int32_t v = 0; v < sim->given->vertex_count; v++)
        any |= sim->given->volumetric_damping[v] > 0;
    return any;
}

/* set the mark of every vertex with a loaded contact */
static void mark_touched(const pel_sim *sim, int32_t mark)
{
    const pel_minimise *minimise = sim->minimise;
    for (int32_t c = 0; c < minimise->count; c++) {
        const pel_minimise_contact *constraint = &minimise->constraints[c];
        for (int i = 0; i < 4; i++)
            if (constraint->load > 0 && constraint->weights[i] != 0)
                minimise->constraint_of_vertex[constraint->vertices[i]] = mark;
    }
}

/* How far the velocities of touching vertices jump; Galilean invariant. */
typedef struct turn_measure {
    double jump;   /* J: sum of m |v_1 - 2 v + v'|^2 of vertices with loaded contacts */
    double change; /* J: sum of m (|v_1 - v|^2 + |v - v'|^2) of all */
    double push;   /* J: squared contact impulse over the mass of the former */
    bool touches;
} turn_measure;

/* N, sum of the loads of contacts on a body */
static double load_on(const pel_sim *sim, int32_t body)
{
    const pel_minimise *minimise = sim->minimise;
    double load = 0;
    for (int32_t c = 0; c < minimise->count; c++) {
        const pel_minimise_contact *constraint = &minimise->constraints[c];
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
        bool is_touched = sim->minimise->constraint_of_vertex[v] != 0;
        double mass = (double)sim->model->mass[v], sum = 0;
        for (int k = 0; k < 3; k++) {
            double last = (double)(state->velocity_next[v][k] - state->velocity[v][k]);
            double before = (double)(state->velocity[v][k] - state->older_velocity[v][k]);
            turn.change += mass * (last * last + before * before);
            sum += mass * (last - before) * (last - before);
        }
        turn.jump += is_touched ? sum : 0;
        turn.touches |= is_touched;
        touched_mass += is_touched ? mass : 0;
    }
    turn.push = touched_mass > 0 ? impulse * impulse / touched_mass : 0;
    return turn;
}

/* What touches and is in no balance has no velocity that could be extrapolated either. */
static void find_collisions(const pel_sim *sim)
{
    pel_sim_newton *newton = sim->minimise->newton;
    bool knows = sim->state->older_is_known, is_balance = sim->minimise->result.converged;
    mark_touched(sim, 1);
    memset(newton->collided, 0, (size_t)sim->model->body_count);
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const turn_measure turn = measure_turn(sim, b);
        bool jumps = turn.jump > JUMP_SHARE * turn.change && turn.jump > PUSH_SHARE * turn.push;
        bool collides = (turn.touches && (!knows || jumps || !is_balance)) || pel_joints_met(sim, b);
        newton->collided[pel_sim_newton_group(sim, b)] |= collides;
    }
    mark_touched(sim, 0);
}

/* A volume that is driven is followed, not resolved: what inertia makes of it is damped. */
static bool volume_moves(const pel_sim *sim)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_shell *shell = sim->model->bodies[b].shell;
        if (shell != NULL && shell->pressure.kind == PEL_PRESSURE_VOLUME && shell->pressure.target.key_count > 0)
            return true;
    }
    return false;
}

/* true if all forces have a potential, so that changes_energy applies */
static bool has_potential(const pel_sim *sim)
{
    bool has = sim->loads->follower_count == 0 && sim->loads->edge_load_count == 0 && sim->loads->fluid_count == 0;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        has &= pel_shell_has_potential(&sim->model->bodies[b]);
    return has;
}

/* N s/m */
static double drag_of(const pel_sim *sim, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    const double *factors = sim->state->factors[sim->model->body_of_slice[v / PEL_WIDTH]];
    return factors[PEL_SPRING_DAMPING] * (double)sim->model->damping[v] +
           sim->solver.drag * (double)sim->model->mass[v];
}

/* whether it is to settle, or to vibrate with some drag */
static bool is_braked(const pel_sim *sim)
{
    bool any = sim->minimise->newton->radial != NULL;
    for (int32_t v = 0; v < sim->model->vertex_count && !any; v++)
        any = sim->step.dt * drag_of(sim, v) > LIGHT_DRAG * (double)sim->model->mass[v];
    return any;
}

/* with one solve, whatever touches */
static const pel_implicit_scheme *plain_scheme(const pel_sim *sim)
{
    const pel_span span = {.time = pel_sim_next_time(sim), .back = sim->step.dt};
    bool is_smooth = sim->state->older_is_known && sim->state->collision == 0 && !pel_loads_jump(sim, span) &&
                     !pel_tools_grasps_change(sim) && !(sim->ties != NULL && sim->ties->change);
    return is_smooth ? &bdf2 : &euler;
}

static const pel_implicit_scheme *choose_scheme(const pel_sim *sim)
{
    const pel_state *state = sim->state;
    const pel_sim_newton *newton = sim->minimise->newton;
    /* beside another simulation the scheme of its step, which is known */
    if (newton->lead != NULL)
        return newton->scheme;
    bool is_apart = memchr(state->contact, 1, (size_t)sim->model->vertex_count) == NULL;
    bool is_alone = sim->tools->held_vertices == NULL && is_apart && sim->solver.budget <= 0 &&
                    !pel_joints_drive(sim) && !volume_moves(sim) && !is_braked(sim);
    bool meets = sim->tools->count > 0 || sim->contacts != NULL || sim->rigids != NULL;
    if (is_alone && !meets && newton->viscous == NULL && !pel_holds_move(sim) && has_potential(sim) &&
        state->unresolved == 0)
        return &midpoint;
    /* what nearly touches at the start lands in a step of first order, without speed */
    if (is_alone && !newton->leads &&
        ((state->older_is_known && state->unresolved == 0) || sim->rigids != NULL || !meets))
        return &first_stage;
    return plain_scheme(sim);
}

/* damping along volumetric springs, in their direction at the start of the step */
static void set_radial(pel_sim *sim, const pel_implicit_scheme *s)
{
    pel_sim_newton *newton = sim->minimise->newton;
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
        double anchor[3], carried[3];
        pel_sim_turn_refer(sim, s, v, anchor, carried);
        along[3] = pel_vec3_dot(along, anchor);
    }
}

/* strains of a state, as the part of the anchor that it is */
static void refer_rates(pel_sim *sim, const pel_record *position, double weight, bool is_other)
{
    pel_sim_newton *newton = sim->minimise->newton;
    const pel_tangent_input input = {
        .unknowns = newton->unknowns, .span = pel_instant(pel_sim_time(sim)), .state = sim->state};
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        pel_vertex_position(position, v, newton->unknowns + 3 * (size_t)v);
    pel_sim_newton_settle_at(sim);
    pel_tangent_refer_rates(pel_newton_tangent(sim->newton), &input, weight, is_other, sim->pool, newton->viscous);
}

/* strains at the start of the step, for rates of strain */
static void set_viscous(pel_sim *sim, const pel_implicit_scheme *s)
{
    pel_sim_newton *newton = sim->minimise->newton;
    newton->rate = s->rate / sim->step.dt;
    if (newton->viscous == NULL)
        return;
    refer_rates(sim, sim->state->position, s->position[0], false);
    if (s->position[1] != 0)
        refer_rates(sim, s->first != NULL ? newton->stage[0] : sim->state->older_position, s->position[1], true);
}

/* J, that the rates of strain at the solution of a stage take out in its part of the step */
static double viscous_loss(pel_sim *sim, const pel_implicit_scheme *s)
{
    const pel_sim_newton *newton = sim->minimise->newton;
    const pel_tangent_input input = {.unknowns = newton->unknowns,
                                     .span = pel_instant(pel_sim_time(sim)),
                                     .state = sim->state,
                                     .viscous = newton->viscous,
                                     .rate = newton->rate};
    double share = s == &first_stage ? 1 - STAGE : s == &second_stage ? STAGE : 1;
    return share * s->rate * pel_tangent_viscous_loss(pel_newton_tangent(sim->newton), &input, sim->pool);
}

/* springs of inertia and drag, and the force of the air: its drag has the velocity at the start of the step */
static void set_points(pel_sim *sim, const pel_implicit_scheme *s)
{
    pel_sim_newton *newton = sim->minimise->newton;
    const pel_record *air = pel_wind_forces(sim);
    double rate = s->rate / sim->step.dt;
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        double inertia = (double)sim->model->mass[v] * rate, drag = drag_of(sim, v);
        double sum = inertia + drag + (air != NULL ? (double)air[v][3] : 0);
        newton->point_stiffness[v] = sim->model->inverse_mass[v] > 0 ? sum * rate : 0;
        double anchor[3], carried[3], push[3] = {0, 0, 0};
        if (!pel_rigid_parts_anchor(sim, &newton->rigid, v, anchor, carried))
            pel_sim_turn_refer(sim, s, v, anchor, carried);
        if (air != NULL)
            pel_vertex_position(air, v, push);
        for (int k = 0; k < 3; k++)
            newton->points[v][k] = sum > 0 ? anchor[k] + (inertia * carried[k] + push[k]) / (sum * rate) : anchor[k];
    }
}

/* positions and velocities at the end of the step */
static void finish(pel_sim *sim, const pel_implicit_scheme *s)
{
    const pel_sim_newton *newton = sim->minimise->newton;
    pel_state *state = sim->state;
    double rate = s->rate / sim->step.dt;
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        double anchor[3], carried[3];
        pel_sim_turn_refer(sim, s, v, anchor, carried);
        for (int k = 0; k < 3; k++) {
            double y = newton->unknowns[3 * v + k], u = rate * (y - anchor[k]);
            bool moves = state->position[v][3] > 0 || (sim->held != NULL && sim->held[v]);
            double velocity = s->end * u + (1 - s->end) * (double)state->velocity[v][k];
            state->velocity_next[v][k] = moves ? (pel_real)velocity : 0;
            if (s->end != 1 && moves) {
                double end = s->end * y + (1 - s->end) * (double)state->position[v][k];
                sim->minimise->position[3 * v + k] = end;
                state->position_next[v][k] = (pel_real)end;
            }
        }
    }
    pel_rigid_parts_finish(sim, &newton->rigid);
    if (s == &first_stage || s->first != NULL)
        pel_joints_keep_speeds(sim);
}

/* m/s: mean velocity of the step */
static double mean_velocity(const pel_sim *sim, int32_t v, int k)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    return (sim->minimise->newton->unknowns[3 * v + k] - (double)sim->state->position[v][k]) / sim->step.dt;
}

/* m/s: change of the velocity of a group's centre of mass if its vertices took their mean velocities of the step */
static void mean_change(const pel_sim *sim, int32_t group, double change[3])
{
    const pel_state *state = sim->state;
    double mass = 0;
    pel_vec3_set(change, 0, 0, 0);
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        if (pel_sim_newton_group(sim, sim->model->body_of_slice[v / PEL_WIDTH]) != group)
            continue;
        mass += (double)sim->model->mass[v];
        for (int k = 0; k < 3; k++)
            change[k] += (double)sim->model->mass[v] * (mean_velocity(sim, v, k) - (double)state->velocity_next[v][k]);
    }
    pel_vec3_scale(change, mass > 0 ? 1 / mass : 0, change);
}

static bool has_collided(const pel_sim *sim, int32_t body)
{
    return sim->minimise->newton->collided[pel_sim_newton_group(sim, body)];
}

/* BDF2 would extrapolate the velocity from before a collision: groups that collide take the mean velocity of the step
   instead, free groups up to a translation that conserves their momentum. */
static void finish_collisions(pel_sim *sim)
{
    const pel_sim_newton *newton = sim->minimise->newton;
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
            for (int k = 0; k < 3; k++)
                state->velocity_next[v][k] = (pel_real)(mean_velocity(sim, v, k) - mean[k]);
        }
    }
    pel_rigid_parts_collide(sim, &newton->rigid, has_collided);
}

static pel_status create(pel_sim *sim, pel_error *error)
{
    pel_status status = pel_minimise_create(sim, pel_sim_newton_minimise, error);
    if (status == PEL_OK)
        status = pel_sim_newton_create(sim, true, error);
    if (status != PEL_OK)
        return status;
    if (has_radial_damping(sim)) {
        size_t vertices = (size_t)sim->model->vertex_count;
        pel_sim_newton *newton = sim->minimise->newton;
        bool room = PEL_ALLOCATE_ALL(PEL_ROOM(newton->radial, vertices), PEL_ROOM(newton->base->radial, vertices));
        status = room ? PEL_OK : pel_fail_memory(error);
    }
    return status == PEL_OK ? pel_state_add_history(sim->model, sim->state, error) : status;
}

/* ---- energy of the midpoint rule ---- */

/* J: elastic energy, with conservative pressure, of positions (3 vertex_count) with their edges settled */
static double potential_at(pel_sim *sim, const double *position, double *elastic)
{
    pel_sim_newton *newton = sim->minimise->newton;
    const pel_tangent_input input = {
        .unknowns = newton->unknowns,
        .span = {pel_sim_part_time(sim, 0.5), 0.5 * sim->step.dt, 0.5 * sim->step.dt, false},
        .state = sim->state};
    memcpy(newton->unknowns, position, 3 * (size_t)sim->model->vertex_count * sizeof *position);
    pel_tangent *tangent = pel_newton_tangent(sim->newton);
    pel_tangent_follow(tangent, newton->unknowns);
    pel_sim_newton_settle_at(sim);
    pel_tangent_energy energy = pel_tangent_evaluate(tangent, &input, sim->pool, NULL);
    /* the gradient is unused; the next run sets the targets again */
    double springs = pel_holds_evaluate(sim, input.span.time, newton->unknowns, newton->target) +
                     pel_ties_evaluate(sim, input.span.time, newton->unknowns, newton->target);
    *elastic = pel_tangent_energy_sum(&energy) - energy.pressure + springs;
    return *elastic + energy.pressure;
}

/* J: energy of rounding errors of positions, which the solve has in double, from the bound of the stiffness */
static double energy_noise(const pel_sim *sim)
{
    const pel_minimise *minimise = sim->minimise;
    double farthest = 0;
    for (int32_t i = 0; i < 3 * sim->model->vertex_count; i++)
        farthest = pel_max(farthest, fabs((double)sim->state->position[i / 3][i % 3]));
    double rounding = DBL_EPSILON * farthest;
    return minimise->stiff_force / minimise->mean_edge * rounding * rounding * sqrt(sim->model->vertex_count);
}

/* true if dK + dE - W of a step of the midpoint rule, W less what drag takes, exceeds its share of K + E */
static bool changes_energy(pel_sim *sim, double potential_before)
{
    const pel_state *state = sim->state;
    const double *end = sim->minimise->position;
    double elastic, kinetic = 0, change = potential_at(sim, end, &elastic) - potential_before - pel_wind_work(sim, 0);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            double mass = (double)sim->model->mass[v], u = (double)state->velocity_next[v][k];
            double w = (double)state->velocity[v][k], way = end[3 * v + k] - (double)state->position[v][k];
            kinetic += 0.5 * mass * u * u;
            change += 0.5 * mass * (u * u - w * w) - sim->minimise->newton->loads[3 * v + k] * way;
            change += drag_of(sim, v) * 0.25 * (u + w) * (u + w) * sim->step.dt;
        }
    return !(fabs(change) <= (change > 0 ? GAIN_SHARE : ENERGY_SHARE) * (kinetic + elastic) + energy_noise(sim));
}

static pel_status solve(pel_sim *sim, const pel_implicit_scheme *s, pel_step_result *result, pel_error *error)
{
    pel_sim_newton *newton = sim->minimise->newton;
    newton->scheme = s;
    /* as the body, from the start of the step */
    pel_tools_return(sim);
    pel_sim_turns_set(sim, s);
    pel_rigid_parts_refer(sim, &newton->rigid, s, s->first != NULL ? newton->stage[0] : sim->state->older_position,
                          s->first != NULL ? newton->stage[1] : sim->state->older_velocity);
    set_points(sim, s);
    sim->minimise->acts = s->acts;
    set_radial(sim, s);
    set_viscous(sim, s);
    pel_sim_newton_begin(sim);
    pel_status status = pel_minimise_step(sim, result, error);
    if (status == PEL_OK)
        finish(sim, s);
    if (status == PEL_OK && sim->minimise->newton->viscous != NULL)
        sim->viscous_loss += viscous_loss(sim, s);
    return status;
}

/* something pushes: stages would throw it back */
static bool touches(const pel_sim *sim)
{
    bool any = false;
    for (int32_t c = 0; c < sim->minimise->count; c++)
        any |= sim->minimise->constraints[c].load > 0;
    return any;
}

/* the stages of a step, one after the other; one that fails or touches something ends it */
static pel_status solve_in_stages(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    pel_descent_result *sum = &sim->minimise->result;
    size_t size = (size_t)sim->model->vertex_count * sizeof(pel_record);
    pel_status status = solve(sim, &first_stage, result, error);
    const pel_descent_result first = *sum;
    if (status != PEL_OK || result->diverged || (sim->minimise->newton->lead == NULL && touches(sim)))
        return status;
    memcpy(sim->minimise->newton->stage[0], sim->state->position_next, size);
    memcpy(sim->minimise->newton->stage[1], sim->state->velocity_next, size);
    status = solve(sim, &second_stage, result, error);
    sum->iterations += first.iterations;
    sum->evaluations += first.evaluations;
    sum->residual = pel_max(sum->residual, first.residual);
    sum->converged &= first.converged;
    return status;
}

static pel_status solve_by(pel_sim *sim, const pel_implicit_scheme *s, pel_step_result *result, pel_error *error)
{
    return s == &first_stage ? solve_in_stages(sim, result, error) : solve(sim, s, result, error);
}

static pel_status step(pel_sim *sim, pel_step_result *result, pel_error *error)
{
    pel_minimise_begin_at_state(sim);
    pel_rigids_begin(sim);
    pel_joints_begin(sim);
    pel_wind_begin(sim);
    sim->viscous_loss = 0;
    const pel_implicit_scheme *s = choose_scheme(sim);
    double elastic, before = s == &midpoint ? potential_at(sim, sim->minimise->position, &elastic) : 0;
    pel_status status = solve_by(sim, s, result, error);
    bool is_beside = sim->minimise->newton->lead != NULL;
    if (status == PEL_OK && !is_beside && s == &midpoint && changes_energy(sim, before)) {
        sim->state->unresolved = UNRESOLVED_STEPS;
        status = solve_by(sim, choose_scheme(sim), result, error);
    } else if (status == PEL_OK && !is_beside && s == &first_stage && touches(sim))
        status = solve(sim, plain_scheme(sim), result, error);
    if (status != PEL_OK)
        return status;
    if (sim->rigids == NULL && touches(sim))
        sim->state->unresolved = UNRESOLVED_STEPS;
    sim->part.is_refused = !sim->minimise->result.converged && pel_parts_can_halve(sim);
    sim->minimise->newton->has_stepped = true;
    find_collisions(sim);
    if (sim->minimise->newton->scheme == &bdf2)
        finish_collisions(sim);
    bool is_spent = sim->part.can_halve && !sim->part.is_refused && !sim->minimise->result.converged;
    if (is_spent && pel_sim_all_inside(sim))
        status = pel_minimise_shorten(sim, error);
    pel_joints_take_rows(sim);
    result->diverged |= !pel_sim_all_inside(sim);
    return status;
}

/* Make the previous state the older one. The velocities have been swapped by now. */
static void accept(pel_sim *sim)
{
    pel_state *state = sim->state;
    size_t count = (size_t)sim->model->vertex_count;
    bool collides = memchr(sim->minimise->newton->collided, true, (size_t)sim->model->body_count) != NULL;
    memcpy(state->older_position, state->position_before, count * sizeof *state->older_position);
    memcpy(state->older_velocity, state->velocity_next, count * sizeof *state->older_velocity);
    state->older_is_known = true;
    if (collides)
        state->collision = COLLISION_STEPS;
    else if (state->collision > 0)
        state->collision--;
    if (state->unresolved > 0)
        state->unresolved--;
    pel_minimise_accept(sim);
}

static void set_time(pel_sim *sim, double before)
{
    pel_state_move_history(sim->model, sim->state, before, sim->step.dt);
}

/* restitution makes the velocities jump */
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
    .damps = true,
    .moves_tools = true,
    .divides = true,
    .create = create,
    .minimises = true,
    .moves_rigid = true,
    .has_budget = true,
    .step = step,
    .read_tools = pel_minimise_read_tools,
    .settle_edges = pel_sim_newton_settle_edges,
    .follow_surface = pel_sim_newton_follow_surface,
    .get_held_force = pel_sim_newton_held_force,
    .mark_contacts = pel_minimise_contacts_mark,
    .restart = restart,
    .get_solver = pel_minimise_get_solver,
    .set_time = set_time,
    .accept = accept,
    .advise = advise,
};
