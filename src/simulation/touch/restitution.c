/* Restitution: after a collision two bodies, or a body and a tool, separate with e times their normal approach
   velocity, including the elastic rebound.

   Newton's law is one of rigid motions. In a shell of many vertices a law at each vertex (Bridson et al. 2002; Mueller
   et al. 2020, section 3.6) says little about the body: the touching vertices have hardly any mass, and the rest of the
   body continues. So the law acts on the rigid part of the motion, velocity V of the center and spin w from
   momentum and angular momentum, at the point p and normal n that the loads of the pair's contacts have on average. An
   impulse J at p along n changes V by J n / M and w by I^-1 (p - c) x J n, as for rigid bodies; vertices get this
   velocity field, which conserves momentum and angular momentum and leaves the deformation unchanged. Pinned and held
   bodies, and tools, keep their prescribed motion.

   A collision begins with the first step in which the pair presses, and ends with the first one in which it does not
   and parts. Its approach and separation velocities are taken at the contact: u^2 +- 2 a s with the relative
   acceleration a of gravity over the displacement s within the step. If a body has lost its velocity without rebound it
   rests in the contact; then the impulse is applied immediately. An impulse adds no more energy than the run has lost
   until then (ledger.h) if the method has the material's energy, so e <= 1 creates none. Bodies that approach more
   slowly than 2 g dt do not bounce, so that resting bodies stay at rest (Mueller et al. 2020, section 3.6). */
#include "touch/restitution.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "observe/ledger.h"
#include "stage/rigid_motion.h"
#include "stage/rigids.h"
#include "tool/tool.h"
#include "touch/contact.h"

#include <string.h>

/* share of the approach velocity: a pair that is slower has come to rest in the contact */
#define REST_SHARE 0.05
/* in steps of gravity: the least approach that bounces */
#define LEAST_STEPS 2
/* share of the mean edge: a pair that approaches by this much without a push has ended its collision */
#define IDLE_SHARE 1.0
/* a pair of groups in a collision, now and when the step began */
typedef struct encounter {
    pel_sim *sim;
    pel_collision_state *state;
    int32_t groups[2];
    pel_rigid_motion before[2], now[2];
    double restitution;
} encounter;

/* ---- rigid motions ---- */

static pel_rigid_motion motion_of_tool(const pel_sim *sim, const pel_tool *tool, bool now)
{
    pel_rigid_motion motion = {0};
    double turn[3];
    pel_vec3_copy(now ? tool->pose.position : tool->pose_before.position, motion.center);
    pel_vec3_subtract(tool->pose.position, tool->pose_before.position, motion.velocity);
    pel_vec3_scale(motion.velocity, 1 / sim->step.dt, motion.velocity);
    pel_pose_turn(&tool->pose_before, &tool->pose, turn);
    pel_vec3_scale(turn, 1 / sim->step.dt, motion.spin);
    return motion;
}

/* the step is accepted: its start is in the swapped arrays */
static pel_rigid_motion motion_of(const pel_sim *sim, int32_t group, bool now)
{
    const pel_state *state = sim->state;
    if (group >= sim->model->body_count)
        return motion_of_tool(sim, &sim->tools->items[group - sim->model->body_count], now);
    return now ? pel_rigid_motion_of(sim, group, state->position, state->velocity)
               : pel_rigid_motion_of(sim, group, state->position_before, state->velocity_next);
}

static void velocity_at(const pel_rigid_motion *motion, const double point[3], double velocity[3])
{
    double arm[3];
    pel_vec3_subtract(point, motion->center, arm);
    pel_vec3_cross(motion->spin, arm, velocity);
    pel_vec3_add(velocity, motion->velocity, velocity);
}

/* ---- one pair ---- */

/* relative velocity along the normal, above 0 = the groups part */
static double parting(const pel_rigid_motion motions[2], const double point[3], const double normal[3])
{
    double a[3], b[3];
    velocity_at(&motions[0], point, a);
    velocity_at(&motions[1], point, b);
    pel_vec3_subtract(a, b, a);
    return pel_vec3_dot(a, normal);
}

static double distance_along(const pel_rigid_motion motions[2], const double normal[3])
{
    double way[3];
    pel_vec3_subtract(motions[0].center, motions[1].center, way);
    return pel_vec3_dot(way, normal);
}

/* relative acceleration of gravity against the normal [m/s2] */
static double fall(const encounter *e)
{
    double along = pel_vec3_dot(e->sim->model->gravity, e->state->normal);
    return -along * ((e->now[0].is_free ? 1 : 0) - (e->now[1].is_free ? 1 : 0));
}

/* change of the parting velocity by an impulse of 1 N s on each */
static double mobility(const encounter *e)
{
    double sum = 0;
    for (int i = 0; i < 2; i++) {
        double arm[3], turn[3], change[3];
        pel_vec3_subtract(e->state->point, e->now[i].center, arm);
        pel_vec3_cross(arm, e->state->normal, turn);
        pel_rigid_apply((const double(*)[3])e->now[i].inverse_inertia, turn, change);
        sum += e->now[i].inverse_mass + pel_vec3_dot(turn, change);
    }
    return sum;
}

/* an impulse [N s] on a body; the forces of the step count it where the mass is that it moves */
static void push_body(const encounter *e, int i, double impulse)
{
    pel_sim *sim = e->sim;
    const pel_model *model = sim->model;
    const pel_rigid_motion *motion = &e->now[i];
    double arm[3], turn[3], spin[3], change[3], x[3], dt = sim->step.dt;
    pel_vec3_subtract(e->state->point, motion->center, arm);
    pel_vec3_cross(arm, e->state->normal, turn);
    pel_vec3_scale(turn, impulse, turn);
    pel_rigid_apply((const double(*)[3])motion->inverse_inertia, turn, spin);
    if (motion->is_free && model->bodies[e->groups[i]].rigid != NULL) {
        double whole[3];
        pel_vec3_scale(e->state->normal, impulse, whole);
        pel_rigids_hit(sim, e->groups[i], e->state->point, whole);
    }
    for (int32_t v = model->bodies[e->groups[i]].slice_begin * PEL_WIDTH;
         motion->is_free && v < pel_body_place_end(model, e->groups[i]); v++) {
        if (model->mesh_vertex[v] < 0)
            continue;
        pel_vertex_position(sim->state->position, v, x);
        pel_vec3_subtract(x, motion->center, x);
        pel_vec3_cross(spin, x, change);
        pel_vec3_along(change, impulse * motion->inverse_mass, e->state->normal, change);
        bool is_done = model->bodies[e->groups[i]].rigid != NULL;
        for (int k = 0; k < 3; k++) {
            sim->state->velocity[v][k] += is_done ? 0 : (pel_real)change[k];
            change[k] = (double)model->mass[v] * change[k] / dt;
        }
        pel_contact_force_add(&sim->contact_forces, &sim->contact_forces.vertex, v, change);
    }
    if (sim->stepper->restart != NULL)
        sim->stepper->restart(sim, e->groups[i]);
}

/* the reaction on a tool, and its work */
static void push_tool(const encounter *e, double impulse)
{
    pel_sim *sim = e->sim;
    pel_tool *tool = &sim->tools->items[e->groups[1] - sim->model->body_count];
    double force[3], velocity[3];
    pel_vec3_scale(e->state->normal, -impulse / sim->step.dt, force);
    pel_tool_add_reaction(tool, e->state->point, force);
    velocity_at(&e->now[1], e->state->point, velocity);
    sim->ledger->sums.work_tools += impulse * pel_vec3_dot(velocity, e->state->normal);
}

static void push(const encounter *e, double impulse)
{
    pel_sim *sim = e->sim;
    pel_pair_force *pair = &sim->contact_forces.pair[e->groups[0] * sim->contact_forces.group_count + e->groups[1]];
    push_body(e, 0, impulse);
    if (e->groups[1] < sim->model->body_count)
        push_body(e, 1, -impulse);
    else
        push_tool(e, impulse);
    pel_vec3_along(pair->force, impulse / sim->step.dt, e->state->normal, pair->force);
    pel_contacts_forget_loads(sim, e->groups[0], e->groups[1]);
    sim->present.has_force = false;
}

/* Energy that the run has lost until now [J]. The energy of pbd is not the material's: there only the approach bounds
   it. */
static double lost_energy(pel_sim *sim)
{
    pel_sim_ledger ledger;
    if (!pel_stepper_knows_material(sim->stepper))
        return HUGE_VAL;
    pel_sim_get_ledger(sim, &ledger);
    return ledger.dissipated_solver - ledger.energy_error;
}

/* Sets the separation velocity by Newton's law. A pair that still presses waits until that takes no more energy than
   was lost. */
static void part(encounter *e, double speed, bool presses)
{
    double wanted = e->restitution * e->state->approach, risen = 2 * fall(e) * e->state->risen;
    double aim = sqrt(pel_max(0, wanted * wanted - risen)), free = mobility(e);
    double gain = 0.5 * (aim * aim - speed * speed) / free;
    if (presses && aim <= speed)
        return;
    if (gain > 0) {
        double lost = pel_max(0, lost_energy(e->sim));
        if (presses && lost < gain)
            return;
        if (lost < gain)
            aim = sqrt(pel_max(speed * speed + 2 * free * lost, 0));
    }
    push(e, (aim - speed) / free);
}

/* place and approach of a pair that presses */
static void meet(encounter *e, const pel_pair_force *pair)
{
    pel_collision_state *state = e->state;
    pel_vec3_copy(pair->load, state->normal);
    pel_vec3_normalize(state->normal);
    pel_vec3_scale(pair->point, 1 / pair->load_size, state->point);
    double way = pel_max(0, pair->approach / pair->load_size), speed = -parting(e->before, state->point, state->normal);
    double square = speed * fabs(speed) + 2 * fall(e) * way;
    if (square > state->approach * state->approach)
        state->approach = sqrt(square);
    state->contact_distance = distance_along(e->before, state->normal) - way;
    state->idle_steps = 0;
}

static void collide(encounter *e, const pel_pair_force *pair)
{
    pel_collision_state *state = e->state;
    bool presses = pair->load_size > 0;
    double least = LEAST_STEPS * e->sim->step.dt * pel_vec3_length(e->sim->model->gravity);
    if (presses)
        meet(e, pair);
    else
        state->idle_steps++;
    if (!(e->now[0].is_free || e->now[1].is_free) || !(state->approach > least)) {
        *state = (pel_collision_state){0};
        return;
    }
    state->is_on = true;
    state->risen = distance_along(e->now, state->normal) - state->contact_distance;
    double speed = parting(e->now, state->point, state->normal);
    bool has_parted = !presses && speed > 0;
    if (has_parted || (presses && fabs(speed) < REST_SHARE * state->approach))
        part(e, speed, presses);
    double idle_way = state->idle_steps * e->sim->step.dt * state->approach;
    if (has_parted || idle_way > IDLE_SHARE * e->sim->contacts->mean_edge)
        *state = (pel_collision_state){0};
}

/* ---- all of them ---- */

static double restitution_of(const pel_sim *sim, int32_t group)
{
    int32_t tool = group - sim->model->body_count;
    double own = tool < 0 ? sim->model->bodies[group].restitution : sim->tools->items[tool].restitution;
    return own >= 0 ? own : sim->touch->def.restitution;
}

/* below 0 where neither has any */
static double restitution_of_pair(const pel_sim *sim, int32_t a, int32_t b)
{
    return pel_max(restitution_of(sim, a), restitution_of(sim, b));
}

static bool is_used(const pel_sim *sim)
{
    bool used = false;
    for (int32_t g = 0; sim->contacts != NULL && g < sim->contact_forces.group_count; g++)
        used |= restitution_of(sim, g) >= 0;
    return used;
}

pel_status pel_restitution_create(pel_sim *sim, pel_error *error)
{
    if (!is_used(sim))
        return PEL_OK;
    for (int32_t g = 0; g < sim->contact_forces.group_count; g++)
        if (restitution_of(sim, g) > 1 || !isfinite(restitution_of(sim, g)))
            return pel_refuse(error, PEL_BAD_ARGUMENT,
                              "give a number from 0 to 1, or omit it for the rebound of the material itself",
                              "restitution of contact is %g", restitution_of(sim, g));
    if (!pel_sim_has_velocity(sim))
        return pel_refuse(error, PEL_BAD_ARGUMENT, "omit it, or use the method xpbd, implicit, pbd or explicit",
                          "restitution needs velocities, which this method does not have");
    size_t count = (size_t)sim->model->body_count * (size_t)sim->contact_forces.group_count;
    sim->touch->collisions = pel_allocate(count, sizeof *sim->touch->collisions);
    return sim->touch->collisions != NULL ? PEL_OK : pel_fail_memory(error);
}

void pel_restitution_apply(pel_sim *sim)
{
    int32_t body_count = sim->model->body_count, group_count = sim->contact_forces.group_count;
    for (int32_t a = 0; sim->touch->collisions != NULL && a < body_count; a++)
        for (int32_t b = a + 1; b < group_count; b++) {
            const pel_pair_force *pair = &sim->contact_forces.pair[a * group_count + b];
            encounter e = {.sim = sim, .state = &sim->touch->collisions[a * group_count + b], .groups = {a, b}};
            e.restitution = restitution_of_pair(sim, a, b);
            if (e.restitution < 0 || !(pair->load_size > 0 || e.state->is_on))
                continue;
            for (int i = 0; i < 2; i++) {
                e.before[i] = motion_of(sim, e.groups[i], false);
                e.now[i] = motion_of(sim, e.groups[i], true);
            }
            collide(&e, pair);
        }
}
