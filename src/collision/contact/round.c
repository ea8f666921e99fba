/* Spheres and capsules in the guard: a point or a segment that keeps its radius from the surface. */
#include "contact/set.h"

#include "math/extremes.h"

/* a round obstacle on its way, with the box of all of it */
typedef struct round_obstacle {
    int32_t number;
    bool is_capsule;
    double radius;
    double start[2][3], end[2][3]; /* ends of its axis */
    double low[3], high[3];
    double longest; /* m, way of its points at most */
} round_obstacle;

/* of the guarded distance: what starts so near is at zero distance but for rounding */
#define TOUCHING 0.01
/* of the radius: straight ways that come nearer to the axis than this went through it */
#define CHORD_SHARE 0.5

/* numbers of the corners of a triangle's edges */
static const int edges[3][2] = {{0, 1}, {1, 2}, {2, 0}};

static bool is_round(const pel_obstacle *obstacle)
{
    return obstacle->mesh == NULL && pel_solid_is_round(&obstacle->solid);
}

static void set_round(const pel_contact_set *set, int32_t number, round_obstacle *round)
{
    const pel_obstacle *o = &set->obstacles[number];
    double grown = o->solid.radius + set->largest;
    *round = (round_obstacle){.number = number, .is_capsule = !pel_solid_is_ball(&o->solid), .radius = o->solid.radius};
    for (int k = 0; k < 3; k++) {
        round->low[k] = HUGE_VAL;
        round->high[k] = -HUGE_VAL;
    }
    for (int i = 0; i < 2; i++) {
        const double local[3] = {0, 0, i == 0 ? -o->solid.half_length : o->solid.half_length};
        pel_pose_to_world(&o->before, local, round->start[i]);
        pel_pose_to_world(&o->pose, local, round->end[i]);
        for (int k = 0; k < 3; k++) {
            round->low[k] = pel_min(round->low[k], pel_min(round->start[i][k], round->end[i][k]) - grown);
            round->high[k] = pel_max(round->high[k], pel_max(round->start[i][k], round->end[i][k]) + grown);
        }
        round->longest = pel_max(round->longest, pel_vec3_distance(round->start[i], round->end[i]));
    }
}

static bool is_near(const pel_contact_set *set, const round_obstacle *round, const int32_t corners[3])
{
    for (int k = 0; k < 3; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int c = 0; c < 3; c++) {
            double a = set->start[corners[c]][k], b = set->end[corners[c]][k];
            low = pel_min(low, pel_min(a, b));
            high = pel_max(high, pel_max(a, b));
        }
        if (!(low <= round->high[k] && high >= round->low[k]))
            return false;
    }
    return true;
}

static void set_corners(const pel_contact_set *set, const int32_t corners[3], double start[4][3], double end[4][3])
{
    for (int c = 0; c < 3; c++) {
        pel_vec3_copy(set->start[corners[c]], start[c + 1]);
        pel_vec3_copy(set->end[corners[c]], end[c + 1]);
    }
}

static void note(bool hits, const pel_ccd_hit *hit, double *time)
{
    if (hits)
        *time = pel_min(*time, hit->time_of_impact);
}

/* time at which the triangle comes within the separation of the axis, above 1 = never */
static double impact_time(const round_obstacle *round, double start[4][3], double end[4][3], double separation)
{
    double time = 2, tolerance = 1e-9 * separation;
    pel_ccd_hit hit;
    for (int i = 0; i < (round->is_capsule ? 2 : 1); i++) {
        pel_vec3_copy(round->start[i], start[0]);
        pel_vec3_copy(round->end[i], end[0]);
        note(pel_ccd_vertex_face((const double(*)[3])start, (const double(*)[3])end, separation, tolerance, &hit), &hit,
             &time);
    }
    for (int e = 0; e < 3 && round->is_capsule; e++) {
        double from[4][3], to[4][3];
        for (int i = 0; i < 2; i++) {
            pel_vec3_copy(round->start[i], from[i]);
            pel_vec3_copy(round->end[i], to[i]);
            pel_vec3_copy(start[1 + edges[e][i]], from[2 + i]);
            pel_vec3_copy(end[1 + edges[e][i]], to[2 + i]);
        }
        note(pel_ccd_edge_edge((const double(*)[3])from, (const double(*)[3])to, separation, tolerance, &hit), &hit,
             &time);
    }
    return time;
}

/* at the end of the step */
static double end_gap(const round_obstacle *round, double end[4][3])
{
    double weights[5];
    return sqrt(pel_closest_segment_triangle(round->end[0], round->end[1], end[1], end[2], end[3], weights)) -
           round->radius;
}

static double conflict_time(const pel_contact_set *set, const round_obstacle *round, const int32_t corners[3])
{
    double start[4][3], end[4][3], weights[5], approach = 0;
    set_corners(set, corners, start, end);
    for (int c = 1; c < 4; c++)
        approach = pel_max(approach, pel_vec3_distance(start[c], end[c]));
    approach += round->longest;
    double gap =
        sqrt(pel_closest_segment_triangle(round->start[0], round->start[1], start[1], start[2], start[3], weights)) -
        round->radius;
    double separation = pel_min(set->guarded, 0.99 * gap);
    if (approach == 0 || gap - 2 * approach > separation)
        return 2;
    double left = end_gap(round, end);
    /* touching from the start on: obstacles may begin a little in a body, and press it out */
    if (gap < TOUCHING * set->guarded && approach < round->radius)
        return left >= pel_min(gap, 0) ? 2 : 0;
    /* what slides over a round obstacle ends as free as it began; only the straight way between cuts a corner */
    if (left >= separation)
        separation = (CHORD_SHARE - 1) * round->radius;
    return impact_time(round, start, end, round->radius + separation);
}

static pel_status find_conflicts(pel_contact_set *set, const round_obstacle *round, pel_error *error)
{
    int32_t body = set->obstacles[round->number].body;
    pel_status status = PEL_OK;
    for (int32_t t = 0; status == PEL_OK && t < set->triangle_count; t++) {
        const int32_t *corners = set->triangles[t];
        if (corners[0] >= set->vertex_count || (body >= 0 && set->group_of_point[corners[0]] != body) ||
            !is_near(set, round, corners))
            continue;
        pel_conflict conflict = {{corners[0], corners[1], corners[2], -1}, round->number, 0};
        conflict.time = conflict_time(set, round, corners);
        if (conflict.time <= 1)
            status = pel_contact_add_conflict(set, &conflict, error);
    }
    return status;
}

pel_status pel_contact_round_conflicts(pel_contact_set *set, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < set->def.obstacle_count; i++) {
        round_obstacle round;
        if (!set->obstacles[i].presses || !is_round(&set->obstacles[i]))
            continue;
        set_round(set, i, &round);
        status = find_conflicts(set, &round, error);
    }
    return status;
}
