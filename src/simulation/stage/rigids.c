#include "stage/rigids.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/functions.h"
#include "math/pose.h"
#include "pellicle/sim_rigid.h"

#include <string.h>

static int32_t count_bodies(const pel_model *model)
{
    int32_t count = 0;
    for (int32_t b = 0; b < model->body_count; b++)
        count += model->bodies[b].rigid != NULL;
    return count;
}

static int32_t body_of(const pel_sim *sim, const pel_rigid *rigid)
{
    return sim->model->body_of_slice[rigid->begin / PEL_WIDTH];
}

/* bodies that the method does not know */
static pel_status check_method(const pel_sim *sim, pel_error *error)
{
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        if (body->rigid != NULL && !sim->stepper->moves_rigid)
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", b,
                                      "use the method xpbd, implicit, explicit, static, pbd or pbd-distance",
                                      "body '%s' is rigid, which this method does not know", body->name);
        if (body->rigid != NULL && body->rigid->radius > 0 && !pel_sim_is_projected(sim))
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "body", b,
                                      "use the method xpbd, explicit, pbd or pbd-distance, or leave rigid.sphere out: "
                                      "then the body collides by its triangles",
                                      "body '%s' is a rigid sphere, which this method does not know", body->name);
    }
    return PEL_OK;
}

pel_status pel_rigids_create(pel_sim *sim, pel_error *error)
{
    const pel_model *model = sim->model;
    int32_t count = count_bodies(model);
    if (count == 0)
        return PEL_OK;
    pel_status status = check_method(sim, error);
    if (status != PEL_OK)
        return status;
    pel_rigids *rigids = sim->rigids = pel_allocate(1, sizeof *rigids);
    if (rigids == NULL ||
        !PEL_ALLOCATE_ALL(PEL_ROOM(rigids->items, count), PEL_ROOM(rigids->of_slice, model->slice_count),
                          PEL_ROOM(rigids->path, (size_t)count * PEL_RIGID_KNOTS)))
        return pel_fail_memory(error);
    rigids->are_all = count == model->body_count;
    rigids->rest = model->rest;
    rigids->inverse_mass = model->inverse_mass;
    for (int32_t s = 0; s < model->slice_count; s++)
        rigids->of_slice[s] = -1;
    for (int32_t b = 0; b < model->body_count; b++) {
        const pel_body *body = &model->bodies[b];
        if (body->rigid == NULL)
            continue;
        for (int32_t s = body->slice_begin; s < body->slice_end; s++)
            rigids->of_slice[s] = rigids->count;
        pel_rigid *rigid = &rigids->items[rigids->count];
        *rigid = (pel_rigid){.shape = body->rigid,
                             .begin = body->slice_begin * PEL_WIDTH,
                             .end = body->slice_end * PEL_WIDTH,
                             .middle = body->slice_begin * PEL_WIDTH + body->mesh->vertex_count,
                             .path = rigids->path + rigids->count++ * PEL_RIGID_KNOTS};
        pel_rigid_begin(rigid, &sim->state->rigids[b]);
    }
    return PEL_OK;
}

void pel_rigids_destroy(pel_sim *sim)
{
    if (sim->rigids == NULL)
        return;
    PEL_FREE_ALL(sim->rigids->items, sim->rigids->of_slice, sim->rigids->path, sim->rigids->rows);
    pel_free(sim->rigids);
}

/* ---- in a step ---- */

static bool is_held(const pel_sim *sim, const pel_rigid *rigid)
{
    for (int32_t v = rigid->begin; sim->held != NULL && v < rigid->end; v++)
        if (sim->held[v])
            return true;
    return false;
}

static bool is_asleep(const pel_sim *sim, const pel_rigid *rigid)
{
    return sim->asleep != NULL && sim->asleep[body_of(sim, rigid)];
}

void pel_rigids_begin(pel_sim *sim)
{
    for (int32_t i = 0; sim->rigids != NULL && i < sim->rigids->count; i++) {
        pel_rigid *rigid = &sim->rigids->items[i];
        rigid->before = sim->state->rigids[body_of(sim, rigid)];
        rigid->path_count = 0;
        pel_rigid_begin(rigid, &rigid->before);
    }
    if (sim->rigids != NULL)
        sim->rigids->substep = 0;
}

/* knots of paths: at the starts of substeps, of every n-th one where there are more */
static void keep_path(const pel_sim *sim, pel_rigid *rigid)
{
    int32_t number = sim->rigids->substep, every = sim->solver.substeps / (PEL_RIGID_KNOTS + 1) + 1;
    every = sim->solver.substeps <= PEL_RIGID_KNOTS + 1 ? 1 : every;
    if (number > 0 && number % every == 0)
        rigid->path[rigid->path_count++] = rigid->state;
}

static void sum_forces(const pel_sim *sim, const pel_rigid *rigid, const pel_record *positions, const pel_record *air,
                       double force[3], double torque[3])
{
    pel_rigid_grip grip = {.rigid = (pel_rigid *)(uintptr_t)rigid};
    double velocity[3];
    pel_vec3_set(force, 0, 0, 0);
    pel_vec3_set(torque, 0, 0, 0);
    for (int32_t v = rigid->begin; v < rigid->end; v++) {
        double own[3], arm[3], turn[3];
        pel_vertex_position(sim->force, v, own);
        pel_vertex_position(positions, v, arm);
        pel_vec3_subtract(arm, rigid->state.pivot, arm);
        if (air != NULL) {
            grip.weight = 1;
            pel_vec3_copy(arm, grip.arm);
            pel_rigid_grip_velocity(&grip, velocity);
            pel_vec3_along(own, -(double)air[v][3], velocity, own);
        }
        pel_vec3_cross(arm, own, turn);
        pel_vec3_add(force, own, force);
        pel_vec3_add(torque, turn, torque);
    }
}

void pel_rigids_kick(pel_sim *sim, const pel_record *positions, double h, const pel_record *air)
{
    for (int32_t i = 0; sim->rigids != NULL && i < sim->rigids->count; i++) {
        pel_rigid *rigid = &sim->rigids->items[i];
        const pel_rigid_state state = rigid->state;
        double force[3], torque[3];
        keep_path(sim, rigid);
        rigid->is_fixed = is_held(sim, rigid) || is_asleep(sim, rigid);
        pel_rigid_begin(rigid, &state);
        rigid->state.is_touched = false;
        sum_forces(sim, rigid, positions, air, force, torque);
        pel_rigid_kick(rigid, force, torque, h);
        pel_vec3_copy(force, rigid->force);
        pel_vec3_copy(torque, rigid->torque);
        /* pins take all of it, see add_reaction; what holds a body takes it by vertices */
        if (!is_held(sim, rigid))
            memset(sim->force + rigid->begin, 0, (size_t)(rigid->end - rigid->begin) * sizeof *sim->force);
    }
    if (sim->rigids != NULL) {
        sim->rigids->rate = 1 / h;
        sim->rigids->substep++;
    }
}

/* A fall goes by h v + h^2 g / 2, exactly; what something pushed has v at the end of the substep, so that it can lie
   still. */
static void fall(const pel_sim *sim, pel_rigid *rigid, double h)
{
    if (!rigid->is_fixed && rigid->shape->is_free && !rigid->started.is_touched)
        pel_vec3_along(rigid->state.pivot, -0.5 * h * h * sim->state->load_factor, sim->model->gravity,
                       rigid->state.pivot);
}

void pel_rigids_drift(pel_sim *sim, double h)
{
    for (int32_t i = 0; sim->rigids != NULL && i < sim->rigids->count; i++) {
        pel_rigid *rigid = &sim->rigids->items[i];
        if (is_held(sim, rigid)) {
            pel_rigid_fit(rigid, sim->rigids, sim->model->mass, sim->state->position_next);
            continue;
        }
        pel_rigid_drift(rigid, h);
        fall(sim, rigid, h);
    }
    pel_rigids_place(sim->rigids, sim->state->position_next);
}

/* of a body that something carries, from its way in a time h */
static void follow_carrier(pel_rigid *rigid, const pel_rigid_state *before, double h)
{
    static const double shorter[3] = {0};
    double start[3], end[3], spin[3];
    pel_rigid_center(rigid->shape, before, start, NULL, NULL, NULL);
    pel_rigid_center(rigid->shape, &rigid->state, end, NULL, NULL, NULL);
    pel_rotation_between(before->rotation, rigid->state.rotation, shorter, spin);
    pel_vec3_subtract(end, start, end);
    pel_vec3_scale(end, 1 / h, end);
    pel_vec3_scale(spin, 1 / h, spin);
    pel_rigid_set_motion(rigid, end, spin);
}

/* The force of the pins: what is missing to the change of the momentum of the center. One on a point of the hinge
   takes a moment about the others (their forces are least squares). */
static void add_reaction(const pel_sim *sim, const pel_rigid *rigid, const double change[3], const double turned[3],
                         double h, pel_record *reaction)
{
    double force[3], torque[3], middle[3] = {0}, x[3], spread[3][3] = {{0}}, inverse[3][3], own[3], share[3];
    int32_t count = 0;
    for (int k = 0; k < 3; k++) {
        force[k] = rigid->force[k] + (rigid->impulse[k] - change[k]) / h;
        torque[k] = rigid->torque[k] + (rigid->moment[k] - turned[k]) / h;
    }
    for (int32_t v = rigid->begin; v < rigid->end; v++)
        if (!(sim->model->inverse_mass[v] > 0) && sim->model->mesh_vertex[v] >= 0) {
            pel_vertex_position(sim->state->position_next, v, x);
            pel_vec3_add(middle, x, middle);
            count++;
        }
    pel_vec3_scale(middle, 1.0 / count, middle);
    for (int32_t v = rigid->begin; v < rigid->end; v++)
        if (!(sim->model->inverse_mass[v] > 0) && sim->model->mesh_vertex[v] >= 0) {
            pel_vertex_position(sim->state->position_next, v, x);
            pel_vec3_subtract(x, middle, x);
            for (int a = 0; a < 3; a++)
                for (int b = 0; b < 3; b++)
                    spread[a][b] += (a == b ? pel_vec3_squared_length(x) : 0) - x[a] * x[b];
        }
    double trace = spread[0][0] + spread[1][1] + spread[2][2];
    for (int a = 0; a < 3; a++)
        spread[a][a] += 1e-9 * trace;
    pel_vec3_subtract(middle, rigid->state.pivot, x);
    pel_vec3_cross(x, force, own);
    pel_vec3_subtract(torque, own, torque);
    pel_inertia_invert((const double(*)[3])spread, inverse);
    for (int a = 0; a < 3; a++)
        share[a] = pel_vec3_dot(inverse[a], torque);
    for (int32_t v = rigid->begin; v < rigid->end; v++)
        if (!(sim->model->inverse_mass[v] > 0) && sim->model->mesh_vertex[v] >= 0) {
            pel_vertex_position(sim->state->position_next, v, x);
            pel_vec3_subtract(x, middle, x);
            pel_vec3_cross(share, x, own);
            for (int k = 0; k < 3; k++)
                reaction[v][k] = (pel_real)((double)reaction[v][k] + force[k] / count + own[k]);
        }
}

static void finish(pel_sim *sim, pel_rigid *rigid, double h, pel_record *reaction, bool is_last)
{
    const pel_rigid_state *start = &rigid->started;
    double kept = pel_exp(-sim->solver.drag * h), velocity[3], before[3], turned[3];
    if (is_asleep(sim, rigid)) {
        pel_vec3_set(rigid->state.momentum, 0, 0, 0);
        pel_vec3_set(rigid->state.angular_momentum, 0, 0, 0);
    } else if (rigid->is_fixed)
        follow_carrier(rigid, start, h);
    else {
        pel_vec3_scale(rigid->state.momentum, kept, rigid->state.momentum);
        pel_vec3_scale(rigid->state.angular_momentum, kept, rigid->state.angular_momentum);
    }
    if (is_last)
        pel_rigid_place_velocities(rigid, sim->rigids, sim->state->position_next, sim->state->velocity_next);
    if (reaction == NULL || rigid->shape->is_free || rigid->is_fixed)
        return;
    pel_rigid_center(rigid->shape, start, NULL, before, NULL, NULL);
    pel_rigid_center(rigid->shape, &rigid->state, NULL, velocity, NULL, NULL);
    pel_vec3_subtract(velocity, before, velocity);
    pel_vec3_scale(velocity, rigid->shape->mass, velocity);
    pel_vec3_subtract(rigid->state.angular_momentum, start->angular_momentum, turned);
    add_reaction(sim, rigid, velocity, turned, h, reaction);
}

void pel_rigids_finish(pel_sim *sim, double h, pel_record *reaction, bool is_last)
{
    for (int32_t i = 0; sim->rigids != NULL && i < sim->rigids->count; i++)
        finish(sim, &sim->rigids->items[i], h, reaction, is_last);
}

void pel_rigids_keep(pel_sim *sim)
{
    for (int32_t i = 0; sim->rigids != NULL && i < sim->rigids->count; i++) {
        pel_rigid *rigid = &sim->rigids->items[i];
        sim->state->rigids_next[body_of(sim, rigid)] = rigid->state;
    }
}

/* ---- between two steps ---- */

static pel_rigid *rigid_of(const pel_sim *sim, int32_t body)
{
    return pel_rigid_of(sim->rigids, sim->model->bodies[body].slice_begin * PEL_WIDTH);
}

void pel_rigids_follow_positions(pel_sim *sim, int32_t body)
{
    pel_rigid *rigid = rigid_of(sim, body);
    if (rigid == NULL)
        return;
    pel_rigid_begin(rigid, &sim->state->rigids[body]);
    pel_rigid_fit(rigid, sim->rigids, sim->model->mass, sim->state->position);
    rigid->is_moved = true;
    pel_rigids_place(sim->rigids, sim->state->position);
    for (int32_t v = rigid->begin; v < rigid->end; v++)
        sim->state->position_before[v] = sim->state->position[v];
    sim->state->rigids[body] = rigid->state;
}

void pel_rigids_take_motion(const pel_sim *sim, pel_rigid *rigid, const pel_record *positions,
                            const pel_record *velocities)
{
    const pel_model *model = sim->model;
    double momentum[3] = {0}, turn[3] = {0}, center[3], inertia[3][3] = {{0}}, inverse[3][3], spin[3], x[3], v[3], c[3];
    pel_rigid_center(rigid->shape, &rigid->state, center, NULL, NULL, NULL);
    for (int32_t i = rigid->begin; i < rigid->end; i++) {
        double mass = (double)model->mass[i];
        pel_vertex_position(positions, i, x);
        pel_vertex_position(velocities, i, v);
        pel_vec3_subtract(x, center, x);
        pel_vec3_along(momentum, mass / rigid->shape->mass, v, momentum);
        pel_vec3_cross(x, v, c);
        pel_vec3_along(turn, mass, c, turn);
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                inertia[a][b] += mass * ((a == b ? pel_vec3_squared_length(x) : 0) - x[a] * x[b]);
    }
    pel_inertia_invert((const double(*)[3])inertia, inverse);
    for (int a = 0; a < 3; a++)
        spin[a] = pel_vec3_dot(inverse[a], turn);
    pel_rigid_set_motion(rigid, momentum, spin);
}

void pel_rigids_follow_velocities(pel_sim *sim, int32_t body)
{
    pel_rigid *rigid = rigid_of(sim, body);
    if (rigid == NULL)
        return;
    pel_rigid_begin(rigid, &sim->state->rigids[body]);
    pel_rigids_take_motion(sim, rigid, sim->state->position, sim->state->velocity);
    pel_rigid_place_velocities(rigid, sim->rigids, sim->state->position, sim->state->velocity);
    sim->state->rigids[body] = rigid->state;
}

void pel_rigids_hit(pel_sim *sim, int32_t body, const double point[3], const double impulse[3])
{
    pel_rigid_grip grip = {.rigid = rigid_of(sim, body), .weight = 1};
    pel_rigid_begin(grip.rigid, &sim->state->rigids[body]);
    pel_vec3_subtract(point, grip.rigid->state.pivot, grip.arm);
    pel_rigid_hit(&grip, impulse);
    pel_rigid_place_velocities(grip.rigid, sim->rigids, sim->state->position, sim->state->velocity);
    sim->state->rigids[body] = grip.rigid->state;
}

/* ---- readings ---- */

double pel_rigids_extra_energy(const pel_sim *sim, const pel_rigid_state *states, const pel_record *velocities)
{
    double sum = 0, v[3];
    for (int32_t i = 0; sim->rigids != NULL && velocities != NULL && i < sim->rigids->count; i++) {
        const pel_rigid *rigid = &sim->rigids->items[i];
        sum += pel_rigid_kinetic_energy(rigid->shape, &states[body_of(sim, rigid)]);
        for (int32_t k = rigid->begin; k < rigid->end; k++) {
            pel_vertex_position(velocities, k, v);
            sum -= 0.5 * (double)sim->model->mass[k] * pel_vec3_squared_length(v);
        }
    }
    return sum;
}

bool pel_sim_get_rigid(const pel_sim *sim, int32_t body, pel_rigid_reading *reading)
{
    if (!pel_sim_has_body(sim, body) || reading == NULL)
        return false;
    const pel_rigid_shape *shape = sim->model->bodies[body].rigid;
    if (shape == NULL)
        return false;
    const pel_rigid_state *state = &sim->state->rigids[body];
    *reading = (pel_rigid_reading){.mass = shape->mass, .kinetic_energy = pel_rigid_kinetic_energy(shape, state)};
    pel_rigid_center(shape, state, reading->center, reading->velocity, reading->spin, reading->angular_momentum);
    memcpy(reading->rotation, state->rotation, sizeof reading->rotation);
    pel_vec3_scale(reading->velocity, shape->mass, reading->momentum);
    return true;
}
