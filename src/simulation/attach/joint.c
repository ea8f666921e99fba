/* A joint is up to six rows J (dx, dw) = -error between two bodies, and the matrix of one joint is solved at once: with
   the directions n of forces, the moments m = r x n + t of forces and torques about the pivots, and the mobilities of
   both bodies

       K_ij = sum over both of  n_i . n_j / M + m_i . I^-1 m_j

   the loads K^-1 (-error) close it to second order (Mueller et al. 2020, "Detailed rigid body simulation with extended
   position based dynamics", solve the rows one after the other, which takes a dozen sweeps under a lever). The last row
   is that of the motor and the limits: a motor too weak for where it aims at gives its strength, and the others are
   solved again; where the joint would then pass a limit, the row leads to the limit with any load.

   Errors are those now; loads act where the joint was when the substep began, along its axes then, with arms to the
   pivots then. So they are the constraint forces of SHAKE (Ryckaert, Ciccotti, Berendsen 1977): the method stays
   symplectic, a pendulum keeps its energy to 6e-5 where loads along the axes now take 3 % in a swing, and the angular
   momentum of two free bodies stays to rounding errors. */
#include "attach/joint.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/pose.h"
#include "pellicle/sim_rigid.h"
#include "stage/accessors.h"
#include "stage/stepper.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

enum { MOST_ROWS = 6 };

/* ---- where a joint is ---- */

static void turn_vector(const pel_rigid *rigid, const double local[3], double turned[3])
{
    if (rigid == NULL)
        pel_vec3_copy(local, turned);
    else
        pel_rotate(rigid->state.rotation, local, turned);
}

void pel_joint_turn(const pel_joint *joint, int side, const double local[3], double turned[3])
{
    turn_vector(joint->bodies[side], local, turned);
}

void pel_joint_point(const pel_joint *joint, int side, double point[3])
{
    const pel_rigid *rigid = joint->bodies[side];
    turn_vector(rigid, joint->arms[side], point);
    if (rigid != NULL)
        pel_vec3_add(rigid->state.pivot, point, point);
}

bool pel_joint_is_driven(const pel_joint *joint)
{
    return joint->def.kind == PEL_JOINT_HINGE || joint->def.kind == PEL_JOINT_SLIDER;
}

/* the whole turns of a hinge are those nearest to the last position */
double pel_joint_position(const pel_joint *joint)
{
    const double full = 6.283185307179586476925;
    double axis[3], across[3], mine[3], points[2][3], side[3];
    turn_vector(joint->bodies[1], joint->axes[0], axis);
    if (joint->def.kind == PEL_JOINT_SLIDER) {
        pel_joint_point(joint, 0, points[0]);
        pel_joint_point(joint, 1, points[1]);
        pel_vec3_subtract(points[0], points[1], side);
        return pel_vec3_dot(side, axis);
    }
    if (joint->def.kind != PEL_JOINT_HINGE)
        return 0;
    turn_vector(joint->bodies[1], joint->axes[1], across);
    turn_vector(joint->bodies[0], joint->axes[1], mine);
    pel_vec3_cross(across, mine, side);
    double angle = pel_atan2(pel_vec3_dot(side, axis), pel_vec3_dot(across, mine));
    return angle + full * floor((joint->present - angle) / full + 0.5);
}

/* ---- rows ---- */

typedef struct joint_rows {
    int count;
    bool has_drive;                             /* the last one is that of motor and limits */
    double position, strength;                  /* rad or m, N s2 or N m s2: where it is, most load of the motor */
    double forces[MOST_ROWS][3];                /* directions of forces */
    double torques[MOST_ROWS][3];               /* of torques beside them */
    double moments[2][MOST_ROWS][3];            /* of both about the pivots */
    double turns[2][MOST_ROWS][3];              /* what these turn the bodies by */
    double errors[MOST_ROWS], loads[MOST_ROWS]; /* m or rad */
} joint_rows;

static void add_row(joint_rows *rows, const double force[3], const double torque[3], double error)
{
    static const double none[3] = {0};
    pel_vec3_copy(force != NULL ? force : none, rows->forces[rows->count]);
    pel_vec3_copy(torque != NULL ? torque : none, rows->torques[rows->count]);
    rows->errors[rows->count++] = error;
}

/* errors along the axes now, loads along those at the start of the substep */
static void add_point_rows(const pel_joint *joint, const double now[3][3], const double axes[3][3], joint_rows *rows)
{
    double points[2][3], apart[3];
    pel_joint_point(joint, 0, points[0]);
    pel_joint_point(joint, 1, points[1]);
    pel_vec3_subtract(points[0], points[1], apart);
    for (int k = joint->def.kind == PEL_JOINT_SLIDER; k < 3; k++)
        add_row(rows, axes[k], NULL, pel_vec3_dot(apart, now[k]));
}

static void add_turn_rows(const pel_joint *joint, const double now[3][3], const double axes[3][3], joint_rows *rows)
{
    static const double shorter[3] = {0}, none[4] = {0, 0, 0, 1};
    double turned[3], mine[3];
    const pel_rigid *other = joint->bodies[1];
    if (joint->def.kind == PEL_JOINT_HINGE) {
        turn_vector(joint->bodies[0], joint->axes[0], mine);
        pel_vec3_cross(now[0], mine, turned);
    } else
        pel_rotation_between(other != NULL ? other->state.rotation : none, joint->bodies[0]->state.rotation, shorter,
                             turned);
    for (int k = joint->def.kind == PEL_JOINT_HINGE; k < 3 && joint->def.kind != PEL_JOINT_BALL; k++)
        add_row(rows, NULL, axes[k], pel_vec3_dot(turned, now[k]));
}

/* leads to where the motor aims at */
static void add_drive_row(const pel_joint *joint, const double axis[3], double substep, joint_rows *rows)
{
    const pel_joint_def *def = &joint->def;
    if (!pel_joint_is_driven(joint) || !(def->strength > 0 || isfinite(def->least) || isfinite(def->most)))
        return;
    rows->position = pel_joint_position(joint);
    rows->strength = def->strength * substep * substep;
    rows->has_drive = true;
    add_row(rows, def->kind == PEL_JOINT_SLIDER ? axis : NULL, def->kind == PEL_JOINT_HINGE ? axis : NULL,
            rows->position - joint->target - def->speed * substep);
}

static bool is_loose(const pel_rigid *rigid)
{
    return rigid != NULL && !rigid->is_fixed;
}

/* where the point of one of its bodies was when the substep began */
static void start_point(const pel_joint *joint, int side, double point[3])
{
    const pel_rigid *rigid = joint->bodies[side];
    pel_vec3_copy(joint->arms[side], point);
    if (rigid == NULL)
        return;
    pel_rotate(rigid->started.rotation, joint->arms[side], point);
    pel_vec3_add(rigid->started.pivot, point, point);
}

static void find_moments(const pel_joint *joint, joint_rows *rows)
{
    double points[2][3], middle[3], arm[3];
    start_point(joint, 0, points[0]);
    start_point(joint, 1, points[1]);
    pel_vec3_subtract(points[1], points[0], middle);
    pel_vec3_along(points[0], joint->def.kind == PEL_JOINT_SLIDER ? 0 : 0.5, middle, middle);
    for (int side = 0; side < 2; side++) {
        const pel_rigid *rigid = joint->bodies[side];
        if (!is_loose(rigid))
            continue;
        pel_vec3_subtract(middle, rigid->started.pivot, arm);
        for (int i = 0; i < rows->count; i++) {
            pel_vec3_cross(arm, rows->forces[i], rows->moments[side][i]);
            pel_vec3_add(rows->moments[side][i], rows->torques[i], rows->moments[side][i]);
            pel_rigid_turn_by(rigid, rows->moments[side][i], rows->turns[side][i]);
        }
    }
}

static double mobility(const pel_joint *joint, const joint_rows *rows, int i, int j)
{
    double sum = 0;
    for (int side = 0; side < 2; side++)
        if (is_loose(joint->bodies[side]))
            sum += joint->bodies[side]->shape->inverse_mass * pel_vec3_dot(rows->forces[i], rows->forces[j]) +
                   pel_vec3_dot(rows->moments[side][i], rows->turns[side][j]);
    return sum;
}

/* the first `count` loads by Cholesky's factors; rows that move nothing get none */
static void solve(double k[MOST_ROWS][MOST_ROWS], int count, const double right[MOST_ROWS], double loads[MOST_ROWS])
{
    double factor[MOST_ROWS][MOST_ROWS] = {{0}}, y[MOST_ROWS] = {0};
    for (int i = 0; i < count; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = k[i][j];
            for (int m = 0; m < j; m++)
                sum -= factor[i][m] * factor[j][m];
            if (i == j)
                factor[i][i] = sum > 1e-12 * k[i][i] ? sqrt(sum) : 0;
            else
                factor[i][j] = factor[j][j] > 0 ? sum / factor[j][j] : 0;
        }
        y[i] = right[i];
        for (int m = 0; m < i; m++)
            y[i] -= factor[i][m] * y[m];
        y[i] = factor[i][i] > 0 ? y[i] / factor[i][i] : 0;
    }
    for (int i = count - 1; i >= 0; i--) {
        loads[i] = y[i];
        for (int m = i + 1; m < count; m++)
            loads[i] -= factor[m][i] * loads[m];
        loads[i] = factor[i][i] > 0 ? loads[i] / factor[i][i] : 0;
    }
}

/* speed of the last row when the substep began */
static double start_speed(const pel_joint *joint, const joint_rows *rows)
{
    double speed = 0, spin[3];
    int last = rows->count - 1;
    for (int side = 0; side < 2; side++) {
        const pel_rigid *rigid = joint->bodies[side];
        if (!is_loose(rigid))
            continue;
        pel_rigid_turn_by(rigid, rigid->started.angular_momentum, spin);
        speed += (side == 0 ? 1 : -1) *
                 (rigid->shape->inverse_mass * pel_vec3_dot(rows->forces[last], rigid->started.momentum) +
                  pel_vec3_dot(rows->moments[side][last], spin));
    }
    return speed;
}

/* the load of the last row beside those that the others then need */
static void drive(pel_joint *joint, joint_rows *rows, double k[MOST_ROWS][MOST_ROWS], double right[MOST_ROWS])
{
    int last = rows->count - 1;
    double all = joint->drive + rows->loads[last], after = rows->position;
    joint->motor = pel_min(pel_max(all, -rows->strength), rows->strength);
    if (joint->motor != all) {
        rows->loads[last] = joint->motor - joint->drive;
        for (int i = 0; i < last; i++)
            right[i] -= k[i][last] * rows->loads[last];
        solve(k, last, right, rows->loads);
    }
    for (int i = 0; i <= last; i++)
        after += k[last][i] * rows->loads[i];
    if (after < joint->def.least || after > joint->def.most) {
        rows->errors[last] = rows->position - (after < joint->def.least ? joint->def.least : joint->def.most);
        for (int i = 0; i <= last; i++)
            right[i] = -rows->errors[i];
        solve(k, rows->count, right, rows->loads);
    }
    joint->drive += rows->loads[last];
    rows->errors[last] = k[last][last] * rows->loads[last];
}

static void find_loads(pel_joint *joint, joint_rows *rows)
{
    double k[MOST_ROWS][MOST_ROWS], right[MOST_ROWS];
    for (int i = 0; i < rows->count; i++) {
        right[i] = -rows->errors[i];
        for (int j = 0; j < rows->count; j++)
            k[i][j] = mobility(joint, rows, i, j);
    }
    solve(k, rows->count, right, rows->loads);
    if (rows->has_drive)
        drive(joint, rows, k, right);
}

/* ---- in a step ---- */

void pel_joints_begin(pel_sim *sim)
{
    for (int32_t i = 0; sim->joints != NULL && i < sim->joints->count; i++) {
        pel_joint *joint = &sim->joints->items[i];
        joint->present = joint->position;
        joint->begun = joint->present = pel_joint_position(joint);
        joint->target = joint->begun == joint->position ? joint->aim : joint->begun;
        joint->done = 0;
        memset(joint->sum, 0, sizeof joint->sum);
    }
}

void pel_joints_begin_substep(pel_sim *sim)
{
    for (int32_t i = 0; sim->joints != NULL && i < sim->joints->count; i++) {
        pel_joint *joint = &sim->joints->items[i];
        joint->start = joint->present;
        joint->drive = joint->motor = 0;
        memset(joint->pushed, 0, sizeof joint->pushed);
    }
}

static double project(pel_joint *joint, double substep)
{
    joint_rows rows = {0};
    double axes[3][3], now[3][3], push[3] = {0}, back[3], moment[3], largest = 0;
    for (int k = 0; k < 3; k++) {
        turn_vector(joint->bodies[1], joint->axes[k], now[k]);
        pel_vec3_copy(joint->axes[k], axes[k]);
        if (joint->bodies[1] != NULL)
            pel_rotate(joint->bodies[1]->started.rotation, joint->axes[k], axes[k]);
    }
    add_point_rows(joint, (const double(*)[3])now, (const double(*)[3])axes, &rows);
    add_turn_rows(joint, (const double(*)[3])now, (const double(*)[3])axes, &rows);
    add_drive_row(joint, axes[0], substep, &rows);
    find_moments(joint, &rows);
    joint->pace = rows.has_drive ? substep * start_speed(joint, &rows) : 0;
    find_loads(joint, &rows);
    for (int i = 0; i < rows.count; i++) {
        double error = pel_vec3_squared_length(rows.forces[i]) > 0 ? rows.errors[i] / joint->size : rows.errors[i];
        largest = pel_max(largest, fabs(error));
        pel_vec3_along(push, rows.loads[i], rows.forces[i], push);
        pel_vec3_along(joint->pushed, rows.loads[i], rows.forces[i], joint->pushed);
        pel_vec3_along(joint->pushed + 3, rows.loads[i], rows.torques[i], joint->pushed + 3);
    }
    for (int side = 0; side < 2; side++) {
        double sign = side == 0 ? 1 : -1;
        pel_vec3_set(moment, 0, 0, 0);
        for (int i = 0; i < rows.count && is_loose(joint->bodies[side]); i++)
            pel_vec3_along(moment, sign * rows.loads[i], rows.moments[side][i], moment);
        pel_vec3_scale(push, sign, back);
        if (is_loose(joint->bodies[side]))
            pel_rigid_shift(joint->bodies[side], back, moment, 1 / substep);
    }
    return largest;
}

double pel_joints_project(pel_sim *sim, double substep)
{
    double largest = 0;
    for (int32_t i = 0; sim->joints != NULL && i < sim->rigids->count; i++)
        pel_rigid_settle(&sim->rigids->items[i]);
    for (int32_t i = 0; sim->joints != NULL && i < sim->joints->count; i++)
        largest = pel_max(largest, project(&sim->joints->items[i], substep));
    return largest;
}

void pel_joints_tally(pel_sim *sim, double substep)
{
    double rate = 1 / (substep * substep);
    for (int32_t i = 0; sim->joints != NULL && i < sim->joints->count; i++) {
        pel_joint *joint = &sim->joints->items[i];
        joint->present = pel_joint_position(joint);
        for (int k = 0; k < 6; k++)
            joint->sum[k] += rate * joint->pushed[k] / sim->solver.substeps;
        joint->sum[6] += rate * joint->drive / sim->solver.substeps;
        /* what is left by contact does not add up to a creep */
        bool holds = fabs(joint->motor) < joint->def.strength * substep * substep && joint->motor == joint->drive;
        joint->target = holds ? joint->target + joint->def.speed * substep : joint->present;
        /* the mean speed before and after is that of the work of an impulse */
        joint->done += rate * joint->motor * 0.5 * (joint->pace + joint->present - joint->start);
    }
}

/* loads of what sleeps stay */
static bool is_asleep(const pel_sim *sim, const pel_joint *joint)
{
    int32_t other = joint->def.to_body;
    return sim->asleep != NULL && (sim->asleep[joint->def.body] || (other >= 0 && sim->asleep[other]));
}

void pel_joints_end(pel_sim *sim)
{
    for (int32_t i = 0; sim->joints != NULL && i < sim->joints->count; i++) {
        pel_joint *joint = &sim->joints->items[i];
        joint->present = pel_joint_position(joint);
        joint->speed = (joint->present - joint->begun) / sim->step.dt;
        joint->position = joint->present;
        joint->aim = joint->target;
        joint->work += joint->done;
        sim->tie_work += joint->done;
        if (is_asleep(sim, joint))
            continue;
        pel_vec3_copy(joint->sum, joint->force);
        pel_vec3_copy(joint->sum + 3, joint->torque);
        joint->load = joint->sum[6];
    }
}

bool pel_joint_is_running(const pel_joint *joint)
{
    return joint->def.strength > 0 && joint->def.speed != 0;
}

/* ---- creation ---- */

pel_joint_def pel_joint_def_default(void)
{
    pel_joint_def def = {0};
    pel_def_reset(PEL_DEF_JOINT, &def);
    def.axis[2] = 1;
    return def;
}

static bool is_rigid(const pel_sim *sim, int32_t body)
{
    return body >= 0 && body < sim->model->body_count && sim->model->bodies[body].rigid != NULL;
}

static pel_status refuse(int32_t number, const char *remedy, const char *what, const char *name, pel_error *error)
{
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "joint", number, remedy, what, name);
}

static bool is_finite(const double v[3])
{
    return isfinite(v[0] + v[1] + v[2]);
}

static pel_status check(const pel_sim *sim, const pel_joint_def *defs, int32_t number, pel_error *error)
{
    const pel_joint_def *def = &defs[number];
    const char *name = def->name != NULL && def->name[0] != '\0' ? def->name : NULL;
    if (name == NULL || strlen(name) >= PEL_NAME_SIZE)
        return refuse(number, "give each joint a short name", "a joint has no name, or a long one: '%s'",
                      name != NULL ? name : "", error);
    for (int32_t i = 0; i < number; i++)
        if (strcmp(defs[i].name, name) == 0)
            return refuse(number, "give each joint a name of its own", "two joints are called '%s'", name, error);
    if (!is_rigid(sim, def->body) || (def->to_body != -1 && !is_rigid(sim, def->to_body)))
        return refuse(number, "give the body `rigid`, or hold its vertices by an attachment",
                      "joint '%s' holds a body that is not rigid", name, error);
    if (def->body == def->to_body)
        return refuse(number, "give another body, or none for the world", "joint '%s' leads from a body to itself",
                      name, error);
    if (PEL_IS_NO_CHOICE(def->kind, PEL_JOINT_KIND_COUNT))
        return refuse(number, "use ball, hinge, slider or weld", "joint '%s' has an unknown kind", name, error);
    if (!is_finite(def->point) || !is_finite(def->axis) || !isfinite(def->speed) || !(def->strength >= 0) ||
        !isfinite(def->strength))
        return refuse(number, "give finite numbers, and a strength of at least 0",
                      "joint '%s' has a number out of range", name, error);
    bool is_driven_kind = def->kind == PEL_JOINT_HINGE || def->kind == PEL_JOINT_SLIDER;
    if (is_driven_kind && !(pel_vec3_length(def->axis) > 0))
        return refuse(number, "give a direction", "the axis of joint '%s' has no length", name, error);
    if (is_driven_kind && !(def->least <= 0 && def->most >= 0))
        return refuse(number, "let the limits include 0, the position at rest", "joint '%s' starts beyond its limits",
                      name, error);
    if (!is_driven_kind && (def->strength > 0 || isfinite(def->least) || isfinite(def->most)))
        return refuse(number, "make it a hinge or a slider", "joint '%s' has a motor or limits without an axis", name,
                      error);
    return PEL_OK;
}

static void find_axes(pel_joint *joint)
{
    double(*axes)[3] = joint->axes;
    if (!pel_joint_is_driven(joint))
        pel_vec3_set(joint->def.axis, 0, 0, 1);
    pel_vec3_copy(joint->def.axis, axes[0]);
    pel_vec3_normalize(axes[0]);
    int least = fabs(axes[0][1]) < fabs(axes[0][0]) ? 1 : 0;
    least = fabs(axes[0][2]) < fabs(axes[0][least]) ? 2 : least;
    pel_vec3_set(axes[1], least == 0, least == 1, least == 2);
    pel_vec3_cross(axes[0], axes[1], axes[2]);
    pel_vec3_normalize(axes[2]);
    pel_vec3_cross(axes[2], axes[0], axes[1]);
}

static void make(const pel_sim *sim, const pel_joint_def *def, pel_joint *joint)
{
    *joint = (pel_joint){.def = *def};
    snprintf(joint->name, sizeof joint->name, "%s", def->name);
    joint->def.name = NULL;
    find_axes(joint);
    for (int side = 0; side < 2; side++) {
        int32_t body = side == 0 ? def->body : def->to_body;
        pel_vec3_copy(def->point, joint->arms[side]);
        if (body < 0)
            continue;
        joint->bodies[side] = pel_rigid_of(sim->rigids, sim->model->bodies[body].slice_begin * PEL_WIDTH);
        pel_vec3_subtract(def->point, joint->bodies[side]->shape->pivot, joint->arms[side]);
        joint->size = pel_max(joint->size, sim->model->bodies[body].diameter);
    }
    joint->position = joint->present = joint->aim = pel_joint_position(joint);
}

pel_status pel_joints_create(pel_sim *sim, const pel_sim_def *def, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < def->joint_count; i++)
        status = check(sim, def->joints, i, error);
    if (status != PEL_OK || def->joint_count == 0)
        return status;
    sim->joints = pel_allocate(1, sizeof *sim->joints);
    if (sim->joints == NULL)
        return pel_fail_memory(error);
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(sim->joints->items, def->joint_count),
                          PEL_ROOM(sim->joints->rows, (size_t)def->joint_count * PEL_JOINT_ROWS),
                          PEL_ROOM(sim->joints->speeds, (size_t)def->joint_count * PEL_JOINT_ROWS)))
        return pel_fail_memory(error);
    sim->joints->count = def->joint_count;
    for (int32_t i = 0; i < def->joint_count; i++)
        make(sim, &def->joints[i], &sim->joints->items[i]);
    if (!sim->goes_on)
        pel_joints_start_speeds(sim);
    return PEL_OK;
}

void pel_joints_destroy(pel_sim *sim)
{
    if (sim->joints == NULL)
        return;
    PEL_FREE_ALL(sim->joints->items, sim->joints->rows, sim->joints->speeds);
    pel_free(sim->joints);
    sim->joints = NULL;
}

/* ---- readings, snapshots ---- */

int32_t pel_sim_joint_count(const pel_sim *sim)
{
    return sim != NULL && sim->joints != NULL ? sim->joints->count : 0;
}

const char *pel_sim_joint_name(const pel_sim *sim, int32_t joint)
{
    return joint >= 0 && joint < pel_sim_joint_count(sim) ? sim->joints->items[joint].name : "";
}

bool pel_sim_get_joint(const pel_sim *sim, int32_t joint, pel_joint_reading *reading)
{
    if (joint < 0 || joint >= pel_sim_joint_count(sim) || reading == NULL)
        return false;
    const pel_joint *item = &sim->joints->items[joint];
    *reading =
        (pel_joint_reading){.position = item->position, .speed = item->speed, .load = item->load, .work = item->work};
    pel_vec3_copy(item->force, reading->force);
    pel_vec3_copy(item->torque, reading->torque);
    return true;
}

void pel_joints_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    for (int32_t i = 0; sim->joints != NULL && i < sim->joints->count; i++)
        pel_transfer(at, &sim->joints->items[i].position, sizeof(pel_joint) - offsetof(pel_joint, position));
}
