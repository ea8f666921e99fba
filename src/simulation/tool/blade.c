/* A blade holds the vertex at the end of its cut, as a grasp does, but no harder than the material allows. The force of
   the vertex on the blade is known after each step. Where it is above the limit R the blade slides: the place of the
   vertex on the blade moves by s along the force, back to where

       F + K (d - s) = R

   in the next step, with the way d of the blade against the force, and the stiffness K of the sheet around a vertex. A
   K that is too large keeps F below R by some K d at first, one that is too small lets it fall behind. Along its edge a
   blade holds nothing, and it does not pull a vertex back. */
#include "tool/blade.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"
#include "pellicle/geometry.h"
#include "geom/sweep.h"
#include "stage/layer.h"
#include "stage/transfer.h"
#include "tool/grip.h"

#include <string.h>

/* of the mean edge: a blade farther from its vertex than this has left it */
#define FAR_OFF 2.5
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

/* ---- checks ---- */

static bool is_number(double value)
{
    return value >= 0 && isfinite(value);
}

static pel_status check_body(const pel_sim *sim, const pel_tool_def *def, int32_t body, int32_t tool, pel_error *error)
{
    const pel_body_def *own = &sim->given->def.bodies[body];
    const char *name = sim->given->bodies[body].name;
    pel_pressure_kind kind = own->shell.pressure.kind;
    if (def->shape == PEL_TOOL_HOOK)
        return PEL_OK;
    if (sim->given->bodies[body].detail != NULL)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "leave out `refine` and subdivide the mesh before (`pellicle subdivide`), or give "
                                  "the blade another `body`",
                                  "blade '%s' acts on body '%s', which refines", def->name, name);
    if (kind == PEL_PRESSURE_GAS || kind == PEL_PRESSURE_VOLUME)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give its pressure as a number or keys, or give the blade another `body`",
                                  "blade '%s' would open body '%s', which encloses a gas or has a target volume",
                                  def->name, name);
    if (def->sharpness > 0 && !own->shell.membrane.on && !(own->spring_thickness > 0))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give the body a membrane or `springs: { young, thickness }`, or leave out sharpness",
                                  "blade '%s' has a sharpness, but the thickness of body '%s' is not known", def->name,
                                  name);
    return PEL_OK;
}

pel_status pel_blade_check(const pel_sim *sim, const pel_tool_def *def, int32_t tool, pel_error *error)
{
    double length = pel_vec3_distance(def->edge[0], def->edge[1]);
    if (!(length > 0) || !isfinite(length))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give two points of the tool's frame that are apart, such as edge: [[0, 0, -0.01], "
                                  "[0, 0, 0.01]]",
                                  "the edge of '%s' has no length", def->name);
    if (!is_number(def->sharpness) || !is_number(def->kerf))
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool,
                                  "give a sharpness in J/m2 and a kerf in m of at least 0",
                                  "blade '%s' has a sharpness or a kerf out of range", def->name);
    if (def->grasp || def->leads)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "use a second tool to grasp",
                                  "'%s' has an edge and a grasp", def->name);
    if (sim->def.tie_count > 0 && def->shape == PEL_TOOL_BLADE)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "leave attachments and stitches out",
                                  "blade '%s' beside attachments or stitches", def->name);
    if (sim->def.solver.path != PEL_PATH_TIME || sim->def.solver.analysis != PEL_ANALYSIS_NONE)
        return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", tool, "use steps over time",
                                  "'%s' along a path of balances or in an analysis", def->name);
    pel_status status = PEL_OK;
    for (int32_t b = 0; status == PEL_OK && b < sim->given->body_count; b++)
        if (def->body < 0 || def->body == b)
            status = check_body(sim, def, b, tool, error);
    return status;
}

pel_status pel_blade_check_start(const pel_sim *sim, int32_t index, pel_error *error)
{
    const pel_tool *tool = &sim->tools->items[index];
    double edge[2][3], corners[3][3], weights[3];
    pel_blade_edge_at(tool, &tool->pose, edge);
    for (int32_t b = 0; b < sim->model->body_count; b++) {
        const pel_body *body = &sim->model->bodies[b];
        for (int32_t t = 0; pel_tool_acts_on(tool, b) && t < body->mesh->triangle_count; t++) {
            for (int c = 0; c < 3; c++)
                pel_vertex_position(sim->state->position, body->model_index[body->mesh->triangles[t][c]], corners[c]);
            if (!pel_segment_passes((const double(*)[3])edge, (const double(*)[3])corners, weights))
                continue;
            double x[3] = {0};
            for (int c = 0; c < 3; c++)
                pel_vec3_along(x, weights[c], corners[c], x);
            return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", index,
                                      "start it beside the surface, or beyond its border, and lead it in by `motion`",
                                      "'%s' starts in the surface of body '%s', at (%.4g, %.4g, %.4g)", tool->name,
                                      body->name, x[0], x[1], x[2]);
        }
    }
    return PEL_OK;
}

pel_status pel_blade_create(pel_sim *sim, pel_tool *tool, pel_error *error)
{
    tool->blade = pel_allocate(1, sizeof *tool->blade);
    if (sim->tools->blade_before == NULL)
        sim->tools->blade_before =
            pel_allocate((size_t)sim->model->vertex_count, sizeof *sim->tools->blade_before);
    tool->press = false;
    tool->grasp = true;
    tool->grasp_from = tool->grasp_until = (double)HUGE_VAL;
    tool->grasp_max_force = (double)HUGE_VAL;
    return tool->blade != NULL && sim->tools->blade_before != NULL ? PEL_OK : pel_fail_memory(error);
}

/* ---- the step ---- */

void pel_blades_begin(pel_sim *sim)
{
    if (sim->tools->blade_before == NULL)
        return;
    memcpy(sim->tools->blade_before, sim->state->position,
           (size_t)sim->model->vertex_count * sizeof *sim->tools->blade_before);
    for (int32_t i = 0; i < sim->tools->count; i++)
        if (sim->tools->items[i].blade != NULL)
            sim->tools->items[i].blade->pose_before = sim->tools->items[i].pose;
}

void pel_blade_edge_at(const pel_tool *tool, const pel_pose *pose, double edge[2][3])
{
    for (int end = 0; end < 2; end++)
        pel_pose_to_world(pose, tool->solid.edge[end], edge[end]);
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

/* N/m, of the sheet around a vertex */
static double stiffness_of(const pel_sim *sim, int32_t body)
{
    const pel_body *own = &sim->model->bodies[body];
    return TIP_SHARE * sim->tools->strengths[body] / sqrt(own->rest_area / own->mesh->vertex_count);
}

static double edge_of(const pel_sim *sim, int32_t body)
{
    const pel_body *own = &sim->model->bodies[body];
    return sqrt(own->rest_area / own->mesh->vertex_count);
}

/* the point of the edge nearest to x, and its way in the step */
static double find_point(const pel_tool *tool, const double x[3], double way[3])
{
    double now[2][3], before[2][3], weights[2], nearest[3];
    pel_blade_edge_at(tool, &tool->pose, now);
    pel_blade_edge_at(tool, &tool->blade->pose_before, before);
    double distance = pel_closest_point_segment(x, now[0], now[1], weights);
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
    int32_t i, v;       /* among the held ones, and of the model */
    double force[3];    /* N, across the edge */
    double along[3];    /* N, along it */
    double way[3];      /* m, of the blade in the step */
} hold;

static void read_hold(hold *h)
{
    double edge[2][3], axis[3], x[3], along[3];
    pel_vertex_position(h->sim->state->position, h->v, x);
    find_point(h->tool, x, h->way);
    pel_blade_edge_at(h->tool, &h->tool->pose, edge);
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
    h->tip->slip += way;
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

static void forget(pel_tool *tool, int32_t i)
{
    tool->blade->tips[i] = tool->blade->tips[--tool->blade->tip_count];
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
        if (find_point(tool, x, way) > FAR_OFF * edge_of(sim, tip->body)) {
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

/* ---- snapshots ---- */

void pel_blade_transfer(pel_cursor *at, pel_blade *blade)
{
    pel_transfer(at, &blade->tip_count, sizeof blade->tip_count);
    pel_transfer(at, blade->tips, sizeof blade->tips);
}

bool pel_blade_is_whole(const pel_sim *sim, const pel_blade *blade)
{
    if (blade->tip_count < 0 || blade->tip_count > PEL_BLADE_TIPS)
        return false;
    for (int32_t i = 0; i < blade->tip_count; i++) {
        const pel_blade_tip *tip = &blade->tips[i];
        if (tip->body < 0 || tip->body >= sim->model->body_count || tip->vertex < 0 ||
            tip->vertex >= sim->model->bodies[tip->body].mesh->vertex_count)
            return false;
    }
    return true;
}
