/* Rigid bodies in steps of Newton's method.

   A step of a scheme u = rate (y - anchor), m rate (u - carried) = F (step_implicit.c) is taken for the center as for a
   vertex. The turn has as reference the motion without torque from the start of the step, exact for any inertia
   (pel_rigid_drift): with the rotation vector t from there and weights w of the other state, whose t' and momentum L'
   are known,

     I rate (t - w t') + L + w (L' - L) = L_1,     L_1 = L + w (L' - L) + torque / rate,

   so a body without torque keeps its angular momentum and a body that something turns is of second order, as others.
   The springs of the vertices end where the body would be without forces: at the rotation exp(t^) of the reference,
   t^ = w t' + I^-1 w (L' - L) / rate. */
#include "minimise/rigid_part.h"

#include "attach/joint.h"
#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/pose.h"
#include "stage/rigids.h"

#include <math.h>
#include <string.h>

/* one body in a step in time */
struct pel_rigid_part {
    double rate;                  /* 1/s */
    double anchor[3], carried[3]; /* m and m/s, of the pivot */
    double spin[3];               /* rad/s, at the end of a step without forces */
    double angular_momentum[3];   /* N m s, then */
    double pivot[3], rotation[4]; /* then */
    double second[3][3];          /* kg m2, of the body about its pivot, in its own axes */
};

static const double no_way[3] = {0};

/* of the sum of second moments, so that those of a sheet have an inverse; of the size, how well a point is told of */
#define LEAST_SPREAD 1e-12
#define ORIGIN_TOLERANCE 1e-6
/* of the size of jointed bodies, rad: how far they may be apart; runs until then */
#define APART 1e-9
enum { MOST_RUNS = 10 };

static bool is_held(const pel_sim *sim, const pel_rigid *rigid)
{
    for (int32_t v = rigid->begin; sim->held != NULL && v < rigid->end; v++)
        if (sim->held[v])
            return true;
    return false;
}

static int32_t body_of(const pel_sim *sim, const pel_rigid *rigid)
{
    return sim->model->body_of_slice[rigid->begin / PEL_WIDTH];
}

pel_status pel_rigid_parts_create(const pel_sim *sim, double *unknowns, bool is_dynamic, pel_rigid_parts *parts,
                                  pel_error *error)
{
    if (sim->rigids == NULL)
        return PEL_OK;
    *parts = (pel_rigid_parts){
        .rigids = {.bodies = sim->rigids, .masses = sim->model->mass}, .unknowns = unknowns, .is_dynamic = is_dynamic};
    bool room = PEL_ALLOCATE_ALL(PEL_ROOM(parts->rigids.items, sim->rigids->count),
                                 PEL_ROOM(parts->rigids.arms, sim->model->vertex_count),
                                 PEL_ROOM(parts->items, sim->rigids->count));
    return room ? PEL_OK : pel_fail_memory(error);
}

void pel_rigid_parts_destroy(pel_rigid_parts *parts)
{
    PEL_FREE_ALL(parts->rigids.items, parts->rigids.arms, parts->items);
}

/* ---- unknowns ---- */

/* two vertices that nothing pins; false where there are none */
static bool find_slots(const pel_sim *sim, pel_newton_rigid *item)
{
    item->at = item->turn = -1;
    for (int32_t v = item->body->begin; v < item->body->end && item->turn < 0; v++)
        if (sim->model->mesh_vertex[v] >= 0 && sim->model->inverse_mass[v] > 0)
            *(item->at < 0 ? &item->at : &item->turn) = v;
    return item->turn >= 0;
}

/* rows: the axis of a hinge first, or those of space */
static void set_axes(pel_newton_rigid *item)
{
    const pel_rigid_shape *shape = item->body->shape;
    static const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    memcpy(item->axes, unit, sizeof unit);
    if (!shape->has_axis)
        return;
    int least = 0;
    for (int k = 1; k < 3; k++)
        least = fabs(shape->axis[k]) < fabs(shape->axis[least]) ? k : least;
    pel_vec3_copy(shape->axis, item->axes[0]);
    pel_vec3_cross(item->axes[0], unit[least], item->axes[1]);
    pel_vec3_normalize(item->axes[1]);
    pel_vec3_cross(item->axes[0], item->axes[1], item->axes[2]);
}

static void own_unknowns(const pel_sim *sim, const pel_newton_rigid *item, bool moves, uint8_t *fixed)
{
    const pel_rigid *body = item->body;
    const pel_rigid_shape *shape = body->shape;
    for (int32_t v = body->begin; v < body->end; v++)
        for (int k = 0; k < 3; k++)
            if (sim->model->mesh_vertex[v] >= 0)
                fixed[3 * v + k] = PEL_NEWTON_OWNED;
    for (int k = 0; k < 3 && moves && item->turn >= 0; k++) {
        fixed[3 * item->at + k] = shape->is_free ? 0 : PEL_NEWTON_OWNED;
        fixed[3 * item->turn + k] = shape->has_joint && (!shape->has_axis || k == 0) ? 0 : PEL_NEWTON_OWNED;
    }
}

/* first and second moments of masses of vertices about `middle` */
static double find_moments(const pel_sim *sim, const pel_rigid *body, const double middle[3], double first[3],
                           double second[3][3])
{
    double sum = 0, x[3];
    for (int32_t v = body->begin; v < body->end; v++) {
        double mass = (double)sim->model->mass[v];
        pel_vertex_position(sim->model->rest, v, x);
        pel_vec3_subtract(x, middle, x);
        pel_vec3_along(first, mass, x, first);
        for (int a = 0; a < 3; a++)
            pel_vec3_along(second[a], mass * x[a], x, second[a]);
        sum += mass;
    }
    return sum;
}

/* of a free body with a joint its point, where the vertices tell of it: a sheet does of points in its plane */
static void set_origin(const pel_sim *sim, pel_newton_rigid *item)
{
    const pel_rigid *body = item->body;
    double first[3] = {0}, unused[3] = {0}, second[3][3] = {{0}}, inverse[3][3], arm[3], back[3];
    pel_vec3_copy(body->shape->pivot, item->origin);
    item->share = 0;
    if (!body->shape->is_free || !pel_joints_find_point(sim, body, arm))
        return;
    pel_vec3_copy(arm, item->origin);
    double mass = find_moments(sim, body, no_way, first, second);
    pel_vec3_scale(first, 1 / mass, item->middle);
    memset(second, 0, sizeof second);
    find_moments(sim, body, item->middle, unused, second);
    pel_vec3_subtract(item->origin, item->middle, arm);
    double trace = second[0][0] + second[1][1] + second[2][2];
    for (int a = 0; a < 3; a++)
        second[a][a] += LEAST_SPREAD * trace;
    pel_inertia_invert((const double(*)[3])second, inverse);
    for (int a = 0; a < 3; a++)
        item->tilt[a] = pel_vec3_dot(inverse[a], arm);
    for (int a = 0; a < 3; a++)
        back[a] = pel_vec3_dot(second[a], item->tilt) - LEAST_SPREAD * trace * item->tilt[a];
    item->share = 1 / mass;
    if (pel_vec3_distance(back, arm) > ORIGIN_TOLERANCE * item->length) {
        item->share = 0;
        pel_vec3_copy(body->shape->pivot, item->origin);
    }
}

/* lengths, axes, and in steps in time the inertia that its vertices lack */
static void set_item(const pel_sim *sim, bool is_dynamic, const pel_rigid_part *part, pel_newton_rigid *item)
{
    const pel_rigid_shape *shape = item->body->shape;
    const double trace = shape->inertia[0][0] + shape->inertia[1][1] + shape->inertia[2][2];
    item->length = sqrt(trace / (3 * shape->mass));
    set_axes(item);
    set_origin(sim, item);
    for (int k = 0; k < 3 && is_dynamic; k++) {
        double axis[3] = {k == 0, k == 1, k == 2};
        pel_vec3_scale(part->second[k], part->rate * part->rate, item->lack[k]);
        pel_rotate(part->rotation, axis, axis);
        for (int a = 0; a < 3; a++)
            item->target[a][k] = axis[a];
    }
}

const pel_newton_rigids *pel_rigid_parts_gather(const pel_sim *sim, pel_rigid_parts *parts,
                                                bool (*is_free)(const pel_sim *sim, int32_t body), uint8_t *fixed)
{
    pel_newton_rigids *rigids = &parts->rigids;
    rigids->count = 0;
    for (int32_t i = 0; sim->rigids != NULL && i < sim->rigids->count; i++) {
        pel_newton_rigid item = {.body = &sim->rigids->items[i]};
        if (is_held(sim, item.body))
            continue;
        bool stays = is_free != NULL && is_free(sim, body_of(sim, item.body));
        bool moves = find_slots(sim, &item) && item.body->shape->has_joint && !stays;
        set_item(sim, parts->is_dynamic, &parts->items[i], &item);
        own_unknowns(sim, &item, moves, fixed);
        if (moves)
            rigids->items[rigids->count++] = item;
    }
    return rigids->count > 0 ? rigids : NULL;
}

/* 1/s2: a fall by the size of the bodies, at rest; the loads of that are the weights */
static double rate_at_rest(const pel_sim *sim, const double *loads)
{
    double least = (double)HUGE_VAL, pull = pel_max(1, pel_vec3_length(sim->model->gravity));
    for (int32_t i = 0; i < sim->rigids->count; i++) {
        const pel_rigid *rigid = &sim->rigids->items[i];
        double load[3] = {0};
        for (int32_t v = rigid->begin; v < rigid->end; v++)
            pel_vec3_add(load, loads + 3 * (size_t)v, load);
        pull = pel_max(pull, pel_vec3_length(load) / rigid->shape->mass);
        least = pel_min(least, sim->model->bodies[body_of(sim, rigid)].diameter);
    }
    return pull / least;
}

void pel_rigid_parts_join(pel_sim *sim, const double *loads, pel_rigid_parts *parts)
{
    double rate = parts->is_dynamic ? 1 / sim->step.dt : 0;
    if (sim->rigids != NULL)
        pel_joints_set_rows(sim, parts->is_dynamic ? rate * rate : rate_at_rest(sim, loads), &parts->rigids);
}

bool pel_rigid_parts_are_apart(pel_sim *sim, int runs)
{
    return pel_joints_renew_rows(sim) > APART && runs < MOST_RUNS;
}

void pel_rigid_parts_take(const pel_sim *sim, const pel_rigid_parts *parts)
{
    for (int32_t i = 0; sim->rigids != NULL && i < sim->rigids->count; i++) {
        pel_rigid *rigid = &sim->rigids->items[i];
        pel_rigid_fit_to(rigid, sim->rigids, sim->model->mass, parts->unknowns, is_held(sim, rigid));
        /* of the two quaternions of a rotation the nearer one */
        const double *q = rigid->state.rotation, *before = rigid->before.rotation;
        double sign = pel_vec3_dot(q, before) + q[3] * before[3] < 0 ? -1 : 1;
        for (int k = 0; k < 4; k++)
            rigid->state.rotation[k] *= sign;
        if (!is_held(sim, rigid))
            pel_rigid_place_in(rigid, sim->rigids, parts->unknowns);
    }
}

/* ---- inertia ---- */

/* half the trace less the tensor */
static void find_second(const double inertia[3][3], double second[3][3])
{
    double half = 0.5 * (inertia[0][0] + inertia[1][1] + inertia[2][2]);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            second[a][b] = (a == b ? half : 0) - inertia[a][b];
}

/* the second moments of vertices that move */
static void take_vertices(const pel_sim *sim, const pel_rigid *rigid, double factor, double second[3][3])
{
    for (int32_t v = rigid->begin; v < rigid->end; v++) {
        double x[3], mass = sim->model->inverse_mass[v] > 0 ? factor * (double)sim->model->mass[v] : 0;
        pel_vertex_position(sim->model->rest, v, x);
        pel_vec3_subtract(x, rigid->shape->pivot, x);
        for (int a = 0; a < 3; a++)
            pel_vec3_along(second[a], mass * x[a], x, second[a]);
    }
}

/* The other state of a scheme, as the way from the motion without torque: t' and L' - L; its pivot and momentum. */
static void find_other(const pel_sim *sim, const pel_rigid *rigid, double time, const pel_record *positions,
                       const pel_record *velocities, double turn[3], pel_rigid_state *other)
{
    pel_rigid_state start = rigid->before;
    pel_rigid drifts = *rigid, moves = *rigid;
    pel_vec3_scale(start.angular_momentum, time < 0 ? -1 : 1, start.angular_momentum);
    drifts.is_fixed = false;
    pel_rigid_begin(&drifts, &start);
    pel_rigid_drift(&drifts, fabs(time));
    pel_rigid_begin(&moves, &rigid->before);
    pel_rigid_fit(&moves, sim->rigids, sim->model->mass, positions);
    pel_rigids_take_motion(sim, &moves, positions, velocities);
    pel_rotation_between(drifts.state.rotation, moves.state.rotation, no_way, turn);
    *other = moves.state;
}

static void refer(const pel_sim *sim, const pel_rigid *rigid, const pel_implicit_scheme *s, const pel_record *positions,
                  const pel_record *velocities, pel_rigid_part *part)
{
    const double *position = s->position, *velocity = s->velocity;
    const pel_rigid_state *before = &rigid->before;
    const pel_rigid_shape *shape = rigid->shape;
    pel_rigid end = *rigid;
    pel_rigid_state other = *before;
    double turn[3] = {0}, more[3], weight = position[1];
    end.is_fixed = false;
    pel_rigid_begin(&end, before);
    pel_rigid_drift(&end, s->acts.time * sim->step.dt);
    if (weight != 0)
        find_other(sim, rigid, s->other * sim->step.dt, positions, velocities, turn, &other);
    pel_vec3_scale(turn, weight, turn);
    pel_vec3_subtract(other.angular_momentum, before->angular_momentum, more);
    pel_vec3_scale(more, weight, more);
    pel_vec3_add(before->angular_momentum, more, part->angular_momentum);
    pel_rigid_turn_by(&end, part->angular_momentum, part->spin);
    pel_rigid_turn_by(&end, more, more);
    pel_vec3_along(turn, 1 / part->rate, more, turn);
    pel_rotation_turn(end.state.rotation, turn, 1, part->rotation);
    for (int k = 0; k < 3; k++) {
        part->anchor[k] = position[0] * before->pivot[k] + position[1] * other.pivot[k];
        part->carried[k] = shape->inverse_mass * (velocity[0] * before->momentum[k] + velocity[1] * other.momentum[k]);
        part->pivot[k] = shape->is_free ? part->anchor[k] + part->carried[k] / part->rate : before->pivot[k];
    }
    find_second((const double(*)[3])shape->inertia, part->second);
    take_vertices(sim, rigid, -1, part->second);
}

void pel_rigid_parts_refer(const pel_sim *sim, pel_rigid_parts *parts, const pel_implicit_scheme *scheme,
                           const pel_record *positions, const pel_record *velocities)
{
    for (int32_t i = 0; sim->rigids != NULL && i < sim->rigids->count; i++) {
        parts->items[i].rate = scheme->rate / sim->step.dt;
        refer(sim, &sim->rigids->items[i], scheme, positions, velocities, &parts->items[i]);
    }
}

bool pel_rigid_parts_anchor(const pel_sim *sim, const pel_rigid_parts *parts, int32_t v, double anchor[3],
                            double carried[3])
{
    const pel_rigid *rigid = pel_rigid_of(sim->rigids, v);
    double arm[3], way[3];
    if (rigid == NULL)
        return false;
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    const pel_rigid_part *part = &parts->items[rigid - sim->rigids->items];
    pel_vertex_position(sim->model->rest, v, arm);
    pel_vec3_subtract(arm, rigid->shape->pivot, arm);
    pel_rotate(part->rotation, arm, arm);
    pel_vec3_cross(part->spin, arm, way);
    pel_vec3_add(part->carried, way, carried);
    pel_vec3_add(part->pivot, arm, anchor);
    pel_vec3_along(anchor, -1 / part->rate, carried, anchor);
    return true;
}

/* Less the torque of the forces that the solver left: what nothing turns keeps its angular momentum to rounding. */
static void subtract_left(const pel_sim *sim, const pel_rigid *rigid, const double *unknowns, double torque[3])
{
    const double *gradient = pel_newton_gradient(sim->newton);
    double arm[3], turn[3];
    for (int32_t v = rigid->begin; v < rigid->end; v++) {
        pel_vec3_subtract(unknowns + 3 * (size_t)v, rigid->state.pivot, arm);
        pel_vec3_cross(arm, gradient + 3 * (size_t)v, turn);
        pel_vec3_subtract(torque, turn, torque);
    }
}

/* N m of what is not inertia: by all of that, rate^2 sum over columns of R_k x ((R - R') C)_k */
static void find_torque(const pel_sim *sim, const pel_rigid *rigid, const pel_rigid_part *part, const double *unknowns,
                        double torque[3])
{
    double way[3][3], second[3][3], whole[3][3];
    static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    memcpy(second, part->second, sizeof second);
    take_vertices(sim, rigid, 1, second);
    for (int k = 0; k < 3; k++) {
        double target[3];
        pel_rotate(part->rotation, axes[k], target);
        for (int a = 0; a < 3; a++)
            way[a][k] = rigid->matrix[a][k] - target[a];
    }
    pel_vec3_set(torque, 0, 0, 0);
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < 3; k++)
            whole[a][k] = pel_vec3_dot(way[a], second[k]);
    for (int k = 0; k < 3; k++) {
        const double column[3] = {rigid->matrix[0][k], rigid->matrix[1][k], rigid->matrix[2][k]};
        const double own[3] = {whole[0][k], whole[1][k], whole[2][k]};
        double turn[3];
        pel_vec3_cross(column, own, turn);
        pel_vec3_along(torque, part->rate * part->rate, turn, torque);
    }
    if (rigid->shape->is_free)
        subtract_left(sim, rigid, unknowns, torque);
}

/* the motion of its way: of what something holds, or that stands short of a balance */
static void follow_carrier(const pel_sim *sim, pel_rigid *rigid)
{
    double start[3], end[3], spin[3];
    pel_rigid_center(rigid->shape, &rigid->before, start, NULL, NULL, NULL);
    pel_rigid_center(rigid->shape, &rigid->state, end, NULL, NULL, NULL);
    pel_rotation_between(rigid->before.rotation, rigid->state.rotation, no_way, spin);
    pel_vec3_subtract(end, start, end);
    pel_vec3_scale(end, 1 / sim->step.dt, end);
    pel_vec3_scale(spin, 1 / sim->step.dt, spin);
    pel_rigid_set_motion(rigid, end, spin);
}

void pel_rigid_parts_finish(const pel_sim *sim, const pel_rigid_parts *parts)
{
    for (int32_t i = 0; sim->rigids != NULL && i < sim->rigids->count; i++) {
        pel_rigid *rigid = &sim->rigids->items[i];
        const pel_rigid_part *part = &parts->items[i];
        const pel_rigid_shape *shape = rigid->shape;
        double torque[3];
        if (is_held(sim, rigid))
            follow_carrier(sim, rigid);
        else {
            find_torque(sim, rigid, part, parts->unknowns, torque);
            pel_vec3_along(part->angular_momentum, 1 / part->rate, torque, rigid->state.angular_momentum);
            if (shape->has_axis)
                pel_vec3_scale(shape->axis, pel_vec3_dot(shape->axis, rigid->state.angular_momentum),
                               rigid->state.angular_momentum);
            pel_vec3_subtract(rigid->state.pivot, part->anchor, torque);
            pel_vec3_scale(torque, shape->is_free ? shape->mass * part->rate : 0, rigid->state.momentum);
        }
        pel_rigid_place_velocities(rigid, sim->rigids, sim->state->position_next, sim->state->velocity_next);
    }
}

void pel_rigid_parts_collide(const pel_sim *sim, const pel_rigid_parts *parts,
                             bool (*collided)(const pel_sim *sim, int32_t body))
{
    for (int32_t i = 0; sim->rigids != NULL && i < sim->rigids->count; i++) {
        pel_rigid *rigid = &sim->rigids->items[i];
        const pel_rigid_part *part = &parts->items[i];
        double torque[3];
        if (!collided(sim, body_of(sim, rigid)) || is_held(sim, rigid))
            continue;
        pel_rigid moved = *rigid;
        pel_rigids_take_motion(sim, &moved, sim->state->position_next, sim->state->velocity_next);
        if (rigid->shape->is_free)
            pel_vec3_copy(moved.state.momentum, rigid->state.momentum);
        find_torque(sim, rigid, part, parts->unknowns, torque);
        pel_vec3_along(rigid->before.angular_momentum, sim->step.dt, torque, rigid->state.angular_momentum);
        if (rigid->shape->has_axis)
            pel_vec3_scale(rigid->shape->axis, pel_vec3_dot(rigid->shape->axis, rigid->state.angular_momentum),
                           rigid->state.angular_momentum);
        pel_rigid_place_velocities(rigid, sim->rigids, sim->state->position_next, sim->state->velocity_next);
    }
}

void pel_rigid_parts_go(const pel_sim *sim, const pel_rigid_parts *parts, double share,
                        bool (*goes)(const pel_sim *sim, int32_t body))
{
    for (int32_t i = 0; sim->rigids != NULL && i < sim->rigids->count; i++) {
        pel_rigid *rigid = &sim->rigids->items[i];
        if (!goes(sim, body_of(sim, rigid)))
            continue;
        pel_rigid_fit_to(rigid, sim->rigids, sim->model->mass, parts->unknowns, is_held(sim, rigid));
        pel_rigid_go_back(rigid, &rigid->state, share);
        follow_carrier(sim, rigid);
        pel_rigid_place_velocities(rigid, sim->rigids, sim->state->position_next, sim->state->velocity_next);
    }
    pel_rigids_place(sim->rigids, sim->state->position_next);
}
