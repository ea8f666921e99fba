/* A blade holds the vertex at the end of its cut, as a grasp does, but no harder than the material allows. The force of
   the vertex on the blade is known after each step. Where it is above the limit R the blade slides: the place of the
   vertex on the blade moves by s along the force, back to where

       F + K (d - s) = R

   in the next step, with the way d of the blade against the force, and the stiffness K of the sheet around a vertex. A
   K that is too large keeps F below R by some K d at first, one that is too small lets it fall behind. Along its edge a
   blade holds nothing, and it does not pull a vertex back. */
#include "blade/hold.h"

#include "math/extremes.h"
#include "pellicle/geometry.h"
#include "stage/layer.h"
#include "tool/grip.h"

#include <string.h>

/* of the mean edge: a blade farther from its vertex than this has left it */
#define FAR_OFF 2.5
/* share of the blades of scissors that are open: a segment without length has no way */
#define LEAST_CLOSED 1e-3
/* stiffness of a sheet at the end of a cut, over Young's modulus times thickness; at least half of what it is */
#define TIP_SHARE 0.6

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
        if (!tip->is_pressing && sim->model->bodies[tip->body].model_index[tip->vertex] == v)
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

/* ---- sliding ---- */

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

typedef struct hold {
    pel_sim *sim;
    pel_tool *tool;
    pel_blade_tip *tip;
    int32_t i, v;    /* among the held ones, and of the model */
    double force[3]; /* N, across the edge */
    double along[3]; /* N, along it */
    double way[3];   /* m, of the blade in the step */
} hold;

static void read_hold(hold *h)
{
    double edge[2][3], axis[3], x[3], along[3];
    pel_vertex_position(h->sim->state->position, h->v, x);
    find_point(h->tool, x, h->way);
    pel_blade_edge_at(h->tool, &h->tool->pose, 1, edge);
    pel_vec3_subtract(edge[1], edge[0], axis);
    pel_vec3_normalize(axis);
    pel_vec3_copy(h->sim->tools->grip_forces[h->v], h->force);
    take_out(axis, h->force, h->along);
    take_out(axis, h->way, along);
}

/* the place of the vertex on the blade moves, in the world's frame */
static void shift(hold *h, const double way[3])
{
    double local[3];
    pel_rotate_back(h->tool->pose.rotation, way, local);
    pel_vec3_add(h->tool->anchors[h->i], local, h->tool->anchors[h->i]);
}

static void slide(hold *h, double limit)
{
    double stiffness = stiffness_of(h->sim, h->tip->body), force = pel_vec3_length(h->force), slip[3];
    double mass = (double)h->sim->model->mass[h->v], dt = h->sim->step.dt;
    double firm = stiffness + (pel_sim_has_velocity(h->sim) ? mass / (dt * dt) : 0);
    double ahead = force > 0 ? pel_max(0, -pel_vec3_dot(h->way, h->force) / force) : 0;
    double way = force >= limit ? ahead + (force - limit) / firm : pel_max(0, ahead - (limit - force) / stiffness);
    pel_vec3_scale(h->along, 1 / firm, slip);
    pel_vec3_along(slip, force > 0 ? way / force : 0, h->force, slip);
    shift(h, slip);
}

/* a hook lets go of all above its limit, a blade slides */
static void follow_hold(hold *h, double limit)
{
    read_hold(h);
    bool is_hook = pel_blade_is_hook(h->sim, h->tool);
    bool is_back = pel_vec3_dot(h->force, h->tip->pull) < 0;
    if (is_back || (is_hook && pel_vec3_length(h->force) > limit)) {
        h->tool->tally.lost_count += is_hook && !is_back;
        drop(h->sim, h->tool, h->i);
        return;
    }
    pel_vec3_copy(h->force, h->tip->pull);
    if (!is_hook)
        slide(h, limit);
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
        int32_t v = sim->model->bodies[tip->body].model_index[tip->vertex];
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
        } else if (pel_vec3_length(tip->pull) > 0) {
            come_back(sim, tool, tip, way);
        }
    }
    release_others(sim, tool);
}
