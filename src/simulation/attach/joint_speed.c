/* Velocities that joints permit. Rows of positions leave a velocity across them: in a stage of length h that of a
   chord, which leads off its arc by w h / 2. Two stages (minimise/step_implicit.c) multiply it, and take as much energy
   as a scheme of first order: a pendulum of 1.16 s lost 41 % in 2 s at steps of 10 ms, 0.04 % with velocities along the
   joints; BDF2, which has no stages, 2.5 %. Such velocities differ by impulses along the rows, which conjugate
   gradients find on the momenta themselves; chains take about as many rounds as they have rows. */
#include "attach/joint.h"

#include "stage/rigids.h"

#include <math.h>

/* of the speeds at the start */
#define TOLERANCE 1e-12
enum { ROUNDS_PER_ROW = 2 };

/* rows of the place, without those of motors and limits */
static bool is_held(const pel_newton_row *row)
{
    return !isfinite(row->least) && !isfinite(row->most);
}

/* m/s or rad/s, of the error of a row */
static double speed_of(const pel_newton_row *row)
{
    double couple[3], sum = 0;
    pel_joint_couple(row, couple);
    for (int side = 0; side < 2; side++) {
        double speed[3], spin[3], sign = side == 0 ? 1 : -1;
        pel_rigid_grip grip = {.rigid = (pel_rigid *)(uintptr_t)row->bodies[side], .weight = 1};
        if (grip.rigid == NULL)
            continue;
        pel_vec3_subtract(row->points[side], grip.rigid->state.pivot, grip.arm);
        pel_rigid_grip_velocity(&grip, speed);
        pel_rigid_turn_by(grip.rigid, grip.rigid->state.angular_momentum, spin);
        sum += sign * (pel_vec3_dot(row->force, speed) + pel_vec3_dot(couple, spin));
    }
    return sum;
}

/* an impulse [N s or N m s] along a row */
static void hit(const pel_joint *joint, const pel_newton_row *row, double impulse)
{
    double couple[3];
    pel_joint_couple(row, couple);
    for (int side = 0; side < 2; side++) {
        double push[3], moment[3], arm[3], share = side == 0 ? impulse : -impulse;
        pel_rigid *rigid = joint->bodies[side];
        if (rigid == NULL)
            continue;
        pel_vec3_subtract(row->points[side], rigid->state.pivot, arm);
        pel_vec3_cross(arm, row->force, moment);
        pel_vec3_add(moment, couple, moment);
        pel_vec3_scale(row->force, share, push);
        pel_vec3_scale(moment, share, moment);
        pel_rigid_hit_by(rigid, push, moment);
    }
}

/* a column of impulses along all rows, times a factor */
static void hit_all(const pel_joints *joints, int column, double factor)
{
    for (int32_t i = 0; i < joints->count; i++)
        for (int32_t k = 0; k < joints->items[i].row_count; k++) {
            const pel_newton_row *row = &joints->items[i].rows[k];
            if (is_held(row))
                hit(&joints->items[i], row, factor * joints->speeds[row - joints->rows][column]);
        }
}

/* the square of the speeds of all rows, which go to a column */
static double find_speeds(const pel_joints *joints, int32_t count, int column)
{
    double square = 0;
    for (int32_t r = 0; r < count; r++) {
        double speed = is_held(&joints->rows[r]) ? speed_of(&joints->rows[r]) : 0;
        joints->speeds[r][column] = speed;
        square += speed * speed;
    }
    return square;
}

/* columns of joints->speeds: residual, direction, the speeds that the direction makes */
enum { LEFT, WAY, MADE };

static void keep_speeds(pel_joints *joints, int32_t count)
{
    double square = find_speeds(joints, count, LEFT), first = square;
    for (int32_t r = 0; r < count; r++)
        joints->speeds[r][WAY] = -joints->speeds[r][LEFT];
    for (int32_t round = 0; round < ROUNDS_PER_ROW * count && square > TOLERANCE * TOLERANCE * first; round++) {
        double work = 0, before = square;
        hit_all(joints, WAY, 1);
        find_speeds(joints, count, MADE);
        for (int32_t r = 0; r < count; r++)
            work += joints->speeds[r][WAY] * (joints->speeds[r][MADE] - joints->speeds[r][LEFT]);
        double length = work > 0 ? before / work : 0;
        hit_all(joints, WAY, length - 1);
        square = find_speeds(joints, count, LEFT);
        for (int32_t r = 0; r < count; r++)
            joints->speeds[r][WAY] = square / before * joints->speeds[r][WAY] - joints->speeds[r][LEFT];
        if (!(work > 0))
            break;
    }
}

static void end_speeds(pel_sim *sim, const pel_record *positions, pel_record *velocities)
{
    pel_joints *joints = sim->joints;
    const pel_joint *last = &joints->items[joints->count - 1];
    keep_speeds(joints, (int32_t)(last->rows + last->row_count - joints->rows));
    for (int32_t i = 0; i < sim->rigids->count; i++)
        pel_rigid_place_velocities(&sim->rigids->items[i], sim->rigids, positions, velocities);
}

void pel_joints_keep_speeds(pel_sim *sim)
{
    if (sim->joints != NULL)
        end_speeds(sim, sim->state->position_next, sim->state->velocity_next);
}

void pel_joints_start_speeds(pel_sim *sim)
{
    pel_newton_rigids unused;
    if (sim->joints == NULL || sim->state->velocity == NULL)
        return;
    pel_rigids_begin(sim);
    pel_joints_set_rows(sim, 1, &unused);
    end_speeds(sim, sim->state->position, sim->state->velocity);
    for (int32_t i = 0; i < sim->rigids->count; i++) {
        const pel_rigid *rigid = &sim->rigids->items[i];
        sim->state->rigids[sim->model->body_of_slice[rigid->begin / PEL_WIDTH]] = rigid->state;
    }
}
