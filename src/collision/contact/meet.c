/* Which pairs of a search may touch in a step. */
#include "contact/set.h"
#include "geom/ccd.h"
#include "math/extremes.h"

#include <string.h>

/* weights of a closest point that is not at an end are larger */
#define INSIDE 1e-3
/* of an edge: what slides less in a step crosses no edge that it meets at an end but near that end, where vertices keep
   it off */
#define SLIDE_SHARE 0.35
/* sine of the angle below which edges are parallel */
#define PARALLEL 0.01
/* of the thickness: lines with this much room keep their edges apart, once vertices do */
#define ROOM_SHARE 0.9

/* features hardly slide along each other in a step whose points move against each other by at most `way` [m] */
static bool hardly_slides(const pel_contact_set *set, double way)
{
    return way + set->margin < SLIDE_SHARE * set->def.shortest_edge;
}

/* Whether vertices keep two edges apart that hardly slide: their closest points at `start` lie at an end of one, and
   the lines along them, which cross where the edges slide over each other, leave room for the layer; or they are
   parallel. The lines are nearest to each other at the shares s of u and t of v; if one of these is not inside, the
   edges meet at an end. */
static bool is_kept_by_ends(const pel_contact_set *set, const pel_collision *pair)
{
    const double(*x)[3] = (const double(*)[3])set->start;
    const double *a = x[pair->vertices[0]], *b = x[pair->vertices[2]];
    double u[3], v[3], way[3], cross[3];
    pel_vec3_subtract(x[pair->vertices[1]], a, u);
    pel_vec3_subtract(x[pair->vertices[3]], b, v);
    pel_vec3_subtract(b, a, way);
    double uu = pel_vec3_squared_length(u), vv = pel_vec3_squared_length(v), uv = pel_vec3_dot(u, v);
    double along_u = pel_vec3_dot(way, u), along_v = pel_vec3_dot(way, v), sine = uu * vv - uv * uv;
    double s = along_u * vv - along_v * uv, t = along_u * uv - along_v * uu, least = INSIDE * sine;
    if (sine < PARALLEL * PARALLEL * uu * vv)
        return true;
    pel_vec3_cross(u, v, cross);
    double across = pel_vec3_dot(way, cross), room = ROOM_SHARE * pel_contact_pair_thickness(set, pair->vertices);
    return (s < least || t < least || s > sine - least || t > sine - least) && across * across >= room * room * sine;
}

double pel_contact_measure_start(const pel_contact_set *set, pel_collision *pair)
{
    const double(*x)[3] = (const double(*)[3])set->start;
    const int32_t *v = pair->vertices;
    double *w = pair->hit.weight, way[3] = {0, 0, 0};
    if (pair->edge_edge)
        pel_closest_segment_segment(x[v[0]], x[v[1]], x[v[2]], x[v[3]], w);
    else {
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
    const int32_t *group = set->group_of_point;
    int32_t first = pel_contact_obstacle_of(set, pair->vertices[0]);
    int32_t obstacle = first >= 0 ? first : pel_contact_obstacle_of(set, pair->vertices[3]);
    if (set->asleep_count > 0 && set->is_asleep[group[pair->vertices[0]]] && set->is_asleep[group[pair->vertices[3]]])
        return false;
    /* the substeps see these as solids */
    if (obstacle >= 0 && set->obstacles[obstacle].mesh == NULL)
        return false;
    double way = pel_contact_longest_approach(set, pair);
    if (pair->edge_edge && hardly_slides(set, way) && is_kept_by_ends(set, pair))
        return false;
    double distance = pel_contact_measure_start(set, pair);
    double reach = pel_contact_pair_thickness(set, pair->vertices) + set->margin;
    return distance <= reach ||
           (distance <= reach + way && (distance_at_end(set, pair) <= reach || comes_within(set, pair, reach)));
}
