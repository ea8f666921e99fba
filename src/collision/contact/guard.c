/* The guard: no step ends with an intersection that it did not begin with.

   A conflict is a pair that comes nearer than it may between the start x0 of the step and its end x1, all points going
   straight, by the conservative test, which misses none. While there are conflicts the ways get shorter:

   rounds 0 .. 15: the points of conflicts, connected ones together, become zones (the impact zones of Provot 1997 and
   Bridson et al. 2002, without rotation). A zone moves by the mean of its ways, weighted with mass, which keeps its
   momentum; its points move relative to that by a share of their own ways, which every conflict reduces: 0.9 of the
   time of impact. In the end it moves as one. A zone with an obstacle, or with a vertex that cannot move, has no mean:
   its ways shrink towards their starts, and so does that of the obstacle, with all that it holds,
   unless it goes away from where they started (which ends with round 19);

   rounds 16 .. 21: the points of conflicts, and ever more rings around them, keep their start positions;

   round 22: everything does.

   A pair whose points all stay is as free as at the start: it is no conflict. So the loop ends after 23 rounds at the
   latest, and it ends free: without a conflict no two features that have no vertex in common touch on the way, and an
   intersection of two triangles that was not there begins with such a touch, also where they are neighbours. End
   positions are rounded to pel_real before they are tested.

   How near may a pair come? To the guarded distance; when it starts nearer than that, to 0.99 of where it starts, so
   that it can part and slide but not close in. */
#include "base/assert.h"
#include "contact/set.h"

#include "base/memory.h"
#include "base/status.h"
#include "math/extremes.h"

#include <string.h>

enum { ZONE_ROUNDS = 16, PARTING_ROUNDS = 20, LAST_ROUND = 22 };

#define SAFE_TIME 0.9
#define LEAST_SHARE 0.02

/* ---- creation ---- */

/* a block that is not there yet; false without memory */
static bool make_block(void **block, size_t count, size_t size)
{
    if (*block == NULL)
        *block = pel_allocate(count, size);
    return *block != NULL;
}

/* when a step is guarded for the first time: many runs never need it, and it is as large as all of the points */
static pel_status allocate(pel_contact_set *set, pel_error *error)
{
    size_t vertices = (size_t)set->vertex_count, obstacles = (size_t)set->def.obstacle_count;
    size_t nodes = vertices + obstacles, bodies = (size_t)set->def.body_count;
    size_t rigids = set->def.rigids != NULL ? (size_t)set->def.rigids->count : 0;
    bool made = make_block((void **)&set->solved, vertices, sizeof *set->solved) &&
                make_block((void **)&set->zones, nodes, sizeof *set->zones) &&
                make_block((void **)&set->rings, nodes, sizeof *set->rings) &&
                make_block((void **)&set->wanted, obstacles, sizeof *set->wanted) &&
                make_block((void **)&set->rigid_wanted, rigids, sizeof *set->rigid_wanted) &&
                make_block((void **)&set->body_shares, bodies, sizeof *set->body_shares) &&
                make_block((void **)&set->body_impacts, bodies, sizeof *set->body_impacts);
    return made ? PEL_OK : pel_fail_memory(error);
}

/* ---- zones ---- */

static int32_t find_zone(pel_zone *zones, int32_t node)
{
    while (zones[node].parent != node)
        node = zones[node].parent = zones[zones[node].parent].parent;
    return node;
}

/* the nodes of a conflict: vertices, then the obstacle; returns how many */
static int nodes_of(const pel_contact_set *set, const pel_conflict *conflict, int32_t nodes[5])
{
    int count = 0;
    for (int i = 0; i < 4; i++)
        if (conflict->vertices[i] >= 0)
            nodes[count++] = conflict->vertices[i];
    if (conflict->obstacle >= 0)
        nodes[count++] = set->vertex_count + conflict->obstacle;
    return count;
}

/* Whether an obstacle goes away from where the vertices of a conflict began: then it is they who come after it, and
   what stops it would keep it in a jam that it leaves. The distance from a convex solid is convex on a straight way:
   what grows at its start grows on all of it. */
static bool parts(const pel_contact_set *set, const pel_conflict *conflict)
{
    if (conflict->obstacle < 0 || set->obstacles[conflict->obstacle].mesh != NULL)
        return false;
    const pel_obstacle *obstacle = &set->obstacles[conflict->obstacle];
    bool any = false;
    for (int i = 0; i < 4; i++) {
        double before[3], after[3], normal[3];
        if (conflict->vertices[i] < 0)
            continue;
        pel_pose_to_local(&obstacle->before, set->start[conflict->vertices[i]], before);
        pel_pose_to_local(&set->wanted[conflict->obstacle], set->start[conflict->vertices[i]], after);
        any = true;
        pel_solid_distance(&obstacle->solid, before, normal);
        pel_vec3_subtract(after, before, after);
        if (!(pel_vec3_dot(after, normal) > 0))
            return false;
    }
    return any;
}

/* every node a zone of its own, going all of its way */
static void begin_zones(pel_contact_set *set)
{
    for (int32_t i = 0; i < set->vertex_count + set->def.obstacle_count; i++) {
        pel_zone *zone = &set->zones[i];
        *zone = (pel_zone){.parent = i, .leader = i, .share = 1, .is_held = true};
        if (i >= set->vertex_count || set->def.inverse_mass[i] <= 0)
            continue;
        double mass = (double)set->def.mass[i];
        *zone = (pel_zone){.parent = i, .leader = i, .share = 1, .mass = mass};
        for (int k = 0; k < 3; k++)
            zone->momentum[k] = mass * (set->solved[i][k] - set->start[i][k]);
    }
    for (int32_t b = 0; b < set->def.body_count; b++)
        set->body_shares[b] = 1;
    /* a rigid body goes as a whole, and has no common motion with others: it would turn as well */
    for (int32_t i = 0; set->def.rigids != NULL && i < set->def.rigids->count; i++) {
        const pel_rigid *rigid = &set->def.rigids->items[i];
        set->rigid_wanted[i] = rigid->state;
        for (int32_t v = rigid->begin; v < rigid->end; v++) {
            set->zones[v].leader = rigid->begin;
            set->zones[v].is_held = true;
        }
    }
    /* what an obstacle holds goes with it */
    for (int32_t i = 0; i < set->def.obstacle_count; i++)
        for (int32_t k = 0; k < set->obstacles[i].held_count; k++) {
            pel_zone *zone = &set->zones[set->obstacles[i].held[k]];
            zone->leader = set->vertex_count + i;
            zone->is_held = true;
        }
}

/* returns the zone of both */
static int32_t join(pel_zone *zones, int32_t a, int32_t b)
{
    PEL_ASSERT(a >= 0 && b >= 0);
    a = find_zone(zones, a);
    b = find_zone(zones, b);
    PEL_ASSERT(zones[a].parent == a && zones[b].parent == b);
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
static bool goes_far(const pel_contact_set *set, const pel_zone *zone)
{
    return zone->is_joined && !zone->is_held &&
           pel_vec3_length(zone->momentum) > PEL_CONTACT_FAR * set->mean_edge * zone->mass;
}

/* one conflict: the zones of its vertices become one, and the ways in it get shorter. An obstacle keeps a zone of its
   own, so that it can come on while the body before it stands */
static void join_conflict(pel_contact_set *set, const pel_conflict *conflict)
{
    PEL_ASSERT(conflict->obstacle >= -1 && conflict->obstacle < set->def.obstacle_count);
    PEL_ASSERT(conflict->time >= 0);
    pel_zone *zones = set->zones;
    int32_t nodes[5], count = nodes_of(set, conflict, nodes), places = conflict->obstacle >= 0 ? count - 1 : count;
    for (int i = 1; i < places; i++)
        join(zones, nodes[0], nodes[i]);
    if (conflict->obstacle >= 0 && places > 0)
        zones[find_zone(zones, nodes[0])].is_held = true;
    bool is_far = places > 0 && goes_far(set, &zones[find_zone(zones, nodes[0])]);
    int shortened = parts(set, conflict) ? places : count;
    for (int i = 0; i < shortened; i++) {
        double *impact =
            is_far ? &set->body_impacts[set->group_of_point[nodes[i]]] : &zones[zones[nodes[i]].leader].impact;
        *impact = pel_min(*impact, conflict->time);
    }
}

/* a share after an impact; small ones are none */
static double shorten(double share, double impact)
{
    if (impact < 1)
        share *= SAFE_TIME * impact;
    return share < LEAST_SHARE ? 0 : share;
}

static void join_conflicts(pel_contact_set *set, int32_t node_count, int32_t body_count)
{
    for (int32_t i = 0; i < node_count; i++)
        set->zones[i].impact = 1;
    for (int32_t b = 0; b < body_count; b++)
        set->body_impacts[b] = 1;
    for (size_t c = 0; c < set->conflict_count; c++)
        join_conflict(set, &set->conflicts[c]);
    for (int32_t i = 0; i < node_count; i++)
        set->zones[i].share = shorten(set->zones[i].share, set->zones[i].impact);
    for (int32_t b = 0; b < body_count; b++)
        set->body_shares[b] = shorten(set->body_shares[b], set->body_impacts[b]);
}

/* conflicts and some rings around them stay where they were */
static void stop_conflicts(pel_contact_set *set, int32_t node_count, int rings)
{
    int32_t nodes[5], *ring_of = set->rings;
    memset(ring_of, 0, (size_t)node_count * sizeof *ring_of);
    for (size_t c = 0; c < set->conflict_count; c++) {
        int count = nodes_of(set, &set->conflicts[c], nodes);
        if (rings < PARTING_ROUNDS - ZONE_ROUNDS && parts(set, &set->conflicts[c]))
            count--;
        for (int i = 0; i < count; i++)
            ring_of[nodes[i]] = 1;
    }
    for (int ring = 1; ring <= rings; ring++)
        for (int32_t t = 0; t < set->triangle_count; t++) {
            const int32_t *v = set->triangles[t];
            for (int i = 0; i < 3 && v[0] < set->vertex_count; i++)
                for (int k = 0; k < 3; k++)
                    if (ring_of[v[i]] == ring && ring_of[v[k]] == 0)
                        ring_of[v[k]] = ring + 1;
        }
    for (int32_t i = 0; i < node_count; i++)
        set->zones[i].is_stopped |= ring_of[i] != 0;
}

static void shorten_ways(pel_contact_set *set, int32_t node_count, int32_t body_count, int round)
{
    if (round < ZONE_ROUNDS)
        join_conflicts(set, node_count, body_count);
    else if (round < LAST_ROUND)
        stop_conflicts(set, node_count, round - ZONE_ROUNDS);
    else
        for (int32_t i = 0; i < node_count; i++)
            set->zones[i].is_stopped = true;
}

/* ---- positions ---- */

static void move_vertex(pel_contact_set *set, const pel_contact_motion *motion, int32_t p)
{
    const pel_zone *zone = &set->zones[find_zone(set->zones, p)], *own = &set->zones[p];
    double share = set->zones[own->leader].share, body_share = set->body_shares[set->group_of_point[p]];
    bool has_mean = zone->is_joined && !zone->is_held && !goes_far(set, zone);
    pel_record *next = &motion->next[p];
    const double *start = set->start[p], *solved = set->solved[p];
    bool stays = own->is_stopped || set->zones[own->leader].is_stopped || (share <= 0 && !has_mean);
    if (!stays && !has_mean && share >= 1 && body_share >= 1)
        return;
    for (int k = 0; k < 3; k++) {
        double mean = has_mean ? zone->momentum[k] / zone->mass : 0;
        double way = body_share * (mean + share * (solved[k] - start[k] - mean));
        (*next)[k] = stays ? motion->position[p][k] : (pel_real)(start[k] + way);
        set->end[p][k] = (double)(*next)[k];
    }
}

static void move_rigid(pel_contact_set *set, const pel_contact_motion *motion, int32_t i)
{
    pel_rigid *rigid = &set->def.rigids->items[i];
    const pel_zone *zone = &set->zones[set->zones[rigid->begin].leader];
    bool is_stopped = zone->is_stopped;
    for (int32_t v = rigid->begin; v < rigid->end; v++)
        is_stopped |= set->zones[v].is_stopped;
    double share = is_stopped ? 0 : zone->share * set->body_shares[set->group_of_point[rigid->begin]];
    if (share >= 1 || rigid->is_fixed)
        return;
    pel_rigid_go_back(rigid, &set->rigid_wanted[i], share);
    if (share > 0)
        pel_rigids_place(set->def.rigids, motion->next);
    rigid->is_moved = false;
    for (int32_t v = rigid->begin; v < rigid->end; v++)
        for (int k = 0; k < 3; k++) {
            if (share <= 0)
                motion->next[v][k] = motion->position[v][k];
            set->end[v][k] = (double)motion->next[v][k];
        }
}

static void move_obstacle(pel_contact_set *set, int32_t i)
{
    const pel_zone *zone = &set->zones[set->vertex_count + i];
    double share = zone->is_stopped ? 0 : zone->share;
    if (share >= 1)
        return;
    pel_obstacle *obstacle = &set->obstacles[i];
    /* what stands still lags behind nothing */
    obstacle->is_held_back |= pel_pose_way(&obstacle->before, &set->wanted[i], pel_solid_size(&obstacle->solid)) > 0;
    pel_pose_between(&obstacle->before, &set->wanted[i], share, &obstacle->pose);
    pel_obstacle_points(obstacle, &obstacle->pose, set->end + obstacle->point_begin);
}

static void move_all(pel_contact_set *set, const pel_contact_motion *motion)
{
    for (int32_t p = 0; p < set->vertex_count; p++)
        move_vertex(set, motion, p);
    for (int32_t i = 0; set->def.rigids != NULL && i < set->def.rigids->count; i++)
        move_rigid(set, motion, i);
    for (int32_t i = 0; i < set->def.obstacle_count; i++)
        move_obstacle(set, i);
}

/* mean velocity of each zone that goes as one, over the momentum of its ways, which is not needed any more */
static void find_zone_velocities(pel_contact_set *set, const pel_record *velocity)
{
    for (int32_t p = 0; p < set->vertex_count; p++)
        pel_vec3_set(set->zones[p].momentum, 0, 0, 0);
    for (int32_t p = 0; p < set->vertex_count; p++) {
        pel_zone *zone = &set->zones[find_zone(set->zones, p)];
        for (int k = 0; k < 3; k++)
            zone->momentum[k] += (double)set->def.mass[p] * (double)velocity[p][k];
    }
}

/* What nothing holds keeps its momentum: the points of a zone get their mean velocity, however far they went, others
   keep theirs. What met an obstacle or a fixed vertex has the velocity of the way that was left to it. */
static void set_velocity(const pel_contact_set *set, const pel_contact_motion *motion, int32_t p, bool moved)
{
    const pel_zone *zone = &set->zones[find_zone(set->zones, p)];
    pel_record *velocity = &motion->velocity[p];
    for (int k = 0; k < 3; k++) {
        if (zone->is_held && moved)
            (*velocity)[k] = (pel_real)((set->end[p][k] - set->start[p][k]) / motion->dt);
        else if (!zone->is_held && zone->is_joined)
            (*velocity)[k] = (pel_real)(zone->momentum[k] / zone->mass);
    }
}

static bool has_moved(const pel_contact_set *set, int32_t p)
{
    return memcmp(set->end[p], set->solved[p], sizeof set->end[p]) != 0;
}

/* velocities follow what became of the positions */
static void finish(pel_contact_set *set, const pel_contact_motion *motion)
{
    if (motion->velocity != NULL)
        find_zone_velocities(set, motion->velocity);
    for (int32_t p = 0; p < set->vertex_count; p++) {
        bool moved = has_moved(set, p);
        set->statistics.fall_backs += moved;
        if (motion->velocity != NULL)
            set_velocity(set, motion, p, moved);
    }
    for (int32_t i = 0; motion->velocity != NULL && set->def.rigids != NULL && i < set->def.rigids->count; i++)
        pel_rigid_place_velocities(&set->def.rigids->items[i], set->def.rigids, motion->next, motion->velocity);
    for (int32_t i = 0; i < set->def.obstacle_count; i++)
        set->statistics.tools_held += set->obstacles[i].is_held_back;
}

pel_status pel_contact_guard(pel_contact_set *set, const pel_contact_motion *motion, pel_error *error)
{
    int32_t node_count = set->vertex_count + set->def.obstacle_count;
    pel_status status = allocate(set, error);
    if (status != PEL_OK)
        return status;
    set->way_is_searched = false;
    memcpy(set->solved, set->end, (size_t)set->vertex_count * sizeof *set->solved);
    for (int32_t i = 0; i < set->def.obstacle_count; i++) {
        set->wanted[i] = set->obstacles[i].pose;
        set->obstacles[i].is_held_back = false;
    }
    begin_zones(set);
    for (int round = 0; set->conflict_count > 0; round++) {
        shorten_ways(set, node_count, set->def.body_count, round);
        move_all(set, motion);
        set->conflict_count = 0;
        if (round == LAST_ROUND)
            break;
        status = pel_contact_look(set, error);
        if (status != PEL_OK)
            return status;
    }
    finish(set, motion);
    return PEL_OK;
}
