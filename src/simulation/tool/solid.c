#include "tool/solid.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "contact/set.h"
#include "math/extremes.h"
#include "stage/accessors.h"
#include "sweep/sweep.h"
#include "tool/contact_force.h"
#include "tool/near.h"
#include "tool/pose.h"
#include "tool/press.h"
#include "tool/reading.h"
#include "tool/sagitta.h"

#include <math.h>
#include <string.h>

/* motion of the surface in a step in addition to its velocity, relative to the longest edge */
#define NEAR_SHARE 0.25
/* relative to the least half width of a tool: a displacement per substep that may pass through it; cosine of the angle
   between the outward directions at the start and the end of the substep below which it did */
#define FAST_SHARE 0.5
#define TURNED 0.5
/* a triangle whose deepest point is nearer to a corner than this is left to the contact of the corner */
#define CORNER_WEIGHT (1 - 1e-6)
/* of the thickness: pairs with tools that rest keep weights and normal until vertices may have moved so far; of its
   distance: how far a vertex away from a tool may come before it is looked at */
#define KEEP_SHARE 0.01
#define ROOM_SHARE 0.5
/* of the thickness: the span in which the load of a vertex begins. With 0 the force of a ball that glides over soft
   tissue changes by 9 % in a step of 2 ms, with .05, .1 and .15 by 5, 3.5 and 2 %; against a rigid tool it is 2 to 5 %
   too small with 0, and -2.5 to .7 % off with .1, -.1 to 3.8 % with .15 */
#define SOFT_SHARE 0.12
/* with contact: of the mean edge, the span of round tools on filled tissue. The force of the same ball changes by 57 %
   in a step of 1 ms with 0, by 8 % with .006, by 6 % with .012, and is 1 and 2 % larger */
#define TISSUE_SHARE 0.012

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
    pel_sim_solids *solids = sim->tools->solids;
    solids->list.rigids = sim->rigids;
    size_t triangle_count = (size_t)sim->model->triangle_begin[sim->model->body_count];
    bool made = PEL_ALLOCATE_ALL(PEL_ROOM(solids->pair_of_vertex, sim->model->vertex_count),
                                 PEL_ROOM(solids->pair_of_triangle, triangle_count));
    const pel_travel_def travel = {sim->model->vertex_count, sim->model->body_count, sim->model->body_of_slice,
                                   sim->model->mass};
    return made ? pel_travel_create(&travel, &solids->travel, error) : pel_fail_memory(error);
}

void pel_solids_destroy(pel_sim *sim)
{
    pel_sim_solids *solids = sim->tools->solids;
    if (solids == NULL)
        return;
    pel_travel_destroy(&solids->travel);
    pel_contact_patches_clear(&solids->patches);
    PEL_FREE_ALL(solids->list.contacts, solids->active, solids->pairs, solids->calm, solids->runs, solids->kept,
                 solids->pair_of_vertex, solids->pair_of_triangle, solids);
}

/* ---- search ---- */

/* m/N, of the layer between a tool and a vertex or the corners of a triangle that come with a speed [m/s], by their
   mean mass: of a rigid body all of it */
static double compliance_of(const pel_sim *sim, const pel_contact *contact, double speed, int count)
{
    int32_t body = sim->model->body_of_slice[contact->vertices[0] / PEL_WIDTH];
    double mass = 0;
    for (int i = 0; i < count; i++) {
        const pel_rigid *rigid = pel_rigid_of(sim->rigids, contact->vertices[i]);
        mass += rigid != NULL ? rigid->shape->mass : (double)sim->model->mass[contact->vertices[i]];
    }
    return pel_contact_layer_compliance(&sim->layers[body], mass / count, speed, sim->step.dt);
}

static bool make_room(pel_sim_solids *solids, size_t count)
{
    return pel_reserve((void **)&solids->list.contacts, &solids->capacity, count, sizeof *solids->list.contacts) &&
           pel_reserve((void **)&solids->pairs, &solids->pair_capacity, count, sizeof *solids->pairs) &&
           pel_reserve((void **)&solids->calm, &solids->calm_capacity, count, sizeof *solids->calm) &&
           pel_reserve((void **)&solids->runs, &solids->run_capacity, count, sizeof *solids->runs) &&
           pel_reserve((void **)&solids->active, &solids->active_capacity, count, sizeof *solids->active) &&
           pel_contact_patches_expect(&solids->patches, &solids->list, count);
}

static pel_status add_pair(pel_sim *sim, int32_t tool, int32_t triangle, int32_t vertex, pel_error *error)
{
    PEL_ASSERT_INDEX(tool, sim->tools->count);
    pel_sim_solids *solids = sim->tools->solids;
    size_t count = (size_t)solids->list.count;
    if (!make_room(solids, count + 1))
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
    contact->compliance = (pel_real)compliance_of(sim, contact, 0, triangle < 0 ? 1 : 3);
    *(triangle < 0 ? &solids->pair_of_vertex[vertex] : &solids->pair_of_triangle[triangle]) = (int32_t)count;
    solids->list.count++;
    return PEL_OK;
}

/* the pair of a tool with a vertex or triangle among those from `begin` on, -1 = there is none */
static int32_t find_pair(const pel_sim_solids *solids, int32_t begin, int32_t triangle, int32_t vertex)
{
    int32_t at = triangle < 0 ? solids->pair_of_vertex[vertex] : solids->pair_of_triangle[triangle];
    if (at < begin || at >= solids->list.count)
        return -1;
    return solids->pairs[at].triangle == triangle && solids->pairs[at].vertex == vertex ? at : -1;
}

static pel_status add_triangle(pel_sim *sim, int32_t tool, int32_t begin, int32_t triangle, pel_error *error)
{
    pel_status status = PEL_OK;
    const pel_rigid *rigid = pel_rigid_of(sim->rigids, sim->model->triangles[triangle][0]);
    bool is_ball = rigid != NULL && rigid->radius > 0;
    for (int c = 0; c < (is_ball ? 1 : 3) && status == PEL_OK; c++) {
        int32_t v = is_ball ? rigid->middle : sim->model->triangles[triangle][c];
        if (find_pair(sim->tools->solids, begin, -1, v) < 0)
            status = add_pair(sim, tool, -1, v, error);
    }
    return status == PEL_OK && !is_ball ? add_pair(sim, tool, triangle, -1, error) : status;
}

static bool is_kept(const pel_solid_pair *pair)
{
    return pair->load > 0;
}

/* before new ones are listed */
static pel_status keep_pairs(pel_sim_solids *solids, pel_error *error)
{
    if (!pel_reserve((void **)&solids->kept, &solids->kept_capacity, (size_t)solids->list.count, sizeof *solids->kept))
        return pel_fail_memory(error);
    solids->kept_count = 0;
    solids->list.active = NULL;
    for (int32_t c = 0; c < solids->list.count; c++)
        if (is_kept(&solids->pairs[c]))
            solids->kept[solids->kept_count++] = solids->pairs[c];
    solids->list.count = 0;
    return PEL_OK;
}

/* copy the loads of the last step to the pairs of a tool from `begin` on */
static void take_kept(pel_sim *sim, int32_t tool, int32_t begin)
{
    pel_sim_solids *solids = sim->tools->solids;
    for (int32_t i = 0; i < solids->kept_count; i++) {
        const pel_solid_pair *old = &solids->kept[i];
        int32_t at = old->tool == tool ? find_pair(solids, begin, old->triangle, old->vertex) : -1;
        if (at < 0)
            continue;
        solids->pairs[at].is_known = true;
        solids->pairs[at].slack = old->slack;
        solids->pairs[at].load = old->load;
        solids->pairs[at].earlier = old->earlier;
        solids->pairs[at].approach = old->approach;
        pel_vec3_copy(old->drag, solids->pairs[at].drag);
    }
}

pel_status pel_solids_find(pel_sim *sim, pel_error *error)
{
    pel_sim_solids *solids = sim->tools->solids;
    pel_status status = keep_pairs(solids, error);
    double longest = pel_sim_longest_edge(sim), motion = pel_sim_fastest_way(sim);
    for (int32_t i = 0; i < sim->tools->count && status == PEL_OK; i++) {
        pel_tool *tool = &sim->tools->items[i];
        int32_t begin = solids->list.count;
        if (!presses(tool))
            continue;
        double margin = NEAR_SHARE * longest + motion + pel_tool_way(tool, &tool->pose_before, &tool->pose_wanted);
        int32_t near_count = pel_tool_near_triangles(sim, tool, &tool->near, sim->state->position, margin);
        for (int32_t n = 0; n < near_count && status == PEL_OK; n++)
            status = add_triangle(sim, i, begin, sim->tools->near_triangles[n], error);
        take_kept(sim, i, begin);
    }
    return status;
}

void pel_solids_mark_carried(const pel_sim *sim, uint8_t *bodies)
{
    const pel_sim_solids *solids = sim->tools->solids;
    for (int32_t c = 0; c < solids->list.count; c++)
        if (solids->list.contacts[c].multiplier > 0 || solids->pairs[c].owed + solids->pairs[c].mean_load > 0)
            bodies[sim->model->body_of_slice[solids->list.contacts[c].vertices[0] / PEL_WIDTH]] = 1;
}

void pel_solids_forget_loads(pel_sim *sim, int32_t body, int32_t tool)
{
    const pel_sim_solids *solids = sim->tools->solids;
    for (int32_t c = 0; c < solids->list.count; c++) {
        pel_solid_pair *pair = &solids->pairs[c];
        if (pair->tool != tool || sim->model->body_of_slice[solids->list.contacts[c].vertices[0] / PEL_WIDTH] != body)
            continue;
        pair->load = pair->earlier = 0;
        memset(pair->drag, 0, sizeof pair->drag);
    }
}

static int32_t body_of(const pel_sim *sim, const pel_solid_pair *pair)
{
    int32_t v = pair->triangle < 0 ? pair->vertex : sim->model->triangles[pair->triangle][0];
    return sim->model->body_of_slice[v / PEL_WIDTH];
}

/* its body is left out of the step */
static bool sleeps(const pel_sim *sim, int32_t c)
{
    const pel_contact_set *contacts = sim->contacts;
    return contacts != NULL && contacts->asleep_count > 0 &&
           contacts->is_asleep[body_of(sim, &sim->tools->solids->pairs[c])];
}

/* m, of the layer of a pair */
static double thickness_of(const pel_sim *sim, const pel_solid_pair *pair)
{
    return sim->layers[body_of(sim, pair)].thickness;
}

double pel_solids_thickness(const pel_sim *sim)
{
    double least = HUGE_VAL;
    for (int32_t b = 0; b < sim->model->body_count; b++)
        least = pel_min(least, sim->layers[b].thickness);
    return least;
}

void pel_solids_recall_loads(pel_sim *sim, double substep)
{
    pel_sim_solids *solids = sim->tools->solids;
    double square = substep * substep;
    pel_contacts_begin(&solids->list, substep);
    pel_travel_restart(&solids->travel);
    solids->list.active = NULL;
    solids->is_moved = solids->moves = false;
    solids->has_slack = false;
    solids->run_count = 0;
    for (int32_t c = 0; c < solids->list.count; c++) {
        pel_contact *contact = &solids->list.contacts[c];
        pel_solid_pair *pair = &solids->pairs[c];
        if (c == 0 || pair->tool != pair[-1].tool || body_of(sim, pair) != body_of(sim, pair - 1))
            solids->runs[solids->run_count++] = (pel_solid_run){.body = body_of(sim, pair), .acts = true};
        solids->runs[solids->run_count - 1].end = c + 1;
        pair->owed = 0;
        memset(pair->owed_drag, 0, sizeof pair->owed_drag);
        solids->calm[c] = sleeps(sim, c) ? HUGE_VAL : 0;
        solids->has_slack |= pair->slack > 0;
        contact->multiplier = (pel_real)(square * pair->load);
        contact->earlier = (pel_real)(square * pair->earlier);
        for (int k = 0; k < 3; k++)
            contact->drag[k] = (pel_real)(square * pair->drag[k]);
    }
}

/* m, the longest way of a tool in this substep */
static double tool_travel(const pel_sim *sim)
{
    double longest = 0;
    for (int32_t i = 0; i < sim->tools->count; i++) {
        const pel_tool *tool = &sim->tools->items[i];
        if (presses(tool))
            longest = pel_max(longest, pel_tool_way(tool, &tool->pose_substep, &tool->pose));
    }
    return longest;
}

void pel_solids_begin_substep(pel_sim *sim, double substep)
{
    pel_sim_solids *solids = sim->tools->solids;
    double ratio = substep / solids->list.substep, way = tool_travel(sim);
    solids->list.substep = substep;
    solids->is_moved = way > 0 || solids->moves;
    solids->moves = way > 0;
    if (solids->list.count > 0)
        pel_travel_follow(&solids->travel, sim->state->position_next, way, sim->pool);
    for (int32_t i = 0; ratio != 1 && i < pel_contact_list_length(&solids->list); i++) {
        pel_contact *contact = pel_contact_list_at(&solids->list, i);
        contact->multiplier *= (pel_real)(ratio * ratio);
        contact->earlier *= (pel_real)(ratio * ratio);
        for (int k = 0; k < 3; k++)
            contact->drag[k] *= (pel_real)(ratio * ratio);
    }
    bool had_slack = solids->has_slack;
    solids->has_slack = false;
    for (int32_t c = 0; had_slack && c < solids->list.count; c++) {
        pel_solid_pair *pair = &solids->pairs[c];
        double gain = thickness_of(sim, pair) * substep / PEL_CONTACT_RECOVERY_TIME;
        if (!sleeps(sim, c))
            pair->slack = pair->slack > gain ? pair->slack - gain : 0;
        solids->has_slack |= pair->slack > 0;
    }
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

/* the half space beyond the surface point that was closest at the start of the substep, for points that pass through
   the tool in it; `before` and `now` are positions of the point in the tool's frame */
static void keep_start_side(const pel_tool *tool, const double before[3], const double now[3], const double point[3],
                            const double normal[3], double distance, pel_contact *contact)
{
    double way[3];
    pel_vec3_subtract(now, before, way);
    set_plane(tool, point, normal, -(distance + pel_vec3_dot(normal, way)), contact);
}

/* A pair that touches for the first time, and did so when the substep began, may be as deep as it was then. */
static void find_slack(pel_sim_solids *solids, pel_solid_pair *pair, double distance, double distance_before)
{
    if (pair->is_known || !(distance < 0))
        return;
    pair->is_known = true;
    pair->slack = distance_before < 0 ? -distance_before : 0;
    solids->has_slack |= pair->slack > 0;
}

/* m, by which the load of a contact moves its point */
static double moved_by_load(const pel_sim *sim, const pel_contact *contact)
{
    double sum = 0;
    for (int i = 0; i < 4; i++) {
        double weight = (double)contact->weights[i];
        sum += (double)sim->state->position_next[contact->vertices[i]][3] * weight * weight;
    }
    return sum * (double)contact->multiplier;
}

/* The load of a layer begins softly: at a gap g it is k (s - g)^2 / (4 s) where |g| is less than the span s [m], and
   -k g farther in. So what a gliding tool comes to is not hit, and its force hardly jumps. Where the tool may sink in
   (without contact) a load is carried where the tool is: the layer neither adds to the size of the tool nor takes from
   it. No gap has less load than without the span, so that with contact the thickness is kept as well. The contact is
   the tangent where the kept load takes the point. Returns the gap from that at which the tangent carries no load. */
static double begin_softly(const pel_sim *sim, double gap, double span, int count, pel_contact *contact)
{
    double end = gap + moved_by_load(sim, contact), compliance = compliance_of(sim, contact, 0, count);
    bool is_soft = fabs(end) < span;
    contact->compliance = (pel_real)(is_soft ? 2 * span / (span - end) * compliance : compliance);
    if (is_soft)
        return gap - 0.5 * (end + span);
    return end < 0 ? gap : gap - span;
}

/* m. With contact triangles of filled tissue carry a round tool as well, and begin as softly. */
static double soft_span(const pel_sim *sim, const pel_solid_pair *pair)
{
    const pel_body *body = &sim->model->bodies[body_of(sim, pair)];
    double thickness = thickness_of(sim, pair);
    bool is_tissue = body->is_foundation && pel_tool_is_round(&sim->tools->items[pair->tool]);
    if (sim->contacts == NULL)
        return pair->triangle < 0 ? SOFT_SHARE * thickness : 0;
    return is_tissue ? TISSUE_SHARE * sim->contacts->mean_edge : 0;
}

/* With contact a layer stops what comes to it within half of its thickness, as between surfaces: beyond it the guard
   would step the point back, in a step however short. A layer that begins softly is for what glides. */
static void find_approach(const pel_sim *sim, const pel_record *start, pel_solid_pair *pair, pel_contact *contact)
{
    double way = 0;
    if (sim->contacts == NULL || soft_span(sim, pair) > 0)
        return;
    for (int k = 0; k < 3; k++) {
        double moved = -(double)contact->drift[k];
        for (int i = 0; i < 4; i++) {
            int32_t v = contact->vertices[i];
            moved += (double)contact->weights[i] * (double)(sim->state->position_next[v][k] - start[v][k]);
        }
        way -= moved * (double)contact->normal[k];
    }
    if (!(contact->multiplier > 0))
        pair->approach = pel_max(way, 0) / sim->tools->solids->list.substep;
    contact->compliance = (pel_real)compliance_of(sim, contact, pair->approach, pair->triangle < 0 ? 1 : 3);
}

/* returns how far the vertex may go before the next look, 0 = not at all [m] */
static double refresh_vertex(const pel_sim *sim, const pel_record *start, pel_solid_pair *pair, pel_contact *contact)
{
    int32_t v = pair->vertex;
    const pel_tool *tool = &sim->tools->items[pair->tool];
    PEL_ASSERT_INDEX(v, sim->model->vertex_count);
    double x[3], local[3], before[3], normal[3], normal_before[3], side[3];
    pel_vertex_position(sim->state->position_next, v, x);
    pel_pose_to_local(&tool->pose, x, local);
    const pel_solid solid = pel_tool_press_solid(sim, tool, v);
    double radius = pel_rigid_radius(sim->rigids, v), distance = pel_solid_distance(&solid, local, normal) - radius;
    start_in_tool(tool, start, v, before);
    double way = pel_vec3_distance(local, before);
    bool is_fast = way >= FAST_SHARE * pel_solid_least_half_width(&solid);
    double distance_before =
        is_fast || (distance < 0 && !pair->is_known) ? pel_solid_distance(&solid, before, normal_before) - radius : 0;
    find_slack(sim->tools->solids, pair, distance, distance_before);
    if (is_fast && distance_before < way && pel_vec3_dot(normal, normal_before) < TURNED) {
        keep_start_side(tool, before, local, x, normal_before, distance_before, contact);
        return 0;
    }
    double thickness = thickness_of(sim, pair), span = soft_span(sim, pair);
    double room = distance - span;
    pel_rotate(tool->pose.rotation, normal, side);
    pel_vec3_along(x, -radius, side, x);
    set_plane(tool, x, normal, radius - begin_softly(sim, distance + pair->slack, span, 1, contact), contact);
    find_approach(sim, start, pair, contact);
    bool is_far = !(contact->multiplier > 0) && room > PEL_CONTACT_NEAR_SHARE * thickness;
    pair->is_near = !is_far;
    return is_far ? ROOM_SHARE * room : KEEP_SHARE * thickness;
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

/* how deep a triangle was in the tool when the substep began */
static double depth_before(const pel_sim *sim, const pel_record *start, const pel_solid_pair *pair)
{
    double before[3][3], weights[3], normal[3];
    for (int c = 0; c < 3; c++)
        start_in_tool(&sim->tools->items[pair->tool], start, sim->model->triangles[pair->triangle][c], before[c]);
    return pel_solid_depth(&pair->solid, before[0], before[1], before[2], weights, normal);
}

/* the same for the corners of a triangle */
static double refresh_triangle(const pel_sim *sim, const pel_record *start, pel_solid_pair *pair, pel_contact *contact)
{
    double corner[3][3], local[3][3], weights[3], normal[3], point[3] = {0, 0, 0};
    const pel_tool *tool = &sim->tools->items[pair->tool];
    const pel_solid *solid = &pair->solid;
    int32_t t = pair->triangle;
    for (int c = 0; c < 3; c++) {
        pel_vertex_position(sim->state->position_next, sim->model->triangles[t][c], corner[c]);
        pel_pose_to_local(&tool->pose, corner[c], local[c]);
    }
    double room = pel_solid_corner_room(solid, (const double(*)[3])local), keep = KEEP_SHARE * thickness_of(sim, pair);
    bool is_vertex = room >= 0;
    double span = soft_span(sim, pair);
    const pel_solid reach = span > 0 ? pel_solid_grown(solid, span) : *solid;
    double depth = is_vertex ? 0 : pel_solid_depth(&reach, local[0], local[1], local[2], weights, normal);
    if (!is_vertex && pel_solid_is_round(solid) &&
        is_passed(sim, start, pair, local, depth > 0 ? normal : NULL, contact))
        return 0;
    if (!(depth > 0) || pel_max(weights[0], pel_max(weights[1], weights[2])) > CORNER_WEIGHT) {
        pel_contact_switch_off(contact);
        pair->is_near = false;
        if (!is_vertex && depth < 0 && pel_solid_is_round(solid))
            room = -ROOM_SHARE * depth;
        return pel_max(keep, room);
    }
    for (int c = 0; c < 3; c++) {
        contact->weights[c] = (pel_real)weights[c];
        pel_vec3_along(point, weights[c], corner[c], point);
    }
    depth -= span;
    if (!pair->is_known)
        find_slack(sim->tools->solids, pair, -depth, -depth_before(sim, start, pair));
    if (span > 0)
        depth = -begin_softly(sim, pair->slack - depth, span, 3, contact);
    else
        depth -= pair->slack;
    set_plane(tool, point, normal, depth, contact);
    find_approach(sim, start, pair, contact);
    return keep;
}

static void refresh_pair(const pel_sim *sim, const pel_record *start, int32_t c)
{
    pel_sim_solids *solids = sim->tools->solids;
    pel_solid_pair *pair = &solids->pairs[c];
    pel_contact *contact = &solids->list.contacts[c];
    pair->is_near = true;
    double room =
        pair->triangle < 0 ? refresh_vertex(sim, start, pair, contact) : refresh_triangle(sim, start, pair, contact);
    bool is_calm = room > 0 && !(pair->is_near && pair->slack > 0);
    solids->calm[c] = is_calm ? solids->travel.way[body_of(sim, pair)] + room : 0;
}

static void list_active(const pel_sim *sim)
{
    pel_sim_solids *solids = sim->tools->solids;
    solids->list.active = solids->active;
    solids->list.active_count = 0;
    int32_t c = 0;
    for (pel_solid_run *run = solids->runs; run < solids->runs + solids->run_count; c = run->end, run++) {
        if (!run->acts)
            continue;
        *run = (pel_solid_run){.body = run->body, .end = run->end, .calm = HUGE_VAL};
        for (; c < run->end; c++) {
            run->calm = pel_min(run->calm, solids->calm[c]);
            if ((!solids->pairs[c].is_near && !(solids->list.contacts[c].multiplier > 0)) || sleeps(sim, c))
                continue;
            solids->active[solids->list.active_count++] = c;
            run->acts = true;
        }
    }
}

/* whether a pair is to be looked at: one of a run, any */
static bool is_restless(const pel_sim_solids *solids, const pel_solid_run *run)
{
    return !(solids->travel.way[run->body] < run->calm);
}

static bool needs_look(const pel_sim *sim)
{
    const pel_sim_solids *solids = sim->tools->solids;
    bool needs = solids->is_moved || solids->list.active == NULL;
    for (int32_t r = 0; r < solids->run_count && !needs; r++)
        needs = is_restless(solids, &solids->runs[r]);
    return needs;
}

/* the loads of past substeps become forces of the step */
static void tell(pel_sim *sim)
{
    const pel_sim_solids *solids = sim->tools->solids;
    double square = solids->list.substep * solids->list.substep * sim->solver.substeps;
    for (int32_t i = 0; solids->list.active != NULL && i < solids->list.active_count; i++) {
        pel_contact contact = *pel_contact_list_at(&solids->list, i);
        pel_solid_pair *pair = &solids->pairs[solids->active[i]];
        if (!(pair->owed > 0))
            continue;
        pair->mean_load += pair->owed;
        contact.multiplier = (pel_real)(square * pair->owed);
        for (int k = 0; k < 3; k++) {
            pair->mean_drag[k] += pair->owed_drag[k];
            contact.drag[k] = (pel_real)(square * pair->owed_drag[k]);
            pair->owed_drag[k] = 0;
        }
        pair->owed = 0;
        pel_contact_take(sim, pair->tool, &contact, 1 / square);
    }
}

void pel_solids_refresh(pel_sim *sim, const pel_record *start, bool is_first)
{
    pel_sim_solids *solids = sim->tools->solids;
    if (!is_first && solids->list.count > 0)
        pel_travel_follow(&solids->travel, sim->state->position_next, 0, sim->pool);
    if (solids->run_count == 0 || !needs_look(sim))
        return;
    tell(sim);
    bool follows_any = solids->is_moved && is_first;
    int32_t c = 0;
    for (pel_solid_run *run = solids->runs; run < solids->runs + solids->run_count; c = run->end, run++) {
        run->acts |= follows_any || is_restless(solids, run);
        for (; run->acts && c < run->end; c++) {
            /* planes follow a tool */
            bool follows = follows_any && solids->pairs[c].is_near;
            bool is_calm = !follows && solids->calm[c] > solids->travel.way[run->body];
            /* freeze the plane of a loaded contact within the substep, as in contact/refresh.c */
            if (!is_calm && !sleeps(sim, c) && (is_first || !(solids->list.contacts[c].multiplier > 0)))
                refresh_pair(sim, start, c);
        }
    }
    list_active(sim);
    pel_contact_patches_thin(&solids->patches, &solids->list, solids->active, sim->state->position_next);
}

void pel_solids_keep_means(const pel_sim *sim, const uint8_t *fell_asleep)
{
    const pel_sim_solids *solids = sim->tools->solids;
    for (int32_t c = 0; solids != NULL && c < solids->list.count; c++) {
        pel_solid_pair *pair = &solids->pairs[c];
        if (!fell_asleep[sim->model->body_of_slice[solids->list.contacts[c].vertices[0] / PEL_WIDTH]])
            continue;
        pair->load = pair->earlier = pair->mean_load;
        pel_vec3_copy(pair->mean_drag, pair->drag);
    }
}

void pel_solids_tally_asleep(pel_sim *sim)
{
    const pel_sim_solids *solids = sim->tools->solids;
    for (int32_t c = 0; c < solids->list.count; c++) {
        const pel_solid_pair *pair = &solids->pairs[c];
        pel_contact *contact = &solids->list.contacts[c];
        if (!(pair->load > 0) || !sleeps(sim, c))
            continue;
        contact->multiplier = (pel_real)pair->load;
        for (int k = 0; k < 3; k++)
            contact->drag[k] = (pel_real)pair->drag[k];
        refresh_pair(sim, sim->state->position, c);
        if (contact->multiplier > 0)
            pel_contact_take(sim, pair->tool, contact, 1);
    }
}

void pel_solids_tally(pel_sim *sim, double rate)
{
    const pel_sim_solids *solids = sim->tools->solids;
    for (int32_t i = 0; i < pel_contact_list_length(&solids->list); i++) {
        const pel_contact *contact = pel_contact_list_at(&solids->list, i);
        pel_solid_pair *pair = &solids->pairs[contact - solids->list.contacts];
        if (!(contact->multiplier > 0))
            continue;
        pair->owed += rate * (double)contact->multiplier;
        for (int k = 0; k < 3; k++)
            pair->owed_drag[k] += rate * (double)contact->drag[k];
    }
}

void pel_solids_keep_loads(pel_sim *sim)
{
    const pel_sim_solids *solids = sim->tools->solids;
    double rate = 1 / (solids->list.substep * solids->list.substep);
    tell(sim);
    for (int32_t c = 0; c < solids->list.count; c++) {
        const pel_contact *contact = &solids->list.contacts[c];
        pel_solid_pair *pair = &solids->pairs[c];
        if (sleeps(sim, c))
            continue;
        pair->load = rate * (double)contact->multiplier;
        pair->earlier = rate * (double)contact->earlier;
        for (int k = 0; k < 3; k++)
            pair->drag[k] = rate * (double)contact->drag[k];
    }
}

/* ---- from step to step ---- */

void pel_solids_release(pel_sim *sim)
{
    pel_sim_solids *solids = sim->tools->solids;
    const pel_refined_model *active = sim->active;
    for (int32_t c = 0; solids != NULL && c < solids->list.count; c++)
        for (int32_t r = 0; solids->pairs[c].triangle < 0 && r < active->released_count; r++)
            if (solids->pairs[c].vertex == active->released[r])
                solids->pairs[c].load = 0;
}

/* what a snapshot has of a pair */
typedef struct pair_numbers {
    int32_t tool, triangle, vertex, unused;
    double slack, load, earlier, approach, drag[3];
} pair_numbers;

static void save_pair(pel_cursor *at, const pel_solid_pair *pair)
{
    pair_numbers numbers = {.tool = pair->tool,
                            .triangle = pair->triangle,
                            .vertex = pair->vertex,
                            .slack = pair->slack,
                            .load = pair->load,
                            .earlier = pair->earlier,
                            .approach = pair->approach};
    pel_vec3_copy(pair->drag, numbers.drag);
    pel_transfer(at, &numbers, sizeof numbers);
}

static void load_pair(pel_cursor *at, pel_solid_pair *pair)
{
    pair_numbers numbers = {0};
    pel_transfer(at, &numbers, sizeof numbers);
    *pair = (pel_solid_pair){.tool = numbers.tool,
                             .triangle = numbers.triangle,
                             .vertex = numbers.vertex,
                             .slack = numbers.slack,
                             .load = numbers.load,
                             .earlier = numbers.earlier,
                             .approach = numbers.approach};
    pel_vec3_copy(numbers.drag, pair->drag);
}

static int64_t count_kept(const pel_sim_solids *solids)
{
    int64_t count = 0;
    for (int32_t c = 0; c < solids->list.count; c++)
        count += is_kept(&solids->pairs[c]);
    return count;
}

void pel_solids_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused)
{
    (void)unused;
    pel_sim_solids *solids = sim->tools->solids;
    if (solids == NULL)
        return;
    int64_t count = count_kept(solids);
    pel_transfer_count(at, &count, sizeof(pair_numbers));
    if (at->load) {
        at->is_short |= count > INT32_MAX;
        solids->list.count = 0;
        at->is_full |= !at->is_short && !make_room(solids, (size_t)count);
        solids->list.count = at->is_short || at->is_full ? 0 : (int32_t)count;
    }
    for (int32_t c = 0; c < solids->list.count; c++) {
        if (at->load)
            load_pair(at, &solids->pairs[c]);
        else if (is_kept(&solids->pairs[c]))
            save_pair(at, &solids->pairs[c]);
    }
}

static bool is_whole(const pel_sim *sim, const pel_solid_pair *pair)
{
    const pel_model *model = sim->model;
    if (pair->tool < 0 || pair->tool >= sim->tools->count || !presses(&sim->tools->items[pair->tool]))
        return false;
    if (!(pair->load >= 0 && pair->earlier >= 0 && pair->slack >= 0 && pair->approach >= 0) ||
        !isfinite(pair->load + pair->earlier + pair->slack + pair->approach + pair->drag[0] + pair->drag[1] +
                  pair->drag[2]))
        return false;
    if (pair->triangle < 0)
        return pair->triangle == -1 && pair->vertex >= 0 && pair->vertex < model->vertex_count;
    return pair->vertex == -1 && pair->triangle < model->triangle_begin[model->body_count];
}

bool pel_solids_restore(pel_sim *sim)
{
    pel_sim_solids *solids = sim->tools->solids;
    for (int32_t c = 0; solids != NULL && c < solids->list.count; c++)
        if (!is_whole(sim, &solids->pairs[c])) {
            solids->list.count = 0;
            return false;
        }
    return true;
}

pel_status pel_solids_take_over(pel_sim *sim, const pel_sim *from, pel_error *error)
{
    const pel_sim_solids *old = from->tools->solids;
    pel_sim_solids *solids = sim->tools->solids;
    if (old == NULL || solids == NULL)
        return PEL_OK;
    if (!make_room(solids, (size_t)old->list.count))
        return pel_fail_memory(error);
    for (int32_t c = 0; c < old->list.count; c++) {
        pel_solid_pair pair = old->pairs[c];
        pair.tool = pel_sim_find_tool(sim, from->tools->items[pair.tool].name);
        if (is_kept(&pair) && is_whole(sim, &pair))
            solids->pairs[solids->list.count++] = pair;
    }
    return PEL_OK;
}
