#include "mesh/path.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "pellicle/geometry.h"

#include <math.h>
#include <string.h>

/* rad; a vertex that would leave a smaller angle stays, unless all would: then the second one is the limit */
#define LEAST_ANGLE (12 * 0.017453292519943295)
#define LAST_ANGLE (7 * 0.017453292519943295)
/* of the cosine between the edge and the path ahead */
#define LEAST_COSINE 0.4
/* cosine between the two borders at a vertex that may move along them */
#define STRAIGHT 0.995
/* cosine between a triangle and the surface around it, when a corner moves */
#define LEAST_TURN 0.2
/* rounds in which the neighbours of a vertex that has moved go to the middle of theirs */
enum { MOST_ROUNDS = 5 };
/* lengths of steps that are tried, relative to the mean edge ahead, and the least rest that one may leave */
enum { FACTORS = 5 };
#define LEAST_REST 0.6
/* of the mean edge: points of the path this near to a border end on it; a vertex inside the surface is this near to the
   path, or stays; points farther from the surface are refused */
#define NEAR_BORDER 0.5
#define LEAST_OFF 0.05
#define FAR_OFF 2
/* cosine: a path that bends more has a vertex at the bend */
#define BEND 0.94
/* mean edges: a single step has this much of a straight path ahead */
#define STEP_AHEAD 20

typedef struct walk {
    pel_mesh *mesh;
    const pel_topology *topology;
    uint8_t *marks;
    const double (*points)[3];
    int32_t point_count;
    double *places; /* (point_count) m, along the path */
    double at;      /* m, of the tip */
    pel_path_trace *trace;
    size_t room;
    int32_t *ring; /* (ring_count) neighbours of the vertex at work */
    int32_t ring_count;
    double (*kept)[3]; /* (ring_count + 1) where they were, and the vertex itself */
} walk;

/* ---- the surface ---- */

/* the next outgoing half-edge of a fan; -1 after the last */
static int32_t turn(const walk *w, int32_t v, int32_t h)
{
    int32_t next = pel_half_edge_turn(w->topology, h);
    return next == w->topology->corner_of_vertex[v] ? -1 : next;
}

static bool is_on_border(const walk *w, int32_t v)
{
    return w->topology->twin[w->topology->corner_of_vertex[v]] < 0;
}

/* neighbours of a vertex; the last one of a border is the tail of a half-edge */
static int32_t neighbour_at(const walk *w, int32_t h, bool is_tail)
{
    return is_tail ? pel_half_edge_origin(w->topology, pel_half_edge_previous(h))
                   : pel_half_edge_target(w->topology, h);
}

static double mean_edge(const walk *w, int32_t v)
{
    double sum = 0;
    int32_t count = 0;
    for (int32_t h = w->topology->corner_of_vertex[v]; h >= 0; h = turn(w, v, h), count++)
        sum += pel_vec3_distance(w->mesh->positions[v], w->mesh->positions[pel_half_edge_target(w->topology, h)]);
    return sum / count;
}

static double angle_at(const double a[3], const double b[3], const double c[3])
{
    double ab[3], ac[3], normal[3];
    pel_vec3_subtract(b, a, ab);
    pel_vec3_subtract(c, a, ac);
    pel_vec3_cross(ab, ac, normal);
    return pel_atan2(pel_vec3_length(normal), pel_vec3_dot(ab, ac));
}

static double least_angle(const double a[3], const double b[3], const double c[3])
{
    return pel_min(angle_at(a, b, c), pel_min(angle_at(b, c, a), angle_at(c, a, b)));
}

/* unit normal of the surface at a vertex */
static void normal_at(const walk *w, int32_t v, double normal[3])
{
    double part[3];
    pel_vec3_set(normal, 0, 0, 0);
    for (int32_t h = w->topology->corner_of_vertex[v]; h >= 0; h = turn(w, v, h)) {
        const int32_t *corners = w->mesh->triangles[h / 3];
        pel_vec3_triangle_normal(w->mesh->positions[corners[0]], w->mesh->positions[corners[1]],
                                 w->mesh->positions[corners[2]], part);
        pel_vec3_add(normal, part, normal);
    }
    pel_vec3_normalize(normal);
}

/* smallest angle of the triangles at a vertex; 0 where one has turned over */
static double quality_of_fan(const walk *w, int32_t v, const double normal[3])
{
    double least = HUGE_VAL, own[3];
    for (int32_t h = w->topology->corner_of_vertex[v]; h >= 0; h = turn(w, v, h)) {
        const double *a = w->mesh->positions[v], *b = w->mesh->positions[pel_half_edge_target(w->topology, h)];
        const double *c = w->mesh->positions[pel_half_edge_origin(w->topology, pel_half_edge_previous(h))];
        pel_vec3_triangle_normal(a, b, c, own);
        if (pel_vec3_dot(own, normal) < LEAST_TURN * pel_vec3_length(own))
            return 0;
        least = pel_min(least, least_angle(a, b, c));
    }
    return least;
}

/* the nearest point to x of the triangles around a vertex; returns the distance */
static double project(const walk *w, int32_t v, const double x[3], double nearest[3])
{
    double least = HUGE_VAL;
    for (int32_t h = w->topology->corner_of_vertex[v]; h >= 0; h = turn(w, v, h)) {
        const int32_t *corners = w->mesh->triangles[h / 3];
        double weights[3], point[3] = {0};
        double distance = pel_closest_point_triangle(x, w->mesh->positions[corners[0]], w->mesh->positions[corners[1]],
                                                     w->mesh->positions[corners[2]], weights);
        if (distance >= least)
            continue;
        least = distance;
        for (int k = 0; k < 3; k++)
            pel_vec3_along(point, weights[k], w->mesh->positions[corners[k]], point);
        pel_vec3_copy(point, nearest);
    }
    return least;
}

/* the nearest point to x of the two border edges of a vertex; false where they are not straight */
static bool slide(const walk *w, int32_t v, const double x[3], double nearest[3])
{
    int32_t h = w->topology->corner_of_vertex[v], last = h;
    for (int32_t next = h; next >= 0; next = turn(w, v, next))
        last = next;
    const double *ends[2] = {w->mesh->positions[pel_half_edge_target(w->topology, h)],
                             w->mesh->positions[neighbour_at(w, last, true)]};
    double before[3], after[3], least = HUGE_VAL;
    pel_vec3_subtract(w->mesh->positions[v], ends[0], before);
    pel_vec3_subtract(ends[1], w->mesh->positions[v], after);
    if (pel_vec3_dot(before, after) < STRAIGHT * pel_vec3_length(before) * pel_vec3_length(after))
        return false;
    for (int i = 0; i < 2; i++) {
        double weights[2], distance = pel_closest_point_segment(x, w->mesh->positions[v], ends[i], weights);
        if (distance >= least)
            continue;
        least = distance;
        pel_vec3_scale(w->mesh->positions[v], weights[0], nearest);
        pel_vec3_along(nearest, weights[1], ends[i], nearest);
    }
    return true;
}

/* ---- the path ---- */

static double length_of(const walk *w)
{
    return w->places[w->point_count - 1];
}

static void point_at(const walk *w, double at, double x[3])
{
    int32_t i = 1;
    while (i + 1 < w->point_count && w->places[i] < at)
        i++;
    double s = (at - w->places[i - 1]) / (w->places[i] - w->places[i - 1]);
    s = pel_max(0, pel_min(1, s));
    pel_vec3_scale(w->points[i - 1], 1 - s, x);
    pel_vec3_along(x, s, w->points[i], x);
}

/* the next bend of the path beyond a place, or its end */
static double next_stop(const walk *w, double at, int32_t *point)
{
    for (int32_t i = 1; i + 1 < w->point_count; i++) {
        double before[3], after[3];
        if (w->places[i] <= at * (1 + 1e-12) + 1e-12 * length_of(w))
            continue;
        pel_vec3_subtract(w->points[i], w->points[i - 1], before);
        pel_vec3_subtract(w->points[i + 1], w->points[i], after);
        *point = i;
        if (pel_vec3_dot(before, after) < BEND * pel_vec3_length(before) * pel_vec3_length(after))
            return w->places[i];
    }
    *point = w->point_count - 1;
    return length_of(w);
}

/* the place of the path nearest to x, from `low` to `high` */
static double place_of(const walk *w, const double x[3], double low, double high)
{
    double least = HUGE_VAL, best = low;
    for (int32_t i = 1; i < w->point_count; i++) {
        double weights[2], near[3];
        if (w->places[i] < low || w->places[i - 1] > high)
            continue;
        pel_closest_point_segment(x, w->points[i - 1], w->points[i], weights);
        double at = w->places[i - 1] + weights[1] * (w->places[i] - w->places[i - 1]);
        at = pel_max(low, pel_min(high, at));
        point_at(w, at, near);
        double distance = pel_vec3_distance(x, near);
        if (distance < least) {
            least = distance;
            best = at;
        }
    }
    return best;
}

static bool add_vertex(walk *w, int32_t v)
{
    void *list = w->trace->vertices;
    bool grown = pel_reserve(&list, &w->room, (size_t)w->trace->count + 1, sizeof *w->trace->vertices);
    w->trace->vertices = list;
    if (grown)
        w->trace->vertices[w->trace->count++] = v;
    return grown;
}

static bool is_in_path(const walk *w, int32_t v)
{
    for (int32_t i = 0; i < w->trace->count; i++)
        if (w->trace->vertices[i] == v)
            return true;
    return false;
}

/* ---- a step ---- */

typedef struct choice {
    int32_t vertex, rounds;
    double quality, x[3], at;
} choice;

static void keep_ring(walk *w, int32_t v)
{
    w->ring_count = 0;
    for (int32_t h = w->topology->corner_of_vertex[v], last = h; h >= 0; last = h, h = turn(w, v, h)) {
        w->ring[w->ring_count++] = pel_half_edge_target(w->topology, h);
        if (turn(w, v, h) < 0 && is_on_border(w, v))
            w->ring[w->ring_count++] = neighbour_at(w, last, true);
    }
    for (int32_t i = 0; i < w->ring_count; i++)
        pel_vec3_copy(w->mesh->positions[w->ring[i]], w->kept[i]);
    pel_vec3_copy(w->mesh->positions[v], w->kept[w->ring_count]);
}

static void restore_ring(walk *w, int32_t v)
{
    for (int32_t i = 0; i < w->ring_count; i++)
        pel_vec3_copy(w->kept[i], w->mesh->positions[w->ring[i]]);
    pel_vec3_copy(w->kept[w->ring_count], w->mesh->positions[v]);
}

/* to the middle of its neighbours, on the surface */
static void smooth(const walk *w, int32_t v)
{
    double middle[3] = {0}, count = 0, x[3];
    for (int32_t h = w->topology->corner_of_vertex[v]; h >= 0; h = turn(w, v, h), count++)
        pel_vec3_add(middle, w->mesh->positions[pel_half_edge_target(w->topology, h)], middle);
    pel_vec3_scale(middle, 1 / count, middle);
    if (isfinite(project(w, v, middle, x)))
        pel_vec3_copy(x, w->mesh->positions[v]);
}

/* moves a vertex and its ring, which is kept; returns the smallest angle there, 0 where triangles turn over */
static double move_vertex(walk *w, int32_t v, const double x[3], int rounds)
{
    double normal[3], least;
    normal_at(w, v, normal);
    pel_vec3_copy(x, w->mesh->positions[v]);
    for (int r = 0; r < rounds; r++)
        for (int32_t i = 0; i < w->ring_count; i++)
            if (!w->marks[w->ring[i]] && !is_on_border(w, w->ring[i]) && !is_in_path(w, w->ring[i]))
                smooth(w, w->ring[i]);
    least = quality_of_fan(w, v, normal);
    for (int32_t i = 0; rounds > 0 && i < w->ring_count && least > 0; i++)
        least = pel_min(least, quality_of_fan(w, w->ring[i], normal));
    return least;
}

/* m, along the surface at a vertex: a path between points may be above a curved surface, or below it */
static double distance_along(const walk *w, int32_t v, const double a[3], const double b[3])
{
    double normal[3], d[3];
    normal_at(w, v, normal);
    pel_vec3_subtract(b, a, d);
    pel_vec3_along(d, -pel_vec3_dot(d, normal), normal, d);
    return pel_vec3_length(d);
}

/* the vertex moved to the point of the path at a place, as far as it may go */
static void try_move(walk *w, int32_t v, double at, double limit, choice *best)
{
    double wanted[3], x[3];
    point_at(w, at, wanted);
    if (w->marks[v])
        return;
    if (is_on_border(w, v) ? !slide(w, v, wanted, x) : !isfinite(project(w, v, wanted, x)))
        return;
    double off = distance_along(w, v, x, wanted), size = mean_edge(w, v);
    if (off > (is_on_border(w, v) ? NEAR_BORDER : LEAST_OFF) * size)
        return;
    keep_ring(w, v);
    for (int rounds = 0; rounds <= MOST_ROUNDS; rounds++) {
        double least = move_vertex(w, v, x, rounds);
        restore_ring(w, v);
        /* a place off the path counts as an angle that is smaller in proportion */
        double quality = least * (1 - off / size);
        if (least < limit || quality <= best->quality)
            continue;
        *best = (choice){.vertex = v, .rounds = rounds, .quality = quality, .at = at};
        pel_vec3_copy(x, best->x);
    }
}

/* the vertex where it is, by the distance from the path */
static void try_stay(const walk *w, int32_t v, double high, double size, choice *best)
{
    double at = place_of(w, w->mesh->positions[v], w->at, high), near[3];
    point_at(w, at, near);
    double quality = 1 - distance_along(w, v, w->mesh->positions[v], near) / size;
    if (at <= w->at + 1e-3 * size || quality <= best->quality)
        return;
    *best = (choice){.vertex = v, .quality = quality, .at = at};
    pel_vec3_copy(w->mesh->positions[v], best->x);
}

/* the end of a path that is shut is its first vertex */
static bool is_shut(const walk *w)
{
    return pel_vec3_distance(w->points[0], w->points[w->point_count - 1]) < 1e-9 * length_of(w);
}

/* the best neighbour ahead of the tip: moved onto the path within a limit of angles, or as it is (0) */
static void look_ahead(walk *w, int32_t tip, double stop, double limit, choice *best)
{
    static const double factors[FACTORS] = {1, 0.8, 1.25, 0.65, 1.5};
    const pel_topology *t = w->topology;
    double size = mean_edge(w, tip), left = stop - w->at, ahead[3], edge[3];
    double steps = pel_max(1, floor(left / size + 0.65)), step = left / steps, normal[3];
    point_at(w, w->at + step, ahead);
    pel_vec3_subtract(ahead, w->mesh->positions[tip], ahead);
    /* along the surface: a straight line between points is deep below a curved one */
    normal_at(w, tip, normal);
    pel_vec3_along(ahead, -pel_vec3_dot(ahead, normal), normal, ahead);
    for (int32_t h = t->corner_of_vertex[tip]; h >= 0; h = turn(w, tip, h)) {
        int32_t v = pel_half_edge_target(t, h);
        if (t->twin[h] < 0)
            continue;
        if (v == w->trace->vertices[0] && w->trace->count > 2 && steps < 1.5 && stop == length_of(w) && is_shut(w)) {
            *best = (choice){.vertex = v, .quality = HUGE_VAL, .at = stop};
            pel_vec3_copy(w->mesh->positions[v], best->x);
            return;
        }
        pel_vec3_subtract(w->mesh->positions[v], w->mesh->positions[tip], edge);
        if (pel_vec3_dot(edge, ahead) < LEAST_COSINE * pel_vec3_length(edge) * pel_vec3_length(ahead) ||
            is_in_path(w, v))
            continue;
        for (int f = 0; limit > 0 && f < (steps > 1.5 ? FACTORS : 1); f++)
            if (f == 0 || left - factors[f] * step > LEAST_REST * step)
                try_move(w, v, w->at + factors[f] * step, limit, best);
        if (limit == 0)
            try_stay(w, v, stop, size, best);
    }
}

static pel_status fail_walk(const walk *w, const char *what, const char *remedy, pel_error *error)
{
    double x[3];
    point_at(w, w->at, x);
    return pel_refuse(error, PEL_BAD_ARGUMENT, remedy, "the path %s at (%.4g, %.4g, %.4g)", what, x[0], x[1], x[2]);
}

/* m, from a point of the path to the nearest point of the surface */
static double distance_off(const walk *w, int32_t point)
{
    double least = HUGE_VAL, weights[3];
    for (int32_t t = 0; t < w->mesh->triangle_count; t++) {
        const int32_t *v = w->mesh->triangles[t];
        const double(*x)[3] = (const double(*)[3])(void *)w->mesh->positions;
        least = pel_min(least, pel_closest_point_triangle(w->points[point], x[v[0]], x[v[1]], x[v[2]], weights));
    }
    return sqrt(least);
}

/* the vertex with triangles nearest to a point */
static int32_t nearest_vertex(const walk *w, const double x[3])
{
    double least = HUGE_VAL;
    int32_t nearest = 0;
    for (int32_t v = 0; v < w->mesh->vertex_count; v++) {
        double distance = pel_vec3_distance(w->mesh->positions[v], x);
        if (w->topology->corner_of_vertex[v] < 0 || distance >= least)
            continue;
        least = distance;
        nearest = v;
    }
    return nearest;
}

static pel_status fail_point(const walk *w, int32_t point, pel_error *error)
{
    const double *x = w->points[point];
    return pel_refuse(error, PEL_BAD_ARGUMENT, "give points on the surface at rest",
                      "the point (%.4g, %.4g, %.4g) of the path lies %.3g m off the surface", x[0], x[1], x[2],
                      distance_off(w, point));
}

/* points above or below the surface; those beyond its border are found on the way */
static pel_status check_points(const walk *w, pel_error *error)
{
    for (int32_t i = 0; i < w->point_count; i++) {
        int32_t v = nearest_vertex(w, w->points[i]);
        double normal[3], arm[3];
        normal_at(w, v, normal);
        pel_vec3_subtract(w->points[i], w->mesh->positions[v], arm);
        if (fabs(pel_vec3_dot(arm, normal)) > FAR_OFF * mean_edge(w, v))
            return fail_point(w, i, error);
    }
    return PEL_OK;
}

/* no edge leads on from the tip, because the path leads off the surface or for want of room */
static pel_status fail_ahead(const walk *w, int32_t tip, pel_error *error)
{
    if (distance_off(w, w->trace->failed_point) > NEAR_BORDER * mean_edge(w, tip))
        return fail_point(w, w->trace->failed_point, error);
    return fail_walk(w, "finds no edge ahead",
                     "keep it apart from itself and from the border, give more points where the surface is curved, or "
                     "refine the mesh there",
                     error);
}

static void take(walk *w, const choice *best)
{
    bool is_moved = pel_vec3_distance(w->mesh->positions[best->vertex], best->x) > 0;
    if (is_moved) {
        keep_ring(w, best->vertex);
        double least = move_vertex(w, best->vertex, best->x, best->rounds);
        w->trace->least_angle = pel_min(w->trace->least_angle, least);
    }
    w->at = best->at;
}

/* whether the path has come to its end, or to a border near it */
static bool is_done(const walk *w, int32_t tip)
{
    double left = length_of(w) - w->at, size = mean_edge(w, tip);
    return left < 1e-6 * size || (w->trace->count > 1 && is_on_border(w, tip) && left < size);
}

static pel_status go(walk *w, pel_error *error)
{
    int32_t tip = w->trace->vertices[0];
    while (!is_done(w, tip)) {
        double stop = next_stop(w, w->at, &w->trace->failed_point);
        choice best = {.quality = 0};
        if (w->trace->count > 1 && is_on_border(w, tip) && !w->marks[tip])
            return fail_walk(w, "leaves the surface", "end it at the border", error);
        look_ahead(w, tip, stop, LEAST_ANGLE, &best);
        if (best.quality <= 0)
            look_ahead(w, tip, stop, LAST_ANGLE, &best);
        /* near its end the tip itself goes there, if it can */
        if (best.quality <= 0 && length_of(w) - w->at < NEAR_BORDER * mean_edge(w, tip)) {
            try_move(w, tip, length_of(w), LAST_ANGLE, &best);
            if (best.quality > 0)
                take(w, &best);
            return PEL_OK;
        }
        if (best.quality <= 0)
            look_ahead(w, tip, stop, 0, &best);
        if (best.quality <= 0)
            return fail_ahead(w, tip, error);
        take(w, &best);
        tip = best.vertex;
        if (!add_vertex(w, tip))
            return pel_fail_memory(error);
    }
    return PEL_OK;
}

/* the vertex nearest to the first point; one that slides along the border if the point is there */
static pel_status begin(walk *w, pel_error *error)
{
    const double *first = w->points[0];
    int32_t start = nearest_vertex(w, first);
    double size = mean_edge(w, start), slid[3];
    if (pel_vec3_distance(w->mesh->positions[start], first) > FAR_OFF * size) {
        const double *x = w->mesh->positions[start];
        fail_walk(w, "begins off the surface", "", error);
        pel_fail_remedy(error, "begin on the surface, %.3g m away; the nearest vertex is at (%.4g, %.4g, %.4g)",
                        distance_off(w, 0), x[0], x[1], x[2]);
        return PEL_BAD_ARGUMENT;
    }
    for (int32_t h = w->topology->corner_of_vertex[start]; h >= 0; h = turn(w, start, h)) {
        int32_t v = pel_half_edge_target(w->topology, h);
        if (!is_on_border(w, start) && is_on_border(w, v) && slide(w, v, first, slid) &&
            pel_vec3_distance(slid, first) < 0.1 * size)
            start = v;
    }
    choice best = {.vertex = start};
    pel_vec3_copy(w->mesh->positions[start], best.x);
    try_move(w, start, 0, LEAST_ANGLE, &best);
    take(w, &best);
    return add_vertex(w, start) ? PEL_OK : pel_fail_memory(error);
}

static size_t most_neighbours(const pel_topology *topology)
{
    size_t most = 0;
    for (int32_t v = 0; v < topology->vertex_count; v++) {
        int32_t first = topology->corner_of_vertex[v], h = first;
        size_t count = 1;
        for (; h >= 0; count++) {
            h = pel_half_edge_turn(topology, h);
            h = h == first ? -1 : h;
        }
        most = count > most ? count : most;
    }
    return most;
}

/* scratch for the ring of any vertex */
static bool has_room(walk *w)
{
    size_t most = most_neighbours(w->topology) + 1;
    return PEL_ALLOCATE_ALL(PEL_ROOM(w->ring, most), PEL_ROOM(w->kept, most + 1));
}

pel_status pel_path_trace_points(pel_mesh *mesh, const pel_topology *topology, const double (*points)[3],
                                 int32_t point_count, uint8_t *marks, pel_path_trace *trace, pel_error *error)
{
    walk w = {.mesh = mesh,
              .topology = topology,
              .marks = marks,
              .points = points,
              .point_count = point_count,
              .trace = trace};
    *trace = (pel_path_trace){.least_angle = 3.141592653589793};
    w.places = pel_allocate((size_t)point_count, sizeof *w.places);
    pel_status status = has_room(&w) && w.places != NULL ? PEL_OK : pel_fail_memory(error);
    for (int32_t i = 1; status == PEL_OK && i < point_count; i++)
        w.places[i] = w.places[i - 1] + pel_vec3_distance(points[i - 1], points[i]);
    if (status == PEL_OK)
        status = begin(&w, error);
    if (status == PEL_OK)
        status = check_points(&w, error);
    if (status == PEL_OK)
        status = go(&w, error);
    for (int32_t i = 0; i < trace->count; i++)
        marks[trace->vertices[i]] = 1;
    PEL_FREE_ALL(w.places, w.ring, w.kept);
    return status;
}

pel_status pel_path_step(pel_mesh *mesh, const pel_topology *topology, int32_t tip, const double direction[3],
                         uint8_t *marks, int32_t *vertex, pel_error *error)
{
    double points[2][3], places[2] = {0};
    pel_path_trace trace = {.vertices = &tip, .count = 1, .least_angle = 3.141592653589793};
    walk w = {.mesh = mesh,
              .topology = topology,
              .marks = marks,
              .points = (const double(*)[3])points,
              .point_count = 2,
              .places = places,
              .trace = &trace};
    const double limits[] = {LEAST_ANGLE, LAST_ANGLE, 0};
    choice best = {.vertex = -1};
    *vertex = -1;
    pel_status status = has_room(&w) ? PEL_OK : pel_fail_memory(error);
    places[1] = STEP_AHEAD * mean_edge(&w, tip);
    pel_vec3_copy(mesh->positions[tip], points[0]);
    pel_vec3_copy(points[0], points[1]);
    pel_vec3_along(points[1], places[1], direction, points[1]);
    for (size_t i = 0; status == PEL_OK && i < sizeof limits / sizeof *limits && best.vertex < 0; i++)
        look_ahead(&w, tip, places[1], limits[i], &best);
    if (best.vertex >= 0) {
        take(&w, &best);
        marks[best.vertex] = 1;
        *vertex = best.vertex;
    }
    PEL_FREE_ALL(w.ring, w.kept);
    return status;
}
