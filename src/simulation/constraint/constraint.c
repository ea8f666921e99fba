#include "constraint/constraint.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/status.h"
#include "boundary/hold.h"
#include "contact/layer.h"
#include "contact/set.h"
#include "math/extremes.h"
#include "pellicle/geometry.h"
#include "stage/surface_view.h"
#include "sweep/contact.h"
#include "tool/pose.h"

#include <math.h>
#include <string.h>

enum { ESTIMATE_SWEEPS = 20 };

/* Of the stiffness along the normal, in motion: where friction begins and ceases to hold the energy bends, the more the
   stiffer it is. What it gives way is taken over by drags, which go on from step to step. */
#define SOFT_FRICTION 0.1

/* of the thickness */
#define GAP_TOLERANCE (0.75 * PEL_SLACK_SHARE)
/* of the stiffness of bodies: a layer up to this acts by its depth alone; how much stiffer what goes with it is */
#define MOST_LAYER 10
#define ALONE 1e3

/* of the forces of a tool: how much they may differ from those of layers at their depths */
#define DOUBT_SHARE 0.1
/* of these forces: how much they may change in a part of a step, beyond which their work is not theirs times its way */
#define JUMP_SHARE 0.5

/* of the two sides of a pair of lips together: below it tools and supports decide where they are */
#define LEAST_FREEDOM 0.5

/* weights of a point inside a feature are larger */
#define INSIDE 1e-9
/* of the mean edge on the finest level, and of the longest way in the last step: pairs closer than this are constraints
   from the start */
#define NEAR_SHARE 0.2
#define NEAR_WAYS 2
/* of two pairs that say the same: smaller weights, and the cosine of their normals */
#define SAME_PLACE 1e-3
#define SAME_NORMAL (1 - 1e-6)

/* ---- one constraint ---- */

static double mobility_of(const pel_sim *sim, int32_t v)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    const pel_rigid *rigid = pel_rigid_of(sim->rigids, v);
    if (rigid != NULL && rigid->shape->has_joint && !(sim->held != NULL && sim->held[v]))
        return 1 / rigid->shape->mass;
    return sim->held != NULL ? pel_tool_mobility(sim, v) : (double)sim->model->inverse_mass[v];
}

void pel_minimise_contact_point(const pel_minimise_contact *constraint, const double *position, double point[3])
{
    pel_vec3_set(point, 0, 0, 0);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            point[k] += constraint->weights[i] * position[3 * (size_t)constraint->vertices[i] + (size_t)k];
}

/* the same at the start of the step */
static void find_start(const pel_sim *sim, const pel_minimise_contact *constraint, double point[3])
{
    pel_vec3_set(point, 0, 0, 0);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            point[k] += constraint->weights[i] * (double)sim->state->position[constraint->vertices[i]][k];
}

/* Nearest points of a feature (in the tool's frame) and the axis of a round tool: weights of the feature's vertices and
   the vector from the axis to it. A vertex and an edge are measured to the whole axis, a triangle to one end of it:
   each of these points depends smoothly on the feature. The nearest point of a triangle to the whole axis does not: it
   jumps from edge to edge if the triangle lies along the capsule. */
static double find_nearest(const pel_solid *solid, const pel_minimise_contact *constraint, double x[3][3],
                           double weights[4], double way[3])
{
    double half = solid->half_length, on_axis[4];
    const double low[3] = {0, 0, -half}, high[3] = {0, 0, half};
    double at[3] = {0, 0, constraint->end * half};
    pel_vec3_set(weights, 1, 0, 0);
    weights[3] = 0;
    if (constraint->points == 3)
        pel_closest_point_triangle(at, x[0], x[1], x[2], weights);
    else if (constraint->points == 1)
        at[2] = pel_min(pel_max(x[0][2], -half), half);
    else {
        pel_closest_segment_segment(x[0], x[1], low, high, on_axis);
        weights[0] = on_axis[0];
        weights[1] = on_axis[1];
        at[2] = half * (on_axis[3] - on_axis[2]);
    }
    pel_vec3_scale(at, -1, way);
    for (int i = 0; i < constraint->points; i++)
        pel_vec3_along(way, weights[i], x[i], way);
    return pel_vec3_length(way);
}

static void meet_round(const pel_sim *sim, const pel_minimise_contact *constraint, const double *position,
                       pel_gap_sample *meeting)
{
    const pel_tool *tool = &sim->tools->items[constraint->tool];
    const pel_solid solid = pel_tool_press_solid(sim, tool, constraint->vertices[0]);
    double x[3][3], way[3];
    for (int i = 0; i < constraint->points; i++) {
        pel_pose_to_local(&tool->pose, position + 3 * (size_t)constraint->vertices[i], x[i]);
    }
    double distance = find_nearest(&solid, constraint, x, meeting->weights, way);
    /* on the axis every way out is as good */
    if (distance > 0)
        pel_vec3_scale(way, 1 / distance, way);
    else
        pel_vec3_set(way, 1, 0, 0);
    meeting->gap = distance - solid.radius - constraint->offset;
    pel_rotate(tool->pose.rotation, way, meeting->normal);
}

void pel_minimise_contact_meet(const pel_sim *sim, const pel_minimise_contact *constraint, const double *position,
                               pel_gap_sample *meeting)
{
    double point[3];
    if (constraint->points > 0) {
        meet_round(sim, constraint, position, meeting);
        return;
    }
    memcpy(meeting->weights, constraint->weights, sizeof meeting->weights);
    pel_vec3_copy(constraint->normal, meeting->normal);
    pel_minimise_contact_point(constraint, position, point);
    meeting->gap = pel_vec3_dot(point, constraint->normal) - constraint->offset;
}

/* m/N, slope of the layer under the load */
static double slope_of(const pel_minimise_contact *constraint)
{
    return (1 / constraint->share - 1) / constraint->stiffness;
}

/* N, of the layer at a gap, below 0 where it does not act */
static double load_at(const pel_minimise_contact *constraint, double gap)
{
    return constraint->load - constraint->share * constraint->stiffness * (gap + constraint->depth);
}

/* the friction force, without limit, for the displacement since the start of the step; false without friction */
static bool find_drag(const pel_sim *sim, const pel_minimise_contact *constraint, const double *position,
                      double drag[3])
{
    if (!(constraint->friction > 0) || !(constraint->grip > 0))
        return false;
    double now[3], before[3], slip[3];
    pel_minimise_contact_point(constraint, position, now);
    find_start(sim, constraint, before);
    pel_vec3_subtract(now, before, slip);
    pel_vec3_subtract(slip, constraint->drift, slip);
    pel_vec3_along(slip, -pel_vec3_dot(slip, constraint->normal), constraint->normal, slip);
    pel_vec3_along(constraint->drag, -constraint->across, slip, drag);
    return true;
}

/* shortens a vector to a limit; returns the length that it had */
static double limit_length(double vector[3], double limit)
{
    double length = pel_vec3_length(vector);
    if (length > limit)
        pel_vec3_scale(vector, limit / length, vector);
    return length;
}

static void push(const pel_minimise_contact *constraint, const double weights[4], const double load[3], double *force)
{
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3 && weights[i] != 0; k++)
            force[3 * (size_t)constraint->vertices[i] + (size_t)k] += weights[i] * load[k];
}

static double evaluate(const pel_sim *sim, const pel_minimise_contact *constraint, const double *position,
                       double *force)
{
    pel_gap_sample meeting;
    double energy = 0, load[3], drag[3];
    pel_minimise_contact_meet(sim, constraint, position, &meeting);
    double along = load_at(constraint, meeting.gap);
    if (along > 0) {
        pel_vec3_scale(meeting.normal, along, load);
        push(constraint, meeting.weights, load, force);
        energy += along * along / (2 * constraint->share * constraint->stiffness);
    }
    if (find_drag(sim, constraint, position, drag)) {
        double limit = constraint->friction * constraint->grip, length = limit_length(drag, limit);
        push(constraint, constraint->weights, drag, force);
        energy += (length <= limit ? 0.5 * length * length : limit * (length - 0.5 * limit)) / constraint->across;
    }
    return energy;
}

/* a stick holds with all of the stiffness across the normal; a slip turns its force at most */
static void drag_stiffness(const pel_minimise_contact *constraint, const double drag[3], double across[3][3])
{
    double length = pel_vec3_length(drag), limit = constraint->friction * constraint->grip;
    bool slips = length > limit;
    double stiffness = constraint->across * (slips ? limit / length : 1);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            double projection = (a == b) - constraint->normal[a] * constraint->normal[b];
            double line = slips ? drag[a] * drag[b] / (length * length) : 0;
            across[a][b] = stiffness * (projection - line);
        }
}

/* The gap to a round tool is d - radius with the distance d of its middle from the nearest feature. To second order in
   the displacements y of the vertices, with weights w and the unit vectors t in the feature (none of a vertex),

     d = n . sum w_i y_i - d/2 sum_t (sum_i grad w_i . t (n . y_i) + w_i t . y_i / d)^2 + |across|^2 / (2 d);

   the last term would make the matrix indefinite and is omitted. An edge along a capsule counts as one at the nearest
   sphere. */
static void add_row(const pel_gap_sample *meeting, double load, double distance, const double gradients[3][3],
                    const double t[3], pel_contact_stiffness *stiffness)
{
    double root = sqrt(load * distance);
    double(*row)[3] = stiffness->rows[stiffness->row_count++];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            row[i][k] =
                root * (pel_vec3_dot(gradients[i], t) * meeting->normal[k] + meeting->weights[i] * t[k] / distance);
    pel_vec3_set(row[3], 0, 0, 0);
}

/* gradients of the weights of a triangle's corners, in its plane, in the frame of its first side */
static bool find_gradients(double x[3][3], double gradients[3][3], double t[2][3])
{
    double v[3], normal[3];
    pel_vec3_subtract(x[1], x[0], t[0]);
    pel_vec3_subtract(x[2], x[0], v);
    pel_vec3_cross(t[0], v, normal);
    double area = pel_vec3_normalize(normal);
    if (!(area > 0))
        return false;
    pel_vec3_normalize(t[0]);
    pel_vec3_cross(normal, t[0], t[1]);
    for (int i = 0; i < 3; i++) {
        double side[3];
        pel_vec3_subtract(x[(i + 2) % 3], x[(i + 1) % 3], side);
        pel_vec3_cross(normal, side, gradients[i]);
        pel_vec3_scale(gradients[i], 1 / area, gradients[i]);
    }
    return true;
}

/* the same for one side, from its start to its end */
static bool find_side_gradients(double x[3][3], int begin, int end, double gradients[3][3], double t[3])
{
    pel_vec3_subtract(x[end], x[begin], t);
    double length = pel_vec3_normalize(t);
    if (!(length > 0))
        return false;
    pel_vec3_scale(t, 1 / length, gradients[end]);
    pel_vec3_scale(t, -1 / length, gradients[begin]);
    return true;
}

static void add_turning(const pel_sim *sim, const pel_minimise_contact *constraint, const double *position,
                        const pel_gap_sample *meeting, double load, pel_contact_stiffness *stiffness)
{
    double x[3][3], gradients[3][3] = {{0}}, t[2][3];
    int inside[3], count = 0;
    for (int i = 0; i < 3; i++) {
        pel_vec3_copy(position + 3 * (size_t)constraint->vertices[i], x[i]);
        if (meeting->weights[i] > INSIDE)
            inside[count++] = i;
    }
    const pel_solid solid = pel_tool_press_solid(sim, &sim->tools->items[constraint->tool], constraint->vertices[0]);
    double distance = solid.radius + constraint->offset + meeting->gap;
    if (count < 2 || !(distance > 0) ||
        !(count == 3 ? find_gradients(x, gradients, t) : find_side_gradients(x, inside[0], inside[1], gradients, t[0])))
        return;
    for (int i = 0; i < count - 1; i++)
        add_row(meeting, load, distance, (const double(*)[3])gradients, t[i], stiffness);
}

bool pel_minimise_contact_stiffness(const pel_sim *sim, const pel_minimise_contact *constraint, const double *position,
                                    pel_contact_stiffness *stiffness)
{
    pel_gap_sample meeting;
    double drag[3];
    pel_minimise_contact_meet(sim, constraint, position, &meeting);
    double load = load_at(constraint, meeting.gap);
    bool drags = find_drag(sim, constraint, position, drag), acts = load > 0;
    if (sim->minimise->kinks != NULL)
        acts = sim->minimise->kinks[constraint - sim->minimise->constraints].acts;
    *stiffness = (pel_contact_stiffness){0};
    memcpy(stiffness->weights, meeting.weights, sizeof meeting.weights);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3 && acts; b++)
            stiffness->along[a][b] = constraint->share * constraint->stiffness * meeting.normal[a] * meeting.normal[b];
    if (drags)
        drag_stiffness(constraint, drag, stiffness->across);
    if (load > 0 && constraint->points > 0)
        add_turning(sim, constraint, position, &meeting, load, stiffness);
    return acts || drags;
}

void pel_minimise_contacts_list_kinks(pel_sim *sim, const double *position, pel_newton_kink *kinks)
{
    const pel_minimise *minimise = sim->minimise;
    for (int32_t c = 0; c < minimise->count; c++) {
        const pel_minimise_contact *constraint = &minimise->constraints[c];
        pel_newton_kink *kink = &kinks[c];
        pel_gap_sample meeting;
        pel_minimise_contact_meet(sim, constraint, position, &meeting);
        *kink = (pel_newton_kink){
            .gap = meeting.gap, .load = load_at(constraint, 0), .stiffness = constraint->share * constraint->stiffness};
        memcpy(kink->vertices, constraint->vertices, sizeof kink->vertices);
        memcpy(kink->weights, meeting.weights, sizeof kink->weights);
        pel_vec3_copy(meeting.normal, kink->normal);
        kink->acts = kink->load - kink->stiffness * kink->gap > 0;
    }
    sim->minimise->kinks = kinks;
}

double pel_minimise_contacts_evaluate(pel_sim *sim, const double *position, double *force)
{
    pel_minimise *minimise = sim->minimise;
    double energy = 0;
    minimise->kinks = NULL;
    for (int32_t c = 0; c < minimise->count; c++)
        energy += evaluate(sim, &minimise->constraints[c], position, force);
    return energy;
}

/* ---- all of them ---- */

pel_status pel_minimise_contact_add(pel_sim *sim, const pel_minimise_contact *constraint, pel_error *error)
{
    pel_minimise *minimise = sim->minimise;
    double free = 0;
    for (int i = 0; i < 4; i++) {
        int32_t v = constraint->vertices[i];
        double mobility = mobility_of(sim, v);
        double share = pel_rigid_of(sim->rigids, v) != NULL ? mobility * (double)sim->model->mass[v] : 1;
        if (mobility > 0 && minimise->inertia != NULL)
            mobility = 1 / (1 / mobility + minimise->inertia[v] / (share * minimise->stiffness));
        free += mobility * constraint->weights[i] * constraint->weights[i];
    }
    if (!(free > 0))
        return PEL_OK;
    if (!pel_reserve((void **)&minimise->constraints, &minimise->capacity, (size_t)minimise->count + 1,
                     sizeof *minimise->constraints))
        return pel_fail_memory(error);
    pel_minimise_contact *added = &minimise->constraints[minimise->count++];
    *added = *constraint;
    double own = minimise->stiffness / free;
    added->compliance = minimise->penalty >= PEL_JAM_PENALTY ? added->compliance : 0;
    added->grip = added->load;
    added->stiffness = minimise->penalty * own;
    added->share = 1;
    added->across = (minimise->inertia != NULL ? SOFT_FRICTION : 1) * minimise->penalty * own;
    pel_vec3_along(added->drag, -pel_vec3_dot(added->drag, added->normal), added->normal, added->drag);
    return PEL_OK;
}

/* ---- layers ---- */

/* the side of a vertex that the i-th weight of a constraint pushes it to */
static int side_of(const pel_minimise_contact *constraint, int i, const pel_minimise_pressed *pressed)
{
    return pel_vec3_dot(pressed->direction, constraint->normal) * constraint->weights[i] < 0;
}

/* Of the side of a constraint that is pressed less, if there are two, in the mean of its points: [0] the load on a
   point, [1] the number of pairs that press it. */
static void find_pressed(const pel_minimise *minimise, const pel_minimise_contact *constraint, double pressed[2])
{
    double loads[2] = {0, 0}, pairs[2] = {0, 0};
    for (int i = 0; i < 4; i++) {
        const pel_minimise_pressed *own = &minimise->pressed[constraint->vertices[i]];
        int side = side_of(constraint, i, own), part = constraint->weights[i] > 0;
        loads[part] += fabs(constraint->weights[i]) * own->load[side];
        pairs[part] += fabs(constraint->weights[i]) * own->pairs[side];
    }
    int part = loads[1] > 0 && (loads[0] > loads[1] || !(loads[0] > 0));
    pressed[0] = pel_max(constraint->load, loads[part]);
    pressed[1] = pel_max(1, pairs[part]);
}

static void press_vertex(const pel_minimise_contact *constraint, int i, pel_minimise_pressed *pressed)
{
    double weight = fabs(constraint->weights[i]);
    if (pressed->load[0] == 0)
        pel_vec3_scale(constraint->normal, constraint->weights[i] < 0 ? -1 : 1, pressed->direction);
    int side = side_of(constraint, i, pressed);
    pressed->load[side] += weight * constraint->load;
    pressed->pairs[side] += weight;
}

/* Where surfaces lie flat on each other a vertex is pressed by several pairs: its layer gives way by the sum of their
   loads. Each takes its share of the tangent. */
void pel_minimise_contacts_press(pel_sim *sim)
{
    pel_minimise *minimise = sim->minimise;
    memset(minimise->pressed, 0, (size_t)sim->model->vertex_count * sizeof *minimise->pressed);
    for (int32_t c = 0; c < minimise->count; c++)
        for (int i = 0; i < 4 && minimise->constraints[c].load > 0; i++)
            if (minimise->constraints[c].weights[i] != 0)
                press_vertex(&minimise->constraints[c], i, &minimise->pressed[minimise->constraints[c].vertices[i]]);
    for (int32_t c = 0; c < minimise->count; c++) {
        pel_minimise_contact *constraint = &minimise->constraints[c];
        double pressed[2];
        find_pressed(minimise, constraint, pressed);
        const pel_layer_state layer =
            pel_contact_layer_state(constraint->compliance, constraint->thickness, pressed[0]);
        double slope = layer.slope * pressed[1];
        if (slope * MOST_LAYER * constraint->stiffness > minimise->penalty)
            constraint->stiffness = pel_max(constraint->stiffness, ALONE / slope);
        constraint->depth = layer.depth;
        constraint->share = 1 / (1 + constraint->stiffness * slope);
    }
}

bool pel_minimise_contacts_jam(const pel_sim *sim)
{
    for (int32_t c = 0; c < sim->minimise->count; c++)
        if (sim->minimise->constraints[c].depth > sim->minimise->constraints[c].tolerance)
            return true;
    return false;
}

/* a load may turn against its last change so often */
enum { SWINGS = 1 };

bool pel_minimise_contacts_grip(pel_sim *sim, const double *position)
{
    pel_minimise *minimise = sim->minimise;
    bool any = false;
    for (int32_t c = 0; c < minimise->count; c++) {
        pel_minimise_contact *constraint = &minimise->constraints[c];
        pel_gap_sample meeting;
        if (!(constraint->friction > 0))
            continue;
        pel_minimise_contact_meet(sim, constraint, position, &meeting);
        double change = pel_max(0, load_at(constraint, meeting.gap)) - constraint->grip;
        /* loads that swing with the limits of friction would swing on */
        bool turns = change * constraint->regrip < 0;
        constraint->swings += turns;
        any |= change != 0;
        constraint->grip += (turns && constraint->swings > SWINGS ? 0.5 : 1) * change;
        constraint->regrip = change;
    }
    return any;
}

/* N, how much the friction force differs from Coulomb's limit under a new load */
static double misfit_of(const pel_sim *sim, const pel_minimise_contact *constraint, double load)
{
    pel_minimise_contact loaded = *constraint;
    double drag[3];
    loaded.grip = pel_max(load, constraint->grip);
    if (!find_drag(sim, &loaded, sim->minimise->position, drag))
        return 0;
    double length = pel_vec3_length(drag);
    return fabs(pel_min(length, constraint->friction * load) -
                pel_min(length, constraint->friction * constraint->grip));
}

static void update(const pel_sim *sim, pel_minimise_contact *constraint, pel_contact_change *sum)
{
    const double *position = sim->minimise->position;
    pel_gap_sample meeting;
    double drag[3], change = 0;
    pel_minimise_contact_meet(sim, constraint, position, &meeting);
    double load = pel_max(0, load_at(constraint, meeting.gap));
    sum->misfit += misfit_of(sim, constraint, load);
    sum->limit += constraint->friction * load;
    if (find_drag(sim, constraint, position, drag)) {
        limit_length(drag, constraint->friction * constraint->grip);
        change = pel_vec3_distance(drag, constraint->drag);
        pel_vec3_copy(drag, constraint->drag);
    } else {
        pel_vec3_set(constraint->drag, 0, 0, 0);
    }
    double gap = fabs(load - constraint->load) / (constraint->share * constraint->stiffness);
    constraint->load = constraint->grip = load;
    sum->gap = pel_max(sum->gap, gap / constraint->tolerance);
    sum->slip = pel_max(sum->slip, change / (constraint->across * constraint->tolerance));
}

pel_contact_change pel_minimise_contacts_update(pel_sim *sim)
{
    pel_minimise *minimise = sim->minimise;
    pel_contact_change sum = {0};
    for (int32_t c = 0; c < minimise->count; c++)
        update(sim, &minimise->constraints[c], &sum);
    return sum;
}

/* Unbalanced force of a constraint, N: without inertia the force that best cancels those on its vertices. With inertia
   the force under which its point, moved by the forces against springs of `stiffness`, keeps the gap and follows the
   tool. False if it has none. */
static bool find_left(const pel_sim *sim, const pel_minimise_contact *constraint, const pel_gap_sample *meeting,
                      const double *stiffness, const double *force, double left[3])
{
    double square = 0, slip[3], slope = stiffness != NULL ? slope_of(constraint) : 0;
    pel_vec3_set(left, 0, 0, 0);
    for (int i = 0; i < 4; i++) {
        int32_t v = constraint->vertices[i];
        double weight = mobility_of(sim, v) > 0 ? meeting->weights[i] : 0;
        double compliance = weight == 0 || stiffness == NULL ? 1 : 1 / stiffness[v];
        square += weight * weight * compliance;
        for (int k = 0; k < 3; k++)
            left[k] += weight * compliance * force[3 * (size_t)v + (size_t)k];
    }
    if (stiffness != NULL) {
        double along = pel_vec3_dot(constraint->drift, meeting->normal);
        pel_vec3_along(constraint->drift, -along - meeting->gap, meeting->normal, slip);
        pel_vec3_subtract(left, slip, left);
    }
    if (!(square > 0))
        return false;
    /* the layer gives way by the load */
    double along = pel_vec3_dot(left, meeting->normal),
           given = (along + (stiffness != NULL ? constraint->depth : 0)) / (1 + slope / square);
    pel_vec3_along(left, given - along, meeting->normal, left);
    pel_vec3_scale(left, -1 / square, left);
    return true;
}

static void balance(const pel_sim *sim, pel_minimise_contact *constraint, double reach, const double *stiffness,
                    double *force)
{
    pel_gap_sample meeting;
    pel_minimise_contact_meet(sim, constraint, sim->minimise->position, &meeting);
    double left[3], change[3], drag[3];
    if ((stiffness == NULL && meeting.gap > reach) || !find_left(sim, constraint, &meeting, stiffness, force, left))
        return;
    double along = pel_vec3_dot(left, meeting.normal), load = pel_max(0, constraint->load + along);
    pel_vec3_along(left, -along, meeting.normal, drag);
    pel_vec3_add(constraint->drag, drag, drag);
    limit_length(drag, constraint->friction * load);
    pel_vec3_subtract(drag, constraint->drag, change);
    pel_vec3_along(change, load - constraint->load, meeting.normal, change);
    push(constraint, meeting.weights, change, force);
    constraint->load = constraint->grip = load;
    pel_vec3_copy(drag, constraint->drag);
}

void pel_minimise_contacts_estimate(pel_sim *sim, double *force, double reach, const double *stiffness)
{
    pel_minimise *minimise = sim->minimise;
    for (int sweep = 0; sweep < ESTIMATE_SWEEPS; sweep++) {
        for (int32_t c = 0; c < minimise->count; c++)
            balance(sim, &minimise->constraints[c], reach + minimise->constraints[c].tolerance, stiffness, force);
        pel_minimise_contacts_press(sim);
    }
}

/* ---- from step to step ---- */

static bool is_before(const pel_minimise_load *a, const pel_minimise_load *b)
{
    for (int i = 0; i < PEL_MINIMISE_PAIR; i++)
        if (a->pair[i] != b->pair[i])
            return a->pair[i] < b->pair[i];
    return false;
}

PEL_DEFINE_SORT(sort_loads, pel_minimise_load, is_before)

void pel_minimise_contacts_keep(pel_sim *sim)
{
    pel_minimise *minimise = sim->minimise;
    int32_t room = PEL_KEPT_PAIRS * sim->model->vertex_count;
    minimise->kept_count = 0;
    for (int32_t c = 0; c < minimise->count && minimise->kept_count < room; c++) {
        const pel_minimise_contact *constraint = &minimise->constraints[c];
        if (!(constraint->load > 0))
            continue;
        pel_minimise_load *kept = &minimise->kept[minimise->kept_count++];
        memcpy(kept->pair, constraint->pair, sizeof kept->pair);
        kept->load = constraint->load;
        pel_vec3_copy(constraint->drag, kept->drag);
    }
    sort_loads(minimise->kept, (size_t)minimise->kept_count);
}

/* null = nothing was kept */
static const pel_minimise_load *find_kept(const pel_minimise *minimise, const pel_minimise_contact *constraint)
{
    pel_minimise_load wanted;
    memcpy(wanted.pair, constraint->pair, sizeof wanted.pair);
    int32_t low = 0, high = minimise->kept_count;
    while (low < high) {
        int32_t middle = (low + high) / 2;
        if (is_before(&minimise->kept[middle], &wanted))
            low = middle + 1;
        else
            high = middle;
    }
    bool is_found = low < minimise->kept_count && !is_before(&wanted, &minimise->kept[low]);
    return is_found ? &minimise->kept[low] : NULL;
}

double pel_minimise_contacts_sum_kept(const pel_sim *sim)
{
    const pel_minimise *minimise = sim->minimise;
    double sum = 0;
    for (int32_t c = 0; c < minimise->count; c++) {
        const pel_minimise_load *kept = find_kept(minimise, &minimise->constraints[c]);
        sum += kept != NULL ? kept->load : 0;
    }
    return sum;
}

double pel_minimise_contacts_sum(const pel_sim *sim)
{
    double sum = 0;
    for (int32_t c = 0; c < sim->minimise->count; c++)
        sum += sim->minimise->constraints[c].load;
    return sum;
}

void pel_minimise_contacts_take_kept(pel_sim *sim)
{
    static const pel_minimise_load none = {.load = 0};
    const pel_minimise *minimise = sim->minimise;
    for (int32_t c = 0; c < minimise->count; c++) {
        pel_minimise_contact *constraint = &minimise->constraints[c];
        const pel_minimise_load *found = find_kept(minimise, constraint), *kept = found != NULL ? found : &none;
        constraint->load = constraint->grip = kept->load;
        pel_vec3_along(kept->drag, -pel_vec3_dot(kept->drag, constraint->normal), constraint->normal, constraint->drag);
    }
    pel_minimise_contacts_press(sim);
}

double pel_minimise_contacts_force(const pel_sim *sim)
{
    const pel_minimise *minimise = sim->minimise;
    double square = 0;
    for (int32_t c = 0; c < minimise->count; c++) {
        const pel_minimise_contact *constraint = &minimise->constraints[c];
        double share = 0;
        for (int i = 0; i < 4; i++)
            share += constraint->weights[i] * constraint->weights[i];
        square += share * constraint->load * constraint->load;
    }
    return sqrt(square);
}

/* ---- surfaces ---- */

/* m, the longest way of a vertex in the last step */
static double last_way(const pel_sim *sim)
{
    const pel_state *state = sim->state;
    double square = 0;
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        double way[3];
        for (int k = 0; k < 3; k++)
            way[k] = (double)(state->position[v][k] - state->position_before[v][k]);
        square = pel_max(square, pel_vec3_squared_length(way));
    }
    return sqrt(square);
}

/* In proportion to the finest edges that there may be: with coarse ones every pair of a fine surface would be near. In
   time only what moves as before: layers at rest have no pairs with those beyond the next one. */
double pel_minimise_contacts_near(const pel_sim *sim)
{
    int32_t levels = 0;
    for (int32_t b = 0; b < sim->given->body_count; b++) {
        const pel_body *body = &sim->given->bodies[b];
        if (body->detail != NULL && body->detail->def.levels > levels)
            levels = body->detail->def.levels;
    }
    double most = NEAR_SHARE * ldexp(sim->minimise->mean_edge, -levels);
    return pel_sim_has_velocity(sim) && sim->state->older_is_known ? pel_min(most, NEAR_WAYS * last_way(sim)) : most;
}

static void constraint_of(const pel_sim *sim, int32_t number, pel_minimise_contact *constraint)
{
    const pel_contact *contact = &sim->contacts->list.contacts[number];
    const pel_contact_key *key = &sim->contacts->keys[number];
    double thickness = pel_contact_pair_thickness(sim->contacts, key->points);
    *constraint = (pel_minimise_contact){
        .offset = (double)contact->separation + PEL_SLACK_SHARE * thickness,
        .tolerance = GAP_TOLERANCE * thickness,
        .compliance = (double)contact->compliance,
        .thickness = thickness,
        .load = key->load,
        .friction = (double)contact->friction,
        .tool = key->obstacle,
        .number = number,
        .pair = {key->edge_edge, key->obstacle, key->points[0], key->points[1], key->points[2], key->points[3]},
    };
    for (int i = 0; i < 4; i++) {
        constraint->vertices[i] = contact->vertices[i];
        constraint->weights[i] = (double)contact->weights[i];
    }
    for (int k = 0; k < 3; k++) {
        constraint->normal[k] = (double)contact->normal[k];
        constraint->drift[k] = (double)contact->drift[k];
        constraint->drag[k] = key->drag[k];
    }
}

/* share of a direction along which a vertex can move: 0 = tools and supports hold it there */
static double freedom(const pel_sim *sim, int32_t v, const double normal[3])
{
    const pel_holds *holds = sim->holds;
    double free[3];
    int32_t low = 0, high = holds != NULL ? holds->held_count : 0;
    if (!(mobility_of(sim, v) > 0))
        return 0;
    while (low < high) {
        int32_t middle = (low + high) / 2;
        low = holds->vertices[middle] < v ? middle + 1 : low;
        high = holds->vertices[middle] < v ? high : middle;
    }
    bool is_held = holds != NULL && low < holds->held_count && holds->vertices[low] == v;
    pel_vec3_copy(normal, free);
    for (int k = 0; is_held && k < holds->held[low].count; k++)
        pel_vec3_along(free, -pel_vec3_dot(free, holds->axes[low][k]), holds->axes[low][k], free);
    return pel_vec3_length(free);
}

/* lips that are held as they are cannot part: the guard minds them alone */
static bool are_held_kin(const pel_sim *sim, const pel_minimise_contact *constraint)
{
    double sum = 0;
    if (!(pel_contact_pair_share(sim->contacts, sim->contacts->keys[constraint->number].points) < 1))
        return false;
    for (int i = 0; i < 4; i++)
        if (constraint->weights[i] != 0)
            sum += fabs(constraint->weights[i]) * freedom(sim, constraint->vertices[i], constraint->normal);
    return sum < LEAST_FREEDOM;
}

/* What a constraint acts on: the vertices of each side, ascending, those of the second one as their complements; the
   side with the lowest comes first. */
typedef struct support {
    int32_t vertices[4]; /* INT32_MAX = no more */
    double sign;         /* of its normal, from the second to the first of these sides */
} support;

static int gather_side(const pel_minimise_contact *constraint, int begin, int end, int32_t side[3])
{
    int count = 0;
    for (int i = begin; i < end; i++) {
        if (!(fabs(constraint->weights[i]) > SAME_PLACE))
            continue;
        int at = count++;
        for (; at > 0 && side[at - 1] > constraint->vertices[i]; at--)
            side[at] = side[at - 1];
        side[at] = constraint->vertices[i];
    }
    return count;
}

static support support_of(const pel_minimise_contact *constraint)
{
    int32_t sides[2][3] = {{0}};
    const int middle = constraint->pair[0] ? 2 : 1;
    const int counts[2] = {gather_side(constraint, 0, middle, sides[0]), gather_side(constraint, middle, 4, sides[1])};
    const int first = counts[0] > 0 && (counts[1] == 0 || sides[0][0] < sides[1][0]) ? 0 : 1;
    support found = {{INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX}, first == 0 ? 1 : -1};
    for (int i = 0; i < counts[first]; i++)
        found.vertices[i] = sides[first][i];
    for (int i = 0; i < counts[1 - first]; i++)
        found.vertices[counts[first] + i] = ~sides[1 - first][i];
    return found;
}

/* An earlier constraint between the same points, along the same line: a vertex above another one is above all triangles
   around it, and so are their edges. Null = there is none. */
static pel_minimise_contact *find_same(const pel_sim *sim, const pel_minimise_contact *constraint, const support *own,
                                       double *sign)
{
    const pel_minimise *minimise = sim->minimise;
    int32_t at = minimise->constraint_of_vertex[own->vertices[0]];
    for (; at > 0; at = minimise->constraints[at - 1].before) {
        pel_minimise_contact *other = &minimise->constraints[at - 1];
        const support its = support_of(other);
        *sign = own->sign * its.sign;
        if (memcmp(its.vertices, own->vertices, sizeof its.vertices) == 0 &&
            *sign * pel_vec3_dot(other->normal, constraint->normal) > SAME_NORMAL)
            return other;
    }
    return NULL;
}

/* loads of a pair that another one stands for */
static void take_over(pel_sim *sim, const pel_minimise_contact *constraint, double sign, pel_minimise_contact *same)
{
    pel_contact_key *key = &sim->contacts->keys[constraint->number];
    same->load += constraint->load;
    same->grip = same->load;
    pel_vec3_along(same->drag, sign, constraint->drag, same->drag);
    key->load = 0;
    pel_vec3_set(key->drag, 0, 0, 0);
}

static pel_status add_surface(pel_sim *sim, const pel_minimise_contact *constraint, pel_error *error)
{
    pel_minimise *minimise = sim->minimise;
    const support own = support_of(constraint);
    double sign;
    /* obstacles have no vertices here */
    const bool is_shared = constraint->tool < 0;
    pel_minimise_contact *same = is_shared ? find_same(sim, constraint, &own, &sign) : NULL;
    if (same != NULL) {
        take_over(sim, constraint, sign, same);
        return PEL_OK;
    }
    const int32_t count = minimise->count;
    pel_status status = pel_minimise_contact_add(sim, constraint, error);
    if (is_shared && minimise->count > count) {
        int32_t *last = &minimise->constraint_of_vertex[own.vertices[0]];
        minimise->constraints[count].before = *last;
        *last = count + 1;
    }
    return status;
}

pel_status pel_minimise_contacts_add_surfaces(pel_sim *sim, pel_error *error)
{
    pel_minimise *minimise = sim->minimise;
    pel_status status = PEL_OK;
    minimise->count = minimise->tool_count;
    for (int32_t c = 0; status == PEL_OK && c < sim->contacts->list.count; c++) {
        pel_minimise_contact constraint;
        if (sim->contacts->keys[c].is_off)
            continue;
        constraint_of(sim, c, &constraint);
        if (!are_held_kin(sim, &constraint))
            status = add_surface(sim, &constraint, error);
    }
    for (int32_t c = minimise->tool_count; c < minimise->count; c++)
        for (int i = 0; i < 4; i++)
            minimise->constraint_of_vertex[minimise->constraints[c].vertices[i]] = 0;
    return status;
}

/* the nearest points of a pair where it stands now: normal from the second side to the first; false where they meet */
static bool find_normal(const pel_sim *sim, const pel_contact_key *key, const double normal[3], double found[3])
{
    double x[4][3], weights[4] = {1, 0, 0, 0};
    for (int i = 0; i < 4; i++) {
        int32_t p = key->points[i];
        pel_vec3_copy(p < sim->model->vertex_count ? sim->minimise->position + 3 * (size_t)p : sim->contacts->end[p],
                      x[i]);
    }
    if (key->edge_edge)
        pel_closest_segment_segment(x[0], x[1], x[2], x[3], weights);
    else
        pel_closest_point_triangle(x[0], x[1], x[2], x[3], weights + 1);
    pel_vec3_set(found, 0, 0, 0);
    for (int i = 0; i < 4; i++)
        pel_vec3_along(found, (i < (key->edge_edge ? 2 : 1) ? 1 : -1) * weights[i], x[i], found);
    if (pel_vec3_dot(found, normal) < 0)
        pel_vec3_scale(found, -1, found);
    return pel_vec3_normalize(found) > 0;
}

double pel_minimise_contacts_turned(const pel_sim *sim)
{
    const pel_minimise *minimise = sim->minimise;
    double square = 0, all = 0;
    for (int32_t c = minimise->tool_count; c < minimise->count; c++) {
        const pel_minimise_contact *constraint = &minimise->constraints[c];
        double normal[3];
        if (!(constraint->load > 0))
            continue;
        all += constraint->load * constraint->load;
        if (!find_normal(sim, &sim->contacts->keys[constraint->number], constraint->normal, normal))
            continue;
        pel_vec3_subtract(normal, constraint->normal, normal);
        square += constraint->load * constraint->load * pel_vec3_squared_length(normal);
    }
    return all > 0 ? sqrt(square / all) : 0;
}

void pel_minimise_contacts_keep_loads(pel_sim *sim)
{
    const pel_minimise *minimise = sim->minimise;
    for (int32_t c = minimise->tool_count; c < minimise->count; c++) {
        const pel_minimise_contact *constraint = &minimise->constraints[c];
        pel_contact_key *key = &sim->contacts->keys[constraint->number];
        key->load = constraint->load;
        pel_vec3_copy(constraint->drag, key->drag);
    }
}

/* N, how much the load of a layer that gives way differs from that of its depth */
static double layer_misfit(const pel_sim *sim, const pel_minimise_contact *constraint)
{
    pel_gap_sample meeting;
    if (!(constraint->depth > constraint->tolerance))
        return 0;
    pel_minimise_contact_meet(sim, constraint, sim->minimise->position, &meeting);
    double pressed[2];
    find_pressed(sim->minimise, constraint, pressed);
    return constraint->load / pressed[0] *
           fabs(pressed[0] - pel_contact_layer_load(constraint->compliance, constraint->thickness, -meeting.gap));
}

/* N, by which a layer that gives way is loaded or relieved at once: on the way of a step the law is far from straight
 */
static double layer_jump(const pel_minimise *minimise, const pel_minimise_contact *constraint)
{
    if (!(constraint->depth > constraint->tolerance))
        return 0;
    const pel_minimise_load *kept = find_kept(minimise, constraint);
    return fabs(constraint->load - (kept != NULL ? kept->load : 0));
}

void pel_minimise_contacts_doubt(pel_sim *sim, bool all)
{
    const pel_minimise *minimise = sim->minimise;
    for (int32_t t = 0; t < sim->tools->count; t++) {
        pel_tool *tool = &sim->tools->items[t];
        double load = 0, misfit = 0, jump = 0;
        for (int32_t c = 0; c < minimise->count; c++) {
            const pel_minimise_contact *constraint = &minimise->constraints[c];
            if (constraint->tool != t || !(constraint->load > 0))
                continue;
            load += constraint->load;
            misfit += layer_misfit(sim, constraint);
            jump += layer_jump(minimise, constraint);
        }
        bool is_unknown = misfit > DOUBT_SHARE * load || jump > JUMP_SHARE * load;
        tool->is_doubtful |= is_unknown || (all && (load > 0 || tool->held_count > 0));
    }
}

void pel_minimise_contacts_mark(const pel_sim *sim)
{
    const pel_minimise *minimise = sim->minimise;
    for (int32_t c = minimise->tool_count; c < minimise->count; c++)
        for (int i = 0; i < 4 && minimise->constraints[c].load > 0; i++)
            if (minimise->constraints[c].weights[i] != 0)
                sim->state->contact[minimise->constraints[c].vertices[i]] = 1;
}
