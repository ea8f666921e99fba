/* A blade holds the vertex at the end of its cut, as a grasp does, but no harder than the material allows. The force of
   the vertex on the blade is known after each step. Where it reaches the limit R the blade drags the vertex: this is
   free, and R acts on it along the way of the blade. So the force is R for any step and mass, as long as the blade
   gains on the vertex. A vertex that overtakes the blade by more than it swings (`slack`), or that the blade leaves, is
   held again. An edge that opens passes R on to the vertex at its end. Along its edge a blade holds nothing, and it
   does not pull a vertex back.

   To hold the vertex at all times, and to move its place on the blade by force and stiffness, does not work in short
   steps: the force of a place that is given jumps with its velocity, by several R. Under `static` it is done: there a
   free vertex may have no balance under R, as in a sheet that crumples before the blade. The place moves by s along the
   force, back to where

       F + K (d - s) = R

   in the next step, with the way d of the blade against the force, and the stiffness K of the sheet around a vertex. A
   K that is too large keeps F below R by some K d at first, one that is too small lets it fall behind. */
#include "blade/hold.h"

#include "boundary/loads.h"
#include "math/extremes.h"
#include "pellicle/geometry.h"
#include "stage/layer.h"
#include "tool/grip.h"
#include "tool/reading.h"

#include <string.h>

/* of the mean edge: a blade farther from its vertex than this has left it */
#define FAR_OFF 2.5
/* share of the blades of scissors that are open: a segment without length has no way */
#define LEAST_CLOSED 1e-3
/* stiffness of a sheet at the end of a cut, over Young's modulus times thickness; at least half of what it is */
#define TIP_SHARE 0.6
/* twice the square of the rate of the first stage of a step, (2 + sqrt 2) / dt: forces of a place that moves jump with
   its second difference, so with less its swings would grow */
#define INERTIA 24
/* of the way by which the limit moves a vertex in balance */
#define SWING 2.0
/* of the limit */
#define LEAST_PULL 0.01

static const pel_tool_def *def_of(const pel_sim *sim, const pel_tool *tool)
{
    return &sim->def.tools[tool - sim->tools->items];
}

bool pel_blade_resists(const pel_sim *sim, const pel_tool *tool)
{
    return pel_blade_is_hook(sim, tool) || def_of(sim, tool)->sharpness > 0;
}

bool pel_blade_is_hook(const pel_sim *sim, const pel_tool *tool)
{
    return def_of(sim, tool)->shape == PEL_TOOL_HOOK;
}

static int32_t vertex_of(const pel_sim *sim, const pel_blade_tip *tip)
{
    return sim->model->bodies[tip->body].model_index[tip->vertex];
}

static bool drags(const pel_sim *sim, const pel_blade_tip *tip)
{
    return tip->slack > 0 && sim->loads->dragged != NULL && pel_tool_mobility(sim, vertex_of(sim, tip)) > 0;
}

/* ---- the step ---- */

void pel_blades_begin(pel_sim *sim)
{
    if (sim->tools->blade_before == NULL)
        return;
    memcpy(sim->tools->blade_before, sim->state->position,
           (size_t)sim->model->vertex_count * sizeof *sim->tools->blade_before);
    for (int32_t i = 0; i < sim->tools->count; i++)
        if (sim->tools->items[i].blade != NULL) {
            sim->tools->items[i].blade->pose_before = sim->tools->items[i].pose;
            sim->tools->items[i].blade->closed_before = sim->tools->items[i].blade->closed;
        }
    if (sim->loads->dragged == NULL)
        return;
    memset(sim->loads->dragged, 0, (size_t)sim->model->vertex_count * sizeof *sim->loads->dragged);
    for (int32_t i = 0; i < sim->tools->count; i++) {
        const pel_blade *blade = sim->tools->items[i].blade;
        for (int32_t k = 0; blade != NULL && k < blade->tip_count; k++)
            for (int c = 0; drags(sim, &blade->tips[k]) && c < 3; c++)
                sim->loads->dragged[vertex_of(sim, &blade->tips[k])][c] -= (pel_real)blade->tips[k].pull[c];
    }
}

void pel_blades_read(pel_sim *sim)
{
    for (int32_t i = 0; sim->loads->dragged != NULL && i < sim->tools->count; i++) {
        pel_tool *tool = &sim->tools->items[i];
        for (int32_t k = 0; tool->blade != NULL && k < tool->blade->tip_count; k++) {
            const pel_blade_tip *tip = &tool->blade->tips[k];
            double point[3];
            if (!drags(sim, tip))
                continue;
            pel_tool_mean_point(sim, tool, vertex_of(sim, tip), point);
            pel_tool_add_reaction(tool, point, tip->pull);
        }
    }
}

static bool is_scissors(const pel_tool *tool)
{
    return tool->solid.shape == PEL_TOOL_SCISSORS;
}

bool pel_blade_close(const pel_sim *sim, pel_tool *tool)
{
    pel_blade *blade = tool->blade;
    if (!is_scissors(tool))
        return true;
    blade->closed = pel_curve_value(blade->closing, blade->closing_count, pel_sim_time(sim));
    tool->solid.closed = blade->closed;
    return blade->closed > blade->closed_before;
}

void pel_blade_edge_at(const pel_tool *tool, const pel_pose *pose, double at, double edge[2][3])
{
    const pel_blade *blade = tool->blade;
    double closed = pel_max(LEAST_CLOSED, blade->closed_before + at * (blade->closed - blade->closed_before));
    for (int end = 0; end < 2; end++) {
        double x[3];
        pel_vec3_scale(tool->solid.edge[end], closed, x);
        pel_pose_to_world(pose, x, edge[end]);
    }
}

/* ---- held vertices ---- */

static int32_t find_held(const pel_tool *tool, int32_t v)
{
    for (int32_t i = 0; i < tool->held_count; i++)
        if (tool->held[i] == v)
            return i;
    return -1;
}

static void drop(pel_sim *sim, pel_tool *tool, int32_t i)
{
    int32_t v = tool->held[i];
    pel_tool_let_go(sim, tool, i);
    sim->state->position[v][3] = sim->model->inverse_mass[v];
    sim->state->older_is_known = false;
}

void pel_blade_take(pel_sim *sim, pel_tool *tool, int32_t body, int32_t vertex)
{
    int32_t v = sim->model->bodies[body].model_index[vertex];
    double x[3];
    if (pel_tool_mobility(sim, v) <= 0)
        return;
    sim->held[v] = 1;
    sim->state->position[v][3] = 0;
    sim->state->older_is_known = false;
    pel_vertex_position(sim->state->position, v, x);
    pel_pose_to_local(&tool->pose, x, tool->anchors[tool->held_count]);
    tool->held[tool->held_count++] = v;
    pel_vec3_set(sim->tools->grip_forces[v], 0, 0, 0);
    sim->tools->held_is_listed = false;
}

void pel_blade_let_go(pel_sim *sim, pel_tool *tool, int32_t body, int32_t vertex)
{
    int32_t i = find_held(tool, sim->model->bodies[body].model_index[vertex]);
    if (i >= 0)
        drop(sim, tool, i);
}

static bool is_tip(const pel_sim *sim, const pel_tool *tool, int32_t v)
{
    for (int32_t i = 0; i < tool->blade->tip_count; i++) {
        const pel_blade_tip *tip = &tool->blade->tips[i];
        if (!tip->is_pressing && vertex_of(sim, tip) == v)
            return true;
    }
    return false;
}

double pel_blade_pressing(const pel_sim *sim, const pel_tool *tool)
{
    double sum[3] = {0};
    for (int32_t i = 0; i < tool->held_count; i++)
        if (!is_tip(sim, tool, tool->held[i]))
            pel_vec3_add(sum, sim->tools->grip_forces[tool->held[i]], sum);
    return pel_vec3_length(sum);
}

void pel_blade_pierce(pel_sim *sim, pel_tool *tool)
{
    for (int32_t i = tool->held_count - 1; i >= 0; i--)
        if (!is_tip(sim, tool, tool->held[i]))
            drop(sim, tool, i);
}

/* ---- dragging ---- */

/* m, about the mean edge at rest */
static double edge_of(const pel_sim *sim, int32_t body)
{
    const pel_body *own = &sim->model->bodies[body];
    return sqrt(own->rest_area / own->mesh->vertex_count);
}

/* N/m, of the sheet around a vertex */
static double stiffness_of(const pel_sim *sim, int32_t body)
{
    return TIP_SHARE * sim->tools->strengths[body] / edge_of(sim, body);
}

typedef struct hold {
    pel_sim *sim;
    pel_tool *tool;
    pel_blade_tip *tip;
    int32_t i, v;  /* among the held ones, and of the model */
    double way[3]; /* m, of the blade in the step, across its edge */
} hold;

/* N/m, of a vertex along the edge, with its inertia in a step of second order */
static double resistance_of(const hold *h)
{
    double dt = h->sim->step.dt, mass = pel_sim_has_velocity(h->sim) ? (double)h->sim->model->mass[h->v] : 0;
    return stiffness_of(h->sim, h->tip->body) + INERTIA * mass / (dt * dt);
}

/* the point of the edge nearest to x, and its way in the step */
static double find_point(const pel_tool *tool, const double x[3], double way[3])
{
    double now[2][3], before[2][3], weights[2], nearest[3];
    pel_blade_edge_at(tool, &tool->pose, 1, now);
    pel_blade_edge_at(tool, &tool->blade->pose_before, 0, before);
    double distance = sqrt(pel_closest_point_segment(x, now[0], now[1], weights));
    pel_vec3_set(way, 0, 0, 0);
    for (int end = 0; end < 2; end++) {
        pel_vec3_subtract(now[end], before[end], nearest);
        pel_vec3_along(way, weights[end], nearest, way);
    }
    return distance;
}

static void take_out(const double axis[3], double x[3], double along[3])
{
    pel_vec3_scale(axis, pel_vec3_dot(axis, x), along);
    pel_vec3_subtract(x, along, x);
}

/* unit */
static void axis_of(const hold *h, double axis[3])
{
    double edge[2][3];
    pel_blade_edge_at(h->tool, &h->tool->pose, 1, edge);
    pel_vec3_subtract(edge[1], edge[0], axis);
    pel_vec3_normalize(axis);
}

static void read_way(hold *h)
{
    double axis[3], x[3], along[3];
    pel_vertex_position(h->sim->state->position, h->v, x);
    find_point(h->tool, x, h->way);
    axis_of(h, axis);
    take_out(axis, h->way, along);
}

/* the place of the vertex on the blade moves, in the world's frame */
static void shift(const hold *h, double factor, const double way[3])
{
    double local[3];
    pel_rotate_back(h->tool->pose.rotation, way, local);
    pel_vec3_along(h->tool->anchors[h->i], factor, local, h->tool->anchors[h->i]);
}

static void slide(const hold *h, double limit)
{
    double stiffness = stiffness_of(h->sim, h->tip->body), force = pel_vec3_length(h->tip->pull);
    double ahead = force > 0 ? pel_max(0, -pel_vec3_dot(h->way, h->tip->pull) / force) : 0;
    double way = force >= limit ? ahead + (force - limit) / stiffness : pel_max(0, ahead - (limit - force) / stiffness);
    shift(h, force > 0 ? way / force : 0, h->tip->pull);
}

/* the force of a vertex on a blade that goes on: towards a point an edge ahead of the blade, across the edge of it */
static void aim(const hold *h, double limit)
{
    double edge[2][3], x[3], weights[2], aim[3], axis[3], along[3];
    pel_vertex_position(h->sim->state->position, h->v, x);
    pel_blade_edge_at(h->tool, &h->tool->pose, 1, edge);
    pel_closest_point_segment(x, edge[0], edge[1], weights);
    pel_vec3_scale(h->tip->pull, -1, aim);
    if (pel_vec3_length(h->way) > 0)
        pel_vec3_copy(h->way, aim);
    pel_vec3_normalize(aim);
    pel_vec3_scale(aim, edge_of(h->sim, h->tip->body), aim);
    for (int end = 0; end < 2; end++)
        pel_vec3_along(aim, weights[end], edge[end], aim);
    pel_vec3_subtract(aim, x, aim);
    axis_of(h, axis);
    take_out(axis, aim, along);
    /* a vertex that is farther ahead than that is not pulled back */
    if (pel_vec3_dot(aim, h->way) < 0)
        pel_vec3_copy(h->way, aim);
    if (pel_vec3_normalize(aim) > 0)
        pel_vec3_scale(aim, -limit, h->tip->pull);
}

static double most_slack(const hold *h, double limit)
{
    return SWING * limit / stiffness_of(h->sim, h->tip->body);
}

/* the vertex is free from the limit on, and is held where the blade does not gain on it */
static void drag(hold *h, double limit)
{
    drop(h->sim, h->tool, h->i);
    h->tip->slack = most_slack(h, limit);
    aim(h, limit);
}

static void follow_drag(hold *h, double limit)
{
    double x[3], way[3];
    read_way(h);
    pel_vertex_position(h->sim->state->position, h->v, x);
    pel_vertex_position(h->sim->tools->blade_before, h->v, way);
    pel_vec3_subtract(x, way, way);
    double force = pel_vec3_length(h->tip->pull), gain = -pel_vec3_dot(h->way, h->tip->pull) / force;
    double ahead = -pel_vec3_dot(way, h->tip->pull) / force - gain;
    h->tip->slack = pel_max(0, pel_min(most_slack(h, limit), h->tip->slack - ahead));
    if (gain < 0 || h->tip->slack == 0) {
        h->tip->slack = 0;
        pel_blade_take(h->sim, h->tool, h->tip->body, h->tip->vertex);
    } else {
        aim(h, limit);
    }
}

void pel_blade_take_on(pel_sim *sim, pel_tool *tool, pel_blade_tip *tip)
{
    const hold h = {.sim = sim, .tool = tool, .tip = tip};
    if (drags(sim, tip)) {
        tip->slack = most_slack(&h, pel_vec3_length(tip->pull));
        sim->state->older_is_known = false;
        return;
    }
    tip->slack = 0;
    pel_blade_take(sim, tool, tip->body, tip->vertex);
}

/* Whether a vertex is pulled back. A blade that has pierced a surface pulls in no direction that it had before, until
   it has cut; a small force has none. */
static bool is_pulled_back(const hold *h, const double force[3], double limit)
{
    bool has_course = pel_vec3_length(h->tip->ahead) > 0 && pel_vec3_length(force) > LEAST_PULL * limit;
    return pel_vec3_dot(force, h->tip->pull) < 0 && (has_course || pel_blade_is_hook(h->sim, h->tool));
}

/* a hook lets go of all above its limit, a blade drags */
static void follow_hold(hold *h, double limit)
{
    double axis[3], force[3], along[3], x[3];
    axis_of(h, axis);
    pel_vec3_copy(h->sim->tools->grip_forces[h->v], force);
    take_out(axis, force, along);
    bool is_hook = pel_blade_is_hook(h->sim, h->tool), is_back = is_pulled_back(h, force, limit);
    if (is_back || (is_hook && pel_vec3_length(force) > limit)) {
        h->tool->tally.lost_count += is_hook && !is_back;
        drop(h->sim, h->tool, h->i);
        return;
    }
    pel_vec3_copy(force, h->tip->pull);
    if (is_hook)
        return;
    read_way(h);
    /* along its edge, where a blade holds nothing, the vertex has stayed (tool/follow.c) */
    pel_vertex_position(h->sim->state->position, h->v, x);
    pel_pose_to_local(&h->tool->pose, x, h->tool->anchors[h->i]);
    shift(h, 1 / resistance_of(h), along);
    if (h->sim->loads->dragged == NULL)
        slide(h, limit);
    else if (pel_vec3_length(force) >= limit)
        drag(h, limit);
}

/* a vertex that was let go is held again where the blade comes against it once more */
static void come_back(pel_sim *sim, pel_tool *tool, const pel_blade_tip *tip, const double way[3])
{
    if (pel_vec3_dot(way, tip->pull) < 0)
        pel_blade_take(sim, tool, tip->body, tip->vertex);
}

/* m, from the blade; of scissors, which open and bite again, from the line that they close along */
static double distance_off(const pel_tool *tool, const double x[3], double way[3])
{
    double middle[3], line[2][3], weights[2];
    if (!is_scissors(tool))
        return find_point(tool, x, way);
    pel_vec3_add(tool->solid.edge[0], tool->solid.edge[1], middle);
    pel_vec3_scale(middle, 0.5, middle);
    pel_pose_to_world(&tool->pose, middle, line[1]);
    pel_vec3_copy(tool->pose.position, line[0]);
    pel_vec3_set(way, 0, 0, 0);
    return sqrt(pel_closest_point_segment(x, line[0], line[1], weights));
}

static void forget(pel_tool *tool, int32_t i)
{
    tool->blade->tips[i] = tool->blade->tips[--tool->blade->tip_count];
    tool->blade->tips[tool->blade->tip_count] = (pel_blade_tip){0};
}

/* vertices that no tip holds any more, such as copies */
static void release_others(pel_sim *sim, pel_tool *tool)
{
    bool is_pressing = false;
    for (int32_t i = 0; i < tool->blade->tip_count; i++)
        is_pressing |= tool->blade->tips[i].is_pressing != 0;
    if (!is_pressing)
        pel_blade_pierce(sim, tool);
}

void pel_blade_slide(pel_sim *sim, pel_tool *tool,
                     double (*limit)(const pel_sim *, const pel_tool *, const pel_blade_tip *))
{
    for (int32_t i = tool->blade->tip_count - 1; i >= 0; i--) {
        pel_blade_tip *tip = &tool->blade->tips[i];
        int32_t v = vertex_of(sim, tip);
        double x[3], way[3];
        hold h = {.sim = sim, .tool = tool, .tip = tip, .v = v, .i = find_held(tool, v)};
        pel_vertex_position(sim->state->position, v, x);
        if (distance_off(tool, x, way) > FAR_OFF * edge_of(sim, tip->body)) {
            pel_blade_let_go(sim, tool, tip->body, tip->vertex);
            forget(tool, i);
        } else if (tip->is_pressing || !pel_blade_resists(sim, tool)) {
            continue;
        } else if (h.i >= 0) {
            follow_hold(&h, limit(sim, tool, tip));
        } else if (tip->slack > 0) {
            follow_drag(&h, limit(sim, tool, tip));
        } else if (pel_vec3_length(tip->pull) > 0) {
            come_back(sim, tool, tip, way);
        }
    }
    release_others(sim, tool);
}
