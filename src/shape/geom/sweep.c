/* A segment from A to B and an edge from P to Q, all of which move straight, lie in one plane where

       f(t) = (B - A) x (Q - P) . (P - A) = 0,

   a cubic in time; so do an end A and a triangle, where (P - A) x (Q - A) . (R - A) = 0. The signs of f at the ends of
   the stretches between its extrema tell each root, and 0 counts as positive, so a root between two steps is found in
   one of them. At any time the segment is in the triangle in one point or none; so events in the order of time are an
   entry, an exit, and so on. */
#include "geom/sweep.h"

#include "math/extremes.h"
#include "math/vec3.h"

#include <math.h>
#include <string.h>

enum { BISECTIONS = 60 };

/* ---- cubics ---- */

/* a vector that changes straight in time */
typedef struct line {
    double start[3], change[3];
} line;

static line line_between(const double from[2][3], const double to[2][3])
{
    line l;
    double end[3];
    pel_vec3_subtract(to[0], from[0], l.start);
    pel_vec3_subtract(to[1], from[1], end);
    pel_vec3_subtract(end, l.start, l.change);
    return l;
}

static double triple(const double a[3], const double b[3], const double c[3])
{
    double product[3];
    pel_vec3_cross(a, b, product);
    return pel_vec3_dot(product, c);
}

/* a x b . c over time */
static void set_cubic(const line *a, const line *b, const line *c, double cubic[4])
{
    cubic[0] = triple(a->start, b->start, c->start);
    cubic[1] = triple(a->change, b->start, c->start) + triple(a->start, b->change, c->start) +
               triple(a->start, b->start, c->change);
    cubic[2] = triple(a->start, b->change, c->change) + triple(a->change, b->start, c->change) +
               triple(a->change, b->change, c->start);
    cubic[3] = triple(a->change, b->change, c->change);
}

static double value_at(const double cubic[4], double t)
{
    return cubic[0] + t * (cubic[1] + t * (cubic[2] + t * cubic[3]));
}

/* extrema inside the time, in order */
static int find_extrema(const double cubic[4], double times[2])
{
    double a = 3 * cubic[3], b = 2 * cubic[2], c = cubic[1], square = b * b - 4 * a * c;
    double q = square > 0 ? -0.5 * (b + copysign(sqrt(square), b)) : 0, first, second;
    int count = 0;
    if (!(square > 0) || q == 0)
        return 0;
    first = c / q;
    second = a != 0 ? q / a : -1;
    if (first > second) {
        double other = first;
        first = second;
        second = other;
    }
    if (first > 0 && first < 1)
        times[count++] = first;
    if (second > 0 && second < 1)
        times[count++] = second;
    return count;
}

static double bisect(const double cubic[4], double low, double high)
{
    bool is_positive = value_at(cubic, low) >= 0;
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = 0.5 * (low + high);
        if ((value_at(cubic, middle) >= 0) == is_positive)
            low = middle;
        else
            high = middle;
    }
    return high;
}

static int find_roots(const double cubic[4], double roots[3])
{
    double times[4] = {0};
    int count = 1, root_count = 0;
    count += find_extrema(cubic, times + 1);
    times[count++] = 1;
    for (int i = 0; i + 1 < count; i++)
        if ((value_at(cubic, times[i]) >= 0) != (value_at(cubic, times[i + 1]) >= 0))
            roots[root_count++] = bisect(cubic, times[i], times[i + 1]);
    return root_count;
}

/* ---- events ---- */

static void place_at(const double path[2][3], double t, double x[3])
{
    pel_vec3_scale(path[0], 1 - t, x);
    pel_vec3_along(x, t, path[1], x);
}

/* where two lines in one plane meet: shares along p-q and a-b; false where they are parallel */
static bool meet(const double p[3], const double q[3], const double a[3], const double b[3], double *edge, double *own)
{
    double u[3], v[3], w[3], normal[3], across[3];
    pel_vec3_subtract(q, p, u);
    pel_vec3_subtract(b, a, v);
    pel_vec3_subtract(a, p, w);
    pel_vec3_cross(u, v, normal);
    double square = pel_vec3_squared_length(normal);
    if (!(square > 0))
        return false;
    pel_vec3_cross(w, v, across);
    *edge = pel_vec3_dot(across, normal) / square;
    pel_vec3_cross(w, u, across);
    *own = pel_vec3_dot(across, normal) / square;
    return true;
}

/* corner paths of an edge, from its own first end or from the other one */
static int add_edge(const pel_sweep *s, int edge, pel_sweep_event *events)
{
    int first = s->turned[edge] ? (edge + 1) % 3 : edge, second = s->turned[edge] ? edge : (edge + 1) % 3, count = 0;
    const double p[2][3] = {{s->corners[0][first][0], s->corners[0][first][1], s->corners[0][first][2]},
                            {s->corners[1][first][0], s->corners[1][first][1], s->corners[1][first][2]}};
    const double q[2][3] = {{s->corners[0][second][0], s->corners[0][second][1], s->corners[0][second][2]},
                            {s->corners[1][second][0], s->corners[1][second][1], s->corners[1][second][2]}};
    const double a[2][3] = {{s->segment[0][0][0], s->segment[0][0][1], s->segment[0][0][2]},
                            {s->segment[1][0][0], s->segment[1][0][1], s->segment[1][0][2]}};
    const double b[2][3] = {{s->segment[0][1][0], s->segment[0][1][1], s->segment[0][1][2]},
                            {s->segment[1][1][0], s->segment[1][1][1], s->segment[1][1][2]}};
    line along = line_between(a, b), side = line_between(p, q), between = line_between(a, p);
    double cubic[4], roots[3];
    set_cubic(&along, &side, &between, cubic);
    int root_count = find_roots(cubic, roots);
    for (int i = 0; i < root_count; i++) {
        double x[4][3], share, own;
        place_at(p, roots[i], x[0]);
        place_at(q, roots[i], x[1]);
        place_at(a, roots[i], x[2]);
        place_at(b, roots[i], x[3]);
        if (!meet(x[0], x[1], x[2], x[3], &share, &own) || share < 0 || share >= 1 || own < 0 || own > 1)
            continue;
        events[count] = (pel_sweep_event){.time = roots[i], .kind = PEL_SWEEP_EDGE, .edge = edge};
        events[count].weights[first] = 1 - share;
        events[count++].weights[second] = share;
    }
    return count;
}

/* weights of a point in the plane of a triangle; false outside */
static bool find_weights(const double x[3], const double corners[3][3], double weights[3])
{
    double normal[3], own[3], side[3], arm[3];
    pel_vec3_triangle_normal(corners[0], corners[1], corners[2], normal);
    double square = pel_vec3_squared_length(normal);
    if (!(square > 0))
        return false;
    for (int c = 0; c < 3; c++) {
        pel_vec3_subtract(corners[(c + 2) % 3], corners[(c + 1) % 3], side);
        pel_vec3_subtract(x, corners[(c + 1) % 3], arm);
        pel_vec3_cross(side, arm, own);
        weights[c] = pel_vec3_dot(own, normal) / square;
    }
    return weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0;
}

static int add_end(const pel_sweep *s, int end, pel_sweep_event *events)
{
    double a[2][3], corner[3][2][3], cubic[4], roots[3];
    line sides[3];
    int count = 0;
    for (int time = 0; time < 2; time++) {
        pel_vec3_copy(s->segment[time][end], a[time]);
        for (int c = 0; c < 3; c++)
            pel_vec3_copy(s->corners[time][c], corner[c][time]);
    }
    for (int c = 0; c < 3; c++)
        sides[c] = line_between((const double(*)[3])a, (const double(*)[3])corner[c]);
    set_cubic(&sides[0], &sides[1], &sides[2], cubic);
    int root_count = find_roots(cubic, roots);
    for (int i = 0; i < root_count; i++) {
        double x[3], corners[3][3];
        place_at((const double(*)[3])a, roots[i], x);
        for (int c = 0; c < 3; c++)
            place_at((const double(*)[3])corner[c], roots[i], corners[c]);
        events[count] = (pel_sweep_event){.time = roots[i], .kind = PEL_SWEEP_END};
        if (find_weights(x, (const double(*)[3])corners, events[count].weights))
            count++;
    }
    return count;
}

bool pel_segment_passes(const double segment[2][3], const double corners[3][3], double weights[3])
{
    double normal[3], arm[2][3], height[2], x[3];
    pel_vec3_triangle_normal(corners[0], corners[1], corners[2], normal);
    for (int end = 0; end < 2; end++) {
        pel_vec3_subtract(segment[end], corners[0], arm[end]);
        height[end] = pel_vec3_dot(arm[end], normal);
    }
    if ((height[0] >= 0) == (height[1] >= 0))
        return false;
    double share = height[0] / (height[0] - height[1]);
    pel_vec3_scale(segment[0], 1 - share, x);
    pel_vec3_along(x, share, segment[1], x);
    return find_weights(x, corners, weights);
}

/* ---- passages ---- */

static void sort(pel_sweep_event *events, int count)
{
    for (int i = 1; i < count; i++) {
        pel_sweep_event event = events[i];
        int place = i;
        for (; place > 0 && events[place - 1].time > event.time; place--)
            events[place] = events[place - 1];
        events[place] = event;
    }
}

/* whether a box about all places of the segment meets that of the triangle */
static bool may_meet(const pel_sweep *s)
{
    for (int k = 0; k < 3; k++) {
        double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
        for (int time = 0; time < 2; time++) {
            for (int end = 0; end < 2; end++) {
                low[0] = pel_min(low[0], s->segment[time][end][k]);
                high[0] = pel_max(high[0], s->segment[time][end][k]);
            }
            for (int c = 0; c < 3; c++) {
                low[1] = pel_min(low[1], s->corners[time][c][k]);
                high[1] = pel_max(high[1], s->corners[time][c][k]);
            }
        }
        if (low[0] > high[1] || low[1] > high[0])
            return false;
    }
    return true;
}

int pel_sweep_find(const pel_sweep *sweep, pel_sweep_event *events)
{
    pel_sweep_event first = {.kind = PEL_SWEEP_FIRST}, last = {.time = 1, .kind = PEL_SWEEP_LAST};
    int count = 0;
    if (!may_meet(sweep))
        return 0;
    bool is_first = pel_segment_passes(sweep->segment[0], sweep->corners[0], first.weights);
    bool is_last = pel_segment_passes(sweep->segment[1], sweep->corners[1], last.weights);
    if (is_first)
        events[count++] = first;
    for (int edge = 0; edge < 3; edge++)
        count += add_edge(sweep, edge, events + count);
    for (int end = 0; end < 2; end++)
        count += add_end(sweep, end, events + count);
    sort(events + is_first, count - is_first);
    /* an event that rounding adds or hides leaves an odd number: the last one goes, or the state at the end does */
    if (is_last && count % 2 != 0)
        events[count++] = last;
    return count - count % 2;
}
