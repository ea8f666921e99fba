#include "contact/set.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "contact/sweep.h"
#include "math/extremes.h"

#include <string.h>

enum { VELOCITY_SWEEPS = 4 };

/* distance that the guard keeps, of the thickness */
#define GUARDED_SHARE 0.3
/* before a solver with contacts in its loop, pairs are found this much beyond the thickness, and this share of the
   fastest way beyond that */
#define REACH_SHARE 0.5
#define MOTION_SHARE 0.5
/* features closer than thickness + NEAR_SHARE x shortest edge at the start of a step become contacts, without a time of
   impact; tried and lost: also where the closest points lie on the border of a feature (such normals
   lean, and what slides is held up), and no look for conflicts in the first round, where many contacts get their place
 */
#define NEAR_SHARE 0.5
/* depth at which sweeps may end, of the thickness */
#define SWEEP_TOLERANCE 1e-2
/* Depth that a pair had at the start of the step and that corrections take back, of the thickness. No more: the start
   keeps all these distances, so that there is an answer, also where layers press each other from all sides. */
#define RECOVERY_SHARE 0.2

/* ---- creation ---- */

static void set_distances(pel_contact_set *set)
{
    set->least = HUGE_VAL;
    for (int32_t i = 0; i < set->def.body_count + set->def.obstacle_count; i++) {
        set->least = pel_min(set->least, set->groups[i].thickness);
        set->largest = pel_max(set->largest, set->groups[i].thickness);
    }
    set->guarded = GUARDED_SHARE * set->least;
    set->near = set->largest + NEAR_SHARE * set->def.shortest_edge;
}

static pel_status copy_def(pel_contact_set *set, const pel_contact_set_def *def, pel_error *error)
{
    size_t obstacle_count = (size_t)def->obstacle_count, group_count = (size_t)def->body_count + obstacle_count;
    set->def = *def;
    set->vertex_count = def->vertex_count;
    set->obstacles = pel_allocate(obstacle_count, sizeof *set->obstacles);
    set->groups = pel_allocate(group_count, sizeof *set->groups);
    set->def.obstacles = set->obstacles;
    set->def.groups = set->groups;
    if (set->obstacles == NULL || set->groups == NULL)
        return pel_fail_memory(error);
    memcpy(set->groups, def->groups, group_count * sizeof *set->groups);
    for (size_t i = 0; i < obstacle_count; i++)
        set->obstacles[i] = def->obstacles[i];
    set_distances(set);
    return PEL_OK;
}

pel_status pel_contact_set_create(const pel_contact_set_def *def, pel_contact_set **set, pel_error *error)
{
    *set = pel_allocate(1, sizeof **set);
    if (*set == NULL)
        return pel_fail_memory(error);
    pel_status status = copy_def(*set, def, error);
    return status == PEL_OK ? pel_contact_surface_create(*set, error) : status;
}

void pel_contact_set_destroy(pel_contact_set *set)
{
    if (set == NULL)
        return;
    pel_collider_destroy(set->collider);
    PEL_FREE_ALL(set->obstacles, set->groups, set->next_triangles, set->group_of_point, set->may_meet, set->start,
                 set->end, set->substep_start, set->substep_end, set->list.contacts, set->keys, set->other_keys,
                 set->other_contacts, set->heights.list.contacts, set->heights.triangles, set->heights.bounds,
                 set->heights.places, set->heights.parts, set->conflicts, set->impacts, set->solved, set->zones,
                 set->rings, set->wanted, set->tangles.pairs, set->tangles.keys, set->body_shares, set->body_impacts);
    pel_free(set);
}

double pel_contact_friction(const pel_contact_set *set, int32_t a, int32_t b)
{
    PEL_ASSERT_INDEX(a, set->def.body_count + set->def.obstacle_count);
    PEL_ASSERT_INDEX(b, set->def.body_count + set->def.obstacle_count);
    double first = set->groups[a].friction, second = set->groups[b].friction;
    return first == second ? first : sqrt(first * second);
}

double pel_contact_thickness(const pel_contact_set *set, int32_t a, int32_t b)
{
    PEL_ASSERT_INDEX(a, set->def.body_count + set->def.obstacle_count);
    PEL_ASSERT_INDEX(b, set->def.body_count + set->def.obstacle_count);
    return 0.5 * (set->groups[a].thickness + set->groups[b].thickness);
}

/* ---- records ---- */

/* a record from a pair and where it meets; false when none of its points can move */
static bool make_contact(const pel_contact_set *set, const pel_collision *pair, const pel_ccd_hit *hit,
                         pel_contact *contact)
{
    PEL_ASSERT_INDEX(pair->vertices[0], set->point_count);
    PEL_ASSERT_INDEX(pair->vertices[3], set->point_count);
    /* points 0 and 3 are of either side */
    const int32_t *group = set->group_of_point;
    double separation = pel_contact_thickness(set, group[pair->vertices[0]], group[pair->vertices[3]]), free = 0;
    double friction = pel_contact_friction(set, group[pair->vertices[0]], group[pair->vertices[3]]);
    *contact = (pel_contact){.friction = (pel_real)friction};
    double drift[3] = {0, 0, 0};
    for (int i = 0; i < 4; i++) {
        int32_t point = pair->vertices[i];
        double weight = hit->weight[i], way[3];
        if (point < set->vertex_count) {
            contact->vertices[i] = point;
            contact->weights[i] = (pel_real)weight;
            free += (double)set->def.inverse_mass[point] * weight * weight;
            continue;
        }
        separation -= weight * pel_vec3_dot(set->end[point], hit->normal);
        pel_vec3_subtract(set->end[point], set->start[point], way);
        pel_vec3_along(drift, -weight, way, drift);
    }
    contact->separation = (pel_real)separation;
    for (int k = 0; k < 3; k++) {
        contact->normal[k] = (pel_real)hit->normal[k];
        contact->drift[k] = (pel_real)drift[k];
    }
    return free > 0 && pel_vec3_squared_length(hit->normal) > 0.5;
}

static pel_contact_key make_key(const pel_contact_set *set, const pel_collision *hit)
{
    pel_contact_key key = {.edge_edge = hit->edge_edge, .first = hit->first, .second = hit->second, .obstacle = -1};
    memcpy(key.points, hit->vertices, sizeof key.points);
    memcpy(key.place, hit->hit.weight, sizeof key.place);
    for (int i = 0; i < 4 && key.obstacle < 0; i++)
        key.obstacle = pel_contact_obstacle_of(set, hit->vertices[i]);
    return key;
}

static int compare_keys(const pel_contact_key *a, const pel_contact_key *b)
{
    if (a->edge_edge != b->edge_edge)
        return a->edge_edge ? 1 : -1;
    if (a->first != b->first)
        return a->first < b->first ? -1 : 1;
    return (a->second > b->second) - (a->second < b->second);
}

static pel_status make_room(pel_contact_set *set, size_t count, pel_error *error)
{
    if (pel_reserve((void **)&set->other_contacts, &set->other_capacity, count, sizeof *set->other_contacts) &&
        pel_reserve((void **)&set->other_keys, &set->other_key_capacity, count, sizeof *set->other_keys))
        return PEL_OK;
    return pel_fail_memory(error);
}

/* the merged list becomes the list */
static void exchange_lists(pel_contact_set *set, int32_t count)
{
    PEL_ASSERT(count >= 0 && (size_t)count <= set->other_capacity);
    pel_contact *list = set->list.contacts;
    pel_contact_key *keys = set->keys;
    size_t capacity = set->capacity, key_capacity = set->key_capacity;
    set->list = (pel_contact_list){set->other_contacts, count, set->list.recovery};
    set->keys = set->other_keys;
    set->capacity = set->other_capacity;
    set->key_capacity = set->other_key_capacity;
    set->other_contacts = list;
    set->other_keys = keys;
    set->other_capacity = capacity;
    set->other_key_capacity = key_capacity;
}

/* what was found on its way into the list */
typedef struct merger {
    pel_contact_set *set;
    const pel_timed_hit *impacts; /* of conflicts among what was found; null = not looked for */
    double obstacle_reach;        /* m, obstacles that are farther away at the start count only by their faces */
    bool has_solids;              /* obstacles without a mesh make none */
    int32_t old, count;           /* contacts of the list that were taken over, contacts of the merged list */
} merger;

/* takes over what comes before a key, all when it is null; true when the next one has this key */
static bool take_over(merger *m, const pel_contact_key *key)
{
    pel_contact_set *set = m->set;
    PEL_ASSERT(m->old >= 0 && m->old <= set->list.count);
    for (; m->old < set->list.count; m->old++) {
        int order = key != NULL ? compare_keys(&set->keys[m->old], key) : -1;
        if (order >= 0)
            return order == 0;
        set->other_keys[m->count] = set->keys[m->old];
        set->other_contacts[m->count++] = set->list.contacts[m->old];
    }
    return false;
}

/* a vertex right before the inner part of a triangle */
static bool is_before_face(const pel_collision *pair)
{
    const double *w = pair->hit.weight;
    return !pair->edge_edge && pel_max(w[1], pel_max(w[2], w[3])) < -1e-6;
}

/* update the contact's location and keep its impulses; a time-of-impact location is kept */
static void add_found(merger *m, const pel_collision *pair, int64_t number)
{
    pel_contact_set *set = m->set;
    pel_contact_key key = make_key(set, pair);
    key.is_impact = m->impacts != NULL && m->impacts[number].hit.time_of_impact <= 1;
    double start = pel_contact_start_distance(set, pair);
    key.depth = pel_max(0, (1 - RECOVERY_SHARE) * set->def.thickness - start);
    if (key.is_impact)
        memcpy(key.place, m->impacts[number].hit.weight, sizeof key.place);
    if (key.obstacle >= 0 && !is_before_face(pair) && start > m->obstacle_reach)
        return;
    if (key.obstacle >= 0 && m->has_solids && set->obstacles[key.obstacle].mesh == NULL)
        return;
    bool known = take_over(m, &key);
    pel_contact contact, *old = known ? &set->list.contacts[m->old] : NULL;
    if (known && set->keys[m->old].is_impact && !key.is_impact)
        return;
    if (!make_contact(set, pair, key.is_impact ? &m->impacts[number].hit : &pair->hit, &contact))
        return;
    if (key.is_impact)
        contact.separation -= (pel_real)key.depth;
    if (known) {
        const pel_contact_key *own = &set->keys[m->old];
        contact.push = old->push;
        memcpy(contact.tangential, old->tangential, sizeof contact.tangential);
        memcpy(contact.stopped, old->stopped, sizeof contact.stopped);
        key.has_pushed = own->has_pushed;
        key.load = own->load;
        pel_vec3_copy(own->drag, key.drag);
        m->old++;
    } else if (set->list.count - m->old + m->count >= set->def.limit) {
        set->statistics.dropped++;
        return;
    }
    set->other_keys[m->count] = key;
    set->other_contacts[m->count++] = contact;
}

/* puts what was found into the list */
static pel_status merge(merger *m, const pel_collision_result *found, pel_error *error)
{
    pel_contact_set *set = m->set;
    pel_status status = make_room(set, (size_t)set->list.count + (size_t)found->collision_count, error);
    if (status != PEL_OK)
        return status;
    for (int64_t i = 0; i < found->collision_count; i++)
        if (set->tangles.count == 0 || !pel_tangles_have(set, &found->collisions[i]))
            add_found(m, &found->collisions[i], i);
    take_over(m, NULL);
    exchange_lists(set, m->count);
    PEL_ASSERT_WHOLE(pel_contact_set_is_valid(set));
    return PEL_OK;
}

/* ---- search ---- */

static pel_collision_query query_of(const pel_contact_set *set, double distance)
{
    pel_collision_query query = pel_collision_query_default();
    query.start = (const double *)set->start;
    query.end = (const double *)set->end;
    query.min_separation = distance;
    query.tolerance = 1e-2 * set->least;
    query.near = set->near;
    query.method = set->def.method;
    return query;
}

/* what comes within the distance between start and end */
static pel_status search(pel_contact_set *set, double distance, pel_collision_result *found, pel_error *error)
{
    double began = pel_seconds();
    set->way_is_searched = false;
    pel_collision_query query = query_of(set, distance);
    pel_status status = pel_collider_detect(set->collider, &query, found, error);
    pel_contact_count_search(set, found);
    set->statistics.find_seconds += pel_seconds() - began;
    return status;
}

/* the longest way of a step of velocities */
static double longest_way(const pel_contact_set *set)
{
    double square = 0;
    for (int32_t p = 0; p < set->point_count; p++) {
        double way[3];
        pel_vec3_subtract(set->end[p], set->start[p], way);
        double own = pel_vec3_squared_length(way);
        square = own > square ? own : square;
    }
    return sqrt(square);
}

/* m, within which a search before a step looks */
static double reach_of(const pel_contact_set *set, double longest)
{
    return pel_min(set->largest * (1 + REACH_SHARE) + MOTION_SHARE * longest, 4 * set->largest);
}

bool pel_contact_set_stays_clear(pel_contact_set *set, const pel_record *position, double least, double longest)
{
    const pel_collision_query query = query_of(set, pel_max(least, reach_of(set, longest)));
    /* a step after a snapshot was loaded decides like that of a run that went on */
    if (!set->was_clear)
        pel_collider_go(set->collider, &query, position);
    set->was_clear = pel_collider_stays_clear(set->collider, &query, longest, false);
    if (set->was_clear) {
        set->list.count = 0;
        set->substep = 0;
    }
    return set->was_clear;
}

pel_status pel_contact_set_find(pel_contact_set *set, double least, bool has_solids, pel_error *error)
{
    set->list.count = 0;
    set->substep = 0;
    set->was_clear = false;
    double reach = reach_of(set, longest_way(set));
    pel_collision_result found;
    pel_status status = search(set, pel_max(least, reach), &found, error);
    /* what slides along the edges between the flat triangles of an obstacle must not run into them */
    merger m = {.set = set, .obstacle_reach = least > reach ? reach : HUGE_VAL, .has_solids = has_solids};
    return status == PEL_OK ? merge(&m, &found, error) : status;
}

/* these are no part of the surface: their conflicts are not among its pairs */
static bool has_round_obstacle(const pel_contact_set *set)
{
    for (int32_t i = 0; i < set->def.obstacle_count; i++)
        if (set->obstacles[i].presses && set->obstacles[i].point_begin == set->obstacles[i].point_end)
            return true;
    return false;
}

static bool measure_way(pel_contact_set *set, const pel_collision_query *query, const pel_record *position,
                        const pel_record *next)
{
    pel_contact_set_place_obstacles(set);
    /* obstacles may have been moved between the steps */
    bool goes_on = set->was_clear && set->point_count == set->vertex_count;
    const pel_clearance_way way = {.start_records = goes_on ? NULL : position,
                                   .end_records = next,
                                   .record_count = set->vertex_count,
                                   .start = (const double(*)[3])set->start,
                                   .end = (const double(*)[3])set->end};
    return pel_collider_is_clear(set->collider, query, &way);
}

bool pel_contact_set_is_clear(pel_contact_set *set, const pel_record *position, const pel_record *next, double longest)
{
    double began = pel_seconds();
    const pel_collision_query query = query_of(set, set->largest);
    bool may_be = set->list.count == 0 && set->tangles.is_known && set->tangles.count == 0 && !has_round_obstacle(set);
    set->was_clear = may_be && ((set->was_clear && pel_collider_stays_clear(set->collider, &query, longest, true)) ||
                                measure_way(set, &query, position, next));
    if (set->was_clear)
        set->conflict_count = 0;
    set->statistics.find_seconds += pel_seconds() - began;
    return set->was_clear;
}

pel_status pel_contact_set_search_way(pel_contact_set *set, pel_collision_result *found, pel_error *error)
{
    if (set->way_is_searched) {
        *found = set->on_way;
        return PEL_OK;
    }
    pel_status status = search(set, set->largest, found, error);
    double began = pel_seconds();
    if (status == PEL_OK)
        status = pel_contact_find_conflicts(set, found, error);
    set->statistics.guard_seconds += pel_seconds() - began;
    set->on_way = *found;
    set->way_is_searched = status == PEL_OK;
    return status;
}

pel_status pel_contact_set_add_way(pel_contact_set *set, const pel_collision_result *found, pel_error *error)
{
    merger m = {.set = set, .impacts = set->impacts, .obstacle_reach = HUGE_VAL};
    set->statistics.rounds++;
    return merge(&m, found, error);
}

void pel_contact_set_forget_step(pel_contact_set *set)
{
    for (int32_t c = 0; c < set->list.count; c++) {
        pel_contact_key *key = &set->keys[c];
        key->is_impact = key->is_off = key->has_side = key->has_pushed = false;
        key->gap = 0;
    }
}

void pel_contact_set_mark(const pel_contact_set *set, uint8_t *flags)
{
    const pel_contact_list *list = &set->list;
    for (int32_t c = 0; c < list->count; c++)
        for (int i = 0; i < 4 && (list->contacts[c].push > 0 || set->keys[c].has_pushed); i++)
            if (list->contacts[c].weights[i] != 0)
                flags[list->contacts[c].vertices[i]] = 1;
}

/* ---- correction ---- */

void pel_contact_set_correct(pel_contact_set *set, const pel_contact_motion *motion, int32_t sweeps)
{
    double tolerance = SWEEP_TOLERANCE * set->least;
    for (int32_t i = 0; i < set->def.obstacle_count; i++)
        set->obstacles[i].substep = set->obstacles[i].before;
    pel_contact_set_begin_substep(set);
    pel_contact_set_refresh(set, motion->next, motion->position, HUGE_VAL);
    for (int32_t c = 0; c < set->list.count; c++)
        if (!set->keys[c].is_impact)
            set->list.contacts[c].separation -= (pel_real)set->keys[c].depth;
    set->list.recovery = HUGE_VAL;
    for (int32_t i = 0; i < sweeps; i++)
        if (pel_contacts_project(&set->list, motion->next, motion->position) < tolerance)
            break;
    set->way_is_searched = false;
    for (int32_t p = 0; p < set->vertex_count; p++)
        pel_vertex_position(motion->next, p, set->end[p]);
    if (motion->velocity != NULL)
        pel_contacts_stop(&set->list, motion->next, motion->velocity, motion->dt, VELOCITY_SWEEPS);
}
