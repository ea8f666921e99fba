#include "tool/solid.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "stage/accessors.h"
#include "tool/contact_force.h"
#include "tool/near.h"
#include "tool/pose.h"
#include "tool/press.h"
#include "tool/sagitta.h"

#include <string.h>

/* motion of the surface in a step in addition to its velocity, relative to the longest edge */
#define NEAR_SHARE 0.25
/* relative to the least half width of a tool: a displacement per substep that may pass through it; cosine of the angle
   between the outward directions at the start and the end of the substep below which it did */
#define FAST_SHARE 0.5
#define TURNED 0.5
/* a triangle whose deepest point is nearer to a corner than this is left to the contact of the corner */
#define CORNER_WEIGHT (1 - 1e-6)

/* ---- creation ---- */

static bool presses(const pel_tool *tool)
{
    return tool->press && tool->mesh == NULL;
}

pel_status pel_solids_create(pel_sim *sim, pel_error *error)
{
    bool any = false;
    for (int32_t i = 0; i < sim->tools->count; i++)
        any |= presses(&sim->tools->items[i]);
    if (!any || !pel_sim_is_projected(sim))
        return PEL_OK;
    sim->tools->solids = pel_allocate(1, sizeof *sim->tools->solids);
    if (sim->tools->solids == NULL)
        return pel_fail_memory(error);
    sim->tools->solids->mark_of_vertex =
        pel_allocate((size_t)sim->model->vertex_count, sizeof *sim->tools->solids->mark_of_vertex);
    return sim->tools->solids->mark_of_vertex != NULL ? PEL_OK : pel_fail_memory(error);
}

void pel_solids_destroy(pel_sim *sim)
{
    pel_sim_solids *solids = sim->tools->solids;
    if (solids == NULL)
        return;
    PEL_FREE_ALL(solids->list.contacts, solids->pairs, solids->mark_of_vertex, solids);
}

/* ---- search ---- */

static pel_status add_pair(pel_sim *sim, int32_t tool, int32_t triangle, int32_t vertex, pel_error *error)
{
    PEL_ASSERT_INDEX(tool, sim->tools->count);
    pel_sim_solids *solids = sim->tools->solids;
    size_t count = (size_t)solids->list.count;
    if (!pel_reserve((void **)&solids->list.contacts, &solids->capacity, count + 1, sizeof *solids->list.contacts) ||
        !pel_reserve((void **)&solids->pairs, &solids->pair_capacity, count + 1, sizeof *solids->pairs))
        return pel_fail_memory(error);
    solids->pairs[count] = (pel_solid_pair){.tool = tool, .triangle = triangle, .vertex = vertex};
    if (triangle >= 0)
        solids->pairs[count].solid = pel_tool_triangle_solid(sim, &sim->tools->items[tool], triangle);
    pel_contact *contact = &solids->list.contacts[count];
    *contact =
        (pel_contact){.friction = (pel_real)pel_sim_friction(
                          sim, &sim->tools->items[tool], triangle < 0 ? vertex : sim->model->triangles[triangle][0])};
    for (int i = 0; i < 4; i++)
        contact->vertices[i] = triangle < 0 ? vertex : sim->model->triangles[triangle][i < 3 ? i : 0];
    contact->weights[0] = triangle < 0;
    solids->list.count++;
    return PEL_OK;
}

static pel_status add_triangle(pel_sim *sim, int32_t tool, int32_t triangle, pel_error *error)
{
    PEL_ASSERT_INDEX(tool, sim->tools->count);
    pel_status status = PEL_OK;
    for (int c = 0; c < 3 && status == PEL_OK; c++) {
        int32_t v = sim->model->triangles[triangle][c];
        if (sim->tools->solids->mark_of_vertex[v] == tool + 1)
            continue;
        sim->tools->solids->mark_of_vertex[v] = tool + 1;
        status = add_pair(sim, tool, -1, v, error);
    }
    return status == PEL_OK ? add_pair(sim, tool, triangle, -1, error) : status;
}

/* the longest way of a vertex in this step by its velocity [m] */
static double fastest_way(const pel_sim *sim)
{
    double square = 0;
    for (int32_t v = 0; v < sim->model->vertex_count; v++) {
        double velocity[3];
        pel_vertex_position(sim->state->velocity, v, velocity);
        square = pel_max(square, pel_vec3_squared_length(velocity));
    }
    return sim->step.dt * sqrt(square);
}

pel_status pel_solids_find(pel_sim *sim, pel_error *error)
{
    pel_sim_solids *solids = sim->tools->solids;
    pel_status status = PEL_OK;
    solids->list.count = 0;
    memset(solids->mark_of_vertex, 0, (size_t)sim->model->vertex_count * sizeof *solids->mark_of_vertex);
    double longest = pel_sim_longest_edge(sim), motion = fastest_way(sim);
    for (int32_t i = 0; i < sim->tools->count; i++) {
        pel_tool *tool = &sim->tools->items[i];
        if (!presses(tool))
            continue;
        double margin = NEAR_SHARE * longest + motion + pel_tool_way(tool, &tool->pose_before, &tool->pose_wanted);
        int32_t near_count = pel_tool_near_triangles(sim, tool, &tool->near, sim->state->position, margin);
        for (int32_t n = 0; n < near_count && status == PEL_OK; n++)
            status = add_triangle(sim, i, sim->tools->near_triangles[n], error);
    }
    return status;
}

/* ---- contacts at the present positions ---- */

/* the half space that a point of the surface has to stay in, and the motion of the tool there in this substep */
static void set_plane(const pel_tool *tool, const double point[3], const double local_normal[3], double depth,
                      pel_contact *contact)
{
    double normal[3], local[3], before[3];
    pel_rotate(tool->pose.rotation, local_normal, normal);
    pel_pose_to_local(&tool->pose, point, local);
    pel_pose_to_world(&tool->pose_substep, local, before);
    for (int k = 0; k < 3; k++) {
        contact->normal[k] = (pel_real)normal[k];
        contact->drift[k] = (pel_real)(point[k] - before[k]);
    }
    contact->separation = (pel_real)(pel_vec3_dot(normal, point) + depth);
}

/* Where a point of the surface was in the tool's frame at the start of the substep. */
static void start_in_tool(const pel_tool *tool, const pel_record *start, int32_t v, double local[3])
{
    double x[3];
    pel_vertex_position(start, v, x);
    pel_pose_to_local(&tool->pose_substep, x, local);
}

static double least_half_width(const pel_solid *solid)
{
    double half[3];
    pel_solid_half_box(solid, half);
    return pel_min(half[0], pel_min(half[1], half[2]));
}

/* the half space beyond the surface point that was closest at the start of the substep, for points that pass through
   the tool in it; `before` and `now` are positions of the point in the tool's frame */
static void keep_start_side(const pel_tool *tool, const double before[3], const double now[3], const double point[3],
                            const double normal[3], double distance, pel_contact *contact)
{
    double way[3];
    pel_vec3_subtract(now, before, way);
    set_plane(tool, point, normal, -(distance + pel_vec3_dot(normal, way)), contact);
}

static void refresh_vertex(const pel_sim *sim, const pel_record *start, const pel_tool *tool, int32_t v,
                           pel_contact *contact)
{
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    double x[3], local[3], before[3], normal[3], normal_before[3];
    pel_vertex_position(sim->state->position_next, v, x);
    pel_pose_to_local(&tool->pose, x, local);
    const pel_solid solid = pel_tool_press_solid(sim, tool, v);
    double distance = pel_solid_distance(&solid, local, normal);
    set_plane(tool, x, normal, -distance, contact);
    start_in_tool(tool, start, v, before);
    double way = pel_vec3_distance(local, before);
    if (way < FAST_SHARE * least_half_width(&solid))
        return;
    double distance_before = pel_solid_distance(&solid, before, normal_before);
    if (distance_before < way && pel_vec3_dot(normal, normal_before) < TURNED)
        keep_start_side(tool, before, local, x, normal_before, distance_before, contact);
}

/* If a round tool passes through a triangle in one substep, the point that was closest at its start is kept on its
   side. False if it does not. */
static bool is_passed(const pel_sim *sim, const pel_record *start, const pel_solid_pair *pair, double local[3][3],
                      const double *normal, pel_contact *contact)
{
    double before[3][3], weights[3], normal_before[3], from[3] = {0, 0, 0}, to[3] = {0, 0, 0}, point[3] = {0, 0, 0},
                                                       x[3];
    const pel_tool *tool = &sim->tools->items[pair->tool];
    int32_t t = pair->triangle;
    double way = 0;
    for (int c = 0; c < 3; c++) {
        start_in_tool(tool, start, sim->model->triangles[t][c], before[c]);
        way = pel_max(way, pel_vec3_distance(local[c], before[c]));
    }
    pel_solid reach = pair->solid;
    if (way < FAST_SHARE * reach.radius)
        return false;
    reach.radius += way;
    double depth = pel_solid_depth(&reach, before[0], before[1], before[2], weights, normal_before);
    if (!(depth > 0) || (normal != NULL && pel_vec3_dot(normal, normal_before) >= TURNED))
        return false;
    for (int c = 0; c < 3; c++) {
        pel_vertex_position(sim->state->position_next, sim->model->triangles[t][c], x);
        pel_vec3_along(from, weights[c], before[c], from);
        pel_vec3_along(to, weights[c], local[c], to);
        pel_vec3_along(point, weights[c], x, point);
        contact->weights[c] = (pel_real)weights[c];
    }
    keep_start_side(tool, from, to, point, normal_before, way - depth, contact);
    return true;
}

static void refresh_triangle(const pel_sim *sim, const pel_record *start, const pel_solid_pair *pair,
                             pel_contact *contact)
{
    double corner[3][3], local[3][3], weights[3], normal[3], point[3] = {0, 0, 0};
    const pel_tool *tool = &sim->tools->items[pair->tool];
    const pel_solid *solid = &pair->solid;
    int32_t t = pair->triangle;
    for (int c = 0; c < 3; c++) {
        pel_vertex_position(sim->state->position_next, sim->model->triangles[t][c], corner[c]);
        pel_pose_to_local(&tool->pose, corner[c], local[c]);
    }
    contact->separation = (pel_real)-HUGE_VAL;
    if (pel_solid_is_deepest_at_corner(solid, (const double(*)[3])local))
        return;
    double depth = pel_solid_depth(solid, local[0], local[1], local[2], weights, normal);
    if (pel_solid_is_round(solid) && is_passed(sim, start, pair, local, depth > 0 ? normal : NULL, contact))
        return;
    if (!(depth > 0) || pel_max(weights[0], pel_max(weights[1], weights[2])) > CORNER_WEIGHT)
        return;
    for (int c = 0; c < 3; c++) {
        contact->weights[c] = (pel_real)weights[c];
        pel_vec3_along(point, weights[c], corner[c], point);
    }
    set_plane(tool, point, normal, depth, contact);
}

void pel_solids_refresh(pel_sim *sim, const pel_record *start)
{
    pel_sim_solids *solids = sim->tools->solids;
    for (int32_t c = 0; c < solids->list.count; c++) {
        const pel_solid_pair *pair = &solids->pairs[c];
        const pel_tool *tool = &sim->tools->items[pair->tool];
        if (pair->triangle < 0)
            refresh_vertex(sim, start, tool, pair->vertex, &solids->list.contacts[c]);
        else
            refresh_triangle(sim, start, pair, &solids->list.contacts[c]);
    }
}

void pel_solids_tally(pel_sim *sim, double rate)
{
    const pel_sim_solids *solids = sim->tools->solids;
    for (int32_t c = 0; c < solids->list.count; c++)
        if (solids->list.contacts[c].push > 0)
            pel_contact_take_push(sim, solids->pairs[c].tool, &solids->list.contacts[c], rate);
}
