/* Tools in a minimisation: spheres by the nearest point of each triangle near them, recomputed as it moves; capsules by
   the nearest points of vertices and edges to their axis, and of triangles to its ends; boxes, if contact does not
   treat them as surfaces, by planes at vertices and at the deepest points of triangles, along separating axes that are
   recomputed in each round. */
#include "constraint/constraint_tool.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/status.h"
#include "constraint/constraint.h"
#include "contact/layer.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "stage/accessors.h"
#include "tool/contact_force.h"
#include "tool/near.h"
#include "tool/pose.h"
#include "tool/press.h"
#include "tool/sagitta.h"

#include <string.h>

/* relative to the longest edge: triangles this near to a tool get constraints */
#define REACH_SHARE 0.5
/* relative to the tolerance of pressing: additional gap, to within the tolerance */
#define SLACK_SHARE 2.0
#define GAP_TOLERANCE 1.5
/* of the thickness of a layer */
#define LAYER_TOLERANCE (0.75 * PEL_SLACK_SHARE)
/* weights of a point inside an edge; tangent of the angle below which an edge is parallel to an axis */
#define INSIDE 1e-9
#define ALONG_AXIS 0.01

/* one tool at work */
typedef struct tool_search {
    pel_sim *sim;
    int32_t tool, other_count;
    double reach, slack;
    pel_minimise_contact blank;
} tool_search;

/* boxes and meshes are in the list of contacts */
static bool is_found_here(const pel_sim *sim, const pel_tool *tool)
{
    return tool->press && tool->mesh == NULL && (pel_tool_is_round(tool) || !pel_sim_has_loop_contacts(sim));
}

/* displacement of the tool at a point since the start of the step */
static void find_drift(const pel_tool *tool, const double point[3], double drift[3])
{
    double local[3], before[3];
    pel_pose_to_local(&tool->pose, point, local);
    pel_pose_to_world(&tool->pose_before, local, before);
    pel_vec3_subtract(point, before, drift);
}

/* The layer between a tool and a vertex or the corners of a triangle; without contact tools are rigid. */
static void set_layer(const pel_sim *sim, pel_minimise_contact *constraint)
{
    const pel_contact_layer *layer = &sim->layers[sim->model->body_of_slice[constraint->vertices[0] / PEL_WIDTH]];
    double mass = 0;
    int count = constraint->number < 0 ? 1 : 3;
    if (sim->contacts == NULL)
        return;
    for (int i = 0; i < count; i++)
        mass += (double)sim->model->mass[constraint->vertices[i]] / count;
    constraint->compliance = pel_contact_layer_compliance(layer, mass, 0, sim->step.dt);
    constraint->thickness = layer->thickness;
    constraint->tolerance = pel_max(constraint->tolerance, LAYER_TOLERANCE * layer->thickness);
}

/* with the loads of the one that was known before, `known` its number plus 1 */
static pel_status add(const tool_search *search, pel_minimise_contact *constraint, int32_t known, pel_error *error)
{
    pel_sim *sim = search->sim;
    double point[3];
    const int32_t pair[] = {
        2, constraint->tool, constraint->number, constraint->points, constraint->end, constraint->vertices[0]};
    memcpy(constraint->pair, pair, sizeof pair);
    pel_minimise_contact_point(constraint, sim->minimise->position, point);
    find_drift(&sim->tools->items[search->tool], point, constraint->drift);
    set_layer(sim, constraint);
    if (known > 0) {
        const pel_minimise_contact *old = &sim->minimise->others[known - 1];
        constraint->load = old->load;
        pel_vec3_copy(old->drag, constraint->drag);
    }
    return pel_minimise_contact_add(sim, constraint, error);
}

static pel_minimise_contact at_triangle(const tool_search *search, int32_t t)
{
    pel_minimise_contact constraint = search->blank;
    for (int i = 0; i < 4; i++)
        constraint.vertices[i] = search->sim->model->triangles[t][i < 3 ? i : 0];
    constraint.number = t;
    return constraint;
}

/* ---- round tools ---- */

/* index + 1 of the same feature in the list of known ones, which groups features by triangle */
static int32_t find_known(const tool_search *search, const pel_minimise_contact *constraint)
{
    const pel_minimise *minimise = search->sim->minimise;
    int32_t c = search->sim->tools->plane_of_triangle[constraint->number];
    for (; c > 0 && c <= search->other_count; c++) {
        const pel_minimise_contact *old = &minimise->others[c - 1];
        if (old->tool != search->tool || old->number != constraint->number)
            break;
        if (old->points == constraint->points && old->end == constraint->end &&
            old->vertices[0] == constraint->vertices[0])
            return c;
    }
    return 0;
}

static pel_status add_feature(const tool_search *search, pel_minimise_contact *constraint, int32_t known,
                              pel_error *error)
{
    pel_gap_sample meeting;
    constraint->offset += search->slack;
    pel_minimise_contact_meet(search->sim, constraint, search->sim->minimise->position, &meeting);
    if (meeting.gap > search->reach && known == 0)
        return PEL_OK;
    memcpy(constraint->weights, meeting.weights, sizeof constraint->weights);
    pel_vec3_copy(meeting.normal, constraint->normal);
    return add(search, constraint, known, error);
}

/* m, that a triangle and its sides keep more than the tool's surface */
static double triangle_offset(const tool_search *search, int32_t t)
{
    const pel_sim *sim = search->sim;
    const pel_tool *tool = &sim->tools->items[search->tool];
    const pel_solid own = pel_tool_triangle_solid(sim, tool, t),
                    whole = pel_tool_press_solid(sim, tool, sim->model->triangles[t][0]);
    return own.radius - whole.radius;
}

static pel_status add_face(const tool_search *search, int32_t t, int end, pel_error *error)
{
    pel_minimise_contact constraint = at_triangle(search, t);
    constraint.points = 3;
    constraint.end = end;
    constraint.offset = triangle_offset(search, t);
    return add_feature(search, &constraint, find_known(search, &constraint), error);
}

/* whether an edge lies along the axis, where its nearest point would jump from end to end: its vertices hold it */
static bool is_along_axis(const tool_search *search, const pel_minimise_contact *constraint)
{
    const double *position = search->sim->minimise->position;
    const double *from = position + 3 * (size_t)constraint->vertices[0];
    const double *to = position + 3 * (size_t)constraint->vertices[1];
    double way[3];
    pel_vec3_subtract(to, from, way);
    pel_rotate_back(search->sim->tools->items[search->tool].pose.rotation, way, way);
    return pel_hypot(way[0], way[1]) < ALONG_AXIS * fabs(way[2]);
}

/* A side of a triangle that crosses the axis; beyond the ends their spheres hold the triangle, and vertices have
   separate constraints. */
static pel_status add_side(const tool_search *search, int32_t t, int side, pel_error *error)
{
    pel_sim *sim = search->sim;
    pel_minimise_contact constraint = at_triangle(search, t);
    const int32_t *corners = sim->model->triangles[t];
    for (int i = 0; i < 4; i++)
        constraint.vertices[i] = corners[i == 1 ? (side + 1) % 3 : side];
    constraint.points = 2;
    constraint.offset = triangle_offset(search, t);
    int32_t known = find_known(search, &constraint);
    bool presses = known > 0 && sim->minimise->others[known - 1].load > 0;
    if (is_along_axis(search, &constraint))
        return PEL_OK;
    pel_gap_sample meeting;
    pel_minimise_contact_meet(sim, &constraint, sim->minimise->position, &meeting);
    if (!presses && pel_max(meeting.weights[0], meeting.weights[1]) > 1 - INSIDE)
        return PEL_OK;
    return add_feature(search, &constraint, presses ? known : 0, error);
}

static pel_status add_vertex(const tool_search *search, int32_t v, pel_error *error)
{
    pel_sim *sim = search->sim;
    int32_t known = sim->minimise->constraint_of_vertex[v];
    /* found before, in this search */
    if (known < 0)
        return PEL_OK;
    pel_minimise_contact constraint = search->blank;
    for (int i = 0; i < 4; i++)
        constraint.vertices[i] = v;
    constraint.points = 1;
    constraint.number = -1 - v;
    int32_t before = sim->minimise->count;
    pel_status status = add_feature(search, &constraint, known, error);
    /* where nothing was added nothing would take the mark away */
    if (sim->minimise->count > before)
        sim->minimise->constraint_of_vertex[v] = -1;
    return status;
}

static pel_status add_round(const tool_search *search, int32_t t, pel_error *error)
{
    const pel_sim *sim = search->sim;
    const pel_tool *tool = &sim->tools->items[search->tool];
    bool is_sphere = pel_solid_is_ball(&tool->solid);
    pel_status status = is_sphere ? add_face(search, t, 0, error) : PEL_OK;
    if (is_sphere && !pel_tool_cuts(sim, tool, sim->model->triangles[t][0]))
        return status;
    for (int end = -1; !is_sphere && status == PEL_OK && end <= 1; end += 2)
        status = add_face(search, t, end, error);
    for (int i = 0; !is_sphere && status == PEL_OK && i < 3; i++)
        status = add_side(search, t, i, error);
    for (int i = 0; status == PEL_OK && i < 3; i++)
        status = add_vertex(search, sim->model->triangles[t][i], error);
    return status;
}

/* ---- boxes ---- */

static void set_plane(const tool_search *search, const double local[3], double gap, pel_minimise_contact *constraint)
{
    pel_sim *sim = search->sim;
    double point[3];
    pel_minimise_contact_point(constraint, sim->minimise->position, point);
    pel_rotate(sim->tools->items[search->tool].pose.rotation, local, constraint->normal);
    constraint->offset = pel_vec3_dot(constraint->normal, point) - gap + search->slack;
}

static pel_status add_corner(const tool_search *search, int32_t v, pel_error *error)
{
    pel_sim *sim = search->sim;
    const pel_tool *tool = &sim->tools->items[search->tool];
    pel_minimise_contact constraint = search->blank;
    double local[3], normal[3];
    int32_t known = sim->minimise->constraint_of_vertex[v];
    /* found before, in this search */
    if (known < 0)
        return PEL_OK;
    pel_pose_to_local(&tool->pose, sim->minimise->position + 3 * (size_t)v, local);
    const pel_solid solid = pel_tool_press_solid(sim, tool, v);
    double gap = pel_solid_distance(&solid, local, normal);
    if (gap > search->reach)
        return PEL_OK;
    for (int i = 0; i < 4; i++)
        constraint.vertices[i] = v;
    constraint.weights[0] = 1;
    constraint.number = -1 - v;
    set_plane(search, normal, gap, &constraint);
    int32_t before = sim->minimise->count;
    pel_status status = add(search, &constraint, known, error);
    /* where nothing was added nothing would take the mark away */
    if (sim->minimise->count > before)
        sim->minimise->constraint_of_vertex[v] = -1;
    return status;
}

static pel_status add_flat(const tool_search *search, int32_t t, pel_error *error)
{
    pel_sim *sim = search->sim;
    const pel_tool *tool = &sim->tools->items[search->tool];
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < 3; i++)
        status = add_corner(search, sim->model->triangles[t][i], error);
    const pel_solid solid = pel_tool_press_solid(sim, tool, sim->model->triangles[t][0]);
    const pel_solid grown = pel_solid_grown(&solid, search->reach);
    pel_minimise_contact constraint = at_triangle(search, t);
    double normal[3], *w = constraint.weights;
    double depth = pel_tool_triangle_depth(sim, tool, &grown, sim->state->position_next, t, w, normal);
    /* corners have their own */
    if (status != PEL_OK || !(depth > 0) || pel_max(w[0], pel_max(w[1], w[2])) > 1 - 1e-6)
        return status;
    double corner[3][3], axis[3];
    for (int i = 0; i < 3; i++) {
        pel_pose_to_local(&tool->pose, sim->minimise->position + 3 * (size_t)sim->model->triangles[t][i], corner[i]);
    }
    double support = pel_solid_separation(&solid, (const double(*)[3])corner, axis);
    double gap = -support;
    for (int i = 0; i < 3; i++)
        gap += w[i] * pel_vec3_dot(axis, corner[i]);
    set_plane(search, axis, gap, &constraint);
    return add(search, &constraint, sim->tools->plane_of_triangle[t], error);
}

/* ---- all tools ---- */

/* index the known features of a tool by triangle and vertex, or forget them */
static void set_known(pel_sim *sim, int32_t tool, int32_t other_count, bool forget)
{
    PEL_ASSERT_INDEX(tool, sim->tools->count);
    const pel_minimise *minimise = sim->minimise;
    for (int32_t c = 0; c < other_count; c++) {
        const pel_minimise_contact *old = &minimise->others[c];
        if (old->tool != tool)
            continue;
        int32_t *known = old->number < 0 ? &minimise->constraint_of_vertex[-1 - old->number]
                                         : &sim->tools->plane_of_triangle[old->number];
        /* the first one of a triangle */
        if (forget || *known == 0)
            *known = forget ? 0 : c + 1;
    }
    for (int32_t c = 0; forget && c < minimise->count; c++)
        if (minimise->constraints[c].number < 0)
            minimise->constraint_of_vertex[-1 - minimise->constraints[c].number] = 0;
}

static pel_status find(pel_sim *sim, int32_t tool, int32_t other_count, double longest, pel_error *error)
{
    PEL_ASSERT_INDEX(tool, sim->tools->count);
    pel_tool *t = &sim->tools->items[tool];
    double free_depth = pel_tool_press_tolerance(sim, t);
    const tool_search search = {.sim = sim,
                                .tool = tool,
                                .other_count = other_count,
                                .reach = REACH_SHARE * longest,
                                .slack = SLACK_SHARE * free_depth,
                                .blank = {.tool = tool, .tolerance = GAP_TOLERANCE * free_depth}};
    int32_t near_count = pel_tool_near_triangles(sim, t, &t->near, sim->state->position_next, search.reach);
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < near_count; i++) {
        tool_search own = search;
        own.blank.friction = pel_sim_friction(sim, t, sim->model->triangles[sim->tools->near_triangles[i]][0]);
        if (pel_tool_is_round(t))
            status = add_round(&own, sim->tools->near_triangles[i], error);
        else
            status = add_flat(&own, sim->tools->near_triangles[i], error);
    }
    return status;
}

pel_status pel_minimise_contacts_find_tools(pel_sim *sim, pel_error *error)
{
    pel_minimise *minimise = sim->minimise;
    pel_minimise_contact *list = minimise->constraints;
    size_t capacity = minimise->capacity;
    int32_t other_count = minimise->tool_count;
    double longest = sim->tools->count > 0 ? pel_sim_longest_edge(sim) : 0;
    minimise->constraints = minimise->others;
    minimise->capacity = minimise->other_capacity;
    minimise->others = list;
    minimise->other_capacity = capacity;
    minimise->count = 0;
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < sim->tools->count; i++) {
        if (!is_found_here(sim, &sim->tools->items[i]))
            continue;
        set_known(sim, i, other_count, false);
        status = find(sim, i, other_count, longest, error);
        set_known(sim, i, other_count, true);
    }
    minimise->tool_count = minimise->count;
    return status;
}

/* ---- readings ---- */

/* load and drag as forces of the step; both act at the same point except for the slip on a round tool in the last
   round */
static void add_action(pel_sim *sim, const pel_minimise_contact *constraint, const pel_gap_sample *meeting)
{
    pel_contact_action action = {.vertices = constraint->vertices, .obstacle = constraint->tool};
    memcpy(action.weights, meeting->weights, sizeof action.weights);
    pel_vec3_scale(meeting->normal, constraint->load, action.load);
    pel_vec3_add(action.load, constraint->drag, action.force);
    pel_contact_act(sim, &action);
}

static void read_constraint(pel_sim *sim, const pel_minimise_contact *constraint)
{
    double point[3] = {0, 0, 0}, sum = 0, side = 0, load[3];
    pel_gap_sample meeting;
    pel_minimise_contact_meet(sim, constraint, sim->minimise->position, &meeting);
    add_action(sim, constraint, &meeting);
    if (constraint->tool < 0)
        return;
    pel_tool *tool = &sim->tools->items[constraint->tool];
    for (int i = 0; i < 4; i++) {
        int32_t v = constraint->vertices[i];
        if (meeting.weights[i] == 0)
            continue;
        pel_contact_vertex *touch = pel_tool_touch(tool, v);
        pel_vec3_along(touch->push, constraint->load * meeting.weights[i], meeting.normal, touch->push);
        pel_vec3_along(point, fabs(meeting.weights[i]), sim->minimise->position + 3 * (size_t)v, point);
        sum += fabs(meeting.weights[i]);
        side += meeting.weights[i];
    }
    if (!(sum > 0))
        return;
    pel_vec3_scale(point, 1 / sum, point);
    pel_vec3_along(constraint->drag, constraint->load, meeting.normal, load);
    /* of surfaces the tool may be the first or the second one */
    pel_vec3_scale(load, -side, load);
    pel_tool_add_reaction(tool, point, load);
}

void pel_minimise_contacts_read(pel_sim *sim)
{
    const pel_minimise *minimise = sim->minimise;
    for (int32_t c = 0; c < minimise->count; c++)
        if (minimise->constraints[c].load > 0)
            read_constraint(sim, &minimise->constraints[c]);
}
