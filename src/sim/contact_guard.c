/* The guard: no step ends with an intersection that it did not begin with.

   Every vertex goes a share s of its way from the start x0 of the step to the end x1, at first 1; so does every tool.
   A conflict is a pair that comes nearer than it may on the ways x0 .. x0 + s (x1 - x0), by the conservative test,
   which misses none. While there are conflicts, shares fall:

     rounds 0 .. 3    of the vertices and tools of each connected group of conflicts, by 0.9 times the earliest time of
                      impact in it
     rounds 4 .. 11   those of conflicts, and ever more rings of vertices around them, to 0
     round 12         all, to 0

   A pair whose points all have share 0 does not move, hence is as free as at the start: it is no conflict. So the loop
   ends after 13 rounds at the latest, and ends free: without a conflict no two features that have no vertex in common
   touch on the way, and an intersection of two triangles that was not there begins with such a touch, also where they
   are neighbours. End positions are rounded to pel_real before they are tested.

   How near may a pair come? To the guarded distance; when it starts nearer than that, to 0.99 of where it starts, so
   that it can part and slide but not close in. */
#include "sim/contact.h"

#include "base/memory.h"
#include "base/status.h"
#include "sim/tool.h"

#include <string.h>

enum { SCALED_ROUNDS = 4, LAST_ROUND = 12, HITS_OF_CHUNK = 64 };

#define APPROACH 0.99
#define SAFE_TIME 0.9
#define LEAST_SHARE 0.02
#define NO_IMPACT 2.0

/* ---- conflicts ---- */

typedef struct check {
    const pel_sim_contacts *contacts;
    const pel_collision_result *found;
} check;

static double start_distance(const pel_sim_contacts *contacts, const pel_collision *hit)
{
    const double(*x)[3] = (const double(*)[3])contacts->start;
    const int32_t *v = hit->vertices;
    double weights[4];
    double square = hit->edge_edge ? pel_closest_segment_segment(x[v[0]], x[v[1]], x[v[2]], x[v[3]], weights)
                                   : pel_closest_point_triangle(x[v[0]], x[v[1]], x[v[2]], x[v[3]], weights);
    return sqrt(square);
}

/* the most that the points of both sides can come nearer to each other */
static double longest_approach(const double start[4][3], const double end[4][3], bool edge_edge)
{
    double side[2] = {0, 0};
    for (int i = 0; i < 4; i++) {
        double *longest = &side[i >= (edge_edge ? 2 : 1)];
        *longest = fmax(*longest, pel_vec3_distance(start[i], end[i]));
    }
    return side[0] + side[1];
}

/* time of impact of what the guard minds, NO_IMPACT when there is none */
static double impact_time(const pel_sim_contacts *contacts, const pel_collision *hit)
{
    double start[4][3], end[4][3], distance = start_distance(contacts, hit);
    for (int i = 0; i < 4; i++) {
        pel_vec3_copy(contacts->start[hit->vertices[i]], start[i]);
        pel_vec3_copy(contacts->end[hit->vertices[i]], end[i]);
    }
    double approach = longest_approach((const double(*)[3])start, (const double(*)[3])end, hit->edge_edge);
    double separation = fmin(contacts->guarded, APPROACH * distance);
    /* twice, to be far from rounding */
    if (approach == 0 || distance - 2 * approach > separation)
        return NO_IMPACT;
    pel_ccd_hit impact;
    double tolerance = 1e-3 * separation;
    bool hits =
        hit->edge_edge
            ? pel_ccd_edge_edge((const double(*)[3])start, (const double(*)[3])end, separation, tolerance, &impact)
            : pel_ccd_vertex_face((const double(*)[3])start, (const double(*)[3])end, separation, tolerance, &impact);
    return hits ? impact.time_of_impact : NO_IMPACT;
}

static void check_chunk(void *context, int32_t chunk)
{
    const check *c = context;
    int64_t begin = (int64_t)chunk * HITS_OF_CHUNK, end = begin + HITS_OF_CHUNK;
    for (int64_t i = begin; i < end && i < c->found->collision_count; i++)
        c->contacts->times[i] = impact_time(c->contacts, &c->found->collisions[i]);
}

pel_status pel_contact_add_conflict(pel_sim_contacts *contacts, const pel_conflict *conflict, pel_error *error)
{
    if (!pel_reserve((void **)&contacts->conflicts, &contacts->conflict_capacity, contacts->conflict_count + 1,
                     sizeof *contacts->conflicts))
        return pel_fail_memory(error);
    contacts->conflicts[contacts->conflict_count++] = *conflict;
    return PEL_OK;
}

static pel_status add_hit(pel_sim *sim, const pel_collision *hit, double time, pel_error *error)
{
    pel_conflict conflict = {.tool = -1, .time = time};
    for (int i = 0; i < 4; i++) {
        int32_t tool = pel_contact_tool_of(sim, hit->vertices[i]);
        conflict.places[i] = tool < 0 ? hit->vertices[i] : -1;
        conflict.tool = tool < 0 ? conflict.tool : tool;
    }
    return pel_contact_add_conflict(sim->contacts, &conflict, error);
}

pel_status pel_contact_find_conflicts(pel_sim *sim, const pel_collision_result *found, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    contacts->conflict_count = 0;
    if (!pel_reserve((void **)&contacts->times, &contacts->time_capacity, (size_t)found->collision_count,
                     sizeof *contacts->times))
        return pel_fail_memory(error);
    check all = {contacts, found};
    pel_pool_run(sim->pool, (int32_t)((found->collision_count + HITS_OF_CHUNK - 1) / HITS_OF_CHUNK), check_chunk, &all);
    pel_status status = PEL_OK;
    for (int64_t i = 0; status == PEL_OK && i < found->collision_count; i++) {
        const pel_collision *hit = &found->collisions[i];
        if (contacts->times[i] > 1 || (contacts->tangles.count > 0 && pel_tangles_have(contacts, hit)))
            continue;
        status = add_hit(sim, hit, contacts->times[i], error);
    }
    return status == PEL_OK ? pel_contact_round_conflicts(sim, error) : status;
}

/* ---- groups ---- */

static int32_t find_group(int32_t *group, int32_t node)
{
    while (group[node] != node)
        node = group[node] = group[group[node]];
    return node;
}

static void join(int32_t *group, int32_t a, int32_t b)
{
    a = find_group(group, a);
    b = find_group(group, b);
    if (a < b)
        group[b] = a;
    else
        group[a] = b;
}

/* the nodes of a conflict: places, then the tool; returns how many */
static int nodes_of(const pel_sim_contacts *contacts, const pel_conflict *conflict, int32_t nodes[5])
{
    int count = 0;
    for (int i = 0; i < 4; i++)
        if (conflict->places[i] >= 0)
            nodes[count++] = conflict->places[i];
    if (conflict->tool >= 0)
        nodes[count++] = contacts->place_count + conflict->tool;
    return count;
}

/* each group of conflicts goes on to 0.9 of its earliest impact */
static void scale_groups(pel_sim_contacts *contacts, int32_t node_count)
{
    int32_t nodes[5];
    for (int32_t i = 0; i < node_count; i++) {
        contacts->group[i] = i;
        contacts->group_share[i] = 1;
    }
    for (size_t c = 0; c < contacts->conflict_count; c++) {
        int count = nodes_of(contacts, &contacts->conflicts[c], nodes);
        for (int i = 1; i < count; i++)
            join(contacts->group, nodes[0], nodes[i]);
    }
    for (size_t c = 0; c < contacts->conflict_count; c++) {
        nodes_of(contacts, &contacts->conflicts[c], nodes);
        double *share = &contacts->group_share[find_group(contacts->group, nodes[0])];
        *share = fmin(*share, SAFE_TIME * contacts->conflicts[c].time);
    }
    for (int32_t i = 0; i < node_count; i++) {
        double share = contacts->shares[i] * contacts->group_share[find_group(contacts->group, i)];
        contacts->shares[i] = share < LEAST_SHARE ? 0 : share;
    }
}

/* conflicts and some rings around them stay where they were; group is scratch: 1 = to be stopped */
static void stop_conflicts(pel_sim_contacts *contacts, int32_t node_count, int rings)
{
    int32_t nodes[5];
    memset(contacts->group, 0, (size_t)node_count * sizeof *contacts->group);
    for (size_t c = 0; c < contacts->conflict_count; c++)
        for (int i = nodes_of(contacts, &contacts->conflicts[c], nodes) - 1; i >= 0; i--)
            contacts->group[nodes[i]] = 1;
    for (int ring = 1; ring <= rings; ring++)
        for (int32_t t = 0; t < contacts->triangle_count; t++) {
            const int32_t *v = contacts->triangles[t];
            if (v[0] >= contacts->place_count)
                continue;
            for (int i = 0; i < 3; i++)
                if (contacts->group[v[i]] >= 1 && contacts->group[v[i]] <= ring)
                    for (int k = 0; k < 3; k++)
                        if (contacts->group[v[k]] == 0)
                            contacts->group[v[k]] = ring + 1;
        }
    for (int32_t i = 0; i < node_count; i++)
        if (contacts->group[i] != 0)
            contacts->shares[i] = 0;
}

static void fall_back(pel_sim_contacts *contacts, int32_t node_count, int round)
{
    if (round < SCALED_ROUNDS)
        scale_groups(contacts, node_count);
    else if (round < LAST_ROUND)
        stop_conflicts(contacts, node_count, round - SCALED_ROUNDS);
    else
        memset(contacts->shares, 0, (size_t)node_count * sizeof *contacts->shares);
}

/* ---- positions ---- */

static void move_places(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    pel_state *state = sim->state;
    for (int32_t p = 0; p < contacts->place_count; p++) {
        double share = contacts->shares[p];
        if (share >= 1)
            continue;
        for (int k = 0; k < 3; k++) {
            double x = contacts->start[p][k] + share * (contacts->solved[p][k] - contacts->start[p][k]);
            state->position_next[p][k] = share > 0 ? (pel_real)x : state->position[p][k];
            contacts->end[p][k] = (double)state->position_next[p][k];
        }
    }
}

static void move_tools(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    for (int32_t i = 0; i < sim->tool_count; i++) {
        pel_tool *tool = &sim->tools[i];
        double share = contacts->shares[contacts->place_count + i];
        if (share >= 1)
            continue;
        tool->blocked = true;
        pel_tool_pose_between(&tool->pose_before, &contacts->wanted[i], share, &tool->pose);
        pel_contact_tool_points(&contacts->tools[i], &tool->pose, contacts->end);
    }
}

static void finish(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    pel_state *state = sim->state;
    for (int32_t p = 0; p < contacts->place_count; p++) {
        if (contacts->shares[p] >= 1)
            continue;
        contacts->statistics.fall_backs += sim->model->mesh_vertex[p] >= 0;
        for (int k = 0; k < 3 && state->velocity_next != NULL; k++)
            state->velocity_next[p][k] += (pel_real)((contacts->end[p][k] - contacts->solved[p][k]) / sim->step.dt);
    }
    for (int32_t i = 0; i < sim->tool_count; i++)
        contacts->statistics.tools_held += contacts->shares[contacts->place_count + i] < 1;
}

static pel_status look(pel_sim *sim, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    pel_collision_query query = pel_collision_query_default();
    query.start = (const double *)contacts->start;
    query.end = (const double *)contacts->end;
    query.min_separation = contacts->guarded;
    pel_collision_result found;
    pel_status status = pel_collider_detect(contacts->collider, &query, &found, error);
    return status == PEL_OK ? pel_contact_find_conflicts(sim, &found, error) : status;
}

pel_status pel_contact_guard(pel_sim *sim, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    int32_t node_count = contacts->place_count + sim->tool_count;
    memcpy(contacts->solved, contacts->end, (size_t)contacts->place_count * sizeof *contacts->solved);
    for (int32_t i = 0; i < node_count; i++)
        contacts->shares[i] = 1;
    for (int32_t i = 0; i < sim->tool_count; i++)
        contacts->wanted[i] = sim->tools[i].pose;
    for (int round = 0; contacts->conflict_count > 0; round++) {
        fall_back(contacts, node_count, round);
        move_places(sim);
        move_tools(sim);
        contacts->conflict_count = 0;
        if (round == LAST_ROUND)
            break;
        pel_status status = look(sim, error);
        if (status != PEL_OK)
            return status;
    }
    finish(sim);
    return PEL_OK;
}
