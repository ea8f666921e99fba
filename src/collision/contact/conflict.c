/* Conflicts: pairs that come nearer than they may between the start and the end of a step, by the conservative test.

   How near may a pair come? To the guarded distance; when it starts nearer than that, to 0.99 of where it starts, so
   that it can part and slide but not close in.

   Rigid bodies roll around each other and do not go straight: a marble that turns by an angle a comes nearer by its
   radius times a^2 / 8 on the chord, which is far more than the thickness. So a pair whose end is free is tested again
   along the path of its bodies, in parts on which they turn by TURN at most. Such a pair is not what other pairs of the
   same triangles were tested for, which is their straight way: one may pass on the path and the other on the chord,
   while an edge ends in a triangle. But two triangles that intersect at the end, and did not at the start, have a pair
   that meets on the chord. So no triangles of the features of a pair that is let pass may intersect at the end. */
#include "contact/set.h"

#include "base/memory.h"
#include "base/status.h"
#include "geom/wide4.h"
#include "math/extremes.h"

#include <string.h>

enum { HITS_OF_CHUNK = 64 };

#define APPROACH 0.99
#define NO_IMPACT 2.0
/* rad */
#define TURN 0.02
enum { MOST_PARTS = 64 };

typedef struct check {
    const pel_contact_set *set;
    const pel_collision_result *found;
} check;

/* m; weights of the closest points: of the triangle, or of both edges */
static double closest_at(const double (*x)[3], const pel_collision *hit, double weights[4])
{
    const int32_t *v = hit->vertices;
    if (!hit->edge_edge && pel_contact_are_balls(v)) {
        pel_vec3_set(weights, 1, 0, 0);
        return pel_vec3_distance(x[v[0]], x[v[1]]);
    }
    double square = hit->edge_edge ? pel_closest_segment_segment(x[v[0]], x[v[1]], x[v[2]], x[v[3]], weights)
                                   : pel_closest_point_triangle(x[v[0]], x[v[1]], x[v[2]], x[v[3]], weights);
    return sqrt(square);
}

static double distance_at(const double (*x)[3], const pel_collision *hit)
{
    double weights[4];
    return closest_at(x, hit, weights);
}

double pel_contact_start_distance(const pel_contact_set *set, const pel_collision *hit)
{
    return distance_at((const double(*)[3])set->start, hit) - pel_contact_pair_radius(set, hit->vertices);
}

double pel_contact_conflict_way(const pel_contact_set *set, const pel_conflict *conflict)
{
    double way = 0, most = 0, mean[3] = {0, 0, 0};
    if (conflict->obstacle >= 0) {
        const pel_obstacle *obstacle = &set->obstacles[conflict->obstacle];
        pel_vec3_subtract(obstacle->pose.position, obstacle->before.position, mean);
        way =
            pel_pose_way(&obstacle->before, &obstacle->pose, pel_solid_size(&obstacle->solid)) - pel_vec3_length(mean);
    } else
        pel_vec3_subtract(set->end[conflict->vertices[0]], set->start[conflict->vertices[0]], mean);
    for (int i = 0; i < 4; i++) {
        int32_t v = conflict->vertices[i];
        double own[3];
        if (v < 0)
            continue;
        pel_vec3_subtract(set->end[v], set->start[v], own);
        double length = pel_vec3_distance(own, mean);
        most = length > most ? length : most;
    }
    return most + way;
}

/* m, distance that the guard keeps between the two parts of a pair */
static double guarded_of(const pel_contact_set *set, const pel_collision *hit)
{
    return pel_contact_pair_share(set, hit->vertices) * set->guarded;
}

/* in how many parts the path of a pair is tested again; 0 = it is straight */
static int count_parts(const pel_contact_set *set, const pel_collision *hit)
{
    int knots = pel_contact_count_knots(set, hit->vertices), parts = 0;
    for (int i = 0; i < 4 && knots > 0; i++) {
        int32_t v = hit->vertices[i];
        const pel_rigid *rigid = v < set->vertex_count ? pel_rigid_of(set->def.rigids, v) : NULL;
        if (rigid != NULL)
            parts = (int)pel_max(parts, pel_min(ceil(pel_rigid_turned(rigid) / TURN), MOST_PARTS));
    }
    return knots > 0 ? (parts + knots - 1) / knots * knots : 0;
}

/* whether a pair keeps a separation [m] while its rigid bodies turn */
static bool turns_free(const pel_contact_set *set, const pel_collision *hit, double separation)
{
    static const int32_t points[4] = {0, 1, 2, 3};
    double x[2][5][3] = {{{0}}};
    int count = count_parts(set, hit);
    pel_contact_place_between(set, hit->vertices, 0, x[0]);
    pel_ccd_batch batch = {.points = points,
                           .query_count = 1,
                           .edge_edge = hit->edge_edge,
                           .min_separation = separation,
                           .tolerance = 1e-3 * separation};
    for (int i = 0; i < count; i++) {
        pel_ccd_statistics statistics = {0};
        pel_ccd_hit impact;
        int32_t number;
        batch.start = x[i % 2][0];
        batch.end = x[1 - i % 2][0];
        pel_contact_place_between(set, hit->vertices, (i + 1.0) / count, x[1 - i % 2]);
        if (pel_ccd_solve_batch(&batch, &number, &impact, &statistics) > 0)
            return false;
    }
    return count > 1;
}

static bool triangles_cross(const pel_contact_set *set, int32_t a, int32_t b)
{
    double x[2][3][3];
    for (int i = 0; i < 3; i++) {
        pel_vec3_copy(set->end[set->triangles[a][i]], x[0][i]);
        pel_vec3_copy(set->end[set->triangles[b][i]], x[1][i]);
    }
    return pel_triangles_intersect((const double(*)[3])x[0], (const double(*)[3])x[1]);
}

/* whether triangles at the two edges cross */
static bool edges_cross(const pel_contact_set *set, int32_t e, int32_t f)
{
    const int32_t *next = pel_collider_tree(set->collider)->next_in_edge;
    int32_t g = e, h = f;
    do
        do
            if (triangles_cross(set, g / 3, h / 3))
                return true;
        while ((h = next[h]) != f);
    while ((g = next[g]) != e);
    return false;
}

/* whether triangles of the features of a pair intersect at the end */
static bool ends_crossed(const pel_contact_set *set, const pel_collision *hit)
{
    if (hit->edge_edge)
        return edges_cross(set, hit->first, hit->second);
    for (int32_t t = 0; t < set->triangle_count; t++) {
        const int32_t *v = set->triangles[t];
        if ((v[0] == hit->first || v[1] == hit->first || v[2] == hit->first) && triangles_cross(set, t, hit->second))
            return true;
    }
    return false;
}

/* impact of what the guard minds */
static pel_timed_hit find_impact(const pel_contact_set *set, const pel_collision *hit)
{
    if (pel_contact_pair_radius(set, hit->vertices) > 0)
        return pel_contact_ball_impact(set, hit, guarded_of(set, hit));
    pel_timed_hit impact = {.hit.time_of_impact = NO_IMPACT}, found = impact;
    double distance = pel_contact_start_distance(set, hit), approach = pel_contact_longest_approach(set, hit);
    double separation = pel_min(guarded_of(set, hit), APPROACH * distance);
    /* twice, to be far from rounding */
    if (approach == 0 || distance - 2 * approach > separation)
        return impact;
    const pel_ccd_batch batch = {.start = set->start[0],
                                 .end = set->end[0],
                                 .points = hit->vertices,
                                 .query_count = 1,
                                 .edge_edge = hit->edge_edge,
                                 .min_separation = separation,
                                 .tolerance = 1e-3 * separation};
    pel_ccd_statistics statistics = {0};
    int32_t number;
    bool is_hit = pel_ccd_solve_batch(&batch, &number, &found.hit, &statistics) > 0;
    bool may_turn = is_hit && set->def.rigids != NULL && distance_at((const double(*)[3])set->end, hit) > separation;
    if (is_hit && !(may_turn && turns_free(set, hit, separation) && !ends_crossed(set, hit)))
        impact = found;
    impact.is_solved = statistics.cubics > 0;
    return impact;
}

static void check_chunk(void *context, int32_t chunk)
{
    const check *c = context;
    int64_t begin = (int64_t)chunk * HITS_OF_CHUNK, end = begin + HITS_OF_CHUNK;
    for (int64_t i = begin; i < end && i < c->found->collision_count; i++)
        c->set->impacts[i] = find_impact(c->set, &c->found->collisions[i]);
}

pel_status pel_contact_add_conflict(pel_contact_set *set, const pel_conflict *conflict, pel_error *error)
{
    if (!pel_reserve((void **)&set->conflicts, &set->conflict_capacity, set->conflict_count + 1,
                     sizeof *set->conflicts))
        return pel_fail_memory(error);
    set->conflicts[set->conflict_count++] = *conflict;
    return PEL_OK;
}

/* six times the signed volume of a vertex and a triangle */
static double volume_at(const double (*x)[3], const int32_t v[4])
{
    double a[3], b[3], c[3], normal[3];
    pel_vec3_subtract(x[v[2]], x[v[1]], a);
    pel_vec3_subtract(x[v[3]], x[v[1]], b);
    pel_vec3_subtract(x[v[0]], x[v[1]], c);
    pel_vec3_cross(a, b, normal);
    return pel_vec3_dot(normal, c);
}

/* Whether the end is beyond the reach of the guard. A vertex right behind the triangle has gone through it. Edges that
   lie otherwise than before may have turned around each other's ends: counted as well, a stiff sheet thrown at the
   corner of a cube gained energy. */
static bool ends_free(const pel_contact_set *set, const pel_collision *hit)
{
    const double(*start)[3] = (const double(*)[3])set->start, (*end)[3] = (const double(*)[3])set->end;
    double weights[4], distance = closest_at(end, hit, weights) - pel_contact_pair_radius(set, hit->vertices);
    bool is_inside = !hit->edge_edge && pel_min(weights[0], pel_min(weights[1], weights[2])) > 0;
    bool is_behind = is_inside && volume_at(start, hit->vertices) * volume_at(end, hit->vertices) < 0;
    return distance > guarded_of(set, hit) && !is_behind;
}

static pel_status add_hit(pel_contact_set *set, const pel_collision *hit, double time, pel_error *error)
{
    pel_conflict conflict = {.obstacle = -1, .time = time, .ends_free = ends_free(set, hit)};
    for (int i = 0; i < 4; i++) {
        int32_t obstacle = pel_contact_obstacle_of(set, hit->vertices[i]);
        conflict.vertices[i] = obstacle < 0 ? hit->vertices[i] : -1;
        conflict.obstacle = obstacle < 0 ? conflict.obstacle : obstacle;
    }
    return pel_contact_add_conflict(set, &conflict, error);
}

pel_status pel_contact_find_conflicts(pel_contact_set *set, const pel_collision_result *found, pel_error *error)
{
    set->conflict_count = 0;
    if (!pel_reserve((void **)&set->impacts, &set->impact_capacity, (size_t)found->collision_count,
                     sizeof *set->impacts))
        return pel_fail_memory(error);
    check all = {set, found};
    pel_pool_run(set->def.pool, (int32_t)((found->collision_count + HITS_OF_CHUNK - 1) / HITS_OF_CHUNK), check_chunk,
                 &all);
    pel_status status = PEL_OK;
    for (int64_t i = 0; status == PEL_OK && i < found->collision_count; i++) {
        const pel_collision *hit = &found->collisions[i];
        const pel_timed_hit *impact = &set->impacts[i];
        set->statistics.cubics += impact->is_solved;
        if (impact->hit.time_of_impact > 1 || (set->tangles.count > 0 && pel_tangles_have(set, hit)))
            continue;
        status = add_hit(set, hit, impact->hit.time_of_impact, error);
    }
    if (status == PEL_OK)
        status = pel_contact_ball_conflicts(set, error);
    return status == PEL_OK ? pel_contact_round_conflicts(set, error) : status;
}

pel_status pel_contact_look(pel_contact_set *set, pel_error *error)
{
    pel_collision_query query = pel_collision_query_default();
    query.start = (const double *)set->start;
    query.end = (const double *)set->end;
    query.min_separation = set->guarded;
    query.near = set->near;
    pel_collision_result found;
    set->way_is_searched = false;
    pel_status status = pel_collider_detect(set->collider, &query, &found, error);
    pel_contact_count_search(set, &found);
    if (status == PEL_OK)
        status = pel_contact_balls_join(set, set->guarded, false, &found, error);
    return status == PEL_OK ? pel_contact_find_conflicts(set, &found, error) : status;
}
