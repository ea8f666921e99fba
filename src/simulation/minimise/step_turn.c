/* rad: turn of a part of the integration of a motion, and the most parts of a step; what spins faster is left to BDF2
 */
#include "minimise/step_turn.h"

#include "attach/tie.h"
#include "base/assert.h"
#include "math/pose.h"
#include "stage/rigid_motion.h"

#define PART_TURN 0.1
enum { PART_LIMIT = 64 };

/* ---- rigid motion without torque ---- */

/* rad/s: angular velocity after the rotation q, with the momentum and the inertia before it */
static void spin_after(const pel_rigid_motion *motion, const double q[4], double spin[3])
{
    double local[3];
    pel_rotate_back(q, motion->momentum, local);
    pel_rigid_apply((const double(*)[3])motion->inverse_inertia, local, spin);
    pel_rotate(q, spin, spin);
}

/* rad/s2 */
static void change_after(const pel_rigid_motion *motion, const double q[4], double change[3])
{
    double spin[3], torque[3];
    spin_after(motion, q, spin);
    pel_vec3_cross(motion->momentum, spin, torque);
    pel_rotate_back(q, torque, torque);
    pel_rigid_apply((const double(*)[3])motion->inverse_inertia, torque, change);
    pel_rotate(q, change, change);
}

/* One part by the classical method of Runge and Kutta, on the quaternion. */
static void turn_part(const pel_rigid_motion *motion, double time, double q[4])
{
    static const double share[4] = {0, 0.5, 0.5, 1}, weight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    double rate[4] = {0, 0, 0, 0}, sum[4] = {0, 0, 0, 0};
    for (int i = 0; i < 4; i++) {
        double at[4], spin[4] = {0, 0, 0, 0};
        for (int k = 0; k < 4; k++)
            at[k] = q[k] + share[i] * time * rate[k];
        double scale = 1 / sqrt(pel_vec3_dot(at, at) + at[3] * at[3]);
        for (int k = 0; k < 4; k++)
            at[k] *= scale;
        spin_after(motion, at, spin);
        pel_rotation_product(spin, at, rate);
        for (int k = 0; k < 4; k++) {
            rate[k] *= 0.5;
            sum[k] += weight[i] * rate[k];
        }
    }
    for (int k = 0; k < 4; k++)
        q[k] += time * sum[k];
    double scale = 1 / sqrt(pel_vec3_dot(q, q) + q[3] * q[3]);
    for (int k = 0; k < 4; k++)
        q[k] *= scale;
}

/* the rotation within a time, which may be negative; false if it is too fast */
static bool turn_for(const pel_rigid_motion *motion, double time, double q[4])
{
    double spin[3];
    pel_vec3_set(q, 0, 0, 0);
    q[3] = 1;
    for (int part = 0, count = 1; part < count; part++) {
        spin_after(motion, q, spin);
        double parts = fabs(time) * pel_vec3_length(spin) / PART_TURN;
        if (part == 0)
            count = parts < PART_LIMIT ? (int)parts + 1 : PART_LIMIT;
        if (!(parts < 2 * PART_LIMIT))
            return false;
        turn_part(motion, time / count, q);
    }
    return true;
}

/* ---- reference motions ---- */

static bool set_turn(const pel_sim *sim, const pel_implicit_scheme *s, int32_t body, pel_sim_turn *turn)
{
    const double times[3] = {s->other, 0, s->acts.time};
    const pel_rigid_motion now = pel_rigid_motion_of(sim, body, sim->state->position, sim->state->velocity);
    pel_vec3_copy(now.center, turn->center);
    for (int i = 0; i < 3; i++) {
        if (!turn_for(&now, times[i] * sim->step.dt, turn->rotation[i]))
            return false;
        spin_after(&now, turn->rotation[i], turn->spin[i]);
    }
    change_after(&now, turn->rotation[2], turn->change);
    return pel_vec3_length(now.spin) > 0;
}

void pel_sim_turns_set(const pel_sim *sim, const pel_implicit_scheme *s)
{
    pel_sim_newton *newton = sim->minimise->newton;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        newton->turns[b].turns = s->end == 1 && !newton->is_exact && pel_sim_newton_is_free(sim, b) &&
                                 !pel_ties_hold(sim, b) && set_turn(sim, s, b, &newton->turns[b]);
}

static void correct(const pel_sim_turn *turn, const pel_implicit_scheme *s, double rate, const double position[3],
                    double anchor[3], double carried[3])
{
    const double weights[3] = {-s->position[1], -s->position[0], 1};
    double start[3], way[3], velocity[3], acceleration[3], part[3];
    pel_vec3_subtract(position, turn->center, start);
    for (int i = s->position[1] != 0 ? 0 : 1; i < 3; i++) {
        pel_rotate(turn->rotation[i], start, way);
        pel_vec3_cross(turn->spin[i], way, velocity);
        pel_vec3_along(anchor, weights[i], way, anchor);
        pel_vec3_along(carried, weights[i], velocity, carried);
    }
    pel_vec3_cross(turn->spin[2], velocity, acceleration);
    pel_vec3_cross(turn->change, way, part);
    pel_vec3_add(acceleration, part, acceleration);
    pel_vec3_along(anchor, -1 / rate, velocity, anchor);
    pel_vec3_along(carried, -1 / rate, acceleration, carried);
}

void pel_sim_turn_refer(const pel_sim *sim, const pel_implicit_scheme *s, int32_t v, double anchor[3],
                        double carried[3])
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    const pel_sim_turn *turn = &sim->minimise->newton->turns[sim->model->body_of_slice[v / PEL_WIDTH]];
    const pel_state *state = sim->state;
    pel_record *const *stage = sim->minimise->newton->stage;
    const pel_record *other = s->first != NULL ? stage[0] : state->older_position;
    const pel_record *its_velocity = s->first != NULL ? stage[1] : state->older_velocity;
    double position[3];
    pel_vertex_position(state->position, v, position);
    for (int k = 0; k < 3; k++) {
        double older = s->position[1] != 0 ? s->position[1] * (double)other[v][k] : 0;
        double before = s->velocity[1] != 0 ? s->velocity[1] * (double)its_velocity[v][k] : 0;
        anchor[k] = s->position[0] * position[k] + older;
        carried[k] = s->velocity[0] * (double)state->velocity[v][k] + before;
    }
    if (turn->turns)
        correct(turn, s, s->rate / sim->step.dt, position, anchor, carried);
}
