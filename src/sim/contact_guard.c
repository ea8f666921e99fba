/* The guard: no step ends with an intersection that it did not begin with.

   A conflict is a pair that comes nearer than it may between the start x0 of the step and its end x1, all points going
   straight, by the conservative test, which misses none. While there are conflicts the ways get shorter:

     rounds 0 .. 15   the points of conflicts, connected ones together, become zones (the impact zones of Provot 1997
   and Bridson et al. 2002, without rotation). A zone moves by the mean of its ways, weighted with mass, so that its
   momentum stays, and its points move against that by a share of their own ways, which every conflict makes smaller:
   0.9 of the time of impact. In the end it moves as one. A zone with a tool, or a vertex that cannot move, has no mean:
   its ways shrink towards where they began, and so does that of the tool, with all that it holds rounds 16 .. 21  the
   points of conflicts, and ever more rings around them, stay where they were round 22         everything stays

   A pair whose points all stay is as free as at the start: it is no conflict. So the loop ends after 23 rounds at the
   latest, and it ends free: without a conflict no two features that have no vertex in common touch on the way, and an
   intersection of two triangles that was not there begins with such a touch, also where they are neighbours. End
   positions are rounded to pel_real before they are tested.

   How near may a pair come? To the guarded distance; when it starts nearer than that, to 0.99 of where it starts, so
   that it can part and slide but not close in. */
#include "sim/contact.h"

#include "base/memory.h"
#include "base/status.h"
#include "sim/tool.h"

#include <string.h>

enum { ZONE_ROUNDS = 16, LAST_ROUND = 22, HITS_OF_CHUNK = 64 };

#define APPROACH 0.99
#define SAFE_TIME 0.9
#define LEAST_SHARE 0.02
#define NO_IMPACT 2.0

/* ---- conflicts ---- */

typedef struct check {
    const pel_sim_contacts *contacts;
    const pel_collision_result *found;
} check;

double pel_contact_start_distance(const pel_sim_contacts *contacts, const pel_collision *hit)
{
    const double(*x)[3] = (const double(*)[3])contacts->start;
    const int32_t *v = hit->vertices;
    double weights[4];
    double square = hit->edge_edge ? pel_closest_segment_segment(x[v[0]], x[v[1]], x[v[2]], x[v[3]], weights)
                                   : pel_closest_point_triangle(x[v[0]], x[v[1]], x[v[2]], x[v[3]], weights);
    return sqrt(square);
}

/* the most that the points of both sides can come nearer to each other */
static double longest_approach(const pel_sim_contacts *contacts, const pel_collision *hit)
{
    double side[2] = {0, 0};
    for (int i = 0; i < 4; i++) {
        int32_t point = hit->vertices[i];
        double *longest = &side[i >= (hit->edge_edge ? 2 : 1)];
        *longest = fmax(*longest, pel_vec3_distance(contacts->start[point], contacts->end[point]));
    }
    return side[0] + side[1];
}

/* impact of what the guard minds */
static pel_timed_hit find_impact(const pel_sim_contacts *contacts, const pel_collision *hit)
{
    pel_timed_hit impact = {.hit.time_of_impact = NO_IMPACT}, found = impact;
    double distance = pel_contact_start_distance(contacts, hit), approach = longest_approach(contacts, hit);
    double separation = fmin(contacts->guarded, APPROACH * distance);
    /* twice, to be far from rounding */
    if (approach == 0 || distance - 2 * approach > separation)
        return impact;
    const pel_ccd_batch batch = {.start = contacts->start[0],
                                 .end = contacts->end[0],
                                 .points = hit->vertices,
                                 .query_count = 1,
                                 .edge_edge = hit->edge_edge,
                                 .min_separation = separation,
                                 .tolerance = 1e-3 * separation};
    pel_ccd_statistics statistics = {0};
    int32_t number;
    if (pel_ccd_solve_batch(&batch, &number, &found.hit, &statistics) > 0)
        impact = found;
    impact.is_solved = statistics.cubics > 0;
    return impact;
}

static void check_chunk(void *context, int32_t chunk)
{
    const check *c = context;
    int64_t begin = (int64_t)chunk * HITS_OF_CHUNK, end = begin + HITS_OF_CHUNK;
    for (int64_t i = begin; i < end && i < c->found->collision_count; i++)
        c->contacts->impacts[i] = find_impact(c->contacts, &c->found->collisions[i]);
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
    if (!pel_reserve((void **)&contacts->impacts, &contacts->impact_capacity, (size_t)found->collision_count,
                     sizeof *contacts->impacts))
        return pel_fail_memory(error);
    check all = {contacts, found};
    pel_pool_run(sim->pool, (int32_t)((found->collision_count + HITS_OF_CHUNK - 1) / HITS_OF_CHUNK), check_chunk, &all);
    pel_status status = PEL_OK;
    for (int64_t i = 0; status == PEL_OK && i < found->collision_count; i++) {
        const pel_collision *hit = &found->collisions[i];
        const pel_timed_hit *impact = &contacts->impacts[i];
        contacts->statistics.cubics += impact->is_solved;
        if (impact->hit.time_of_impact > 1 || (contacts->tangles.count > 0 && pel_tangles_have(contacts, hit)))
            continue;
        status = add_hit(sim, hit, impact->hit.time_of_impact, error);
    }
    return status == PEL_OK ? pel_contact_round_conflicts(sim, error) : status;
}

/* ---- zones ---- */

static int32_t find_zone(pel_zone *zones, int32_t node)
{
    while (zones[node].parent != node)
        node = zones[node].parent = zones[zones[node].parent].parent;
    return node;
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

/* every node a zone of its own, going all of its way */
static void begin_zones(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    for (int32_t i = 0; i < contacts->place_count + sim->tool_count; i++) {
        pel_zone *zone = &contacts->zones[i];
        *zone = (pel_zone){.parent = i, .leader = i, .share = 1, .is_held = true};
        if (i >= contacts->place_count || sim->model->inverse_mass[i] <= 0)
            continue;
        double mass = (double)sim->model->mass[i];
        *zone = (pel_zone){.parent = i, .leader = i, .share = 1, .mass = mass};
        for (int k = 0; k < 3; k++)
            zone->momentum[k] = mass * (contacts->solved[i][k] - contacts->start[i][k]);
    }
    for (int32_t b = 0; b < sim->model->body_count; b++)
        contacts->body_shares[b] = 1;
    /* what a tool holds goes with it */
    for (int32_t i = 0; i < sim->tool_count; i++)
        for (int32_t k = 0; k < sim->tools[i].held_count; k++) {
            pel_zone *zone = &contacts->zones[sim->tools[i].held[k]];
            zone->leader = contacts->place_count + i;
            zone->is_held = true;
        }
}

/* returns the zone of both */
static int32_t join(pel_zone *zones, int32_t a, int32_t b)
{
    a = find_zone(zones, a);
    b = find_zone(zones, b);
    if (a == b)
        return a;
    pel_zone *kept = &zones[a < b ? a : b];
    const pel_zone *gone = &zones[a < b ? b : a];
    kept->is_joined = true;
    kept->is_held |= gone->is_held;
    kept->mass += gone->mass;
    pel_vec3_add(kept->momentum, gone->momentum, kept->momentum);
    zones[a < b ? b : a].parent = a < b ? a : b;
    return a < b ? a : b;
}

/* A zone that flies far in one step would tear what it meets along, and what it belongs to would fly on without it. */
static bool goes_far(const pel_sim_contacts *contacts, const pel_zone *zone)
{
    return zone->is_joined && !zone->is_held &&
           pel_vec3_length(zone->momentum) > PEL_CONTACT_FAR * contacts->mean_edge * zone->mass;
}

/* one conflict: the zones of its places become one, and the ways in it get shorter. A tool keeps a zone of its own, so
   that it can come on while the body before it stands */
static void join_conflict(pel_sim_contacts *contacts, const pel_conflict *conflict)
{
    pel_zone *zones = contacts->zones;
    int32_t nodes[5], count = nodes_of(contacts, conflict, nodes), places = conflict->tool >= 0 ? count - 1 : count;
    for (int i = 1; i < places; i++)
        join(zones, nodes[0], nodes[i]);
    if (conflict->tool >= 0 && places > 0)
        zones[find_zone(zones, nodes[0])].is_held = true;
    bool is_far = places > 0 && goes_far(contacts, &zones[find_zone(zones, nodes[0])]);
    for (int i = 0; i < count; i++) {
        double *impact = is_far ? &contacts->body_impacts[contacts->group_of_point[nodes[i]]]
                                : &zones[zones[nodes[i]].leader].impact;
        *impact = fmin(*impact, conflict->time);
    }
}

/* a share after an impact; small ones are none */
static double shorten(double share, double impact)
{
    if (impact < 1)
        share *= SAFE_TIME * impact;
    return share < LEAST_SHARE ? 0 : share;
}

static void join_conflicts(pel_sim_contacts *contacts, int32_t node_count, int32_t body_count)
{
    for (int32_t i = 0; i < node_count; i++)
        contacts->zones[i].impact = 1;
    for (int32_t b = 0; b < body_count; b++)
        contacts->body_impacts[b] = 1;
    for (size_t c = 0; c < contacts->conflict_count; c++)
        join_conflict(contacts, &contacts->conflicts[c]);
    for (int32_t i = 0; i < node_count; i++)
        contacts->zones[i].share = shorten(contacts->zones[i].share, contacts->zones[i].impact);
    for (int32_t b = 0; b < body_count; b++)
        contacts->body_shares[b] = shorten(contacts->body_shares[b], contacts->body_impacts[b]);
}

/* conflicts and some rings around them stay where they were */
static void stop_conflicts(pel_sim_contacts *contacts, int32_t node_count, int rings)
{
    int32_t nodes[5], *ring_of = contacts->rings;
    memset(ring_of, 0, (size_t)node_count * sizeof *ring_of);
    for (size_t c = 0; c < contacts->conflict_count; c++)
        for (int i = nodes_of(contacts, &contacts->conflicts[c], nodes) - 1; i >= 0; i--)
            ring_of[nodes[i]] = 1;
    for (int ring = 1; ring <= rings; ring++)
        for (int32_t t = 0; t < contacts->triangle_count; t++) {
            const int32_t *v = contacts->triangles[t];
            for (int i = 0; i < 3 && v[0] < contacts->place_count; i++)
                for (int k = 0; k < 3; k++)
                    if (ring_of[v[i]] == ring && ring_of[v[k]] == 0)
                        ring_of[v[k]] = ring + 1;
        }
    for (int32_t i = 0; i < node_count; i++)
        contacts->zones[i].is_stopped |= ring_of[i] != 0;
}

static void shorten_ways(pel_sim_contacts *contacts, int32_t node_count, int32_t body_count, int round)
{
    if (round < ZONE_ROUNDS)
        join_conflicts(contacts, node_count, body_count);
    else if (round < LAST_ROUND)
        stop_conflicts(contacts, node_count, round - ZONE_ROUNDS);
    else
        for (int32_t i = 0; i < node_count; i++)
            contacts->zones[i].is_stopped = true;
}

/* ---- positions ---- */

static void move_place(pel_sim *sim, int32_t p)
{
    pel_sim_contacts *contacts = sim->contacts;
    const pel_zone *zone = &contacts->zones[find_zone(contacts->zones, p)], *own = &contacts->zones[p];
    double share = contacts->zones[own->leader].share, body_share = contacts->body_shares[contacts->group_of_point[p]];
    bool has_mean = zone->is_joined && !zone->is_held && !goes_far(contacts, zone);
    pel_record *next = &sim->state->position_next[p];
    const double *start = contacts->start[p], *solved = contacts->solved[p];
    bool stays = own->is_stopped || contacts->zones[own->leader].is_stopped || (share <= 0 && !has_mean);
    if (!stays && !has_mean && share >= 1 && body_share >= 1)
        return;
    for (int k = 0; k < 3; k++) {
        double mean = has_mean ? zone->momentum[k] / zone->mass : 0;
        double way = body_share * (mean + share * (solved[k] - start[k] - mean));
        (*next)[k] = stays ? sim->state->position[p][k] : (pel_real)(start[k] + way);
        contacts->end[p][k] = (double)(*next)[k];
    }
}

static void move_tool(pel_sim *sim, int32_t i)
{
    pel_sim_contacts *contacts = sim->contacts;
    const pel_zone *zone = &contacts->zones[contacts->place_count + i];
    double share = zone->is_stopped ? 0 : zone->share;
    if (share >= 1)
        return;
    pel_tool *tool = &sim->tools[i];
    /* a tool that stands still lags behind nothing */
    if (pel_tool_way(tool, &tool->pose_before, &contacts->wanted[i]) > 0)
        tool->blocked = tool->is_held_back = true;
    pel_pose_between(&tool->pose_before, &contacts->wanted[i], share, &tool->pose);
    pel_contact_tool_points(&contacts->tools[i], &tool->pose, contacts->end);
}

static void move_all(pel_sim *sim)
{
    for (int32_t p = 0; p < sim->contacts->place_count; p++)
        move_place(sim, p);
    for (int32_t i = 0; i < sim->tool_count; i++)
        move_tool(sim, i);
}

/* mean velocity of each zone that goes as one, over the momentum of its ways, which is not needed any more */
static void find_zone_velocities(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    for (int32_t p = 0; p < contacts->place_count; p++)
        pel_vec3_set(contacts->zones[p].momentum, 0, 0, 0);
    for (int32_t p = 0; p < contacts->place_count; p++) {
        pel_zone *zone = &contacts->zones[find_zone(contacts->zones, p)];
        for (int k = 0; k < 3; k++)
            zone->momentum[k] += (double)sim->model->mass[p] * (double)sim->state->velocity_next[p][k];
    }
}

/* What nothing holds keeps its momentum: the points of a zone get their mean velocity, however far they went, others
   keep theirs. What met a tool or a fixed vertex has the velocity of the way that was left to it. */
static void set_velocity(pel_sim *sim, int32_t p, bool moved)
{
    const pel_sim_contacts *contacts = sim->contacts;
    const pel_zone *zone = &contacts->zones[find_zone(contacts->zones, p)];
    pel_record *velocity = &sim->state->velocity_next[p];
    for (int k = 0; k < 3; k++) {
        if (zone->is_held && moved)
            (*velocity)[k] = (pel_real)((contacts->end[p][k] - contacts->start[p][k]) / sim->step.dt);
        else if (!zone->is_held && zone->is_joined)
            (*velocity)[k] = (pel_real)(zone->momentum[k] / zone->mass);
    }
}

static bool has_moved(const pel_sim_contacts *contacts, int32_t p)
{
    return memcmp(contacts->end[p], contacts->solved[p], sizeof contacts->end[p]) != 0;
}

/* velocities follow what became of the positions */
static void finish(pel_sim *sim)
{
    pel_sim_contacts *contacts = sim->contacts;
    if (sim->state->velocity_next != NULL)
        find_zone_velocities(sim);
    for (int32_t p = 0; p < contacts->place_count; p++) {
        bool moved = has_moved(contacts, p);
        contacts->statistics.fall_backs += moved;
        if (sim->state->velocity_next != NULL)
            set_velocity(sim, p, moved);
    }
    for (int32_t i = 0; i < sim->tool_count; i++)
        contacts->statistics.tools_held += sim->tools[i].is_held_back;
}

pel_status pel_contact_look(pel_sim *sim, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    pel_collision_query query = pel_collision_query_default();
    query.start = (const double *)contacts->start;
    query.end = (const double *)contacts->end;
    query.min_separation = contacts->guarded;
    query.near = contacts->near;
    pel_collision_result found;
    contacts->way_is_searched = false;
    pel_status status = pel_collider_detect(contacts->collider, &query, &found, error);
    pel_contact_count_search(contacts, &found);
    return status == PEL_OK ? pel_contact_find_conflicts(sim, &found, error) : status;
}

pel_status pel_contact_guard(pel_sim *sim, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    int32_t node_count = contacts->place_count + sim->tool_count;
    contacts->way_is_searched = false;
    memcpy(contacts->solved, contacts->end, (size_t)contacts->place_count * sizeof *contacts->solved);
    for (int32_t i = 0; i < sim->tool_count; i++)
        contacts->wanted[i] = sim->tools[i].pose;
    begin_zones(sim);
    for (int round = 0; contacts->conflict_count > 0; round++) {
        shorten_ways(contacts, node_count, sim->model->body_count, round);
        move_all(sim);
        contacts->conflict_count = 0;
        if (round == LAST_ROUND)
            break;
        pel_status status = pel_contact_look(sim, error);
        if (status != PEL_OK)
            return status;
    }
    finish(sim);
    return PEL_OK;
}
