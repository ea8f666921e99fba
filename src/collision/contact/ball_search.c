/* Pairs with balls, by boxes around their ways: balls along x, triangles against the box of all balls first. */
#include "contact/set.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"

#include <stdlib.h>

static void enclose(const double x[3], double low[3], double high[3])
{
    for (int k = 0; k < 3; k++) {
        low[k] = x[k] < low[k] ? x[k] : low[k];
        high[k] = x[k] > high[k] ? x[k] : high[k];
    }
}

/* the box around the way of points; follows_path: also where rigid bodies were at the ends of substeps */
static void enclose_ways(const pel_contact_set *set, const int32_t points[4], int count, bool follows_path,
                         double low[3], double high[3])
{
    int knots = follows_path ? pel_contact_count_knots(set, points) : 0;
    double x[4][3];
    for (int k = 0; k < 3; k++) {
        low[k] = HUGE_VAL;
        high[k] = -HUGE_VAL;
    }
    for (int i = 0; i < count; i++) {
        enclose(set->start[points[i]], low, high);
        enclose(set->end[points[i]], low, high);
    }
    for (int knot = 1; knot < knots; knot++) {
        pel_contact_place_between(set, points, (double)knot / knots, x);
        for (int i = 0; i < count; i++)
            enclose(x[i], low, high);
    }
}

/* boxes of balls, and their order along x */
static void find_boxes(pel_contact_set *set, double distance, bool for_layers)
{
    for (int32_t i = 0; i < set->ball_count; i++) {
        pel_contact_ball *ball = &set->balls[i];
        const int32_t points[4] = {ball->point, ball->point, ball->point, ball->point};
        double grown = ball->radius + distance + (for_layers ? 0.25 * pel_vec3_length(set->bend[ball->point]) : 0);
        enclose_ways(set, points, 1, !for_layers, ball->low, ball->high);
        for (int k = 0; k < 3; k++) {
            ball->low[k] -= grown;
            ball->high[k] += grown;
        }
    }
    int32_t *order = set->ball_order;
    for (int32_t i = 1; i < set->ball_count; i++) {
        int32_t own = order[i], at = i;
        for (; at > 0 && set->balls[order[at - 1]].low[0] > set->balls[own].low[0]; at--)
            order[at] = order[at - 1];
        order[at] = own;
    }
}

static bool overlap(const double low[3], const double high[3], const pel_contact_ball *ball)
{
    bool overlaps = true;
    for (int k = 0; k < 3; k++)
        overlaps &= low[k] <= ball->high[k] && high[k] >= ball->low[k];
    return overlaps;
}

static bool may_meet(const pel_contact_set *set, int32_t a, int32_t b)
{
    int32_t groups = set->def.body_count + set->def.obstacle_count;
    return set->may_meet[set->group_of_point[a] * groups + set->group_of_point[b]] != 0;
}

/* Whether a pair may come within its thickness in the step, if ways are wrong by up to half of the margin. */
static bool may_touch(const pel_contact_set *set, const pel_collision *pair, double distance)
{
    int32_t obstacle = pel_contact_obstacle_of(set, pair->vertices[3]);
    /* the substeps see these as solids */
    if (pel_contact_sleeps(set, pair->vertices) || (obstacle >= 0 && set->obstacles[obstacle].mesh == NULL))
        return false;
    return distance <=
           pel_contact_pair_thickness(set, pair->vertices) + set->margin + pel_contact_longest_approach(set, pair);
}

static pel_status add_pair(pel_contact_set *set, const pel_contact_ball *ball, int32_t second, const int32_t corners[3],
                           bool for_layers, pel_error *error)
{
    pel_collision pair = {
        .first = ball->point, .second = second, .vertices = {ball->point, corners[0], corners[1], corners[2]}};
    double distance = pel_contact_measure_start(set, &pair) - pel_contact_pair_radius(set, pair.vertices);
    if (for_layers && !may_touch(set, &pair, distance))
        return PEL_OK;
    if (!pel_reserve((void **)&set->ball_pairs, &set->ball_pair_capacity, set->ball_pair_count + 1,
                     sizeof *set->ball_pairs))
        return pel_fail_memory(error);
    set->ball_pairs[set->ball_pair_count++] = pair;
    return PEL_OK;
}

static pel_status pair_balls(pel_contact_set *set, bool for_layers, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t i = 0; i < set->ball_count; i++)
        for (int32_t j = i + 1; j < set->ball_count && status == PEL_OK; j++) {
            int32_t a = set->ball_order[i], b = set->ball_order[j];
            const pel_contact_ball *one = &set->balls[a < b ? a : b], *other = &set->balls[a < b ? b : a];
            if (set->balls[b].low[0] > set->balls[a].high[0])
                break;
            const int32_t corners[3] = {other->point, other->point, other->point};
            if (overlap(one->low, one->high, other) && may_meet(set, one->point, other->point))
                status = add_pair(set, one, set->triangle_count + (a < b ? b : a), corners, for_layers, error);
        }
    return status;
}

/* the box around all balls */
static void find_bounds(const pel_contact_set *set, pel_contact_ball *all)
{
    *all = set->balls[0];
    for (int32_t i = 1; i < set->ball_count; i++) {
        enclose(set->balls[i].low, all->low, all->high);
        enclose(set->balls[i].high, all->low, all->high);
    }
}

static pel_status pair_triangles(pel_contact_set *set, bool for_layers, pel_error *error)
{
    pel_contact_ball all;
    pel_status status = PEL_OK;
    find_bounds(set, &all);
    for (int32_t t = 0; t < set->triangle_count && status == PEL_OK; t++) {
        const int32_t *corners = set->triangles[t], points[4] = {corners[0], corners[1], corners[2], corners[2]};
        double low[3], high[3];
        enclose_ways(set, points, 3, !for_layers, low, high);
        if (!overlap(low, high, &all))
            continue;
        for (int32_t i = 0; i < set->ball_count && status == PEL_OK; i++)
            if (overlap(low, high, &set->balls[i]) && may_meet(set, set->balls[i].point, corners[0]))
                status = add_pair(set, &set->balls[i], t, corners, for_layers, error);
    }
    return status;
}

static int compare_pairs(const void *a, const void *b)
{
    const pel_collision *x = a, *y = b;
    if (x->first != y->first)
        return x->first < y->first ? -1 : 1;
    return (x->second > y->second) - (x->second < y->second);
}

/* both lists are in order, and balls have no edges */
static pel_status merge(pel_contact_set *set, pel_collision_result *found, pel_error *error)
{
    size_t count = (size_t)found->collision_count + set->ball_pair_count, own = 0, other = 0;
    if (!pel_reserve((void **)&set->joined, &set->joined_capacity, count, sizeof *set->joined))
        return pel_fail_memory(error);
    qsort(set->ball_pairs, set->ball_pair_count, sizeof *set->ball_pairs, compare_pairs);
    for (size_t i = 0; i < count; i++) {
        const pel_collision *next = other < (size_t)found->collision_count ? &found->collisions[other] : NULL;
        bool is_own = own < set->ball_pair_count &&
                      (next == NULL || next->edge_edge || compare_pairs(&set->ball_pairs[own], next) < 0);
        set->joined[i] = is_own ? set->ball_pairs[own++] : found->collisions[other++];
    }
    found->collisions = set->joined;
    found->collision_count = (int64_t)count;
    return PEL_OK;
}

pel_status pel_contact_balls_join(pel_contact_set *set, double distance, bool for_layers, pel_collision_result *found,
                                  pel_error *error)
{
    if (set->ball_count == 0)
        return PEL_OK;
    set->ball_pair_count = 0;
    find_boxes(set, distance, for_layers);
    pel_status status = pair_balls(set, for_layers, error);
    if (status == PEL_OK)
        status = pair_triangles(set, for_layers, error);
    return status == PEL_OK && set->ball_pair_count > 0 ? merge(set, found, error) : status;
}

pel_status pel_contact_balls_find_deepest(pel_contact_set *set, pel_collision *deepest, double *depth, pel_error *error)
{
    pel_collision_result found = {.collision_count = 0};
    *depth = 0;
    pel_status status = pel_contact_balls_join(set, 0, false, &found, error);
    for (int64_t i = 0; status == PEL_OK && i < found.collision_count; i++) {
        pel_collision pair = found.collisions[i];
        double own = pel_contact_pair_radius(set, pair.vertices) - pel_contact_measure_start(set, &pair);
        if (!(own > *depth))
            continue;
        *depth = own;
        *deepest = pair;
    }
    return status;
}
