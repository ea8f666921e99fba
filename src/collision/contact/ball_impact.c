/* Balls in the guard.

   A step is free for a pair if one of two ways between its ends is: the straight one, or the path through the substeps,
   on which a ball bounces off a wall and rolls around another one where the chord cuts through. Balls have no other
   sides than that, so the end is free too. On a straight way of two balls the time of impact is the root of a square.
 */
#include "contact/set.h"

#include "math/extremes.h"

#define NO_IMPACT 2.0
/* how near the guard lets a pair come, of where it started; of the guarded distance: what starts so near touches */
#define APPROACH 0.99
#define TOUCHING 0.01
/* of the guarded distance, of a time of impact */
#define TOLERANCE 1e-3
/* of an advance towards a capsule */
enum { MOST_ADVANCES = 1000 };

/* The share of straight ways at which two points come within a distance, above 1 = never; they may start nearer. */
static double meet_points(const double from[3], const double to[3], double distance)
{
    double way[3];
    pel_vec3_subtract(to, from, way);
    /* |from + t way|^2 = distance^2 */
    double a = pel_vec3_squared_length(way), b = pel_vec3_dot(from, way);
    double c = pel_vec3_squared_length(from) - distance * distance, root = b * b - a * c;
    if (c <= 0)
        return 0;
    return b < 0 && root >= 0 ? c / (sqrt(root) - b) : NO_IMPACT;
}

/* fills the place of an impact in: weights, and the normal to the ball */
static void set_place(const double x[4][3], bool are_balls, pel_ccd_hit *hit)
{
    double *w = hit->weight, way[3] = {0};
    pel_vec3_set(w + 1, 1, 0, 0);
    if (!are_balls)
        pel_closest_point_triangle(x[0], x[1], x[2], x[3], w + 1);
    w[0] = 1;
    for (int i = 0; i < 4; i++) {
        w[i] = i == 0 ? 1 : -w[i];
        pel_vec3_along(way, w[i], x[i], way);
    }
    if (pel_vec3_normalize(way) > 0)
        pel_vec3_copy(way, hit->normal);
}

/* the same for a pair on one part of its path */
static double meet_pair(double from[4][3], double to[4][3], bool are_balls, double distance, double tolerance,
                        pel_ccd_hit *hit)
{
    double x[4][3];
    hit->time_of_impact = NO_IMPACT;
    if (are_balls) {
        double start[3], end[3];
        pel_vec3_subtract(from[0], from[1], start);
        pel_vec3_subtract(to[0], to[1], end);
        hit->time_of_impact = meet_points(start, end, distance);
    } else if (!pel_ccd_vertex_face((const double(*)[3])from, (const double(*)[3])to, distance, tolerance, hit))
        hit->time_of_impact = NO_IMPACT;
    if (hit->time_of_impact > 1)
        return NO_IMPACT;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            x[i][k] = from[i][k] + hit->time_of_impact * (to[i][k] - from[i][k]);
    set_place((const double(*)[3])x, are_balls, hit);
    return hit->time_of_impact;
}

static double gap_at(double x[4][3], bool are_balls, double radius)
{
    double w[3];
    return (are_balls ? pel_vec3_distance(x[0], x[1]) : sqrt(pel_closest_point_triangle(x[0], x[1], x[2], x[3], w))) -
           radius;
}

pel_timed_hit pel_contact_ball_impact(const pel_contact_set *set, const pel_collision *hit, double guarded)
{
    pel_timed_hit impact = {.hit.time_of_impact = NO_IMPACT};
    bool are_balls = pel_contact_are_balls(hit->vertices);
    double radius = pel_contact_pair_radius(set, hit->vertices), x[2][4][3];
    int knots = pel_contact_count_knots(set, hit->vertices);
    pel_contact_place_between(set, hit->vertices, 0, x[0]);
    double gap = gap_at(x[0], are_balls, radius), separation = pel_min(guarded, APPROACH * gap);
    if (gap < TOUCHING * guarded) {
        /* touching from the start on: balls may begin a little in each other, and part */
        pel_contact_place_between(set, hit->vertices, 1, x[1]);
        if (gap_at(x[1], are_balls, radius) >= pel_min(gap, 0))
            return impact;
        set_place((const double(*)[3])x[0], are_balls, &impact.hit);
        impact.hit.time_of_impact = 0;
        return impact;
    }
    pel_contact_place_between(set, hit->vertices, 1, x[1]);
    double reach = radius + separation, tolerance = TOLERANCE * separation;
    if (meet_pair(x[0], x[1], are_balls, reach, tolerance, &impact.hit) > 1 || !(knots > 1) ||
        gap_at(x[1], are_balls, radius) <= separation)
        return impact;
    for (int i = 0; i < knots; i++) {
        pel_ccd_hit other;
        pel_contact_place_between(set, hit->vertices, (i + 1.0) / knots, x[1 - i % 2]);
        if (meet_pair(x[i % 2], x[1 - i % 2], are_balls, reach, tolerance, &other) <= 1)
            return impact;
    }
    impact.hit.time_of_impact = NO_IMPACT;
    return impact;
}

/* ---- spheres and capsules ---- */

/* share of the way at which a point comes within a distance of a segment; both go straight, by steps that cannot pass
 * it */
static double meet_segment(double from[3][3], double to[3][3], double distance, double tolerance)
{
    double longest = 0, time = 0, x[3][3], weights[5];
    for (int i = 1; i < 3; i++) {
        double a[3], b[3];
        pel_vec3_subtract(from[0], from[i], a);
        pel_vec3_subtract(to[0], to[i], b);
        longest = pel_max(longest, pel_vec3_distance(a, b));
    }
    for (int step = 0; step < MOST_ADVANCES && time <= 1; step++) {
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                x[i][k] = from[i][k] + time * (to[i][k] - from[i][k]);
        double gap = sqrt(pel_closest_segment_segment(x[0], x[0], x[1], x[2], weights)) - distance;
        if (gap <= tolerance)
            return time;
        if (!(longest > 0))
            return NO_IMPACT;
        time += gap / longest;
    }
    return time;
}

/* the middle of a ball and the ends of the axis of an obstacle after a share of the way */
static void place_with_axis(const pel_contact_set *set, const pel_contact_ball *ball, const pel_obstacle *obstacle,
                            double share, double x[3][3])
{
    const int32_t points[4] = {ball->point, ball->point, ball->point, ball->point};
    double places[4][3];
    pel_contact_place_between(set, points, share, places);
    pel_vec3_copy(places[0], x[0]);
    for (int i = 0; i < 2; i++) {
        double half = pel_solid_is_ball(&obstacle->solid) ? 0 : obstacle->solid.half_length, from[3], to[3];
        const double local[3] = {0, 0, i == 0 ? -half : half};
        pel_pose_to_world(&obstacle->before, local, from);
        pel_pose_to_world(&obstacle->pose, local, to);
        for (int k = 0; k < 3; k++)
            x[1 + i][k] = from[k] + share * (to[k] - from[k]);
    }
}

static double axis_gap(double x[3][3], double radius)
{
    double weights[5];
    return sqrt(pel_closest_segment_segment(x[0], x[0], x[1], x[2], weights)) - radius;
}

static double conflict_time(const pel_contact_set *set, const pel_contact_ball *ball, const pel_obstacle *obstacle)
{
    const int32_t points[4] = {ball->point, ball->point, ball->point, ball->point};
    double radius = ball->radius + obstacle->solid.radius, x[2][3][3];
    int count = pel_contact_count_knots(set, points);
    place_with_axis(set, ball, obstacle, 0, x[0]);
    double gap = axis_gap(x[0], radius), separation = pel_min(set->guarded, APPROACH * gap);
    if (gap < TOUCHING * set->guarded) {
        place_with_axis(set, ball, obstacle, 1, x[1]);
        return axis_gap(x[1], radius) >= pel_min(gap, 0) ? NO_IMPACT : 0;
    }
    place_with_axis(set, ball, obstacle, 1, x[1]);
    double time = meet_segment(x[0], x[1], radius + separation, TOLERANCE * separation);
    if (time > 1 || count <= 1 || axis_gap(x[1], radius) <= separation)
        return time;
    for (int i = 0; i < count; i++) {
        place_with_axis(set, ball, obstacle, (i + 1.0) / count, x[1 - i % 2]);
        if (meet_segment(x[i % 2], x[1 - i % 2], radius + separation, TOLERANCE * separation) <= 1)
            return time;
    }
    return NO_IMPACT;
}

pel_status pel_contact_ball_conflicts(pel_contact_set *set, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t i = 0; i < set->def.obstacle_count; i++) {
        const pel_obstacle *obstacle = &set->obstacles[i];
        if (!obstacle->presses || obstacle->mesh != NULL || !pel_solid_is_round(&obstacle->solid))
            continue;
        for (int32_t b = 0; b < set->ball_count && status == PEL_OK; b++) {
            const pel_contact_ball *ball = &set->balls[b];
            pel_conflict conflict = {.vertices = {ball->point, -1, -1, -1}, .obstacle = i};
            if (obstacle->body >= 0 && set->group_of_point[ball->point] != obstacle->body)
                continue;
            conflict.time = conflict_time(set, ball, obstacle);
            if (conflict.time <= 1)
                status = pel_contact_add_conflict(set, &conflict, error);
        }
    }
    return status;
}
