/* Which pairs of a search may touch in a step. */
#include "collide/ends.h"
#include "contact/set.h"
#include "geom/ccd.h"
#include "math/extremes.h"

#include <string.h>

/* of an edge: what slides less in a step crosses no edge that it meets at an end but near that end, where vertices keep
   it off */
#define SLIDE_SHARE 0.35
/* of the thickness: lines with this much room keep their edges apart, once vertices do */
#define ROOM_SHARE 0.9

/* edges that their ends do not keep apart */
static int32_t sift_edges(const pel_contact_set *set, const int32_t (*points)[4], int32_t count, int32_t *numbers)
{
    double rooms[PEL_COLLIDER_BLOCK];
    const pel_edge_pairs pairs = {.start = (const double(*)[3])set->start,
                                  .end = (const double(*)[3])set->end,
                                  .points = points,
                                  .rooms = rooms,
                                  .count = count,
                                  .slide = SLIDE_SHARE * set->def.shortest_edge - set->margin};
    bool are_same = set->finest == set->largest;
    for (int32_t i = 0; i < count; i++)
        rooms[i] = ROOM_SHARE * (are_same ? set->largest : pel_contact_pair_thickness(set, points[i]));
    return pel_edges_to_measure(&pairs, numbers);
}

int32_t pel_contact_sift(const void *context, bool edge_edge, const pel_pair *pairs, const int32_t (*points)[4],
                         int32_t count, int32_t *numbers)
{
    const pel_contact_set *set = context;
    int32_t left = 0;
    if (edge_edge)
        count = sift_edges(set, points, count, numbers);
    for (int32_t i = 0; i < count; i++) {
        int32_t number = edge_edge ? numbers[i] : i;
        numbers[left] = number;
        left += !set->known.is_used || !pel_contact_is_known(&set->known, edge_edge, &pairs[number], points[number]);
    }
    return left;
}

double pel_contact_measure_start(const pel_contact_set *set, pel_collision *pair)
{
    const double(*x)[3] = (const double(*)[3])set->start;
    const int32_t *v = pair->vertices;
    double *w = pair->hit.weight, way[3] = {0, 0, 0};
    if (pair->edge_edge)
        pel_closest_segment_segment(x[v[0]], x[v[1]], x[v[2]], x[v[3]], w);
    else if (pel_contact_are_balls(v)) {
        w[0] = w[1] = 1;
        w[2] = w[3] = 0;
    } else {
        w[0] = 1;
        pel_closest_point_triangle(x[v[0]], x[v[1]], x[v[2]], x[v[3]], w + 1);
    }
    for (int i = 0; i < 4; i++) {
        w[i] *= i < (pair->edge_edge ? 2 : 1) ? 1 : -1;
        pel_vec3_along(way, w[i], x[v[i]], way);
    }
    double distance = pel_vec3_length(way);
    pel_vec3_scale(way, distance > 0 ? 1 / distance : 0, pair->hit.normal);
    return distance;
}

/* m */
static double distance_at_end(const pel_contact_set *set, const pel_collision *pair)
{
    const double(*x)[3] = (const double(*)[3])set->end;
    const int32_t *v = pair->vertices;
    double weights[4];
    return sqrt(pair->edge_edge ? pel_closest_segment_segment(x[v[0]], x[v[1]], x[v[2]], x[v[3]], weights)
                                : pel_closest_point_triangle(x[v[0]], x[v[1]], x[v[2]], x[v[3]], weights));
}

/* whether straight ways from start to end bring a pair within a distance, by the conservative test */
static bool comes_within(const pel_contact_set *set, const pel_collision *pair, double distance)
{
    const pel_ccd_batch batch = {.start = set->start[0],
                                 .end = set->end[0],
                                 .points = pair->vertices,
                                 .query_count = 1,
                                 .edge_edge = pair->edge_edge,
                                 .min_separation = distance,
                                 .tolerance = PEL_CONTACT_TOLERANCE * set->least};
    pel_ccd_statistics statistics = {0};
    pel_ccd_hit hit;
    int32_t number;
    return pel_ccd_solve_batch(&batch, &number, &hit, &statistics) > 0;
}

bool pel_contact_may_meet(const void *context, pel_collision *pair)
{
    const pel_contact_set *set = context;
    int32_t first = pel_contact_obstacle_of(set, pair->vertices[0]);
    int32_t obstacle = first >= 0 ? first : pel_contact_obstacle_of(set, pair->vertices[3]);
    if (pel_contact_sleeps(set, pair->vertices))
        return false;
    /* the substeps see these as solids */
    if (obstacle >= 0 && set->obstacles[obstacle].mesh == NULL)
        return false;
    double distance = pel_contact_measure_start(set, pair);
    double reach = pel_contact_pair_thickness(set, pair->vertices) + set->margin;
    return distance <= reach || (distance <= reach + pel_contact_longest_approach(set, pair) &&
                                 (distance_at_end(set, pair) <= reach || comes_within(set, pair, reach)));
}
