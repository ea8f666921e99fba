/* In a step the edge of a blade goes through triangles in arcs, each from an event to another (geom/sweep.h). Arcs that
   share an event on an edge of the mesh are one way through the surface. A way goes on from a tip of the blade that it
   begins near, or begins a new one. The cut follows the way edge by edge, each time to the neighbour that the path of a
   cut would take (mesh/path.h), as long as the end of the way is more than half an edge ahead; so the cut is as long as
   the way to half an edge, however the way is divided into steps. */
#include "blade/incision.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "blade/hold.h"
#include "geom/sweep.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "mesh/opening.h"
#include "mesh/path.h"
#include "model/origin.h"
#include "pellicle/geometry.h"

#include <math.h>
#include <string.h>

/* rad, by which a blade turns in a part of a step */
#define MOST_TURN 0.1
/* of its length: the edge is moved aside, so that it does not go through vertices and along edges; by another share in
   each step, because vertices move onto the way of the steps before */
#define ASIDE 1e-7
#define GOLDEN 0.6180339887498949
/* of the mean edge: what is ahead and not cut; the length of a first cut inside a surface, and from a lip; how far a
   way begins from the tip that it goes on from */
#define LAG 0.5
#define FIRST_INSIDE 1.25
#define FIRST_FROM_LIP 0.5
#define NEAR_TIP 1.6
/* the same for a blade that resists, which deforms what is around its tip */
#define NEAR_FIRM_TIP 6
/* of the mean edge: a blade that presses holds vertices this near to its edge */
#define NEAR_EDGE 0.75

/* of the mean edge: scissors bite again along lips this near */
#define ALONG_LIP 0.3

/* cosine between the edges of a border at a vertex that may move along it */
#define STRAIGHT 0.995
/* between the edge and a surface that it lies on */
#define FLAT_SINE 0.1

enum { MOST_PARTS = 64 };

/* vertices that say how the sheet around a tip is deformed; of the trace, so that a flat sheet can be inverted */
enum { MOST_AROUND = 61 };
#define FLATNESS 1e-4
/* between the last edge of a cut and the next one of a blade that resists */
#define LEAST_COSINE 0.3
/* of an edge at rest: a blade nearer to its tip than this does not cut on */
#define LEAST_WAY 0.25

/* a stretch of the way in one triangle */
typedef struct arc {
    int32_t triangle;
    pel_sweep_event ends[2];
    int32_t edges[2][2]; /* vertices of the edge at each end, the lower one first; -1 = none */
    double points[2][3]; /* m, at rest */
    int32_t next[2];     /* the arc beyond each end times 2 plus its end there; -1 = none */
    int part;            /* of the step */
    bool is_done;
} arc;

typedef struct search {
    pel_sim *sim;
    pel_tool *tool;
    int32_t body;
    const pel_body *own;
    const pel_mesh *mesh;
    arc *arcs; /* (arc_count) */
    size_t arc_room;
    int32_t arc_count;
    double (*points)[3]; /* (point_count) m, at rest: of the way at work */
    size_t point_room;
    int32_t point_count;
    const arc *first, *last; /* its arcs at both ends, and which end of them */
    int first_end, last_end;
    pel_topology *topology; /* made when edges open */
    uint8_t *fixed;
    pel_incision *found;
} search;

/* ---- arcs ---- */

static void rest_point(const search *s, int32_t triangle, const double weights[3], double x[3])
{
    pel_vec3_set(x, 0, 0, 0);
    for (int c = 0; c < 3; c++)
        pel_vec3_along(x, weights[c], s->mesh->positions[s->mesh->triangles[triangle][c]], x);
}

static bool add_arc(search *s, int32_t triangle, int part, const pel_sweep_event events[2])
{
    void *list = s->arcs;
    bool is_grown = pel_reserve(&list, &s->arc_room, (size_t)s->arc_count + 1, sizeof *s->arcs);
    s->arcs = list;
    if (!is_grown)
        return false;
    arc *a = &s->arcs[s->arc_count++];
    *a = (arc){.triangle = triangle, .part = part};
    for (int i = 0; i < 2; i++) {
        const int32_t *v = s->mesh->triangles[triangle];
        int32_t from = v[events[i].edge], to = v[(events[i].edge + 1) % 3];
        bool is_edge = events[i].kind == PEL_SWEEP_EDGE;
        a->ends[i] = events[i];
        a->next[i] = -1;
        a->edges[i][0] = is_edge ? (from < to ? from : to) : -1;
        a->edges[i][1] = is_edge ? (from < to ? to : from) : -1;
        rest_point(s, triangle, events[i].weights, a->points[i]);
    }
    return true;
}

/* the triangle and the edge between two shares of the step */
static void fill_sweep(const search *s, int32_t triangle, const double edges[2][2][3], double from, double to,
                       pel_sweep *sweep)
{
    memcpy(sweep->segment, edges, sizeof sweep->segment);
    for (int c = 0; c < 3; c++) {
        int32_t v = s->mesh->triangles[triangle][c], place = s->own->model_index[v];
        double before[3], after[3];
        pel_vertex_position(s->sim->tools->blade_before, place, before);
        pel_vertex_position(s->sim->state->position, place, after);
        for (int k = 0; k < 3; k++) {
            sweep->corners[0][c][k] = from > 0 ? before[k] + from * (after[k] - before[k]) : before[k];
            sweep->corners[1][c][k] = to < 1 ? before[k] + to * (after[k] - before[k]) : after[k];
        }
        sweep->turned[c] = s->mesh->triangles[triangle][(c + 1) % 3] < v;
    }
}

/* m, by how much the edge is aside at a share of the step */
static double aside_at(const search *s, double share)
{
    double turns = GOLDEN * (double)(s->sim->state->step % 1000000), start = turns - floor(turns);
    double end = start + GOLDEN - floor(start + GOLDEN);
    double length = pel_vec3_distance(s->tool->solid.edge[0], s->tool->solid.edge[1]);
    return ASIDE * length * (0.5 + (1 - share) * start + share * end);
}

static bool sweep_part(search *s, int part, int part_count)
{
    const double shares[2] = {(double)part / part_count, (double)(part + 1) / part_count};
    double edges[2][2][3];
    static const double aside[3] = {0.5377, 0.7311, 0.4201};
    for (int i = 0; i < 2; i++) {
        pel_pose pose;
        pel_pose_between(&s->tool->blade->pose_before, &s->tool->pose, shares[i], &pose);
        pel_blade_edge_at(s->tool, &pose, shares[i], edges[i]);
        for (int end = 0; end < 2; end++)
            pel_vec3_along(edges[i][end], aside_at(s, shares[i]), aside, edges[i][end]);
    }
    for (int32_t t = 0; t < s->mesh->triangle_count; t++) {
        pel_sweep sweep;
        pel_sweep_event events[PEL_SWEEP_EVENTS];
        fill_sweep(s, t, (const double(*)[2][3])edges, shares[0], shares[1], &sweep);
        int count = pel_sweep_find(&sweep, events);
        for (int i = 0; i + 1 < count; i += 2)
            if (!add_arc(s, t, part, &events[i]))
                return false;
    }
    return true;
}

static pel_status find_arcs(search *s, pel_error *error)
{
    double turn[3];
    pel_pose_turn(&s->tool->blade->pose_before, &s->tool->pose, turn);
    double parts = ceil(pel_vec3_length(turn) / MOST_TURN);
    int count = parts < 1 ? 1 : parts < MOST_PARTS ? (int)parts : MOST_PARTS;
    for (int part = 0; part < count; part++)
        if (!sweep_part(s, part, count))
            return pel_fail_memory(error);
    return PEL_OK;
}

/* ---- ways ---- */

static bool joins(const arc *a, int end, const arc *b, int other)
{
    const pel_sweep_event *e = &a->ends[end], *f = &b->ends[other];
    if (e->kind == PEL_SWEEP_EDGE)
        return f->kind == PEL_SWEEP_EDGE && a->part == b->part && a->triangle != b->triangle &&
               a->edges[end][0] == b->edges[other][0] && a->edges[end][1] == b->edges[other][1] && e->time == f->time;
    /* of the next part of a step */
    return a->triangle == b->triangle &&
           ((e->kind == PEL_SWEEP_LAST && f->kind == PEL_SWEEP_FIRST && b->part == a->part + 1) ||
            (e->kind == PEL_SWEEP_FIRST && f->kind == PEL_SWEEP_LAST && a->part == b->part + 1));
}

static void link_arcs(search *s)
{
    for (int32_t i = 0; i < 2 * s->arc_count; i++)
        for (int32_t k = i + 1; k < 2 * s->arc_count && s->arcs[i / 2].next[i % 2] < 0; k++) {
            arc *a = &s->arcs[i / 2], *b = &s->arcs[k / 2];
            if (a == b || b->next[k % 2] >= 0 || !joins(a, i % 2, b, k % 2))
                continue;
            a->next[i % 2] = k;
            b->next[k % 2] = i;
        }
}

static bool add_point(search *s, const double x[3])
{
    void *list = s->points;
    bool is_grown = pel_reserve(&list, &s->point_room, (size_t)s->point_count + 1, sizeof *s->points);
    s->points = list;
    if (is_grown)
        pel_vec3_copy(x, s->points[s->point_count++]);
    return is_grown;
}

static double when(const arc *a, int end)
{
    return a->part + a->ends[end].time;
}

static bool is_border(const arc *a, int end)
{
    return a->ends[end].kind == PEL_SWEEP_EDGE;
}

static void reverse(search *s)
{
    for (int32_t i = 0, k = s->point_count - 1; i < k; i++, k--) {
        double x[3];
        pel_vec3_copy(s->points[i], x);
        pel_vec3_copy(s->points[k], s->points[i]);
        pel_vec3_copy(x, s->points[k]);
    }
    const arc *first = s->first;
    int end = s->first_end;
    s->first = s->last;
    s->first_end = s->last_end;
    s->last = first;
    s->last_end = end;
}

/* the way that begins at an end of an arc without another one beyond; in the order of time, from a border inward */
static pel_status follow_way(search *s, int32_t start, pel_error *error)
{
    s->point_count = 0;
    s->first = &s->arcs[start / 2];
    s->first_end = start % 2;
    bool has_room = add_point(s, s->first->points[s->first_end]);
    for (int32_t at = start; has_room && at >= 0;) {
        arc *a = &s->arcs[at / 2];
        a->is_done = true;
        s->last = a;
        s->last_end = 1 - at % 2;
        has_room = add_point(s, a->points[s->last_end]);
        at = a->next[s->last_end];
    }
    if (!has_room)
        return pel_fail_memory(error);
    double from = when(s->first, s->first_end), to = when(s->last, s->last_end);
    if (from > to || (from == to && !is_border(s->first, s->first_end) && is_border(s->last, s->last_end)))
        reverse(s);
    return PEL_OK;
}

static double length_of(const search *s)
{
    double sum = 0;
    for (int32_t i = 0; i + 1 < s->point_count; i++)
        sum += pel_vec3_distance(s->points[i], s->points[i + 1]);
    return sum;
}

/* ---- tips ---- */

/* m, the mean edge of a triangle at rest */
static double size_of(const search *s, int32_t triangle)
{
    const int32_t *v = s->mesh->triangles[triangle];
    double sum = 0;
    for (int c = 0; c < 3; c++)
        sum += pel_vec3_distance(s->mesh->positions[v[c]], s->mesh->positions[v[(c + 1) % 3]]);
    return sum / 3;
}

/* m, at present, from where the way begins to a vertex */
static double distance_at_present(const search *s, int32_t vertex)
{
    double x[3], at[3] = {0};
    for (int c = 0; c < 3; c++) {
        pel_vertex_position(s->sim->state->position, s->own->model_index[s->mesh->triangles[s->first->triangle][c]], x);
        pel_vec3_along(at, s->first->ends[s->first_end].weights[c], x, at);
    }
    pel_vertex_position(s->sim->state->position, s->own->model_index[vertex], x);
    return pel_vec3_distance(x, at);
}

static pel_blade_tip *find_tip(const search *s)
{
    pel_blade_tip *best = NULL;
    bool is_firm = pel_blade_resists(s->sim, s->tool);
    double least = (is_firm ? NEAR_FIRM_TIP : NEAR_TIP) * size_of(s, s->first->triangle);
    for (int32_t i = 0; i < s->found->tip_count; i++) {
        pel_blade_tip *tip = &s->found->tips[i];
        if (tip->body != s->body)
            continue;
        const double *x = s->mesh->positions[tip->vertex];
        double distance = pel_min(pel_vec3_distance(x, s->points[0]), pel_vec3_distance(tip->to, s->points[0]));
        if (is_firm)
            distance = pel_min(distance, distance_at_present(s, tip->vertex));
        if (tip->is_pressing)
            distance = pel_min(distance, pel_max(0, pel_vec3_distance(tip->from, s->points[0]) - tip->width));
        if (distance >= least)
            continue;
        least = distance;
        best = tip;
    }
    return best;
}

static pel_status fail_tips(const search *s, pel_error *error)
{
    double x[3];
    pel_vertex_position(s->sim->state->position, s->own->model_index[s->mesh->triangles[s->first->triangle][0]], x);
    return pel_refuse_element(error, PEL_BAD_ARGUMENT, "tool", (int32_t)(s->tool - s->sim->tools->items),
                              "give it a shorter edge, or a `body`",
                              "blade '%s' is in body '%s' at more than %d places, the last one at (%.4g, %.4g, %.4g)",
                              s->tool->name, s->own->name, (int)PEL_BLADE_TIPS, x[0], x[1], x[2]);
}

/* the end of the edge that the way comes over, or the corner that it begins near */
static int32_t first_vertex(const search *s)
{
    const pel_sweep_event *event = &s->first->ends[s->first_end];
    const int32_t *v = s->mesh->triangles[s->first->triangle];
    int best = 0;
    for (int c = 1; c < 3; c++)
        if (event->weights[c] > event->weights[best])
            best = c;
    return v[best];
}

static bool begins_at_lip(const search *s)
{
    return is_border(s->first, s->first_end) &&
           pel_is_lip(s->own, 3 * s->first->triangle + s->first->ends[s->first_end].edge);
}

/* m, distance at present from the edge */
static double off_edge(const search *s, int32_t vertex)
{
    double edge[2][3], x[3], weights[2];
    pel_blade_edge_at(s->tool, &s->tool->pose, 1, edge);
    pel_vertex_position(s->sim->state->position, s->own->model_index[vertex], x);
    return sqrt(pel_closest_point_segment(x, edge[0], edge[1], weights));
}

/* vertices of the triangles of a way near the edge: those that the blade presses on */
static void press_on(const search *s, double size)
{
    for (int32_t i = 0; i < s->arc_count; i++)
        for (int c = 0; c < 3; c++) {
            int32_t v = s->mesh->triangles[s->arcs[i].triangle][c];
            if (off_edge(s, v) < NEAR_EDGE * size)
                pel_blade_take(s->sim, s->tool, s->body, v);
        }
}

/* m, of the edge that lies on the surface where the way begins; 0 where it comes with its point first */
static double width_of(const search *s, double length)
{
    double edge[2][3], corners[3][3], normal[3], along[3];
    pel_blade_edge_at(s->tool, &s->tool->pose, 1, edge);
    for (int c = 0; c < 3; c++)
        pel_vertex_position(s->sim->state->position, s->own->model_index[s->mesh->triangles[s->first->triangle][c]],
                            corners[c]);
    pel_vec3_triangle_normal(corners[0], corners[1], corners[2], normal);
    pel_vec3_subtract(edge[1], edge[0], along);
    double own = pel_vec3_length(along), tilt = fabs(pel_vec3_dot(normal, along));
    return tilt < FLAT_SINE * own * pel_vec3_length(normal) ? pel_min(own, length) : 0;
}

/* a new tip, or none where the way is not worth one */
static pel_status begin_tip(search *s, pel_blade_tip **begun, pel_error *error)
{
    double size = size_of(s, s->first->triangle), length = length_of(s);
    bool is_at_border = is_border(s->first, s->first_end), is_hook = pel_blade_is_hook(s->sim, s->tool);
    *begun = NULL;
    if (begins_at_lip(s) ? !is_hook && length < FIRST_FROM_LIP * size : is_hook && !is_at_border)
        return PEL_OK;
    if (s->found->tip_count == PEL_BLADE_TIPS)
        return fail_tips(s, error);
    pel_blade_tip *tip = &s->found->tips[s->found->tip_count++];
    *tip = (pel_blade_tip){.body = s->body, .vertex = first_vertex(s), .width = width_of(s, length)};
    pel_vec3_copy(s->points[0], tip->from);
    pel_vec3_copy(s->points[s->point_count - 1], tip->to);
    if (is_at_border)
        pel_vec3_subtract(tip->to, tip->from, tip->ahead);
    pel_vec3_normalize(tip->ahead);
    if (pel_blade_resists(s->sim, s->tool)) {
        tip->is_pressing = !is_at_border;
        pel_blade_take(s->sim, s->tool, s->body, tip->vertex);
        if (tip->is_pressing)
            press_on(s, size);
    }
    *begun = tip;
    return PEL_OK;
}

/* ---- the cut ---- */

static pel_status prepare(search *s, pel_error *error)
{
    if (s->topology != NULL)
        return PEL_OK;
    pel_status status = pel_topology_create(s->mesh, &s->topology, error);
    if (status == PEL_OK && !PEL_ALLOCATE_ALL(PEL_ROOM(s->found->growth.marks, s->topology->edge_count),
                                              PEL_ROOM(s->found->growth.is_moved, s->mesh->vertex_count),
                                              PEL_ROOM(s->fixed, s->mesh->vertex_count)))
        status = pel_fail_memory(error);
    if (status != PEL_OK)
        return status;
    pel_growth_mark_fixed(s->sim, s->body, s->fixed);
    return pel_mesh_create(s->mesh->positions[0], s->mesh->vertex_count, s->mesh->triangles[0], s->mesh->triangle_count,
                           &s->found->growth.mesh, error);
}

static double mean_edge(const search *s, int32_t v)
{
    const pel_topology *t = s->topology;
    double sum = 0;
    int32_t count = 0, first = t->corner_of_vertex[v];
    for (int32_t h = first; h >= 0; count++) {
        sum += pel_vec3_distance(s->found->growth.mesh->positions[v],
                                 s->found->growth.mesh->positions[pel_half_edge_target(t, h)]);
        h = pel_half_edge_turn(t, h);
        h = h == first ? -1 : h;
    }
    return sum / count;
}

/* the way to cut along: that of this step, after what came before and is not cut */
typedef struct course {
    const double (*points)[3];
    int32_t count;
    double length;
} course;

static void point_at(const course *c, double at, double x[3])
{
    int32_t i = 0;
    for (; i + 2 < c->count; i++) {
        double own = pel_vec3_distance(c->points[i], c->points[i + 1]);
        if (at <= own)
            break;
        at -= own;
    }
    double own = c->count > 1 ? pel_vec3_distance(c->points[i], c->points[i + 1]) : 0;
    double share = own > 0 ? pel_min(1, at / own) : 0;
    pel_vec3_scale(c->points[i], 1 - share, x);
    pel_vec3_along(x, share, c->points[c->count > 1 ? i + 1 : i], x);
}

/* the place nearest to x from `low` on */
static double place_of(const course *c, const double x[3], double low)
{
    double least = HUGE_VAL, best = low, begin = 0;
    for (int32_t i = 0; i + 1 < c->count; i++) {
        double weights[2], near[3], own = pel_vec3_distance(c->points[i], c->points[i + 1]);
        pel_closest_point_segment(x, c->points[i], c->points[i + 1], weights);
        double at = pel_max(low, begin + weights[1] * own);
        begin += own;
        if (at > begin)
            continue;
        point_at(c, at, near);
        double distance = pel_vec3_distance(x, near);
        if (distance < least) {
            least = distance;
            best = at;
        }
    }
    return best;
}

static bool is_on_border(const search *s, int32_t v)
{
    return s->topology->twin[s->topology->corner_of_vertex[v]] < 0;
}

/* the unit vector from the tip to the course ahead; false if there is less of it than `rest` mean edges */
static bool find_direction(const search *s, const course *c, const pel_blade_tip *tip, double rest, double *at,
                           double direction[3])
{
    const double *x = s->found->growth.mesh->positions[tip->vertex];
    double size = mean_edge(s, tip->vertex), aim[3], near[3];
    *at = place_of(c, x, *at);
    point_at(c, *at, near);
    double left = c->length - *at + (*at > 0 ? 0 : pel_vec3_distance(x, near));
    if (!(left > rest * size))
        return false;
    point_at(c, pel_min(c->length, *at + size), aim);
    pel_vec3_subtract(aim, x, direction);
    return pel_vec3_normalize(direction) > 0 &&
           (*at > 0 || !tip->is_open || pel_vec3_dot(direction, tip->ahead) > -0.2);
}

/* opens the next edge; false if none leads that way */
static pel_status advance(search *s, pel_blade_tip *tip, const double direction[3], bool *is_done, pel_error *error)
{
    pel_growth *growth = &s->found->growth;
    int32_t next, from = tip->vertex;
    pel_status status = pel_path_step(growth->mesh, s->topology, from, direction, s->fixed, &next, error);
    int32_t e = status == PEL_OK && next >= 0 ? pel_topology_edge_between(s->topology, from, next) : -1;
    *is_done = e < 0 || growth->marks[e];
    if (*is_done)
        return status;
    growth->marks[e] = 1;
    growth->edge_count++;
    tip->vertex = next;
    tip->is_open = 1;
    pel_vec3_subtract(growth->mesh->positions[next], growth->mesh->positions[from], tip->ahead);
    double length = pel_vec3_normalize(tip->ahead);
    if (pel_blade_resists(s->sim, s->tool))
        growth->energy += length * pel_incision_limit(s->sim, s->tool, tip);
    *is_done = is_on_border(s, next);
    return PEL_OK;
}

/* m, what is ahead of a tip whose cut has not begun, over its mean edge */
static bool is_long_enough(const search *s, const pel_blade_tip *tip, const course *c, double rest)
{
    if (tip->is_open)
        return true;
    double least = is_on_border(s, tip->vertex) ? pel_max(rest, LAG) : FIRST_INSIDE;
    return c->length > least * mean_edge(s, tip->vertex);
}

/* the vertex of a straight border where the cut begins moves along it to where the blade came in */
static void slide_start(const search *s, const pel_blade_tip *tip)
{
    const pel_topology *t = s->topology;
    double(*x)[3] = s->found->growth.mesh->positions, before[3], after[3];
    int32_t first = t->corner_of_vertex[tip->vertex], last = first;
    for (int32_t h = first; h >= 0; h = pel_half_edge_turn(t, h))
        last = h;
    const double *ends[2] = {x[pel_half_edge_target(t, first)],
                             x[pel_half_edge_origin(t, pel_half_edge_previous(last))]};
    pel_vec3_subtract(x[tip->vertex], ends[0], before);
    pel_vec3_subtract(ends[1], x[tip->vertex], after);
    if (pel_vec3_dot(before, after) > STRAIGHT * pel_vec3_length(before) * pel_vec3_length(after) &&
        pel_vec3_distance(x[tip->vertex], tip->from) < LAG * mean_edge(s, tip->vertex))
        pel_vec3_copy(tip->from, x[tip->vertex]);
}

/* cuts along the course; a way that leaves the surface is cut to the border */
static pel_status cut_along(search *s, pel_blade_tip *tip, const course *c, bool leaves, pel_error *error)
{
    pel_status status = prepare(s, error);
    double rest = leaves ? 1e-3 : LAG, at = 0, direction[3];
    int32_t begun = tip->is_open, first = s->found->growth.edge_count, was = tip->vertex;
    bool is_done = false, has_direction;
    if (status != PEL_OK || !is_long_enough(s, tip, c, rest))
        return status;
    if (!begun && is_on_border(s, was) && !s->fixed[was])
        slide_start(s, tip);
    s->fixed[was] = 1;
    for (int32_t i = 0; status == PEL_OK && !is_done && i < s->topology->edge_count; i++) {
        has_direction = find_direction(s, c, tip, rest, &at, direction);
        /* an edge inside the surface opens together with the next one only */
        bool is_single = !begun && s->found->growth.edge_count == first + 1 && !is_on_border(s, was);
        if (!has_direction && !is_single)
            break;
        status = advance(s, tip, has_direction ? direction : tip->ahead, &is_done, error);
    }
    return status;
}

/* of this step, after the first point where the cut has not begun there */
static pel_status make_course(search *s, const pel_blade_tip *tip, course *c, pel_error *error)
{
    if (!tip->is_open) {
        if (!add_point(s, s->points[s->point_count - 1]))
            return pel_fail_memory(error);
        memmove(s->points + 1, s->points, (size_t)(s->point_count - 1) * sizeof *s->points);
        pel_vec3_copy(tip->from, s->points[0]);
    }
    *c = (course){.points = (const double(*)[3])s->points, .count = s->point_count, .length = length_of(s)};
    return PEL_OK;
}

static void remove_tip(search *s, pel_blade_tip *tip)
{
    *tip = s->found->tips[--s->found->tip_count];
    s->found->tips[s->found->tip_count] = (pel_blade_tip){0};
}

/* whether a way goes over the border of the surface, and no lip */
static bool leaves_surface(const search *s)
{
    return is_border(s->last, s->last_end) &&
           !pel_is_lip(s->own, 3 * s->last->triangle + s->last->ends[s->last_end].edge);
}

static bool is_along_lip(const search *s, const double x[3])
{
    const pel_mesh *mesh = s->mesh;
    double reach = ALONG_LIP * size_of(s, s->first->triangle), weights[2];
    for (int32_t h = 0; h < 3 * mesh->triangle_count; h++) {
        const int32_t *v = mesh->triangles[h / 3];
        const double *from = mesh->positions[v[h % 3]], *to = mesh->positions[v[(h + 1) % 3]];
        if (pel_is_lip(s->own, h) && pel_closest_point_segment(x, from, to, weights) < reach * reach)
            return true;
    }
    return false;
}

/* The start of a way is left out as far as it goes along lips, up to a tip of theirs: scissors bite from behind the end
   of their cut. */
static void leave_out_slit(search *s)
{
    while (s->point_count > 1 && find_tip(s) == NULL && is_along_lip(s, s->points[0]) &&
           is_along_lip(s, s->points[1])) {
        int32_t next = s->first->next[1 - s->first_end];
        memmove(s->points, s->points + 1, (size_t)--s->point_count * sizeof *s->points);
        if (next < 0)
            return;
        s->first = &s->arcs[next / 2];
        s->first_end = next % 2;
    }
}

/* a way that is followed to its end; a blade that resists cuts by its slip */
static pel_status use_way(search *s, pel_error *error)
{
    pel_blade_tip *tip = find_tip(s);
    course c;
    pel_status status = tip == NULL ? begin_tip(s, &tip, error) : PEL_OK;
    if (status != PEL_OK || tip == NULL)
        return status;
    pel_vec3_copy(s->points[s->point_count - 1], tip->to);
    if (tip->is_pressing || pel_blade_is_hook(s->sim, s->tool))
        return PEL_OK;
    bool leaves = is_border(s->last, s->last_end), is_firm = pel_blade_resists(s->sim, s->tool);
    if (is_firm && !(leaves_surface(s) && pel_vec3_distance(tip->to, s->mesh->positions[tip->vertex]) <
                                              NEAR_TIP * size_of(s, s->last->triangle)))
        return PEL_OK;
    int32_t before = tip->vertex;
    status = make_course(s, tip, &c, error);
    if (status == PEL_OK)
        status = cut_along(s, tip, &c, leaves, error);
    if (status == PEL_OK && (leaves || (tip->vertex != before && is_on_border(s, tip->vertex))))
        remove_tip(s, tip);
    return status;
}

/* a blade that presses too hard cuts from where it met the surface to where it is */
static pel_status pierce(search *s, pel_blade_tip *tip, pel_error *error)
{
    if (!tip->is_pressing || pel_blade_pressing(s->sim, s->tool) < pel_incision_limit(s->sim, s->tool, tip))
        return PEL_OK;
    tip->is_pressing = 0;
    pel_blade_pierce(s->sim, s->tool);
    pel_blade_take(s->sim, s->tool, s->body, tip->vertex);
    const double points[2][3] = {{tip->from[0], tip->from[1], tip->from[2]}, {tip->to[0], tip->to[1], tip->to[2]}};
    const course c = {.points = points, .count = 2, .length = pel_vec3_distance(points[0], points[1])};
    return cut_along(s, tip, &c, false, error);
}

/* vertices around one, ring by ring; returns their number */
static int32_t gather(const search *s, int32_t vertex, int32_t list[MOST_AROUND])
{
    const pel_topology *t = s->topology;
    int32_t count = 1;
    list[0] = vertex;
    for (int32_t i = 0; i < count; i++) {
        int32_t first = t->corner_of_vertex[list[i]];
        for (int32_t h = first; h >= 0 && count < MOST_AROUND;) {
            int32_t v = pel_half_edge_target(t, h), k = 0;
            while (k < count && list[k] != v)
                k++;
            if (k == count)
                list[count++] = v;
            h = pel_half_edge_turn(t, h);
            h = h == first ? -1 : h;
        }
    }
    return count;
}

/* solves a symmetric system of three equations */
static void solve(const double rows[3][3], const double right[3], double x[3])
{
    double c[3][3];
    for (int i = 0; i < 3; i++)
        pel_vec3_cross(rows[(i + 1) % 3], rows[(i + 2) % 3], c[i]);
    double determinant = pel_vec3_dot(rows[0], c[0]);
    for (int k = 0; k < 3; k++)
        x[k] = determinant != 0 ? (right[0] * c[0][k] + right[1] * c[1][k] + right[2] * c[2][k]) / determinant : 0;
}

/* The vector at rest that is one at present, by the linear map that fits the vertices around best: the triangles at the
   blade itself may be folded. */
static void pull_back(const search *s, int32_t v, const double present[3], double rest[3])
{
    int32_t list[MOST_AROUND], count = gather(s, v, list);
    double products[3][3] = {{0}}, sums[3][3] = {{0}}, means[2][3] = {{0}}, weights[3], x[3], arm[2][3];
    for (int32_t i = 0; i < count; i++) {
        pel_vertex_position(s->sim->state->position, s->own->model_index[list[i]], x);
        pel_vec3_along(means[0], 1.0 / count, x, means[0]);
        pel_vec3_along(means[1], 1.0 / count, s->mesh->positions[list[i]], means[1]);
    }
    for (int32_t i = 0; i < count; i++) {
        pel_vertex_position(s->sim->state->position, s->own->model_index[list[i]], x);
        pel_vec3_subtract(x, means[0], arm[0]);
        pel_vec3_subtract(s->mesh->positions[list[i]], means[1], arm[1]);
        for (int k = 0; k < 3; k++) {
            pel_vec3_along(products[k], arm[0][k], arm[0], products[k]);
            pel_vec3_along(sums[k], arm[0][k], arm[1], sums[k]);
        }
    }
    double trace = products[0][0] + products[1][1] + products[2][2];
    for (int k = 0; k < 3; k++)
        products[k][k] += FLATNESS * trace;
    solve((const double(*)[3])products, present, weights);
    pel_vec3_set(rest, 0, 0, 0);
    for (int k = 0; k < 3; k++)
        pel_vec3_along(rest, weights[k], sums[k], rest);
    pel_vec3_normalize(rest);
}

static void place(const search *s, int32_t v, double x[3])
{
    pel_vertex_position(s->sim->state->position, s->own->model_index[v], x);
}

/* m, mean distance of a vertex to its neighbours at present, over that at rest */
static double present_stretch(const search *s, int32_t v)
{
    const pel_topology *t = s->topology;
    double sum = 0, rest = 0, x[3], y[3];
    int32_t first = t->corner_of_vertex[v];
    place(s, v, x);
    for (int32_t h = first; h >= 0;) {
        int32_t next = pel_half_edge_target(t, h);
        place(s, next, y);
        sum += pel_vec3_distance(x, y);
        rest += pel_vec3_distance(s->mesh->positions[v], s->mesh->positions[next]);
        h = pel_half_edge_turn(t, h);
        h = h == first ? -1 : h;
    }
    return sum / rest;
}

/* m, from the tip to the edge of the blade at present: by as much as the blade has slid on since it took the vertex */
static double way_ahead(const search *s, const pel_blade_tip *tip, double way[3])
{
    double edge[2][3], x[3], weights[2];
    pel_blade_edge_at(s->tool, &s->tool->pose, 1, edge);
    place(s, tip->vertex, x);
    pel_closest_point_segment(x, edge[0], edge[1], weights);
    pel_vec3_scale(edge[0], weights[0], way);
    pel_vec3_along(way, weights[1], edge[1], way);
    pel_vec3_subtract(way, x, way);
    return pel_vec3_length(way);
}

/* A blade that resists cuts towards where it is, by the length that it has slid on: the cut never runs ahead of it. */
static pel_status cut_slip(search *s, pel_blade_tip *tip, pel_error *error)
{
    double way[3], direction[3], length = way_ahead(s, tip, way);
    if (tip->is_pressing || !(length > LEAST_WAY * size_of(s, 0)))
        return PEL_OK;
    pel_status status = prepare(s, error);
    int32_t before = tip->vertex;
    if (status != PEL_OK || !(length > mean_edge(s, before) * pel_min(1, present_stretch(s, before))))
        return status;
    pull_back(s, before, way, direction);
    if (pel_vec3_length(tip->ahead) > 0 && pel_vec3_dot(direction, tip->ahead) < LEAST_COSINE)
        return status;
    /* inside the surface two edges open together, or none */
    bool is_first = !tip->is_open && !is_on_border(s, before), is_done = false;
    for (int i = 0; status == PEL_OK && !is_done && i < 1 + is_first; i++)
        status = advance(s, tip, i > 0 ? tip->ahead : direction, &is_done, error);
    if (tip->vertex != before)
        pel_vec3_scale(way, -pel_vec3_length(tip->pull) / length, tip->pull);
    if (is_done && tip->vertex != before)
        remove_tip(s, tip);
    return status;
}

static pel_status use_ways(search *s, pel_error *error)
{
    pel_status status = PEL_OK;
    for (int32_t i = 0; status == PEL_OK && i < 2 * s->arc_count; i++) {
        if (s->arcs[i / 2].is_done || s->arcs[i / 2].next[i % 2] >= 0)
            continue;
        status = follow_way(s, i, error);
        if (status == PEL_OK && s->tool->solid.shape == PEL_TOOL_SCISSORS)
            leave_out_slit(s);
        if (status == PEL_OK && s->point_count > 1)
            status = use_way(s, error);
    }
    for (int32_t i = s->found->tip_count - 1; status == PEL_OK && i >= 0; i--)
        if (s->found->tips[i].body == s->body)
            status = pierce(s, &s->found->tips[i], error);
    bool slides = pel_blade_resists(s->sim, s->tool) && !pel_blade_is_hook(s->sim, s->tool);
    for (int32_t i = s->found->tip_count - 1; status == PEL_OK && slides && i >= 0; i--)
        if (s->found->tips[i].body == s->body)
            status = cut_slip(s, &s->found->tips[i], error);
    return status;
}

static void mark_moved(search *s)
{
    pel_growth *growth = &s->found->growth;
    for (int32_t v = 0; growth->mesh != NULL && v < s->mesh->vertex_count; v++)
        growth->is_moved[v] =
            memcmp(s->mesh->positions[v], growth->mesh->positions[v], sizeof *s->mesh->positions) != 0;
}

pel_status pel_incision_find(pel_sim *sim, int32_t tool, int32_t body, pel_incision *incision, pel_error *error)
{
    pel_tool *own = &sim->tools->items[tool];
    search s = {.sim = sim,
                .tool = own,
                .body = body,
                .own = &sim->model->bodies[body],
                .mesh = sim->model->bodies[body].mesh,
                .found = incision};
    *incision = (pel_incision){.tip_count = own->blade->tip_count};
    memcpy(incision->tips, own->blade->tips, sizeof incision->tips);
    pel_status status = find_arcs(&s, error);
    if (status == PEL_OK) {
        link_arcs(&s);
        status = use_ways(&s, error);
    }
    if (status == PEL_OK)
        mark_moved(&s);
    pel_topology_destroy(s.topology);
    PEL_FREE_ALL(s.arcs, s.points, s.fixed);
    return status;
}

void pel_incision_clear(pel_incision *incision)
{
    pel_growth_clear(&incision->growth);
}

double pel_incision_limit(const pel_sim *sim, const pel_tool *tool, const pel_blade_tip *tip)
{
    const pel_tool_def *def = &sim->def.tools[tool - sim->tools->items];
    if (def->shape == PEL_TOOL_HOOK)
        return def->grasp_max_force > 0 ? def->grasp_max_force : (double)HUGE_VAL;
    double thickness = pel_tear_thickness(sim, tip->body, tip->vertex);
    double width = def->kerf > 0 ? def->kerf : thickness;
    return def->sharpness * thickness * (tip->is_pressing ? pel_max(1, tip->width / width) : 1);
}
