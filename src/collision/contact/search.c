/* What comes near on the way of a step: searches for the list, and what the guard minds. */
#include "contact/set.h"
#include "math/extremes.h"

/* before a solver with contacts in its loop, pairs are found this much beyond the thickness, and this share of the
   fastest way beyond that */
#define REACH_SHARE 0.5
#define MOTION_SHARE 0.5
/* of ways: more than their rounding */
#define WAY_SLACK 1e-6

static pel_collision_query query_of(const pel_contact_set *set, double distance)
{
    pel_collision_query query = pel_collision_query_default();
    query.start = (const double *)set->start;
    query.end = (const double *)set->end;
    query.min_separation = distance;
    query.tolerance = PEL_CONTACT_TOLERANCE * set->least;
    /* layers know where their pairs may touch */
    query.near = set->def.has_layers ? pel_min(set->near, distance) : set->near;
    query.method = set->def.method;
    return query;
}

pel_status pel_contact_search(pel_contact_set *set, double distance, bool for_layers, pel_collision_result *found,
                              pel_error *error)
{
    const pel_pair_test test = {.measure = pel_contact_may_meet, .sieve = pel_contact_sift, .context = set};
    double began = pel_seconds();
    set->way_is_searched = false;
    pel_collision_query query = query_of(set, distance);
    /* What comes within the distance starts within it and the ways of both sides. The search looks no farther. */
    if (!set->def.has_layers)
        query.near = pel_min(query.near, distance + 2 * pel_contact_longest_way(set) * (1 + WAY_SLACK));
    pel_status status = pel_collider_list(set->collider, &query, for_layers ? &test : NULL, found, error);
    pel_contact_count_search(set, found);
    if (status == PEL_OK)
        status = pel_contact_balls_join(set, distance, for_layers, found, error);
    set->statistics.find_seconds += pel_seconds() - began;
    return status;
}

double pel_contact_search_reach(const pel_contact_set *set, double longest)
{
    return pel_min(set->largest * (1 + REACH_SHARE) + MOTION_SHARE * longest, 4 * set->largest);
}

bool pel_contact_set_stays_clear(pel_contact_set *set, const pel_record *position, double least, double longest)
{
    const pel_collision_query query = query_of(set, pel_max(least, pel_contact_search_reach(set, longest)));
    if (set->ball_count > 0)
        return set->was_clear = false;
    /* a step after a snapshot was loaded decides like that of a run that went on */
    if (!set->was_clear)
        pel_collider_go(set->collider, &query, position);
    set->was_clear = pel_collider_stays_clear(set->collider, &query, longest, false);
    if (set->was_clear) {
        set->has_home = false;
        set->list.count = 0;
        set->substep = 0;
    }
    return set->was_clear;
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
    bool has_layers = set->def.has_layers;
    pel_collision_query query = query_of(set, has_layers ? set->guarded : set->largest);
    query.near = query.min_separation;
    bool may_be = (has_layers || set->list.count == 0) && set->tangles.is_known && set->tangles.count == 0 &&
                  set->ball_count == 0 && !has_round_obstacle(set);
    set->was_clear = may_be && ((set->was_clear && pel_collider_stays_clear(set->collider, &query, longest, true)) ||
                                measure_way(set, &query, position, next));
    if (set->was_clear)
        set->conflict_count = 0;
    set->statistics.find_seconds += pel_seconds() - began;
    return set->was_clear;
}

/* what comes within the distance, and the conflicts among it */
static pel_status look_on_way(pel_contact_set *set, double distance, pel_collision_result *found, pel_error *error)
{
    pel_status status = pel_contact_search(set, distance, false, found, error);
    double began = pel_seconds();
    if (status == PEL_OK)
        status = pel_contact_find_conflicts(set, found, error);
    set->statistics.guard_seconds += pel_seconds() - began;
    return status;
}

pel_status pel_contact_set_search_way(pel_contact_set *set, pel_collision_result *found, pel_error *error)
{
    if (set->way_is_searched) {
        *found = set->on_way;
        return PEL_OK;
    }
    /* layers need the pairs within the thickness only where there are conflicts, which are nearer */
    pel_status status = PEL_OK;
    if (set->def.has_layers)
        status = look_on_way(set, set->guarded, found, error);
    if (status == PEL_OK && (!set->def.has_layers || set->conflict_count > 0))
        status = look_on_way(set, set->largest, found, error);
    set->on_way = *found;
    set->way_is_searched = status == PEL_OK;
    return status;
}
