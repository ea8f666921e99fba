/* The free motion of a body with the angular momentum L, constant in space. In its own axes L is pi = R^T L, and the
   midpoint rule

       pi1 = pi0 - theta x m,    theta = h J^-1 m,    m = (pi0 + pi1) / 2

   conserves both quadratic invariants of Euler's equations, energy and |pi|, exactly. theta is the vector of a Cayley
   rotation, of the quaternion (theta / 2, 1): with R1 = R0 cay(theta) also R1 pi1 = R0 pi0 = L (Simo and Wong 1991,
   "Unconditionally stable algorithms for rigid body dynamics that exactly preserve energy and momentum", for bodies
   without torque). No functions of angles are needed. Fast rotations are divided, so that the angle is right too. */
#include "rigid/rigid.h"

#include "geom/wide4.h"
#include "math/extremes.h"
#include "math/pose.h"

#include <string.h>

/* rad, of one midpoint step: its angle is too small by a twelfth of the square */
#define MOST_TURN 0.05
enum { MOST_TURNS = 4096, MOST_ROUNDS = 60 };
#define ROUND_TOLERANCE 1e-16
/* of the mean moment of inertia */
#define ROUND_TENSOR 1e-12
/* of the longest distance between pins: those nearer to a line are on it */
#define LINE_TOLERANCE 1e-9
/* rad, in a substep, from where on rows are found anew: (1 - cos) of it is the error of an arm */
#define FAR_TURN 0.1

static void multiply(const double m[3][3], const double x[3], double y[3])
{
    pel_vec3_set(y, pel_vec3_dot(m[0], x), pel_vec3_dot(m[1], x), pel_vec3_dot(m[2], x));
}

/* y = m^T x */
static void multiply_back(const double m[3][3], const double x[3], double y[3])
{
    double sum[3] = {0};
    for (int i = 0; i < 3; i++)
        pel_vec3_along(sum, x[i], m[i], sum);
    pel_vec3_copy(sum, y);
}

/* ---- shape ---- */

/* the pin that is farthest from the first one, and the one farthest from the line of both; -1 = there is none */
static void find_line(const pel_mesh *mesh, const int32_t *pinned, int32_t count, double axis[3], bool *is_line,
                      bool *is_plane)
{
    const double *first = mesh->positions[pinned[0]];
    double longest = 0, aside = 0, way[3], across[3];
    for (int32_t i = 1; i < count; i++) {
        pel_vec3_subtract(mesh->positions[pinned[i]], first, way);
        double length = pel_vec3_length(way);
        if (length > longest) {
            longest = length;
            pel_vec3_scale(way, 1 / length, axis);
        }
    }
    for (int32_t i = 1; i < count && longest > 0; i++) {
        pel_vec3_subtract(mesh->positions[pinned[i]], first, way);
        pel_vec3_cross(way, axis, across);
        double length = pel_vec3_length(across);
        aside = length > aside ? length : aside;
    }
    *is_line = longest > 0;
    *is_plane = longest > 0 && aside > LINE_TOLERANCE * longest;
}

/* A tensor that differs from a multiple of one only by rounding becomes that: of balls, cubes and other regular bodies.
 */
static void find_roundness(pel_rigid_shape *shape)
{
    double mean = (shape->inertia[0][0] + shape->inertia[1][1] + shape->inertia[2][2]) / 3, most = 0;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            most = pel_max(most, fabs(shape->inertia[a][b] - (a == b ? mean : 0)));
    if (!(mean > 0) || most > ROUND_TENSOR * mean)
        return;
    shape->roundness = 1 / mean;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            shape->inertia[a][b] = a == b ? mean : 0;
}

void pel_rigid_shape_set(pel_rigid_shape *shape, const pel_inertia *inertia, const pel_mesh *mesh,
                         const int32_t *pinned, int32_t pinned_count)
{
    bool is_line = false, is_plane = false;
    double arm[3];
    *shape = (pel_rigid_shape){.mass = inertia->mass, .is_free = pinned_count == 0};
    shape->inverse_mass = shape->is_free ? 1 / inertia->mass : 0;
    pel_vec3_copy(inertia->center, shape->center);
    pel_vec3_copy(shape->is_free ? inertia->center : mesh->positions[pinned[0]], shape->pivot);
    if (!shape->is_free)
        find_line(mesh, pinned, pinned_count, shape->axis, &is_line, &is_plane);
    shape->has_axis = is_line && !is_plane;
    shape->has_joint = !is_plane;
    pel_vec3_subtract(shape->center, shape->pivot, arm);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            shape->inertia[a][b] =
                inertia->tensor[a][b] + inertia->mass * ((a == b ? pel_vec3_squared_length(arm) : 0) - arm[a] * arm[b]);
    if (shape->is_free)
        find_roundness(shape);
    if (!is_line)
        pel_inertia_invert((const double(*)[3])shape->inertia, shape->inverse_inertia);
    if (!shape->has_axis)
        return;
    double turned[3];
    multiply((const double(*)[3])shape->inertia, shape->axis, turned);
    double about = pel_vec3_dot(turned, shape->axis);
    for (int a = 0; a < 3; a++)
        pel_vec3_scale(shape->axis, shape->axis[a] / about, shape->inverse_inertia[a]);
}

/* ---- states ---- */

/* angular velocity in space */
static void spin_of(const pel_rigid_shape *shape, const pel_rigid_state *state, double spin[3])
{
    double own[3], turned[3];
    pel_rotate_back(state->rotation, state->angular_momentum, own);
    multiply((const double(*)[3])shape->inverse_inertia, own, turned);
    pel_rotate(state->rotation, turned, spin);
}

/* Momenta of a motion of the center. Those about a pinned pivot are J_center spin + arm x M velocity, for the tensor
   about the pivot is larger by M (|arm|^2 - arm arm^T); of them stays what pins leave. */
static void set_momenta(const pel_rigid_shape *shape, const double velocity[3], const double spin[3],
                        pel_rigid_state *state)
{
    double arm[3], own[3], along[3], push[3], turned[3];
    pel_rotate_back(state->rotation, spin, own);
    multiply((const double(*)[3])shape->inertia, own, turned);
    pel_rotate(state->rotation, turned, state->angular_momentum);
    pel_vec3_scale(velocity, shape->is_free ? shape->mass : 0, state->momentum);
    if (shape->is_free)
        return;
    pel_vec3_subtract(shape->center, shape->pivot, arm);
    pel_rotate(state->rotation, arm, arm);
    pel_vec3_cross(spin, arm, along);
    pel_vec3_subtract(velocity, along, along);
    pel_vec3_cross(arm, along, push);
    pel_vec3_along(state->angular_momentum, shape->mass, push, state->angular_momentum);
    if (shape->has_axis)
        pel_vec3_scale(shape->axis, pel_vec3_dot(shape->axis, state->angular_momentum), state->angular_momentum);
    else if (!shape->has_joint)
        pel_vec3_set(state->angular_momentum, 0, 0, 0);
}

void pel_rigid_state_start(const pel_rigid_shape *shape, const double velocity[3], const double spin[3],
                           pel_rigid_state *state)
{
    *state = (pel_rigid_state){.rotation = {0, 0, 0, 1}};
    pel_vec3_copy(shape->pivot, state->pivot);
    set_momenta(shape, velocity, spin, state);
}

void pel_rigid_set_motion(pel_rigid *rigid, const double velocity[3], const double spin[3])
{
    set_momenta(rigid->shape, velocity, spin, &rigid->state);
}

void pel_rigid_center(const pel_rigid_shape *shape, const pel_rigid_state *state, double center[3], double velocity[3],
                      double spin[3], double angular_momentum[3])
{
    double arm[3], turn[3], speed[3], own[3];
    pel_vec3_subtract(shape->center, shape->pivot, arm);
    pel_rotate(state->rotation, arm, arm);
    spin_of(shape, state, turn);
    pel_vec3_cross(turn, arm, speed);
    pel_vec3_along(speed, shape->inverse_mass, state->momentum, speed);
    if (center != NULL)
        pel_vec3_add(state->pivot, arm, center);
    if (velocity != NULL)
        pel_vec3_copy(speed, velocity);
    if (spin != NULL)
        pel_vec3_copy(turn, spin);
    if (angular_momentum == NULL)
        return;
    /* all of it, not only what pins leave */
    double about[3];
    pel_rotate_back(state->rotation, turn, own);
    multiply((const double(*)[3])shape->inertia, own, about);
    pel_rotate(state->rotation, about, angular_momentum);
    pel_vec3_cross(arm, speed, about);
    pel_vec3_along(angular_momentum, shape->is_free ? 0 : -shape->mass, about, angular_momentum);
}

double pel_rigid_kinetic_energy(const pel_rigid_shape *shape, const pel_rigid_state *state)
{
    double spin[3];
    spin_of(shape, state, spin);
    return 0.5 * (shape->inverse_mass * pel_vec3_squared_length(state->momentum) +
                  pel_vec3_dot(spin, state->angular_momentum));
}

/* ---- in a step ---- */

static void set_matrix(pel_rigid *rigid)
{
    const double *q = rigid->state.rotation, x = 2 * q[0], y = 2 * q[1], z = 2 * q[2];
    const double xx = x * q[0], yy = y * q[1], zz = z * q[2], xy = x * q[1], yz = y * q[2], zx = z * q[0];
    const double xw = x * q[3], yw = y * q[3], zw = z * q[3];
    pel_vec3_set(rigid->matrix[0], 1 - (yy + zz), xy - zw, zx + yw);
    pel_vec3_set(rigid->matrix[1], xy + zw, 1 - (zz + xx), yz - xw);
    pel_vec3_set(rigid->matrix[2], zx - yw, yz + xw, 1 - (xx + yy));
}

void pel_rigid_begin(pel_rigid *rigid, const pel_rigid_state *state)
{
    rigid->state = *state;
    rigid->started = *state;
    pel_vec3_set(rigid->impulse, 0, 0, 0);
    pel_vec3_set(rigid->moment, 0, 0, 0);
    pel_vec3_set(rigid->way, 0, 0, 0);
    pel_vec3_set(rigid->turned, 0, 0, 0);
    rigid->unrest = 0;
    PEL_ASSERT(!rigid->is_owed);
    set_matrix(rigid);
}

/* of a vertex from the pivot, now */
static void arm_of(const pel_rigid *rigid, const pel_rigids *rigids, int32_t v, double arm[3])
{
    double local[3];
    pel_vertex_position(rigids->rest, v, local);
    pel_vec3_subtract(local, rigid->shape->pivot, local);
    multiply((const double(*)[3])rigid->matrix, local, arm);
}

/* four numbers at once, the sums in the order of arm_of */
static void place(const pel_rigid *rigid, const pel_rigids *rigids, pel_record *positions)
{
    const double(*m)[3] = (const double(*)[3])rigid->matrix, *p = rigid->state.pivot, *middle = rigid->shape->pivot;
    const wide4 x = {m[0][0], m[1][0], m[2][0], 0}, y = {m[0][1], m[1][1], m[2][1], 0};
    const wide4 z = {m[0][2], m[1][2], m[2][2], 0}, pivot = {p[0], p[1], p[2], 0};
    for (int32_t v = rigid->begin; v < rigid->end; v++) {
        const pel_record rest = rigids->rest[v];
        if (!(rigids->inverse_mass[v] > 0) && !rigid->shape->is_free)
            continue;
        pel_real w = positions[v][3];
        wide4 arm = x * ((double)rest[0] - middle[0]) + y * ((double)rest[1] - middle[1]);
        positions[v] = __builtin_convertvector(pivot + (arm + z * ((double)rest[2] - middle[2])), pel_record);
        positions[v][3] = w;
    }
}

void pel_rigids_place(pel_rigids *rigids, pel_record *positions)
{
    for (int32_t i = 0; rigids != NULL && i < rigids->count; i++) {
        pel_rigid *rigid = &rigids->items[i];
        pel_rigid_settle(rigid);
        if (rigid->is_moved)
            place(rigid, rigids, positions);
        rigid->is_moved = false;
    }
}

/* angular velocity */
static void turn_by(const pel_rigid *rigid, const double angular_momentum[3], double turn[3])
{
    double own[3], turned[3];
    if (rigid->shape->roundness > 0) {
        pel_vec3_scale(angular_momentum, rigid->shape->roundness, turn);
        return;
    }
    multiply_back((const double(*)[3])rigid->matrix, angular_momentum, own);
    multiply((const double(*)[3])rigid->shape->inverse_inertia, own, turned);
    multiply((const double(*)[3])rigid->matrix, turned, turn);
}

void pel_rigid_place_velocities(const pel_rigid *rigid, const pel_rigids *rigids, const pel_record *positions,
                                pel_record *velocities)
{
    double spin[3], velocity[3], arm[3];
    turn_by(rigid, rigid->state.angular_momentum, spin);
    for (int32_t v = rigid->begin; v < rigid->end; v++) {
        pel_vertex_position(positions, v, arm);
        pel_vec3_subtract(arm, rigid->state.pivot, arm);
        pel_vec3_cross(spin, arm, velocity);
        pel_vec3_along(velocity, rigid->shape->inverse_mass, rigid->state.momentum, velocity);
        bool is_pinned = !(rigids->inverse_mass[v] > 0) && !rigid->shape->is_free;
        for (int k = 0; k < 3; k++)
            velocities[v][k] = is_pinned ? 0 : (pel_real)velocity[k];
    }
}

/* what the bearing of a hinge takes */
static void keep_axis(pel_rigid *rigid)
{
    if (rigid->shape->has_axis)
        pel_vec3_scale(rigid->shape->axis, pel_vec3_dot(rigid->shape->axis, rigid->state.angular_momentum),
                       rigid->state.angular_momentum);
    else if (!rigid->shape->has_joint)
        pel_vec3_set(rigid->state.angular_momentum, 0, 0, 0);
}

void pel_rigid_kick(pel_rigid *rigid, const double force[3], const double torque[3], double time)
{
    if (rigid->is_fixed)
        return;
    if (rigid->shape->is_free)
        pel_vec3_along(rigid->state.momentum, time, force, rigid->state.momentum);
    pel_vec3_along(rigid->state.angular_momentum, time, torque, rigid->state.angular_momentum);
    keep_axis(rigid);
}

/* rotation <- rotation (theta / 2, 1), in the axes of the body; in those of space if `is_before` */
static void turn(double rotation[4], const double theta[3], bool is_before)
{
    double q[4] = {0.5 * theta[0], 0.5 * theta[1], 0.5 * theta[2], 1};
    if (is_before)
        pel_rotation_product(q, rotation, rotation);
    else
        pel_rotation_product(rotation, q, rotation);
    double scale = 1 / sqrt(pel_vec3_dot(rotation, rotation) + rotation[3] * rotation[3]);
    for (int i = 0; i < 4; i++)
        rotation[i] *= scale;
}

/* one midpoint step */
static void turn_freely(pel_rigid *rigid, double own[3], double time)
{
    double middle[3], theta[3], next[3], change[3], size = pel_vec3_length(own);
    pel_vec3_copy(own, middle);
    for (int round = 0; round < MOST_ROUNDS; round++) {
        multiply((const double(*)[3])rigid->shape->inverse_inertia, middle, theta);
        pel_vec3_scale(theta, time, theta);
        pel_vec3_cross(theta, middle, change);
        pel_vec3_subtract(own, change, next);
        pel_vec3_along(own, -0.5, change, change);
        double moved = pel_vec3_distance(change, middle);
        pel_vec3_copy(change, middle);
        if (!(moved > ROUND_TOLERANCE * size))
            break;
    }
    pel_vec3_copy(next, own);
    turn(rigid->state.rotation, theta, false);
}

void pel_rigid_drift(pel_rigid *rigid, double time)
{
    pel_rigid_state *state = &rigid->state;
    double own[3], spin[3];
    if (rigid->is_fixed)
        return;
    pel_vec3_along(state->pivot, time * rigid->shape->inverse_mass, state->momentum, state->pivot);
    turn_by(rigid, state->angular_momentum, spin);
    double turns = ceil(time * pel_vec3_length(spin) / MOST_TURN);
    int32_t count = turns < MOST_TURNS ? (int32_t)turns : MOST_TURNS;
    rigid->is_moved = true;
    if (count == 0)
        return;
    multiply_back((const double(*)[3])rigid->matrix, state->angular_momentum, own);
    for (int32_t i = 0; i < count; i++)
        turn_freely(rigid, own, time / count);
    set_matrix(rigid);
}

/* ---- pushes ---- */

double pel_rigid_mobility(const pel_rigid_grip *grip, const double direction[3])
{
    double torque[3], theta[3];
    if (grip->rigid->is_fixed)
        return 0;
    pel_vec3_cross(grip->arm, direction, torque);
    turn_by(grip->rigid, torque, theta);
    return grip->weight * grip->weight * grip->rigid->shape->inverse_mass + pel_vec3_dot(torque, theta);
}

void pel_rigid_hit_by(pel_rigid *rigid, const double impulse[3], const double moment[3])
{
    pel_vec3_add(rigid->impulse, impulse, rigid->impulse);
    pel_vec3_add(rigid->moment, moment, rigid->moment);
    if (rigid->shape->is_free)
        pel_vec3_add(rigid->state.momentum, impulse, rigid->state.momentum);
    pel_vec3_add(rigid->state.angular_momentum, moment, rigid->state.angular_momentum);
    keep_axis(rigid);
    rigid->state.is_touched = true;
}

void pel_rigid_turn_by(const pel_rigid *rigid, const double moment[3], double turn[3])
{
    turn_by(rigid, moment, turn);
}

void pel_rigid_shift(pel_rigid *rigid, const double push[3], const double moment[3], double rate)
{
    pel_rigid_shift_later(rigid, push, moment, rate);
    pel_rigid_settle(rigid);
}

void pel_rigid_shift_later(pel_rigid *rigid, const double push[3], const double moment[3], double rate)
{
    double theta[3], inverse_mass = rigid->shape->inverse_mass;
    if (rigid->is_fixed)
        return;
    turn_by(rigid, moment, theta);
    pel_vec3_along(rigid->state.pivot, inverse_mass, push, rigid->state.pivot);
    pel_vec3_along(rigid->way, inverse_mass, push, rigid->way);
    pel_vec3_add(rigid->turned, theta, rigid->turned);
    pel_vec3_add(rigid->owed_turn, theta, rigid->owed_turn);
    pel_vec3_along(rigid->owed_impulse, rate, push, rigid->owed_impulse);
    pel_vec3_along(rigid->owed_moment, rate, moment, rigid->owed_moment);
    rigid->is_owed = rigid->is_moved = true;
    if (pel_vec3_squared_length(rigid->turned) > FAR_TURN * FAR_TURN) {
        pel_rigid_settle(rigid);
        pel_vec3_set(rigid->way, 0, 0, 0);
        pel_vec3_set(rigid->turned, 0, 0, 0);
        rigid->far_turns++;
    }
}

void pel_rigid_settle(pel_rigid *rigid)
{
    if (!rigid->is_owed)
        return;
    pel_rigid_hit_by(rigid, rigid->owed_impulse, rigid->owed_moment);
    turn(rigid->state.rotation, rigid->owed_turn, true);
    set_matrix(rigid);
    pel_vec3_set(rigid->owed_turn, 0, 0, 0);
    pel_vec3_set(rigid->owed_impulse, 0, 0, 0);
    pel_vec3_set(rigid->owed_moment, 0, 0, 0);
    rigid->is_owed = false;
}

void pel_rigid_hit(const pel_rigid_grip *grip, const double impulse[3])
{
    double torque[3], own[3];
    if (grip->rigid->is_fixed)
        return;
    pel_vec3_cross(grip->arm, impulse, torque);
    pel_vec3_scale(impulse, grip->weight, own);
    pel_rigid_hit_by(grip->rigid, own, torque);
}

void pel_rigid_push(const pel_rigid_grip *grip, const double push[3], double rate)
{
    double torque[3], own[3];
    pel_vec3_cross(grip->arm, push, torque);
    pel_vec3_scale(push, grip->weight, own);
    pel_rigid_shift(grip->rigid, own, torque, rate);
}

void pel_rigid_grip_velocity(const pel_rigid_grip *grip, double velocity[3])
{
    const pel_rigid *rigid = grip->rigid;
    double spin[3];
    turn_by(rigid, rigid->state.angular_momentum, spin);
    pel_vec3_cross(spin, grip->arm, velocity);
    pel_vec3_along(velocity, grip->weight * rigid->shape->inverse_mass, rigid->state.momentum, velocity);
}

/* ---- places ---- */

void pel_rigid_go_back(pel_rigid *rigid, const pel_rigid_state *state, double share)
{
    static const double shorter[3] = {0};
    const pel_rigid_state *before = &rigid->before;
    double way[3], turned[3];
    pel_vec3_subtract(state->pivot, before->pivot, way);
    pel_vec3_along(before->pivot, share, way, rigid->state.pivot);
    pel_rotation_between(before->rotation, state->rotation, shorter, turned);
    pel_rotation_turn(before->rotation, turned, share, rigid->state.rotation);
    pel_vec3_scale(state->momentum, share, rigid->state.momentum);
    pel_vec3_scale(state->angular_momentum, share, rigid->state.angular_momentum);
    set_matrix(rigid);
    rigid->is_moved = true;
    rigid->path_count = 0;
}

double pel_rigid_turned(const pel_rigid *rigid)
{
    static const double shorter[3] = {0};
    double angle = 0, turn[3];
    for (int32_t i = 0; i <= rigid->path_count; i++) {
        const pel_rigid_state *from = i > 0 ? &rigid->path[i - 1] : &rigid->before;
        const pel_rigid_state *to = i < rigid->path_count ? &rigid->path[i] : &rigid->state;
        pel_rotation_between(from->rotation, to->rotation, shorter, turn);
        angle += pel_vec3_length(turn);
    }
    return angle;
}

void pel_rigid_place_between(const pel_rigid *rigid, const pel_rigids *rigids, int32_t v, double share, double x[3])
{
    static const double shorter[3] = {0};
    double parts = share * (rigid->path_count + 1), turn[3], rotation[4], way[3], arm[3];
    int32_t part = (int32_t)(parts < rigid->path_count ? parts : rigid->path_count);
    const pel_rigid_state *from = part > 0 ? &rigid->path[part - 1] : &rigid->before;
    const pel_rigid_state *to = part < rigid->path_count ? &rigid->path[part] : &rigid->state;
    pel_rotation_between(from->rotation, to->rotation, shorter, turn);
    pel_rotation_turn(from->rotation, turn, parts - part, rotation);
    pel_vertex_position(rigids->rest, v, arm);
    pel_vec3_subtract(arm, rigid->shape->pivot, arm);
    pel_rotate(rotation, arm, arm);
    pel_vec3_subtract(to->pivot, from->pivot, way);
    pel_vec3_along(arm, parts - part, way, arm);
    pel_vec3_add(from->pivot, arm, x);
}

/* sum of r_k x a_k over the columns of the rotation and of A, and the size of the latter */
static double find_torque(const double a[3][3], const pel_rigid *rigid, double torque[3])
{
    double along = 0, size = 0;
    pel_vec3_set(torque, 0, 0, 0);
    for (int k = 0; k < 3; k++) {
        const double r[3] = {rigid->matrix[0][k], rigid->matrix[1][k], rigid->matrix[2][k]};
        const double column[3] = {a[0][k], a[1][k], a[2][k]};
        double cross[3];
        pel_vec3_cross(r, column, cross);
        pel_vec3_add(torque, cross, torque);
        along += pel_vec3_dot(r, column);
        size += pel_vec3_length(column);
    }
    return fabs(along) + 1e-9 * size;
}

/* tr(S) - S with the symmetric part S of A R^T: how the torque falls as the rotation turns */
static void find_slope(const double a[3][3], const pel_rigid *rigid, double slope[3][3])
{
    double product[3][3], trace = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            product[i][k] = pel_vec3_dot(a[i], rigid->matrix[k]);
    for (int k = 0; k < 3; k++)
        trace += product[k][k];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            slope[i][k] = (i == k ? trace : 0) - 0.5 * (product[i][k] + product[k][i]);
}

/* The rotation that fits a matrix A = sum m x X^T best, from a guess: by torques of its columns (Mueller et al. 2016,
   "A robust method to extract the rotational part of deformations"), near the end by Newton's method. */
static void fit_rotation(const double a[3][3], pel_rigid *rigid)
{
    for (int round = 0; round < MOST_ROUNDS; round++) {
        double torque[3], turned[3], slope[3][3], inverse[3][3], size = find_torque(a, rigid, torque);
        pel_vec3_scale(torque, 1 / size, turned);
        if (!(pel_vec3_length(turned) > 1e-15))
            return;
        find_slope(a, rigid, slope);
        if (pel_vec3_length(turned) < 0.01 && pel_inertia_invert((const double(*)[3])slope, inverse))
            multiply((const double(*)[3])inverse, torque, turned);
        pel_rotation_turn(rigid->state.rotation, turned, 1, rigid->state.rotation);
        set_matrix(rigid);
    }
}

/* positions as records, or, where those are null, in double */
static void fit(pel_rigid *rigid, const pel_rigids *rigids, const pel_real *masses, const pel_record *records,
                const double *positions)
{
    double sum = 0, center[3] = {0}, rest[3] = {0}, x[3], own[3], a[3][3] = {{0}};
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t v = rigid->begin; v < rigid->end; v++) {
            double mass = (double)masses[v];
            if (records != NULL)
                pel_vertex_position(records, v, x);
            else
                pel_vec3_copy(positions + 3 * (size_t)v, x);
            pel_vertex_position(rigids->rest, v, own);
            if (pass == 0) {
                pel_vec3_along(center, mass, x, center);
                pel_vec3_along(rest, mass, own, rest);
                sum += mass;
                continue;
            }
            pel_vec3_subtract(x, center, x);
            pel_vec3_subtract(own, rest, own);
            for (int i = 0; i < 3; i++)
                pel_vec3_along(a[i], mass * x[i], own, a[i]);
        }
        pel_vec3_scale(center, pass == 0 ? 1 / sum : 1, center);
        pel_vec3_scale(rest, pass == 0 ? 1 / sum : 1, rest);
    }
    fit_rotation((const double(*)[3])a, rigid);
    pel_vec3_subtract(rigid->shape->pivot, rest, own);
    multiply((const double(*)[3])rigid->matrix, own, own);
    if (rigid->shape->is_free)
        pel_vec3_add(center, own, rigid->state.pivot);
}

void pel_rigid_fit(pel_rigid *rigid, const pel_rigids *rigids, const pel_real *masses, const pel_record *positions)
{
    fit(rigid, rigids, masses, positions, NULL);
}

/* Of the rotation the part about the axis of the hinge: fits of far positions need not be about it. */
static void keep_hinge(pel_rigid *rigid)
{
    double *q = rigid->state.rotation, along = pel_vec3_dot(rigid->shape->axis, q),
           size = sqrt(along * along + q[3] * q[3]);
    if (!(size > 0))
        return;
    pel_vec3_scale(rigid->shape->axis, along / size, q);
    q[3] /= size;
    set_matrix(rigid);
}

void pel_rigid_fit_to(pel_rigid *rigid, const pel_rigids *rigids, const pel_real *masses, const double *positions,
                      bool is_held)
{
    fit(rigid, rigids, masses, NULL, positions);
    if (rigid->shape->has_axis && !is_held)
        keep_hinge(rigid);
}

void pel_rigid_place_in(const pel_rigid *rigid, const pel_rigids *rigids, double *positions)
{
    double arm[3];
    for (int32_t v = rigid->begin; v < rigid->end; v++) {
        if (!(rigids->inverse_mass[v] > 0) && !rigid->shape->is_free)
            continue;
        arm_of(rigid, rigids, v, arm);
        pel_vec3_add(rigid->state.pivot, arm, positions + 3 * (size_t)v);
    }
}
