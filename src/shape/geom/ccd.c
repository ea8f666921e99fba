/* The conservative time of impact of one pair (see ccd_pair.h for the two proofs of freedom).

   First the step is cut into quarters, four lanes of the wide kernel: if each of them has a separating axis, the cubic
   is not needed. Otherwise time is subdivided. On an interval [a, b] the cubic's Bernstein polygon is taken by
   blossoming the coefficients of the whole step, so that errors do not build up; where its hull lies beyond the band
   the interval is clipped away (Bezier clipping: quadratic convergence at simple roots). The rest is tested against
   separating axes; if that fails it is clipped further until the motion within it is below the tolerance, and halved
   when clipping does not shrink it, earlier half first. The lower end of the first interval that could not be proved
   free is the time of impact.

   The axis tried is the vector between the closest points at mid-time, which is the best axis for pairs that do not
   turn, whatever feature is closest. Pairs that slide and turn close to each other would need ever more intervals the
   smaller their gap; after a few intervals an axis that turns with them is tried as well, from the vector between the
   closest points at the start to that at the end, which leaves an error of second order in the interval. The directions
   carry no obligation: the proofs bound their own errors. */
#include "geom/ccd.h"

#include <string.h>

#include "math/vec3.h"

enum { INTERVAL_BUDGET = 2048, STACK_SIZE = 64, EASY_INTERVALS = 8 };

/* no interval of time is split below this; also the outward rounding of a clip */
#define TIME_RESOLUTION (64 * DBL_EPSILON)
#define CLIP_ROUNDING (8 * DBL_EPSILON)

/* of time, 0 <= begin <= end <= 1 */
typedef struct interval {
    double begin, end;
} interval;

/* ---- order and scale ---- */

static bool comes_before(const ccd_points *points, int i, int j)
{
    const double *a = points->start[i], *b = points->start[j];
    int k = 0;
    while (k < 2 && a[k] == b[k])
        k++;
    if (a[k] == b[k]) {
        a = points->end[i];
        b = points->end[j];
        k = 0;
        while (k < 2 && a[k] == b[k])
            k++;
    }
    return a[k] < b[k];
}

static void sort_two(const ccd_points *points, int order[4], int i, int j)
{
    /* which one is first cannot be predicted: no branch */
    int first = order[i], second = order[j], change = (second - first) * comes_before(points, second, first);
    order[i] = first + change;
    order[j] = second - change;
}

/* one order of the points for all orders in which they may be given */
static void sort_points(const ccd_points *points, bool edge_edge, int order[4])
{
    for (int i = 0; i < 4; i++)
        order[i] = i;
    if (!edge_edge) {
        sort_two(points, order, 1, 2);
        sort_two(points, order, 2, 3);
        sort_two(points, order, 1, 2);
        return;
    }
    sort_two(points, order, 0, 1);
    sort_two(points, order, 2, 3);
    bool lower = comes_before(points, order[2], order[0]);
    if (!lower && !comes_before(points, order[0], order[2]))
        lower = comes_before(points, order[3], order[1]);
    if (lower) {
        const int swapped[4] = {order[2], order[3], order[0], order[1]};
        memcpy(order, swapped, sizeof swapped);
    }
}

static void scale_pair(ccd_pair *pair, double scale)
{
    for (int time = 0; time < 2; time++)
        for (int k = 0; k < 3; k++) {
            pair->offset[time][k] *= scale;
            pair->edge1[time][k] *= scale;
            pair->edge2[time][k] *= scale;
        }
}

bool ccd_query_set(const ccd_points *points, bool edge_edge, const ccd_lengths *lengths, ccd_query *query)
{
    double ordered[4][3];
    query->edge_edge = edge_edge;
    query->scale = 1;
    query->min_separation = lengths->min_separation > 0 ? lengths->min_separation : 0;
    query->tolerance = lengths->tolerance > 0 ? lengths->tolerance : 0;
    query->near = lengths->near > query->min_separation ? lengths->near : query->min_separation;
    sort_points(points, edge_edge, query->order);
    for (int time = 0; time < 2; time++) {
        for (int i = 0; i < 4; i++)
            memcpy(ordered[i], (time ? points->end : points->start)[query->order[i]], sizeof ordered[i]);
        ccd_pair_set(&query->pair, time, ordered, edge_edge);
    }
    query->error = ccd_pair_error(&query->pair);
    if (!isfinite(query->error) || !isfinite(lengths->min_separation))
        return false;
    /* products of three lengths neither overflow nor underflow between these */
    if (query->error < 0x1p-200 || query->error > 0x1p200) {
        int exponent;
        frexp(query->error, &exponent);
        exponent = exponent < -950 ? -950 : exponent;
        query->scale = ldexp(1, -exponent);
        scale_pair(&query->pair, query->scale);
        query->min_separation *= query->scale;
        query->tolerance *= query->scale;
        query->near *= query->scale;
        query->error = ccd_pair_error(&query->pair);
    }
    return isfinite(query->error);
}

/* ---- closest place at one time ---- */

/* false when the vector is not longer than `least` */
static bool normalize(double vector[3], double least)
{
    double length = sqrt(pel_vec3_dot(vector, vector));
    if (!(length > least))
        return false;
    for (int k = 0; k < 3; k++)
        vector[k] /= length;
    return true;
}

static double mix(double a, double b, double t)
{
    return (1 - t) * a + t * b;
}

static void closest_place(const double offset[3], const double edge1[3], const double edge2[3], bool edge_edge,
                          double *s, double *u, double vector[3])
{
    static const double origin[3] = {0, 0, 0};
    double end1[3], end2[3], weights[4];
    pel_vec3_along(offset, 1, edge1, end1);
    if (edge_edge) {
        pel_vec3_subtract(origin, edge2, end2);
        pel_closest_segment_segment(offset, end1, origin, end2, weights);
        *s = weights[1];
        *u = weights[3];
    } else {
        pel_vec3_along(offset, 1, edge2, end2);
        pel_closest_point_triangle(origin, offset, end1, end2, weights);
        *s = weights[1];
        *u = weights[2];
    }
    double along1[3];
    pel_vec3_along(offset, *s, edge1, along1);
    pel_vec3_along(along1, *u, edge2, vector);
}

/* Removes the component of a vector along an edge. */
static void straighten(const double edge[3], double vector[3])
{
    double length2 = pel_vec3_dot(edge, edge);
    if (length2 > 0)
        pel_vec3_along(vector, -pel_vec3_dot(vector, edge) / length2, edge, vector);
}

/* The direction of the vector between the closest points, from the features they lie on: the vector itself turns with
   its rounding errors when it is short, and an edge is long. True when they lie inside both features, so that the
   direction is the normal. */
static bool closest_axis(const double offset[3], const double edge1[3], const double edge2[3], bool edge_edge,
                         double vector[3], double axis[3])
{
    double s, u, normal[3], edge3[3];
    closest_place(offset, edge1, edge2, edge_edge, &s, &u, vector);
    memcpy(axis, vector, 3 * sizeof *axis);
    bool along1 = edge_edge ? s > 0 && s < 1 : s > 0 && s + u < 1;
    bool along2 = edge_edge ? u > 0 && u < 1 : u > 0 && s + u < 1;
    bool along3 = !edge_edge && s > 0 && u > 0;
    const bool inside = along1 + along2 + along3 > 1;
    if (inside) {
        pel_vec3_cross(edge1, edge2, normal);
        double along = pel_vec3_dot(normal, axis), length2 = pel_vec3_dot(normal, normal);
        if (length2 > 0)
            for (int k = 0; k < 3; k++)
                axis[k] = along < 0 ? -normal[k] : normal[k];
    } else if (along1) {
        straighten(edge1, axis);
    } else if (along2) {
        straighten(edge2, axis);
    } else if (along3) {
        pel_vec3_subtract(edge1, edge2, edge3);
        straighten(edge3, axis);
    }
    return inside;
}

void ccd_closest(const ccd_query *query, double time, double *s, double *u, double vector[3])
{
    const ccd_pair *pair = &query->pair;
    double offset[3], edge1[3], edge2[3];
    for (int k = 0; k < 3; k++) {
        offset[k] = mix(pair->offset[0][k], pair->offset[1][k], time);
        edge1[k] = mix(pair->edge1[0][k], pair->edge1[1][k], time);
        edge2[k] = mix(pair->edge2[0][k], pair->edge2[1][k], time);
    }
    closest_place(offset, edge1, edge2, query->edge_edge, s, u, vector);
}

/* ---- separating axes on an interval of time ---- */

/* corners at both ends of the interval against the unit vectors between the closest points at these ends, which turn
   into each other: the products are quadratic in time, with these Bernstein coefficients */
static bool is_separated_turning(const ccd_query *query, const ccd_pair *part, double corners[8][3], int count)
{
    double axes[2][3], vector[3], threshold = 0;
    for (int time = 0; time < 2; time++) {
        closest_axis(part->offset[time], part->edge1[time], part->edge2[time], query->edge_edge, vector, axes[time]);
        if (!normalize(axes[time], CCD_TINY_NORMAL))
            return false;
        threshold = real_max(ccd_axis_threshold(axes[time], query->error, query->min_separation), threshold);
    }
    for (int i = 0; i < count; i += 2) {
        double begin = dot(axes[0], corners[i]), end = dot(axes[1], corners[i + 1]);
        double middle = 0.5 * (dot(axes[0], corners[i + 1]) + dot(axes[1], corners[i]));
        if (!(begin > threshold && middle > threshold && end > threshold))
            return false;
    }
    return true;
}

static bool is_separated(const ccd_query *query, const interval *now, int tried)
{
    ccd_pair part;
    double corners[8][3], offset[3], edge1[3], edge2[3], vector[3], axis[3];
    ccd_pair_part(&query->pair, now->begin, now->end, &part);
    int count = ccd_pair_corners(&part, query->edge_edge, corners);
    if (ccd_box_margin(corners, count, query->error, query->min_separation) > 0)
        return true;
    for (int k = 0; k < 3; k++) {
        offset[k] = 0.5 * (part.offset[0][k] + part.offset[1][k]);
        edge1[k] = 0.5 * (part.edge1[0][k] + part.edge1[1][k]);
        edge2[k] = 0.5 * (part.edge2[0][k] + part.edge2[1][k]);
    }
    closest_axis(offset, edge1, edge2, query->edge_edge, vector, axis);
    if (ccd_axis_margin(corners, count, axis, query->error, query->min_separation) > 0)
        return true;
    if (tried <= EASY_INTERVALS)
        return false;
    return ccd_axis_margin(corners, count, vector, query->error, query->min_separation) > 0 ||
           is_separated_turning(query, &part, corners, count);
}

/* ---- clipping ---- */

/* Bernstein coefficients on [begin, end] from those on [0, 1] */
static void blossom(const double b[4], double begin, double end, double part[4])
{
    double p0 = mix(b[0], b[1], begin), p1 = mix(b[1], b[2], begin), p2 = mix(b[2], b[3], begin);
    double q0 = mix(b[0], b[1], end), q1 = mix(b[1], b[2], end), q2 = mix(b[2], b[3], end);
    double pp0 = mix(p0, p1, begin), pp1 = mix(p1, p2, begin);
    double pq0 = mix(p0, p1, end), pq1 = mix(p1, p2, end);
    double qq0 = mix(q0, q1, end), qq1 = mix(q1, q2, end);
    part[0] = mix(pp0, pp1, begin);
    part[1] = mix(pp0, pp1, end);
    part[2] = mix(pq0, pq1, end);
    part[3] = mix(qq0, qq1, end);
}

/* first place in [0, 1] where the hull of the polygon comes down to `level`; the polygon starts above it */
static double first_below(const double b[4], double level)
{
    double first = 1;
    for (int i = 0; i < 3; i++)
        for (int j = i + 1; j < 4; j++)
            if (b[i] > level && b[j] <= level) {
                double place = (i + (j - i) * ((b[i] - level) / (b[i] - b[j]))) / 3;
                first = place < first ? place : first;
            }
    return first;
}

/* first place where the hull meets the band about zero; 2 when it never does */
static double first_in_band(const double b[4], double band)
{
    if (b[0] > band)
        return first_below(b, band);
    if (b[0] < -band) {
        const double mirrored[4] = {-b[0], -b[1], -b[2], -b[3]};
        return first_below(mirrored, band);
    }
    return 0;
}

/* Shrinks an interval to where the cubic may be zero; false when it is nowhere. */
static bool clip(const ccd_cubic *cubic, interval *now)
{
    double b[4];
    blossom(cubic->coefficient, now->begin, now->end, b);
    if (ccd_cubic_margin(b, cubic->band) > 0)
        return false;
    const double reversed[4] = {b[3], b[2], b[1], b[0]};
    double width = now->end - now->begin;
    double low = now->begin + width * first_in_band(b, cubic->band) - CLIP_ROUNDING;
    double high = now->end - width * first_in_band(reversed, cubic->band) + CLIP_ROUNDING;
    if (low > now->begin)
        now->begin = low;
    if (high < now->end)
        now->end = high;
    return true;
}

/* ---- search in time ---- */

/* no point of the one feature moves faster relative to the other */
static double relative_speed(const ccd_query *query)
{
    double corners[8][3], largest = 0;
    int count = ccd_pair_corners(&query->pair, query->edge_edge, corners);
    for (int i = 0; i < count; i += 2) {
        double motion[3];
        pel_vec3_subtract(corners[i + 1], corners[i], motion);
        largest = real_max(pel_vec3_dot(motion, motion), largest);
    }
    return sqrt(largest);
}

/* True with the first time that is not proved free. */
static bool search(const ccd_query *query, const ccd_cubic *cubic, double *time, ccd_counts *counts)
{
    interval later[STACK_SIZE], now = {0, 1};
    int depth = 0;
    double speed = relative_speed(query);
    for (counts->intervals = 1;; counts->intervals++) {
        double width = now.end - now.begin;
        if (!clip(cubic, &now) || is_separated(query, &now, counts->intervals)) {
            if (depth == 0)
                return false;
            now = later[--depth];
            continue;
        }
        counts->fall_back = counts->intervals >= INTERVAL_BUDGET;
        double left = now.end - now.begin;
        if (counts->fall_back || left <= TIME_RESOLUTION || !(left * speed > query->tolerance)) {
            *time = now.begin;
            return true;
        }
        if (left > 0.5 * width && depth < STACK_SIZE) {
            double middle = 0.5 * (now.begin + now.end);
            later[depth++] = (interval){middle, now.end};
            now.end = middle;
        }
    }
}

/* the quarters of a step, one a lane: where axes separate each of them there is no need of the cubic */
typedef struct quarters {
    wide4 corners[8][3], margin;
} quarters;

WIDE4_INLINE void set_quarters(const ccd_query *query, bool edge_edge, quarters *q)
{
    static const wide4 begin = {0, 0.25, 0.5, 0.75}, end = {0.25, 0.5, 0.75, 1};
    wide_ccd_pair pair, part;
    for (int time = 0; time < 2; time++)
        for (int k = 0; k < 3; k++) {
            pair.offset[time][k] = wide4_set(query->pair.offset[time][k]);
            pair.edge1[time][k] = wide4_set(query->pair.edge1[time][k]);
            pair.edge2[time][k] = wide4_set(query->pair.edge2[time][k]);
        }
    wide_ccd_pair_part(&pair, begin, end, &part);
    const int count = wide_ccd_pair_corners(&part, edge_edge, q->corners);
    q->margin = wide_ccd_hull_margin(&part, q->corners, count, wide4_set(query->error), query->min_separation);
}

typedef enum step_state { STEP_IS_FREE, STEP_STARTS_NEAR, STEP_IS_UNKNOWN } step_state;

/* the axis between the closest points at the start is best where not much moves */
WIDE4_INLINE step_state look_for_axes(const ccd_query *query, bool edge_edge)
{
    quarters q;
    const int count = edge_edge ? 8 : 6;
    const wide4 error = wide4_set(query->error);
    double vector[3], axis[3];
    set_quarters(query, edge_edge, &q);
    if (wide4_all(q.margin > 0))
        return STEP_IS_FREE;
    const bool inside =
        closest_axis(query->pair.offset[0], query->pair.edge1[0], query->pair.edge2[0], edge_edge, vector, axis);
    const double square = pel_vec3_dot(vector, vector);
    if (square <= query->min_separation * query->min_separation)
        return STEP_STARTS_NEAR;
    wide4 direction[3] = {wide4_set(axis[0]), wide4_set(axis[1]), wide4_set(axis[2])};
    wide4 margin = wide_ccd_axis_margin(q.corners, count, direction, error, query->min_separation);
    q.margin = wide4_max(margin, q.margin);
    if (wide4_all(q.margin > 0))
        return STEP_IS_FREE;
    margin = wide_ccd_descent_margin(q.corners, count, error, query->min_separation);
    if (wide4_all(wide4_max(margin, q.margin) > 0))
        return STEP_IS_FREE;
    return inside && square <= query->near * query->near ? STEP_STARTS_NEAR : STEP_IS_UNKNOWN;
}

bool ccd_solve(const ccd_points *points, bool edge_edge, const ccd_lengths *lengths, pel_ccd_hit *hit,
               ccd_counts *counts)
{
    ccd_query query;
    ccd_cubic cubic;
    double time = 0;
    *counts = (ccd_counts){0};
    if (!ccd_query_set(points, edge_edge, lengths, &query)) {
        ccd_hit_unknown(edge_edge, hit);
        return true;
    }
    ccd_pair_cubic(&query.pair, query.min_separation, &cubic);
    if (ccd_cubic_margin(cubic.coefficient, cubic.band) > 0)
        return false;
    step_state state = edge_edge ? look_for_axes(&query, true) : look_for_axes(&query, false);
    if (state == STEP_IS_FREE || (state == STEP_IS_UNKNOWN && !search(&query, &cubic, &time, counts)))
        return false;
    ccd_hit_set(&query, time, hit);
    return true;
}

/* ---- the hit ---- */

static void hit_weights(const ccd_query *query, double s, double u, double weight[4])
{
    const double vertex_face[4] = {1, -(1 - (s + u)), -s, -u}, edge_edge[4] = {1 - s, s, -(1 - u), -u};
    for (int i = 0; i < 4; i++)
        weight[query->order[i]] = query->edge_edge ? edge_edge[i] : vertex_face[i];
    /* edges that were exchanged for the canonical order */
    if (query->edge_edge && query->order[0] >= 2)
        for (int i = 0; i < 4; i++)
            weight[i] = -weight[i];
}

/* where the features touch from the start: the plane's normal against the relative motion at the place */
static void normal_against_motion(const ccd_query *query, double s, double u, double normal[3])
{
    const ccd_pair *pair = &query->pair;
    double motion[3], least = CCD_TINY_NORMAL;
    for (int k = 0; k < 3; k++)
        motion[k] = pair->offset[1][k] - pair->offset[0][k] + s * (pair->edge1[1][k] - pair->edge1[0][k]) +
                    u * (pair->edge2[1][k] - pair->edge2[0][k]);
    pel_vec3_cross(pair->edge1[0], pair->edge2[0], normal);
    if (!normalize(normal, least)) {
        const double negative[3] = {-motion[0], -motion[1], -motion[2]}, any[3] = {0, 0, 1};
        memcpy(normal, negative, sizeof negative);
        if (!normalize(normal, least))
            memcpy(normal, any, sizeof any);
        return;
    }
    double along = pel_vec3_dot(normal, motion);
    for (int k = 0; k < 3 && along > 0; k++)
        normal[k] = -normal[k];
}

void ccd_hit_set(const ccd_query *query, double time, pel_ccd_hit *hit)
{
    if (hit == NULL)
        return;
    double s, u, vector[3], earlier_s, earlier_u;
    ccd_closest(query, time, &s, &u, vector);
    hit->time_of_impact = time;
    hit_weights(query, s, u, hit->weight);
    /* the distance must exceed its rounding error: go back in time until it does */
    double least = 256 * query->error;
    bool found = normalize(vector, least);
    for (double back = 0x1p-24; !found && time > 0 && back < 8; back *= 8) {
        ccd_closest(query, back < time ? time - back : 0, &earlier_s, &earlier_u, vector);
        found = normalize(vector, least);
    }
    if (!found)
        normal_against_motion(query, s, u, vector);
    bool exchanged = query->edge_edge && query->order[0] >= 2;
    for (int k = 0; k < 3; k++)
        hit->normal[k] = exchanged ? -vector[k] : vector[k];
}

void ccd_hit_unknown(bool edge_edge, pel_ccd_hit *hit)
{
    static const pel_ccd_hit vertex_face = {.weight = {1, -1.0 / 3, -1.0 / 3, -1.0 / 3}};
    static const pel_ccd_hit edges = {.weight = {0.5, 0.5, -0.5, -0.5}};
    if (hit != NULL)
        *hit = edge_edge ? edges : vertex_face;
}

/* ---- public functions ---- */

static ccd_points points_of(const double start[4][3], const double end[4][3])
{
    ccd_points points;
    for (int i = 0; i < 4; i++) {
        points.start[i] = start[i];
        points.end[i] = end[i];
    }
    return points;
}

bool pel_ccd_vertex_face(const double start[4][3], const double end[4][3], double min_separation, double tolerance,
                         pel_ccd_hit *hit)
{
    ccd_counts counts;
    ccd_points points = points_of(start, end);
    return ccd_solve(&points, false, &(ccd_lengths){min_separation, tolerance, 0}, hit, &counts);
}

bool pel_ccd_edge_edge(const double start[4][3], const double end[4][3], double min_separation, double tolerance,
                       pel_ccd_hit *hit)
{
    ccd_counts counts;
    ccd_points points = points_of(start, end);
    return ccd_solve(&points, true, &(ccd_lengths){min_separation, tolerance, 0}, hit, &counts);
}

bool pel_ccd_filter(const double start[4][3], const double end[4][3], bool edge_edge, double min_separation)
{
    ccd_query query;
    ccd_cubic cubic;
    ccd_points points = points_of(start, end);
    if (!ccd_query_set(&points, edge_edge, &(ccd_lengths){.min_separation = min_separation}, &query))
        return true;
    ccd_pair_cubic(&query.pair, query.min_separation, &cubic);
    return !(ccd_cubic_margin(cubic.coefficient, cubic.band) > 0);
}

bool pel_ccd_bridson(const double start[4][3], const double end[4][3], bool edge_edge, double min_separation,
                     double tolerance, pel_ccd_hit *hit)
{
    ccd_points points = points_of(start, end);
    return ccd_solve_bridson(&points, edge_edge, min_separation, tolerance, hit);
}
