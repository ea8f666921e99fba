/* The frame of the methods that minimise: each step minimises the energy of springs, shells, pressure and loads at the
   end of the step, starting at the present positions, by L-BFGS (step_descent.c) or Newton's method (step_newton.c). A
   pressure without potential (vertex-normal form, a part of the surface, open meshes) is held at its value from the
   start of the step: equilibrium is reached over several steps.

   With tools or contact the energy is minimised under their constraints (constraint/frame.h), in rounds: minimise,
   update the multipliers, search for new contacts. After a collision during a step, the next round starts there. A step
   in time begins with the multipliers that the same pairs had at the end of the step before, which are a part of the
   state; others, and the first one that touches, with those that balance the forces at its start. */
#include "minimise/rounds.h"

#include "base/assert.h"
#include "base/lane.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "boundary/loads.h"
#include "constraint/constraint.h"
#include "constraint/constraint_tool.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "minimise/free_body.h"
#include "minimise/prepared.h"
#include "minimise/step_newton.h"
#include "solve/shell_stability.h"
#include "stage/accessors.h"
#include "tool/grip.h"
#include "tool/tools.h"
#include "touch/contact.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { ROUND_LIMIT = 12, MOST_PARTS = 16 };
/* rounds, and unconverged rounds, after which a step is repeated in parts */
enum { HALVING_ROUNDS = 8, HALVING_FAILURES = 2 };
/* rounds of a part after the systems of the step are spent, and systems of each of them */
enum { SPENT_ROUNDS = 2, SPENT_SYSTEMS = 6 };
/* unconverged rounds of a step at rest, one after the other, after which surfaces are taken where they are by now */
enum { LOST_ROUNDS = 2 };
/* of a run under constraints */
enum { MOST_SYSTEMS = 40, SETTLING_SYSTEMS = 20 };
/* Steps in time that were spent one after the other, after which the next ones have few systems: a jam that lasts. One
   in so many has all of them, in case the jam can be solved by now. */
enum { JAMMED_STEPS = 4, JAMMED_SYSTEMS = 30, PROBING_STEPS = 8 };

/* forces are balanced when the residual is this share of the forces that act */
#define LOAD_SHARE 1e-6
/* at most, where that share is less than rounding leaves */
#define LOST_SHARE 1e-3
/* The same share in motion, of the loads and of the rate of change of momentum. A share of momentum over dt would stop
   a spinning body. */
#define DYNAMIC_SHARE 1e-3
/* and on the way to rest */
#define SETTLING_SHARE 3e-4
/* units of the last place that rounding leaves of the forces of a body at rest */
#define ROUNDING_ERRORS 32
/* strain of a body by forces that no step lowers, because they are lost in the rounding of its energy */
#define STUCK_STRAIN 1e-10
/* of the mean edge that a vertex goes in one iteration at most */
#define MOVE_SHARE 0.3
/* of the size of the bodies: who would go no farther than this is there; forces of stiff bodies round to more */
#define SHORT_SHARE 1e-9

/* share of its initial gradient at which a round ends; for the first round, and after vertices were moved back */
#define FIRST_REDUCTION 1e-3
#define REDUCTION 0.1
/* and at most this multiple of the tolerance: loads from positions far from equilibrium are useless */
#define ROUGH_SHARE 1e3
/* Stiffness of constraints relative to the bound of bodies and inertia. It grows when a round closes gaps by less than
   CLOSING, or leaves them open by more than FAR tolerances; the next step in time begins with SOFTENING of it. */
#define PENALTY 0.1
#define MOST_PENALTY 100
#define STIFFENING 4.0
#define SOFTENING 0.5
/* Loads of the step before may have been this many times farther from those at its end than an estimate: the estimate
   is either exact or useless. */
#define FAVOUR 4
#define CLOSING 0.3
#define FAR 20
/* Tolerances that gaps may stay open by, 0.3 of the thickness: in jams without layers, and in motion before layers give
   way. The certified distance is less than half of the rest. */
#define JAM_GAP 8
/* A round limits friction by the loads at its last linear system. Largest difference from the limits by its own loads.
 */
#define FRICTION_SHARE 0.05
/* Of the forces of surfaces, how much may have turned since a step at rest found where they touch. */
#define MOST_TURNED 0.02
/* displacement of a tool in one part of a step, relative to half its thickness; share of the path to an impact that is
   taken */
#define PART_SHARE 0.5
#define SAFE_SHARE 0.9
/* of the mean edge: vertices that moved farther than this beyond an impact restart there */
#define BEYOND_SHARE 0.1

bool pel_minimise_is_in_motion(const pel_sim *sim)
{
    return pel_sim_has_velocity(sim) || (sim->minimise->newton != NULL && sim->minimise->newton->settling.rate > 0);
}

static double spring_energy(const pel_minimise_context *at)
{
    double sum = 0;
    const pel_model *model = at->sim->model;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b];
        bool has_springs = body->uniform_spring != 0 || body->has_volumetric;
        for (int32_t slice = body->slice_begin; has_springs && slice < body->slice_end; slice++)
            sum = pel_slice_energy_add(model, &at->state, slice, true, sum);
    }
    return sum;
}

/* of springs, shells and conservative pressure by batches, in the precision of the state; clears sim->force */
static double batch_energy(pel_minimise_context *at, const double *position, double *force)
{
    const pel_sim *sim = at->sim;
    pel_record *record = sim->minimise->record;
    at->state.position = record;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            record[v][k] = (pel_real)position[3 * (size_t)v + (size_t)k];
    pel_body_forces(sim->model, &at->state, NULL, sim->pool, sim->force);
    pel_shell_energy shells = pel_shell_forces_add(sim->shells, record, at->span,
                                                   PEL_SHELL_ELASTIC | PEL_SHELL_CONSERVATIVE, sim->pool, sim->force);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++)
            force[3 * (size_t)v + (size_t)k] = (double)sim->force[v][k];
    return spring_energy(at) + shells.membrane + shells.bending + shells.fibres + shells.pressure;
}

/* the same in double */
static double precise_energy(const pel_minimise_context *at, const double *position, double *force)
{
    const pel_sim *sim = at->sim;
    const pel_tangent_input input = {
        .unknowns = position, .span = at->span, .state = sim->state, .leaves_followers = true};
    pel_tangent_energy energy = pel_tangent_evaluate(sim->minimise->tangent, &input, sim->pool, force);
    for (int32_t u = 0; u < 3 * sim->model->vertex_count; u++)
        force[u] = -force[u];
    return pel_tangent_energy_sum(&energy);
}

static double energy_of(void *context, const double *position, double *force)
{
    pel_minimise_context *at = context;
    pel_sim *sim = at->sim;
    const pel_minimise *minimise = sim->minimise;
    double energy = minimise->tangent != NULL ? precise_energy(at, position, force) : batch_energy(at, position, force);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            size_t u = 3 * (size_t)v + (size_t)k;
            energy -= (double)minimise->external[v][k] * (position[u] - (double)sim->model->rest[v][k]);
            force[u] += (double)minimise->external[v][k];
        }
    return at->is_constrained ? energy + pel_minimise_contacts_evaluate(sim, position, force) : energy;
}

/* N, error of the forces of an enclosed gas or a target volume by rounding of the volume */
static double pressure_noise(const pel_sim *sim)
{
    double sum = 0;
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        if (body->shell == NULL)
            continue;
        const pel_pressure_def *pressure = &body->shell->pressure;
        if (pressure->kind == PEL_PRESSURE_GAS || pressure->kind == PEL_PRESSURE_VOLUME)
            sum += body->rest_area * (pressure->kind == PEL_PRESSURE_GAS ? fabs(pressure->value) : pressure->bulk);
    }
    return ROUNDING_ERRORS * (double)PEL_REAL_EPSILON * sum;
}

/* N, root of the sum of squares of all forces that are not elastic at some positions, including constant ones; 0 below
   rounding */
static double measure_external(pel_sim *sim, pel_span span, const pel_record *position)
{
    double square = 0;
    memcpy(sim->force, sim->minimise->external, (size_t)sim->model->vertex_count * sizeof *sim->force);
    pel_shell_forces_add(sim->shells, position, span, PEL_SHELL_CONSERVATIVE, sim->pool, sim->force);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int c = 0; c < 3; c++)
            square += sim->model->inverse_mass[v] > 0 ? (double)sim->force[v][c] * (double)sim->force[v][c] : 0;
    return sqrt(square) > pressure_noise(sim) ? sqrt(square) : 0;
}

/* the constant forces; returns measure_external at the present state */
static double find_external(pel_sim *sim, pel_span span)
{
    pel_record *external = sim->minimise->external;
    memset(external, 0, (size_t)sim->model->vertex_count * sizeof *external);
    pel_loads_add(sim, span, sim->state->position, external);
    pel_shell_forces_add(sim->shells, sim->state->position, span, PEL_SHELL_FOLLOWER, sim->pool, external);
    return measure_external(sim, span, sim->state->position);
}

/* N, of the forces of a body at rest: in double, as all minimisation */
static double rounding_force(const pel_sim *sim)
{
    return ROUNDING_ERRORS * DBL_EPSILON * sim->minimise->stiff_force;
}

/* What tools and contact leave alone may vibrate by forces that are small next to those of its supports: only loads and
   inertia measure what is left of them. */
static bool vibrates(const pel_sim *sim)
{
    return pel_minimise_is_in_motion(sim) && sim->tools->count == 0 && sim->contacts == NULL;
}

static pel_descent_problem make_problem(pel_minimise_context *context)
{
    const pel_sim *sim = context->sim;
    int32_t iterations = context->is_constrained ? PEL_ROUND_ITERATIONS : PEL_FREE_ITERATIONS;
    return (pel_descent_problem){
        .inverse_mass = sim->model->inverse_mass,
        .held = sim->held,
        .energy = energy_of,
        .context = context,
        .pool = sim->pool,
        .held_share = !pel_minimise_is_in_motion(sim) ? LOAD_SHARE
                      : vibrates(sim)                 ? 0
                                                      : DYNAMIC_SHARE,
        .inertia_share = DYNAMIC_SHARE,
        .longest_move = MOVE_SHARE * sim->minimise->mean_edge,
        .short_move = SHORT_SHARE * sim->minimise->size,
        .rounding = rounding_force(sim),
        .iterations = sim->solver.iterations > 0 ? sim->solver.iterations : iterations,
        .gradient_only = sim->solver.gradient_only,
    };
}

/* ---- under constraints ---- */

/* number of parts of the tools' motion, so that none passes through a body; and the longest displacement [m] */
static int count_parts(const pel_sim *sim, double *longest)
{
    double most = 1;
    *longest = 0;
    for (int32_t i = 0; i < sim->tools->count; i++) {
        const pel_tool *tool = &sim->tools->items[i];
        double half[3];
        pel_solid_half_box(&tool->solid, half);
        double limit = PART_SHARE * pel_min(half[0], pel_min(half[1], half[2]));
        double way = pel_tool_way(tool, &tool->pose_before, &tool->pose);
        *longest = pel_max(*longest, way);
        if (tool->press && tool->mesh == NULL)
            most = pel_max(most, way / limit);
    }
    return (int)ceil(pel_min(most, MOST_PARTS));
}

static void set_poses(pel_sim *sim, double share)
{
    for (int32_t i = 0; i < sim->tools->count; i++)
        pel_pose_between(&sim->tools->items[i].pose_before, &sim->tools->items[i].pose_wanted, share,
                         &sim->tools->items[i].pose);
    pel_tools_carry(sim);
    for (int32_t v = 0; sim->held != NULL && v < sim->model->vertex_count; v++)
        if (sim->held[v])
            pel_vertex_position(sim->state->position_next, v, sim->minimise->position + 3 * (size_t)v);
}

/* false if it is close enough to continue from its position */
static bool go_back_to(pel_sim *sim, int32_t v, double share)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    const double *start = sim->contacts->start[v], *end = sim->contacts->end[v];
    if ((1 - share) * pel_vec3_distance(start, end) < BEYOND_SHARE * sim->minimise->mean_edge ||
        (sim->held != NULL && sim->held[v]))
        return false;
    /* Newton's method comes back by itself, and keeps the shape of the bodies */
    if (sim->minimise->minimiser == NULL)
        return true;
    for (int k = 0; k < 3; k++)
        sim->state->position_next[v][k] = (pel_real)(start[k] + share * (end[k] - start[k]));
    pel_vertex_position(sim->state->position_next, v, sim->minimise->position + 3 * (size_t)v);
    return true;
}

/* moves vertices that passed far through a surface back to shortly before it; false if there are none. For round tools
   the gaps are used instead */
static bool go_back(pel_sim *sim)
{
    const pel_contact_set *contacts = sim->contacts;
    double *shares = sim->minimise->shares;
    bool any = false;
    for (int pass = 0; pass < 2; pass++)
        for (size_t c = 0; c < contacts->conflict_count; c++) {
            const pel_conflict *conflict = &contacts->conflicts[c];
            if (conflict->obstacle >= 0 && pel_tool_is_round(&sim->tools->items[conflict->obstacle]))
                continue;
            for (int i = 0; i < 4; i++) {
                int32_t v = conflict->vertices[i];
                if (v < 0)
                    continue;
                if (pass == 1 && shares[v] < 1)
                    any |= go_back_to(sim, v, shares[v]);
                shares[v] = pass == 0 ? pel_min(shares[v], SAFE_SHARE * conflict->time) : 1;
            }
        }
    return any;
}

/* finds contacts at position_next, and with `looks` surfaces that met during the motion; *again is set if they restart
   the round */
static pel_status find_constraints(pel_sim *sim, bool looks, bool *again, pel_error *error)
{
    bool sees = pel_sim_has_loop_contacts(sim);
    *again = false;
    if (sees)
        pel_minimise_contacts_keep_loads(sim);
    pel_status status = pel_minimise_contacts_find_tools(sim, error);
    if (status == PEL_OK && sees && looks) {
        status = pel_contacts_find_on_way(sim, error);
        *again = status == PEL_OK && go_back(sim);
    }
    if (status == PEL_OK && sees) {
        pel_contact_set_look_at_start(sim->contacts);
        status = pel_minimise_contacts_add_surfaces(sim, error);
    }
    pel_minimise_contacts_press(sim);
    return status;
}

/* largest violation of newly found constraints, relative to tolerance */
static double deepest_gap(const pel_sim *sim)
{
    const pel_minimise *minimise = sim->minimise;
    double deepest = 0;
    for (int32_t c = 0; c < minimise->count; c++) {
        pel_gap_sample meeting;
        pel_minimise_contact_meet(sim, &minimise->constraints[c], minimise->position, &meeting);
        const pel_minimise_contact *constraint = &minimise->constraints[c];
        deepest = pel_max(deepest, -(meeting.gap + constraint->depth) / constraint->tolerance);
    }
    return deepest;
}

/* N, loads, moments on edges, contacts and holding forces: those are sums of forces of the bodies, whose rounding holds
   nothing */
static double acting_force(const pel_sim *sim, double loads)
{
    double contact = pel_minimise_contacts_force(sim), held = sim->minimise->result.held_force;
    held = held > rounding_force(sim) ? held : 0;
    return pel_hypot(sqrt(loads * loads + contact * contact + held * held), sim->minimise->result.moment_force);
}

/* Relative to the acting forces, or to the rounding of the forces of a body where those are lost in it. If none acts
   now, a body recovers from earlier ones; if none ever did, it is at rest. */
static double tolerance_of(const pel_sim *sim, double loads)
{
    double acting = acting_force(sim, loads), rounding = rounding_force(sim);
    if (acting == 0)
        acting = sim->minimise->step_acted;
    return acting > 0 ? pel_max(LOAD_SHARE * acting, pel_min(rounding, LOST_SHARE * acting)) : rounding;
}

double pel_minimise_tolerance(pel_sim *sim, double time)
{
    double loads = find_external(sim, pel_instant(time));
    return loads > 0 ? LOAD_SHARE * loads : rounding_force(sim);
}

double pel_minimise_held_share(void)
{
    return LOAD_SHARE;
}

double pel_minimise_short_move(const pel_sim *sim)
{
    return SHORT_SHARE * sim->minimise->size;
}

/* relative to the forces that act; Newton's method adds the same share of inertia */
static double dynamic_tolerance(const pel_sim *sim, double loads)
{
    if (vibrates(sim))
        return pel_max(DYNAMIC_SHARE * loads, rounding_force(sim));
    double acting = acting_force(sim, loads), share = pel_sim_has_velocity(sim) ? DYNAMIC_SHARE : SETTLING_SHARE;
    return acting > 0 ? share * acting : rounding_force(sim);
}

/* the largest force that has acted; for a body that starts deformed or prestressed, its stress */
static void remember_acting(pel_sim *sim, double loads, double first_residual)
{
    pel_minimise *minimise = sim->minimise;
    bool is_stressed = minimise->step_acted == 0 && first_residual > tolerance_of(sim, loads);
    double acting = acting_force(sim, loads);
    minimise->step_acted = pel_max(minimise->step_acted, acting == 0 && is_stressed ? first_residual : acting);
}

/* N, a body that tools push about freely resists them by forces that are too small to strain it, and rounding leaves
   some of these */
static double stuck_force(const pel_sim *sim)
{
    return STUCK_STRAIN * sim->minimise->stiff_force;
}

/* the friction that balances the forces is that of the loads which do */
static bool slips_by_law(const pel_sim *sim, const pel_contact_change *change, double tolerance)
{
    return change->misfit <= pel_max(FRICTION_SHARE * change->limit, pel_max(tolerance, stuck_force(sim)));
}

/* not relative to the initial forces of the round: forces of closing gaps are far larger than all others */
static bool is_balanced(const pel_sim *sim, const pel_descent_result *round, double loads)
{
    const double least = stuck_force(sim);
    if (round->stuck && round->residual <= least && acting_force(sim, loads) <= 10 * least)
        return true;
    double tolerance = pel_minimise_is_in_motion(sim)
                           ? pel_hypot(dynamic_tolerance(sim, loads), DYNAMIC_SHARE * round->inertia_force)
                           : pel_hypot(tolerance_of(sim, loads), LOAD_SHARE * round->held_force);
    return round->converged && (round->is_near || round->residual <= tolerance);
}

/* one run of the minimiser; the state takes its positions */
static pel_status run_and_round(pel_minimise_context *context, const pel_descent_problem *problem,
                                pel_descent_result *result, pel_error *error)
{
    pel_sim *sim = context->sim;
    pel_status status = sim->minimise->run(context, problem, result, error);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3 && sim->model->mesh_vertex[v] >= 0; k++)
            sim->state->position_next[v][k] = (pel_real)sim->minimise->position[3 * (size_t)v + (size_t)k];
    return status;
}

/* ---- work of a step in time ---- */

static bool is_bounded(const pel_sim *sim)
{
    return pel_sim_has_velocity(sim) && sim->part.can_halve;
}

int32_t pel_minimise_systems_left(const pel_sim *sim)
{
    int32_t left = PEL_STEP_SYSTEMS - sim->part.systems;
    if (!is_bounded(sim))
        return pel_sim_has_velocity(sim) ? MOST_SYSTEMS : SETTLING_SYSTEMS;
    return pel_parts_are_spent(sim) ? SPENT_SYSTEMS : left < MOST_SYSTEMS ? left : MOST_SYSTEMS;
}

/* before its first part */
static void begin_work(pel_sim *sim)
{
    int32_t spent = sim->minimise->spent_steps;
    bool is_jammed = spent >= JAMMED_STEPS && spent % PROBING_STEPS != 0;
    if (is_bounded(sim) && sim->part.at == 0 && sim->part.systems == 0 && is_jammed)
        sim->part.systems = PEL_STEP_SYSTEMS - JAMMED_SYSTEMS;
}

/* a round: what costs as much as several systems counts as so many */
static void count_work(pel_sim *sim, const pel_descent_result *round)
{
    int32_t systems = (int32_t)(round->work / PEL_SYSTEM_WORK);
    if (pel_sim_has_velocity(sim))
        sim->part.systems += systems > round->iterations ? systems : round->iterations > 0 ? round->iterations : 1;
}

/* after an accepted part */
static void end_work(pel_sim *sim)
{
    pel_minimise *minimise = sim->minimise;
    if (is_bounded(sim) && pel_parts_are_last(sim))
        minimise->spent_steps = pel_parts_are_spent(sim) ? minimise->spent_steps + 1 : 0;
}

/* rounds until gaps are closed and forces balanced; the last part of a step looks for surfaces as well */
static pel_status minimise_in_rounds(pel_minimise_context *context, double loads, bool is_last, pel_error *error)
{
    pel_sim *sim = context->sim;
    pel_minimise *minimise = sim->minimise;
    pel_descent_problem problem = make_problem(context);
    pel_descent_result *sum = &minimise->result, round;
    pel_status status = PEL_OK;
    bool closed = false, is_dynamic = pel_minimise_is_in_motion(sim), can_halve = pel_parts_can_halve(sim);
    bool is_spent = is_bounded(sim) && pel_parts_are_spent(sim);
    int failures = 0, lost = 0, limit = can_halve ? HALVING_ROUNDS : is_spent ? SPENT_ROUNDS : ROUND_LIMIT;
    double before = HUGE_VAL;
    sum->converged = false;
    for (int n = 0; status == PEL_OK && !sum->converged && n < limit; n++) {
        bool again, had_any = minimise->count > 0;
        problem.tolerance = is_dynamic ? dynamic_tolerance(sim, loads) : tolerance_of(sim, loads);
        problem.enough = ROUGH_SHARE * problem.tolerance;
        problem.reduction = !had_any || closed ? 0 : problem.goes_on ? REDUCTION : FIRST_REDUCTION;
        status = run_and_round(context, &problem, &round, error);
        if (status != PEL_OK)
            return status;
        count_work(sim, &round);
        sum->iterations += round.iterations;
        sum->evaluations += round.evaluations;
        sum->residual = round.residual;
        sum->held_force = round.held_force;
        if (n == 0)
            remember_acting(sim, loads, round.first_residual);
        failures += !round.converged;
        bool settles = is_dynamic && !pel_sim_has_velocity(sim);
        if (!pel_sim_all_inside(sim) || (settles && failures == 1) || (can_halve && failures == HALVING_FAILURES))
            return PEL_OK;
        const pel_contact_change change = pel_minimise_contacts_update(sim);
        /* what sticks in motion comes to rest over steps, since drags are kept */
        double error_of_gaps = is_dynamic ? change.gap : pel_max(change.gap, change.slip);
        bool is_stiff = minimise->penalty >= PEL_JAM_PENALTY, is_rigid = sim->contacts == NULL;
        double allowed = (is_rigid ? is_stiff : is_dynamic && !is_stiff) ? JAM_GAP : 1;
        if (round.converged && error_of_gaps > allowed && error_of_gaps > pel_min(CLOSING * before, FAR))
            minimise->penalty = pel_min(STIFFENING * minimise->penalty, MOST_PENALTY);
        before = error_of_gaps;
        status = find_constraints(sim, is_last, &again, error);
        /* nothing touches: continue to minimise until the forces balance; without tools, as far as iterations go that
           are given, as a body alone does */
        if (minimise->count == 0 && !had_any) {
            sum->converged = round.converged;
            problem.goes_on = true;
            if (round.stuck || (sim->tools->count == 0 && sim->solver.iterations > 0 && !round.converged))
                break;
            continue;
        }
        closed = !again && pel_max(error_of_gaps, deepest_gap(sim)) <= allowed;
        sum->converged = closed && slips_by_law(sim, &change, problem.tolerance) && is_balanced(sim, &round, loads);
        problem.goes_on = !again;
        lost = sim->stepper->is_static && minimise->count > minimise->tool_count && !round.converged ? lost + 1 : 0;
        bool is_late = sim->deadline < HUGE_VAL && sim->clock() >= sim->deadline;
        if (is_late || lost == LOST_ROUNDS || (!is_spent && is_bounded(sim) && pel_parts_are_spent(sim)))
            break;
    }
    return status;
}

/* the energy without constraints, and the forces of the bodies */
static double plain_energy(pel_minimise_context *context)
{
    const pel_minimise *minimise = context->sim->minimise;
    context->is_constrained = false;
    double energy = energy_of(context, minimise->position, minimise->force);
    context->is_constrained = true;
    return energy;
}

/* when forces act in the present part of the step */
static pel_span span_of(const pel_sim *sim)
{
    pel_span span = sim->minimise->acts;
    span.time = pel_sim_part_time(sim, span.time);
    span.back *= sim->step.dt;
    span.ahead *= sim->step.dt;
    return span;
}

double pel_minimise_energy(pel_sim *sim)
{
    pel_minimise_context context = {.sim = sim, .state = *sim->state, .span = span_of(sim)};
    return plain_energy(&context);
}

/* add the forces of inertia at the start of the step */
static void add_inertia(const pel_sim *sim, double *force)
{
    const pel_sim_newton *newton = sim->minimise->newton;
    if (newton->settling.rate > 0)
        return;
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            double way = newton->points[v][k] - (double)sim->state->position[v][k];
            force[3 * (size_t)v + (size_t)k] += newton->point_stiffness[v] * way;
        }
}

/* multipliers of contacts at the start of the step */
static void estimate_loads(pel_minimise_context *context, double reach)
{
    pel_sim *sim = context->sim;
    const double *stiffness = NULL;
    plain_energy(context);
    if (pel_minimise_is_in_motion(sim)) {
        stiffness = sim->minimise->inertia;
        add_inertia(sim, sim->minimise->force);
    }
    pel_minimise_contacts_estimate(sim, sim->minimise->force, reach, stiffness);
}

/* Loads that balance the forces at the start of a step are exact where inertia and weight make them: sheets, free
   bodies; those of the step before are better where bodies are stiff. Steps in time begin with what was better last. */
static void begin_loads(pel_minimise_context *context, double reach)
{
    pel_sim *sim = context->sim;
    pel_minimise *minimise = sim->minimise;
    estimate_loads(context, reach);
    minimise->begun[0] = pel_minimise_contacts_sum(sim);
    minimise->begun[1] = pel_minimise_contacts_sum_kept(sim);
    if (pel_minimise_is_in_motion(sim) && minimise->prefers_kept)
        pel_minimise_contacts_take_kept(sim);
}

/* after an accepted step; what rests keeps its loads, since updates without steps would add up */
static void keep_loads(pel_sim *sim)
{
    pel_minimise *minimise = sim->minimise;
    double sum = pel_minimise_contacts_sum(sim);
    if (pel_minimise_contacts_jam(sim))
        minimise->penalty = pel_max(minimise->penalty, PEL_JAM_PENALTY / SOFTENING);
    if (minimise->result.iterations == 0 && minimise->kept_count > 0)
        return;
    minimise->prefers_kept = fabs(minimise->begun[1] - sum) < FAVOUR * fabs(minimise->begun[0] - sum);
    pel_minimise_contacts_keep(sim);
}

static pel_status minimise_under_constraints(pel_minimise_context *context, double loads, pel_error *error)
{
    pel_sim *sim = context->sim;
    bool again;
    double way;
    for (int32_t i = 0; i < sim->tools->count; i++)
        sim->tools->items[i].pose_before = sim->tools->items[i].pose;
    /* before the tools move: it asks from where they come */
    pel_status status =
        pel_sim_has_loop_contacts(sim) ? pel_contacts_find(sim, pel_minimise_contacts_near(sim), error) : PEL_OK;
    if (status != PEL_OK)
        return status;
    pel_tools_move(sim, context->span.time);
    context->is_constrained = true;
    int part_count = count_parts(sim, &way);
    begin_work(sim);
    sim->minimise->penalty =
        pel_minimise_is_in_motion(sim) ? pel_max(PENALTY, SOFTENING * sim->minimise->penalty) : PENALTY;
    for (int part = 1; status == PEL_OK && part <= part_count; part++) {
        set_poses(sim, (double)part / part_count);
        status = find_constraints(sim, false, &again, error);
        if (status != PEL_OK)
            break;
        if (part == 1 && (sim->minimise->count > 0 || pel_minimise_is_in_motion(sim)))
            begin_loads(context, way / part_count);
        status = minimise_in_rounds(context, loads, part == part_count, error);
        if (!pel_sim_all_inside(sim))
            return status;
    }
    sim->minimise->result.energy = plain_energy(context);
    sim->minimise->step_way = way;
    if (!pel_sim_has_velocity(sim))
        pel_minimise_find_stray(sim);
    return status;
}

/* ---- a step ---- */

/* The pressure of a driven volume is far larger at the start of a step than at its end: use the forces at the end. */
static pel_status minimise_alone(pel_minimise_context *context, double loads, pel_error *error)
{
    pel_sim *sim = context->sim;
    pel_descent_result *sum = &sim->minimise->result, round;
    pel_descent_problem problem = make_problem(context);
    pel_status status = PEL_OK;
    bool is_done = false;
    for (int n = 0; status == PEL_OK && !is_done && n < ROUND_LIMIT; n++) {
        int32_t iterations = sum->iterations, evaluations = sum->evaluations;
        problem.tolerance = pel_minimise_is_in_motion(sim) ? dynamic_tolerance(sim, loads) : tolerance_of(sim, loads);
        status = run_and_round(context, &problem, &round, error);
        if (status != PEL_OK)
            return status;
        if (n == 0)
            remember_acting(sim, loads, round.first_residual);
        *sum = round;
        sum->iterations += iterations;
        sum->evaluations += evaluations;
        bool is_dynamic = pel_minimise_is_in_motion(sim);
        if (!is_dynamic && pel_sim_all_inside(sim))
            loads = measure_external(sim, context->span, sim->state->position_next);
        sim->minimise->step_acted = pel_max(sim->minimise->step_acted, acting_force(sim, loads));
        bool is_near = round.is_near || (is_dynamic && round.converged);
        const double enough = pel_hypot(tolerance_of(sim, loads), problem.held_share * round.held_force);
        sum->converged = is_near || round.residual <= enough;
        is_done = sum->converged || !round.converged || round.stuck;
        problem.goes_on = true;
    }
    return status;
}

void pel_minimise_begin_at_state(pel_sim *sim)
{
    pel_state *state = sim->state;
    memcpy(state->position_next, state->position, (size_t)sim->model->vertex_count * sizeof *state->position);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        pel_vertex_position(state->position, v, sim->minimise->position + 3 * (size_t)v);
}

pel_status pel_minimise_step(pel_sim *sim, pel_step_result *step, pel_error *error)
{
    pel_state *state = sim->state;
    pel_minimise_context context = {.sim = sim, .state = *state, .span = span_of(sim)};
    pel_shell_forces_follow(sim->shells, state->position);
    double loads = find_external(sim, context.span);
    pel_status status = pel_sim_has_velocity(sim)
                            ? PEL_OK
                            : pel_minimise_check_held(sim, sim->minimise->external, context.span.time, error);
    if (status != PEL_OK)
        return status;
    pel_minimise_begin_at_state(sim);
    if (sim->minimise->tangent != NULL)
        pel_tangent_follow(sim->minimise->tangent, sim->minimise->position);
    sim->minimise->result = (pel_descent_result){0};
    sim->minimise->count = sim->minimise->tool_count = 0;
    sim->minimise->step_way = 0;
    sim->minimise->step_acted = sim->minimise->acted;
    if (sim->tools->count > 0 || pel_sim_has_loop_contacts(sim))
        status = minimise_under_constraints(&context, loads, error);
    else
        status = minimise_alone(&context, loads, error);
    sim->minimise->turned = pel_sim_has_velocity(sim) ? 0 : pel_minimise_contacts_turned(sim);
    /* search again for remaining constraints */
    if (sim->contacts != NULL)
        sim->contacts->list.count = 0;
    *step = (pel_step_result){.diverged = status == PEL_OK && !pel_sim_all_inside(sim)};
    return status;
}

/* ---- creation ---- */

/* of the body with the shortest edges */
static double find_mean_edge(const pel_model *model)
{
    double least = HUGE_VAL;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_mesh *mesh = model->bodies[b].mesh;
        double sum = 0;
        for (int32_t t = 0; t < mesh->triangle_count; t++)
            for (int i = 0; i < 3; i++)
                sum += pel_vec3_distance(mesh->positions[mesh->triangles[t][i]],
                                         mesh->positions[mesh->triangles[t][(i + 1) % 3]]);
        least = pel_min(least, sum / (3.0 * mesh->triangle_count));
    }
    return least;
}

/* force that moves every vertex by an edge, from the bound of the stiffness */
static double find_stiff_force(pel_sim *sim, double edge)
{
    pel_stability stability;
    double square = 0, dt = sim->step.dt;
    pel_stability_bound(sim->model, &stability);
    pel_shell_stability_bound(sim->shells, &stability);
    for (int32_t v = 0; v < sim->model->vertex_count; v++)
        square += (double)sim->model->mass[v] * (double)sim->model->mass[v];
    sim->minimise->stiffness = stability.stiffness_bound > 0 ? stability.stiffness_bound : 1 / (dt * dt);
    return stability.stiffness_bound * edge * sqrt(square);
}

pel_status pel_minimise_create(pel_sim *sim, pel_minimise_run *run, pel_error *error)
{
    pel_minimise *minimise = sim->minimise = pel_allocate(1, sizeof *minimise);
    if (minimise == NULL)
        return pel_fail_memory(error);
    size_t count = (size_t)sim->model->vertex_count;
    minimise->run = run;
    minimise->acts = pel_instant(1);
    minimise->stray_body = -1;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(minimise->position, 3 * count), PEL_ROOM(minimise->force, 3 * count),
                          PEL_ROOM_ALIGNED(minimise->record, count), PEL_ROOM_ALIGNED(minimise->external, count),
                          PEL_ROOM(minimise->constraint_of_vertex, count), PEL_ROOM(minimise->shares, count),
                          PEL_ROOM(minimise->kept, PEL_KEPT_PAIRS * count), PEL_ROOM(minimise->pressed, count)))
        return pel_fail_memory(error);
    for (size_t v = 0; v < count; v++)
        minimise->shares[v] = 1;
    sim->contact_in_loop = true;
    minimise->mean_edge = find_mean_edge(sim->model);
    for (int32_t b = 0; b < sim->model->body_count; b++)
        minimise->size = pel_max(minimise->size, sim->model->bodies[b].diameter);
    minimise->stiff_force = find_stiff_force(sim, minimise->mean_edge);
    return PEL_OK;
}

void pel_minimise_follow_surface(pel_sim *sim)
{
    sim->minimise->kept_count = 0;
    pel_stability stability;
    if (sim->shells != NULL && pel_sim_has_velocity(sim))
        return;
    pel_stability_bound(sim->model, &stability);
    pel_shell_stability_bound(sim->shells, &stability);
    if (stability.stiffness_bound > 0)
        sim->minimise->stiffness = stability.stiffness_bound;
}

void pel_minimise_destroy(pel_sim *sim)
{
    pel_minimise *minimise = sim->minimise;
    if (minimise == NULL)
        return;
    pel_descent_destroy(minimise->minimiser);
    pel_sim_newton_destroy(sim);
    pel_tangent_destroy(minimise->tangent);
    PEL_FREE_ALL(minimise->position, minimise->force, minimise->record, minimise->external,
                 minimise->constraint_of_vertex, minimise->shares, minimise->kept, minimise->pressed,
                 minimise->constraints, minimise->others);
    pel_free(minimise);
}

void pel_minimise_read_tools(pel_sim *sim)
{
    pel_minimise_contacts_read(sim);
    /* a part in time that has not converged, although nobody limits its work */
    pel_minimise_contacts_doubt(sim, !sim->minimise->result.converged && sim->part.can_halve);
    for (int32_t t = 0; t < sim->tools->count; t++) {
        pel_tool *tool = &sim->tools->items[t];
        for (int32_t i = 0; i < tool->held_count; i++) {
            int32_t v = tool->held[i];
            double x[3], force[3];
            pel_vertex_position(sim->state->position_next, v, x);
            sim->stepper->get_held_force(sim, v, force);
            pel_tool_add_grip(sim, tool, v, x, force);
        }
    }
}

void pel_minimise_accept(pel_sim *sim)
{
    pel_descent_result *accepted = &sim->minimise->accepted, *part = &sim->minimise->result;
    end_work(sim);
    pel_sim_newton_choose(sim);
    if (sim->minimise->newton != NULL && sim->minimise->newton->base != NULL)
        sim->minimise->newton->base->is_due |= !pel_newton_is_prepared(sim->newton);
    keep_loads(sim);
    sim->minimise->tool_way += sim->minimise->step_way;
    sim->minimise->acted = sim->minimise->step_acted;
    if (sim->part.at > 0) {
        part->iterations += accepted->iterations;
        part->evaluations += accepted->evaluations;
        part->residual = pel_max(part->residual, accepted->residual);
        part->converged &= accepted->converged;
    }
    *accepted = *part;
}

bool pel_minimise_slides(const pel_sim *sim)
{
    return sim->minimise->turned > MOST_TURNED;
}

void pel_minimise_get_solver(const pel_sim *sim, pel_solver_reading *reading)
{
    const pel_descent_result *result = &sim->minimise->accepted;
    reading->solves = true;
    reading->iterations = result->iterations;
    reading->evaluations = result->evaluations;
    reading->energy = result->energy;
    reading->residual = result->residual;
    reading->unstable = result->unstable;
    reading->stray_body = sim->minimise->stray_body;
    reading->stray_way = sim->minimise->stray_way;
    reading->has_budget = sim->solver.budget > 0;
    reading->converged = result->converged;
}

/* ---- snapshots ---- */

/* numbers of a damaged snapshot must not lead out of arrays */
static void check_loaded(pel_minimise *minimise, int32_t vertex_count)
{
    if (minimise->kept_count < 0 || minimise->kept_count > PEL_KEPT_PAIRS * vertex_count)
        minimise->kept_count = 0;
    if (minimise->spent_steps < 0 || minimise->spent_steps == INT32_MAX)
        minimise->spent_steps = 0;
    if (minimise->newton != NULL && (PEL_IS_NO_CHOICE(minimise->newton->choice.way, PEL_WAY_COUNT) ||
                                     PEL_IS_NO_CHOICE(minimise->newton->choice.tried, PEL_WAY_COUNT)))
        minimise->newton->choice = (pel_newton_choice){.way = PEL_QUASI};
}

void pel_minimise_forget_contacts(pel_sim *sim)
{
    if (sim->minimise == NULL)
        return;
    sim->minimise->kept_count = 0;
    sim->minimise->prefers_kept = false;
    if (sim->minimise->newton != NULL && sim->minimise->newton->base != NULL)
        sim->minimise->newton->base->is_due = true;
}

void pel_minimise_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    if (sim->minimise == NULL)
        return;
    pel_transfer(at, &sim->minimise->acted, sizeof sim->minimise->acted);
    pel_transfer(at, &sim->minimise->tool_way, sizeof sim->minimise->tool_way);
    pel_transfer(at, &sim->minimise->accepted, sizeof sim->minimise->accepted);
    pel_transfer_list(at, sim->minimise->kept, (size_t)sim->model->vertex_count,
                      PEL_KEPT_PAIRS * sizeof *sim->minimise->kept);
    pel_transfer(at, &sim->minimise->kept_count, sizeof sim->minimise->kept_count);
    pel_transfer(at, &sim->minimise->prefers_kept, sizeof sim->minimise->prefers_kept);
    pel_transfer(at, &sim->minimise->penalty, sizeof sim->minimise->penalty);
    pel_transfer(at, &sim->minimise->spent_steps, sizeof sim->minimise->spent_steps);
    if (sim->minimise->newton != NULL)
        pel_transfer(at, &sim->minimise->newton->choice, sizeof sim->minimise->newton->choice);
    if (sim->minimise->newton != NULL && sim->minimise->newton->base != NULL)
        pel_sim_prepared_transfer(at, sim);
    if (at->load && at->bytes != NULL)
        check_loaded(sim->minimise, sim->model->vertex_count);
}

void pel_minimise_forget(pel_sim *sim)
{
    if (sim->minimise == NULL)
        return;
    sim->minimise->stray_body = -1;
    if (sim->minimise->newton == NULL)
        return;
    sim->minimise->newton->has_stepped = false;
    sim->minimise->newton->settling = (pel_settling){0};
    if (sim->minimise->newton->base != NULL)
        sim->minimise->newton->base->is_made = false;
}
