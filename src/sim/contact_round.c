/* Spheres and capsules in the guard: a point or a segment that keeps its radius from the surface. */
#include "sim/contact.h"
#include "sim/tool.h"

/* a round tool on its way, with the box of all of it */
typedef struct round_tool {
    int32_t tool;
    bool is_capsule;
    double radius;
    double start[2][3], end[2][3]; /* ends of its axis */
    double low[3], high[3];
    double longest; /* m, way of its points at most */
} round_tool;

/* of the guarded distance: what starts so near is at zero distance but for rounding */
#define TOUCHING 0.01
/* of the radius: straight ways that come nearer to the axis than this went through the tool */
#define CHORD_SHARE 0.5

/* numbers of the corners of a triangle's edges */
static const int edges[3][2] = {{0, 1}, {1, 2}, {2, 0}};

static void set_round(const pel_sim *sim, int32_t tool, round_tool *round)
{
    const pel_tool *t = &sim->tools[tool];
    double grown = t->solid.radius + sim->contacts->largest;
    *round = (round_tool){.tool = tool, .is_capsule = t->solid.kind == PEL_SOLID_CAPSULE, .radius = t->solid.radius};
    for (int k = 0; k < 3; k++) {
        round->low[k] = HUGE_VAL;
        round->high[k] = -HUGE_VAL;
    }
    for (int i = 0; i < 2; i++) {
        double half = round->is_capsule ? t->solid.half_length : 0;
        const double local[3] = {0, 0, i == 0 ? -half : half};
        pel_pose_to_world(&t->pose_before, local, round->start[i]);
        pel_pose_to_world(&t->pose, local, round->end[i]);
        for (int k = 0; k < 3; k++) {
            round->low[k] = fmin(round->low[k], fmin(round->start[i][k], round->end[i][k]) - grown);
            round->high[k] = fmax(round->high[k], fmax(round->start[i][k], round->end[i][k]) + grown);
        }
        round->longest = fmax(round->longest, pel_vec3_distance(round->start[i], round->end[i]));
    }
}

static bool is_near(const pel_sim_contacts *contacts, const round_tool *round, const int32_t corners[3])
{
    for (int k = 0; k < 3; k++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int c = 0; c < 3; c++) {
            double a = contacts->start[corners[c]][k], b = contacts->end[corners[c]][k];
            low = fmin(low, fmin(a, b));
            high = fmax(high, fmax(a, b));
        }
        if (!(low <= round->high[k] && high >= round->low[k]))
            return false;
    }
    return true;
}

static void set_corners(const pel_sim_contacts *contacts, const int32_t corners[3], double start[4][3],
                        double end[4][3])
{
    for (int c = 0; c < 3; c++) {
        pel_vec3_copy(contacts->start[corners[c]], start[c + 1]);
        pel_vec3_copy(contacts->end[corners[c]], end[c + 1]);
    }
}

static void note(bool hits, const pel_ccd_hit *hit, double *time)
{
    if (hits)
        *time = fmin(*time, hit->time_of_impact);
}

/* time at which the triangle comes within the separation of the axis, above 1 = never */
static double impact_time(const round_tool *round, double start[4][3], double end[4][3], double separation)
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
static double end_gap(const round_tool *round, double end[4][3])
{
    double weights[5];
    return sqrt(pel_closest_segment_triangle(round->end[0], round->end[1], end[1], end[2], end[3], weights)) -
           round->radius;
}

static double conflict_time(const pel_sim_contacts *contacts, const round_tool *round, const int32_t corners[3])
{
    double start[4][3], end[4][3], weights[5], approach = 0;
    set_corners(contacts, corners, start, end);
    for (int c = 1; c < 4; c++)
        approach = fmax(approach, pel_vec3_distance(start[c], end[c]));
    approach += round->longest;
    double gap =
        sqrt(pel_closest_segment_triangle(round->start[0], round->start[1], start[1], start[2], start[3], weights)) -
        round->radius;
    double separation = fmin(contacts->guarded, 0.99 * gap);
    if (approach == 0 || gap - 2 * approach > separation)
        return 2;
    double left = end_gap(round, end);
    /* touching from the start on: tools may begin a little in a body, and press it out */
    if (gap < TOUCHING * contacts->guarded && approach < round->radius)
        return left >= fmin(gap, 0) ? 2 : 0;
    /* what slides over a round tool ends as free as it began; only the straight way between cuts a corner */
    if (left >= separation)
        separation = (CHORD_SHARE - 1) * round->radius;
    return impact_time(round, start, end, round->radius + separation);
}

static pel_status find_conflicts(pel_sim *sim, const round_tool *round, pel_error *error)
{
    pel_sim_contacts *contacts = sim->contacts;
    int32_t body = sim->tools[round->tool].body;
    pel_status status = PEL_OK;
    for (int32_t t = 0; status == PEL_OK && t < contacts->triangle_count; t++) {
        const int32_t *corners = contacts->triangles[t];
        if (corners[0] >= contacts->place_count || (body >= 0 && contacts->group_of_point[corners[0]] != body) ||
            !is_near(contacts, round, corners))
            continue;
        pel_conflict conflict = {{corners[0], corners[1], corners[2], -1}, round->tool, 0};
        conflict.time = conflict_time(contacts, round, corners);
        if (conflict.time <= 1)
            status = pel_contact_add_conflict(contacts, &conflict, error);
    }
    return status;
}

pel_status pel_contact_round_conflicts(pel_sim *sim, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < sim->tool_count; i++) {
        round_tool round;
        if (!sim->tools[i].press || !pel_tool_is_round(&sim->tools[i]))
            continue;
        set_round(sim, i, &round);
        status = find_conflicts(sim, &round, error);
    }
    return status;
}
