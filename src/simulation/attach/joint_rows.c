/* Joints as rows of Newton's method on the six unknowns of their bodies (newton/rigid.c): each row has a load that goes
   with its error, stiffer by STIFFER than the inertia that the row moves, and starts with the load of the last step. A
   run is repeated with the loads that it ended with while joints are apart (an augmented Lagrangian). Errors are exact
   functions of the places of both bodies: products of directions that turn with them, and ways between their points. */
#include "attach/joint.h"

#include "base/assert.h"
#include "math/extremes.h"
#include "math/pose.h"
#include "stage/accessors.h"

#include <math.h>
#include <string.h>

#define STIFFER 1e4
/* of the size of the bodies, rad: from where on a limit is met, not held */
#define MET 1e-6

/* the rows of one joint, one after the other */
typedef struct joint_place {
    pel_joint *joint;
    pel_newton_row *next;
    double axes[2][3][3]; /* those of the joint, as both bodies have turned them */
    double points[2][3];
    double step; /* s */
} joint_place;

static pel_newton_row *add(joint_place *at, double error)
{
    static const double none[3] = {0};
    pel_newton_row *row = at->next++;
    for (int side = 0; side < 2; side++) {
        row->bodies[side] = at->joint->bodies[side];
        pel_vec3_copy(at->points[side], row->points[side]);
        pel_vec3_copy(none, row->directors[side]);
    }
    pel_vec3_copy(none, row->force);
    pel_vec3_copy(none, row->torque);
    row->error = error;
    return row;
}

/* Along the axes of space, or across that of a slider, whose forces act on both bodies at the point of the first. */
static void add_points(joint_place *at)
{
    static const double space[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    bool slides = at->joint->def.kind == PEL_JOINT_SLIDER;
    const double(*axes)[3] = slides ? (const double(*)[3])at->axes[1] : space;
    double apart[3];
    pel_vec3_subtract(at->points[0], at->points[1], apart);
    if (slides)
        pel_vec3_copy(at->points[0], at->points[1]);
    for (int k = slides; k < 3; k++)
        pel_vec3_copy(axes[k], add(at, pel_vec3_dot(apart, axes[k]))->force);
}

/* an axis of the first body stays across one of the second */
static void add_turns(joint_place *at)
{
    static const int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    pel_joint_kind kind = at->joint->def.kind;
    int count = kind == PEL_JOINT_BALL ? 0 : kind == PEL_JOINT_HINGE ? 2 : 3;
    for (int i = 0; i < count; i++) {
        const double *mine = at->axes[0][pairs[i][0]], *other = at->axes[1][pairs[i][1]];
        pel_newton_row *row = add(at, pel_vec3_dot(mine, other));
        pel_vec3_copy(mine, row->directors[0]);
        pel_vec3_copy(other, row->directors[1]);
    }
}

static void add_drive(joint_place *at, double goal, double least, double most)
{
    bool turns = at->joint->def.kind == PEL_JOINT_HINGE;
    pel_newton_row *row = add(at, pel_joint_position(at->joint) - goal);
    pel_vec3_copy(at->axes[1][0], turns ? row->torque : row->force);
    row->least = least;
    row->most = most;
}

static void add_drives(joint_place *at)
{
    const pel_joint_def *def = &at->joint->def;
    if (!pel_joint_is_driven(at->joint))
        return;
    if (def->strength > 0)
        add_drive(at, at->joint->target + def->speed * at->step, -def->strength, def->strength);
    if (isfinite(def->least))
        add_drive(at, def->least, -(double)HUGE_VAL, 0);
    if (isfinite(def->most))
        add_drive(at, def->most, 0, (double)HUGE_VAL);
}

/* the rows of a joint as its bodies are; returns their end */
static pel_newton_row *place(const pel_sim *sim, pel_joint *joint, pel_newton_row *rows)
{
    joint_place at = {.joint = joint, .next = rows, .step = sim->step.dt};
    for (int side = 0; side < 2; side++) {
        pel_joint_point(joint, side, at.points[side]);
        for (int k = 0; k < 3; k++)
            pel_joint_turn(joint, side, joint->axes[k], at.axes[side][k]);
    }
    add_points(&at);
    add_turns(&at);
    add_drives(&at);
    joint->rows = rows;
    joint->row_count = (int32_t)(at.next - rows);
    PEL_ASSERT(joint->row_count <= PEL_JOINT_ROWS);
    return at.next;
}

static void place_rows(void *context)
{
    pel_sim *sim = context;
    pel_newton_row *next = sim->joints->rows;
    for (int32_t i = 0; i < sim->joints->count; i++)
        next = place(sim, &sim->joints->items[i], next);
}

/* ---- loads ---- */

static bool is_drive(const pel_joint *joint, const pel_newton_row *row)
{
    return pel_joint_is_driven(joint) && (isfinite(row->least) || isfinite(row->most));
}

static bool is_motor(const pel_newton_row *row)
{
    return isfinite(row->least) && isfinite(row->most) && row->most > 0;
}

void pel_joint_couple(const pel_newton_row *row, double couple[3])
{
    pel_vec3_cross(row->directors[0], row->directors[1], couple);
    pel_vec3_add(couple, row->torque, couple);
}

/* how far the row moves by 1 N s2 or N m s2 on it */
static double mobility_of(const pel_newton_row *row)
{
    double sum = 0, arm[3], moment[3], couple[3], turn[3];
    pel_joint_couple(row, couple);
    for (int side = 0; side < 2; side++) {
        const pel_rigid *rigid = row->bodies[side];
        if (rigid == NULL)
            continue;
        pel_vec3_subtract(row->points[side], rigid->state.pivot, arm);
        pel_vec3_cross(arm, row->force, moment);
        pel_vec3_add(moment, couple, moment);
        pel_rigid_turn_by(rigid, moment, turn);
        sum += rigid->shape->inverse_mass * pel_vec3_squared_length(row->force) + pel_vec3_dot(moment, turn);
    }
    return sum;
}

/* Those of the last step: what a joint held along the rows; along the axis the motor's, and a limit's beyond it. */
static void set_load(const pel_joint *joint, pel_newton_row *row)
{
    double couple[3], along = -joint->load;
    pel_joint_couple(row, couple);
    row->load = -pel_vec3_dot(joint->force, row->force) - pel_vec3_dot(joint->torque, couple);
    if (!is_drive(joint, row))
        return;
    double motor = pel_max(-joint->def.strength, pel_min(along, joint->def.strength));
    row->load = is_motor(row) ? motor : pel_max(row->least, pel_min(along - motor, row->most));
}

void pel_joints_set_rows(pel_sim *sim, double squared_rate, pel_newton_rigids *rigids)
{
    pel_joints *joints = sim->joints;
    if (joints == NULL)
        return;
    pel_newton_row *row = joints->rows;
    for (int32_t i = 0; i < joints->count; i++) {
        for (int k = 0; k < PEL_JOINT_ROWS; k++) {
            row[k].least = -(double)HUGE_VAL;
            row[k].most = (double)HUGE_VAL;
        }
        for (pel_newton_row *end = place(sim, &joints->items[i], row); row < end; row++) {
            double mobility = mobility_of(row);
            row->stiffness = mobility > 0 ? STIFFER * squared_rate / mobility : 1;
            set_load(&joints->items[i], row);
        }
    }
    rigids->rows = joints->rows;
    rigids->row_count = (int32_t)(row - joints->rows);
    rigids->place_rows = place_rows;
    rigids->rows_context = sim;
}

double pel_joints_renew_rows(pel_sim *sim)
{
    double largest = 0;
    if (sim->joints == NULL)
        return 0;
    place_rows(sim);
    for (int32_t i = 0; i < sim->joints->count; i++) {
        const pel_joint *joint = &sim->joints->items[i];
        for (pel_newton_row *row = joint->rows; row < joint->rows + joint->row_count; row++) {
            double load = row->load + row->stiffness * row->error;
            row->load = row->present = pel_max(row->least, pel_min(load, row->most));
            double error = load == row->load ? fabs(row->error) : 0;
            largest = pel_max(largest, pel_vec3_squared_length(row->force) > 0 ? error / joint->size : error);
        }
    }
    return largest;
}

void pel_joints_take_rows(pel_sim *sim)
{
    for (int32_t i = 0; sim->joints != NULL && i < sim->joints->count; i++) {
        pel_joint *joint = &sim->joints->items[i];
        double couple[3];
        memset(joint->sum, 0, sizeof joint->sum);
        joint->motor = 0;
        for (const pel_newton_row *row = joint->rows; row < joint->rows + joint->row_count; row++) {
            pel_joint_couple(row, couple);
            pel_vec3_along(joint->sum, -row->present, row->force, joint->sum);
            pel_vec3_along(joint->sum + 3, -row->present, couple, joint->sum + 3);
            joint->sum[6] -= is_drive(joint, row) ? row->present : 0;
            joint->motor -= is_motor(row) ? row->present : 0;
        }
        joint->present = pel_joint_position(joint);
        joint->done = joint->motor * (joint->present - joint->begun);
        bool holds = fabs(joint->motor) < joint->def.strength;
        joint->target = holds ? joint->target + joint->def.speed * sim->step.dt : joint->present;
    }
}

/* a limit acts that was not reached when the step began: the speed jumps */
static bool has_met(const pel_joint *joint)
{
    double near = MET * (joint->def.kind == PEL_JOINT_SLIDER ? joint->size : 1);
    for (const pel_newton_row *row = joint->rows; row < joint->rows + joint->row_count; row++) {
        double limit = row->most > 0 ? joint->def.most : joint->def.least;
        if (is_drive(joint, row) && !is_motor(row) && row->present != 0 && fabs(joint->begun - limit) > near)
            return true;
    }
    return false;
}

bool pel_joints_met(const pel_sim *sim, int32_t body)
{
    bool any = false;
    for (int32_t i = 0; sim->joints != NULL && i < sim->joints->count; i++) {
        const pel_joint *joint = &sim->joints->items[i];
        any |= (joint->def.body == body || joint->def.to_body == body) && has_met(joint);
    }
    return any;
}

bool pel_joints_drive(const pel_sim *sim)
{
    bool any = false;
    for (int32_t i = 0; sim->joints != NULL && i < sim->joints->count; i++) {
        const pel_joint_def *def = &sim->joints->items[i].def;
        any |= def->strength > 0 || isfinite(def->least) || isfinite(def->most);
    }
    return any;
}

bool pel_joints_hold(const pel_sim *sim, int32_t body)
{
    bool any = false;
    for (int32_t i = 0; sim->joints != NULL && i < sim->joints->count; i++)
        any |= sim->joints->items[i].def.body == body || sim->joints->items[i].def.to_body == body;
    return any;
}

bool pel_joints_find_point(const pel_sim *sim, const pel_rigid *body, double point[3])
{
    for (int32_t i = 0; sim->joints != NULL && i < sim->joints->count; i++) {
        const pel_joint *joint = &sim->joints->items[i];
        if (joint->bodies[0] != body && joint->bodies[1] != body)
            continue;
        pel_vec3_copy(joint->def.point, point);
        return true;
    }
    return false;
}
