#include "bvh/hulls.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/sort.h"
#include "base/status.h"
#include "math/extremes.h"
#include "math/vec3.h"

#include <string.h>

enum { MOST_VERTICES = 1024 };
/* of the size of a body: what is so little beyond a face is on it */
#define FLAT 1e-4
/* of the reach and of coordinates: more than the rounding of heights, and of boxes in float */
#define SLACK 1e-9
#define FLOAT_SLACK 4e-7

/* features of one side that may be near the other one */
typedef struct side {
    const pel_hull *hull;
    double *height[2];                 /* (most vertices) at the start and the end */
    double low[2], high[2];            /* of them */
    uint8_t *is_near;                  /* (most vertices) */
    int32_t *vertices, *faces, *edges; /* near ones */
    pel_box *vertex_boxes, *face_boxes, *edge_boxes;
    int32_t vertex_count, face_count, edge_count;
} side;

struct pel_hull_part {
    side sides[2];
    pel_pair_list lists[2];
    bool is_short; /* of memory */
};

/* ---- creation ---- */

/* whether no vertex of a body lies beyond the plane of a triangle */
static bool is_behind(const pel_hulls *hulls, const pel_hull *hull, const double (*x)[3], int32_t triangle, double size)
{
    const int32_t *v = hulls->tree->triangles[triangle];
    double u[3], w[3], normal[3], way[3];
    pel_vec3_subtract(x[v[1]], x[v[0]], u);
    pel_vec3_subtract(x[v[2]], x[v[0]], w);
    pel_vec3_cross(u, w, normal);
    double most = FLAT * size * pel_vec3_length(normal);
    for (int32_t i = hull->begin; i < hull->end; i++) {
        pel_vec3_subtract(x[hulls->vertices[i]], x[v[0]], way);
        if (pel_vec3_dot(way, normal) > most)
            return false;
    }
    return true;
}

static bool is_convex(const pel_hulls *hulls, const pel_hull *hull, const double (*x)[3])
{
    const double *first = x[hulls->vertices[hull->begin]];
    double size = 0;
    for (int32_t i = hull->begin; i < hull->end; i++)
        size = pel_max(size, pel_vec3_distance(x[hulls->vertices[i]], first));
    /* sheets that are flat at rest bend */
    for (int32_t f = hulls->fan_begin[hull->begin]; f < hulls->fan_begin[hull->end]; f++)
        for (int32_t h = 3 * hulls->fans[f]; h < 3 * hulls->fans[f] + 3; h++)
            if (hulls->tree->next_in_edge[h] == h)
                return false;
    for (int32_t f = hulls->fan_begin[hull->begin]; f < hulls->fan_begin[hull->end]; f++)
        if (!is_behind(hulls, hull, x, hulls->fans[f], size))
            return false;
    return true;
}

/* The vertices of each group (group_count), negative = it cannot be a hull: it meets itself, shares vertices with
   others, or has too many. */
static void count_vertices(const pel_hulls *hulls, int32_t *counts)
{
    const pel_tree *tree = hulls->tree;
    const pel_collision_groups *groups = &hulls->groups;
    memset(hulls->place, 0, (size_t)tree->vertex_count * sizeof *hulls->place);
    for (int32_t g = 0; g < groups->group_count; g++)
        counts[g] = groups->may_meet[g * groups->group_count + g] ? INT32_MIN / 2 : 0;
    for (int32_t h = 0; h < 3 * tree->triangle_count; h++) {
        int32_t v = pel_tree_corner(tree, h), group = groups->group_of_vertex[v];
        if (group != groups->group_of_vertex[tree->triangles[h / 3][0]])
            counts[group] = counts[groups->group_of_vertex[tree->triangles[h / 3][0]]] = INT32_MIN / 2;
        counts[group] += hulls->place[v] == 0;
        hulls->place[v] = 1;
    }
    for (int32_t g = 0; g < groups->group_count; g++)
        counts[g] = counts[g] > 0 && counts[g] <= MOST_VERTICES ? counts[g] : -1;
}

/* the hulls, of groups with counts, where their vertices are, and the triangles around these; next (group_count):
   scratch */
static void list_hulls(pel_hulls *hulls, const int32_t *counts, int32_t *next)
{
    const pel_tree *tree = hulls->tree;
    int32_t *begin = hulls->fan_begin;
    hulls->count = hulls->vertex_count = 0;
    for (int32_t g = 0; g < hulls->groups.group_count; g++) {
        next[g] = hulls->vertex_count;
        if (counts[g] < 0)
            continue;
        hulls->vertex_count += counts[g];
        hulls->items[hulls->count++] = (pel_hull){.group = g, .begin = next[g], .end = hulls->vertex_count};
    }
    for (int32_t v = 0; v < tree->vertex_count; v++)
        hulls->place[v] = -1;
    memset(begin, 0, ((size_t)hulls->vertex_count + 1) * sizeof *begin);
    for (int32_t h = 0; h < 3 * tree->triangle_count; h++) {
        int32_t v = pel_tree_corner(tree, h), group = hulls->groups.group_of_vertex[v];
        if (counts[group] < 0)
            continue;
        if (hulls->place[v] < 0)
            hulls->place[v] = next[group]++;
        hulls->vertices[hulls->place[v]] = v;
        begin[hulls->place[v]]++;
    }
    for (int32_t i = 1; i <= hulls->vertex_count; i++)
        begin[i] += begin[i - 1];
    /* from where each ends to where it begins */
    for (int32_t h = 3 * tree->triangle_count - 1; h >= 0; h--)
        if (hulls->place[pel_tree_corner(tree, h)] >= 0)
            hulls->fans[--begin[hulls->place[pel_tree_corner(tree, h)]]] = h / 3;
}

/* which groups meet elsewhere than as hulls; whether any hulls meet */
static bool part_groups(pel_hulls *hulls, const int32_t *counts)
{
    const pel_collision_groups *groups = &hulls->groups;
    bool any = false;
    hulls->are_all = true;
    for (int32_t a = 0; a < groups->group_count; a++)
        for (int32_t b = 0; b < groups->group_count; b++) {
            int32_t at = a * groups->group_count + b;
            bool are_hulls = counts[a] >= 0 && counts[b] >= 0;
            any |= are_hulls && groups->may_meet[at];
            hulls->may_meet[at] = groups->may_meet[at] && !are_hulls;
            hulls->are_all &= !hulls->may_meet[at];
        }
    return any;
}

static bool find_hulls(pel_hulls *hulls, const double (*positions)[3])
{
    int32_t *counts, *next;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(counts, hulls->groups.group_count), PEL_ROOM(next, hulls->groups.group_count)))
        return false;
    count_vertices(hulls, counts);
    list_hulls(hulls, counts, next);
    for (int32_t i = 0; i < hulls->count; i++)
        if (!is_convex(hulls, &hulls->items[i], positions))
            counts[hulls->items[i].group] = -1;
    list_hulls(hulls, counts, next);
    if (!part_groups(hulls, counts))
        hulls->count = 0;
    PEL_FREE_ALL(counts, next);
    return true;
}

static bool make_side(side *s, size_t vertices, size_t triangles)
{
    return PEL_ALLOCATE_ALL(PEL_ROOM(s->height[0], vertices), PEL_ROOM(s->height[1], vertices),
                            PEL_ROOM(s->is_near, vertices), PEL_ROOM(s->vertices, vertices),
                            PEL_ROOM(s->faces, triangles), PEL_ROOM(s->edges, 3 * triangles),
                            PEL_ROOM_ALIGNED(s->vertex_boxes, vertices), PEL_ROOM_ALIGNED(s->face_boxes, triangles),
                            PEL_ROOM_ALIGNED(s->edge_boxes, 3 * triangles));
}

static bool make_parts(pel_hulls *hulls)
{
    int32_t vertices = 0, triangles = 0;
    for (int32_t i = 0; i < hulls->count; i++) {
        const pel_hull *hull = &hulls->items[i];
        int32_t around = hulls->fan_begin[hull->end] - hulls->fan_begin[hull->begin];
        vertices = hull->end - hull->begin > vertices ? hull->end - hull->begin : vertices;
        triangles = around / 3 > triangles ? around / 3 : triangles;
    }
    hulls->parts = pel_allocate(PEL_HULL_PARTS, sizeof *hulls->parts);
    for (int i = 0; hulls->parts != NULL && i < 2 * PEL_HULL_PARTS; i++)
        if (!make_side(&hulls->parts[i / 2].sides[i % 2], (size_t)vertices, (size_t)triangles))
            return false;
    return hulls->parts != NULL;
}

pel_status pel_hulls_create(const pel_tree *tree, const double (*positions)[3], const pel_collision_groups *groups,
                            pel_hulls **result)
{
    size_t group_count = (size_t)groups->group_count;
    *result = NULL;
    if (groups->group_of_vertex == NULL || tree->features == NULL)
        return PEL_OK;
    pel_hulls *hulls = pel_allocate(1, sizeof *hulls);
    if (hulls == NULL)
        return PEL_OUT_OF_MEMORY;
    hulls->tree = tree;
    hulls->groups = *groups;
    bool made = PEL_ALLOCATE_ALL(
        PEL_ROOM(hulls->items, group_count), PEL_ROOM(hulls->order, group_count),
        PEL_ROOM(hulls->vertices, tree->vertex_count), PEL_ROOM(hulls->place, tree->vertex_count),
        PEL_ROOM(hulls->fan_begin, (size_t)tree->vertex_count + 1), PEL_ROOM(hulls->fans, 3 * tree->triangle_count),
        PEL_ROOM(hulls->may_meet, group_count * group_count));
    made = made && find_hulls(hulls, positions) && (hulls->count == 0 || make_parts(hulls));
    if (made && hulls->count > 0)
        *result = hulls;
    else
        pel_hulls_destroy(hulls);
    return made ? PEL_OK : PEL_OUT_OF_MEMORY;
}

void pel_hulls_destroy(pel_hulls *hulls)
{
    if (hulls == NULL)
        return;
    for (int i = 0; hulls->parts != NULL && i < 2 * PEL_HULL_PARTS; i++) {
        side *s = &hulls->parts[i / 2].sides[i % 2];
        PEL_FREE_ALL(s->height[0], s->height[1], s->is_near, s->vertices, s->faces, s->edges, s->vertex_boxes,
                     s->face_boxes, s->edge_boxes, hulls->parts[i / 2].lists[i % 2].pairs);
    }
    PEL_FREE_ALL(hulls->items, hulls->order, hulls->vertices, hulls->place, hulls->fan_begin, hulls->fans,
                 hulls->may_meet, hulls->pairs, hulls->parts, hulls);
}

/* ---- bodies ---- */

typedef struct hull_job {
    pel_hulls *hulls;
    const double (*x[2])[3]; /* at the start and the end */
    double reach;
    const uint8_t *sought;
    int32_t bad[PEL_HULL_PARTS]; /* a vertex that is not finite, -1 = none */
} hull_job;

static void find_bounds(void *context, int32_t part)
{
    hull_job *job = context;
    pel_hulls *hulls = job->hulls;
    job->bad[part] = -1;
    for (int32_t i = hulls->count * part / PEL_HULL_PARTS; i < hulls->count * (part + 1) / PEL_HULL_PARTS; i++) {
        pel_hull *hull = &hulls->items[i];
        for (int end = 0; end < 2; end++) {
            double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
            for (int32_t v = hull->begin; v < hull->end; v++) {
                const double *x = job->x[end][hulls->vertices[v]];
                double sum = 0;
                for (int k = 0; k < 3; k++) {
                    low[k] = x[k] < low[k] ? x[k] : low[k];
                    high[k] = x[k] > high[k] ? x[k] : high[k];
                    sum += x[k] - x[k];
                }
                if (sum != 0 && job->bad[part] < 0)
                    job->bad[part] = hulls->vertices[v];
            }
            pel_vec3_copy(low, hull->low[end]);
            pel_vec3_copy(high, hull->high[end]);
        }
    }
}

static bool is_lower(const pel_hull_order *a, const pel_hull_order *b)
{
    return a->low != b->low ? a->low < b->low : a->hull < b->hull;
}

PEL_DEFINE_SORT(sort_hulls, pel_hull_order, is_lower)

/* m, along axis k: how far b is above a, at the start and the end at least */
static double gap_along(const pel_hull *a, const pel_hull *b, int k)
{
    return pel_min(b->low[0][k] - a->high[0][k], b->low[1][k] - a->high[1][k]);
}

/* the axis along which two are farthest apart, and how far; the sign tells which is above */
static double widest_gap(const pel_hull *a, const pel_hull *b, double axis[3])
{
    double widest = -HUGE_VAL;
    for (int k = 0; k < 6; k++) {
        double gap = k < 3 ? gap_along(a, b, k) : gap_along(b, a, k - 3);
        if (!(gap > widest))
            continue;
        widest = gap;
        pel_vec3_set(axis, 0, 0, 0);
        axis[k % 3] = k < 3 ? 1 : -1;
    }
    return widest;
}

/* m, more than rounding changes a distance between two that come within the reach */
static double slack_of(const hull_job *job, const pel_hull *a, const pel_hull *b, double share)
{
    double size = 0;
    for (int i = 0; i < 12; i++) {
        const pel_hull *one = i < 6 ? a : b;
        size = pel_max(size, pel_max(fabs(one->low[i % 2][i % 3]), fabs(one->high[i % 2][i % 3])));
    }
    return share * (job->reach + size);
}

/* lists pairs of hulls whose boxes come near each other */
static bool list_pairs(hull_job *job)
{
    pel_hulls *hulls = job->hulls;
    const pel_collision_groups *groups = &hulls->groups;
    double axis[3];
    for (int32_t i = 0; i < hulls->count; i++)
        hulls->order[i] = (pel_hull_order){pel_min(hulls->items[i].low[0][0], hulls->items[i].low[1][0]), i};
    sort_hulls(hulls->order, (size_t)hulls->count);
    hulls->pair_count = 0;
    for (int32_t i = 0; i < hulls->count; i++) {
        const pel_hull *a = &hulls->items[hulls->order[i].hull];
        double end = pel_max(a->high[0][0], a->high[1][0]) + job->reach;
        end += SLACK * (fabs(end) + job->reach);
        for (int32_t j = i + 1; j < hulls->count && hulls->order[j].low <= end; j++) {
            const pel_hull *b = &hulls->items[hulls->order[j].hull];
            bool is_asked = job->sought == NULL || job->sought[a->group] || job->sought[b->group];
            if (!is_asked || !groups->may_meet[a->group * groups->group_count + b->group] ||
                widest_gap(a, b, axis) > job->reach + slack_of(job, a, b, SLACK))
                continue;
            if (!pel_reserve((void **)&hulls->pairs, &hulls->pair_capacity, hulls->pair_count + 1,
                             sizeof *hulls->pairs))
                return false;
            hulls->pairs[hulls->pair_count++] = (pel_pair){hulls->order[i].hull, hulls->order[j].hull};
        }
    }
    return true;
}

/* ---- two bodies ---- */

/* heights along a direction, from an origin at the start and at the end */
static void find_heights(const hull_job *job, side *s, const double n[3], const double origin[2][3])
{
    const int32_t *vertices = job->hulls->vertices + s->hull->begin;
    int32_t count = s->hull->end - s->hull->begin;
    for (int end = 0; end < 2; end++) {
        const double(*x)[3] = job->x[end];
        double low = HUGE_VAL, high = -HUGE_VAL, from = pel_vec3_dot(n, origin[end]);
        for (int32_t i = 0; i < count; i++) {
            double h = pel_vec3_dot(n, x[vertices[i]]) - from;
            s->height[end][i] = h;
            low = h < low ? h : low;
            high = h > high ? h : high;
        }
        s->low[end] = low;
        s->high[end] = high;
    }
}

/* m, by how much the second side is above the first */
static double gap_of(const side sides[2])
{
    return pel_min(sides[1].low[0] - sides[0].high[0], sides[1].low[1] - sides[0].high[1]);
}

/* heights along the better of two directions; returns the gap between the sides */
static double choose_heights(const hull_job *job, side sides[2], const double origin[2][3])
{
    const pel_hull *a = sides[0].hull, *b = sides[1].hull;
    double axis[3], between[3], widest = widest_gap(a, b, axis);
    for (int k = 0; k < 3; k++) {
        between[k] = 0;
        for (int end = 0; end < 2; end++)
            between[k] += b->low[end][k] + b->high[end][k] - a->low[end][k] - a->high[end][k];
    }
    if (pel_vec3_normalize(between) > 0) {
        for (int i = 0; i < 2; i++)
            find_heights(job, &sides[i], between, origin);
        if (gap_of(sides) >= widest)
            return gap_of(sides);
    }
    for (int i = 0; i < 2; i++)
        find_heights(job, &sides[i], axis, origin);
    return gap_of(sides);
}

/* marks the vertices of both sides that may be part of what comes near */
static void mark_near(side sides[2], double reach)
{
    for (int i = 0; i < 2; i++) {
        side *s = &sides[i];
        for (int32_t v = 0; v < s->hull->end - s->hull->begin; v++) {
            double start = i == 0 ? sides[1].low[0] - s->height[0][v] : s->height[0][v] - sides[0].high[0];
            double end = i == 0 ? sides[1].low[1] - s->height[1][v] : s->height[1][v] - sides[0].high[1];
            s->is_near[v] = pel_min(start, end) <= reach;
        }
    }
}

/* of vertices on their way, in a frame with this origin, grown by a length on each side */
static pel_box box_of(const hull_job *job, const int32_t *vertices, int count, const double origin[2][3], double grown)
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (int i = 0; i < 2 * count; i++)
        for (int k = 0; k < 3; k++) {
            double x = job->x[i % 2][vertices[i / 2]][k] - origin[i % 2][k];
            low[k] = x < low[k] ? x : low[k];
            high[k] = x > high[k] ? x : high[k];
        }
    return (pel_box){{(float)(low[0] - grown), (float)(low[1] - grown), (float)(low[2] - grown), 0},
                     {(float)(high[0] + grown), (float)(high[1] + grown), (float)(high[2] + grown), 0}};
}

static bool is_near_vertex(const hull_job *job, const side *s, int32_t v)
{
    return s->is_near[job->hulls->place[v] - s->hull->begin];
}

/* the near edges that belong to a near triangle, as do all that have a near end */
static void add_edges(const hull_job *job, side *s, int32_t t, const double origin[2][3], double grown)
{
    const pel_tree *tree = job->hulls->tree;
    for (int i = 0; i < 3; i++) {
        const int32_t ends[2] = {tree->triangles[t][i], tree->triangles[t][(i + 1) % 3]};
        if (!(tree->features[t] & 1u << i) || !(is_near_vertex(job, s, ends[0]) || is_near_vertex(job, s, ends[1])))
            continue;
        s->edge_boxes[s->edge_count] = box_of(job, ends, 2, origin, grown);
        s->edges[s->edge_count++] = 3 * t + i;
    }
}

/* The near features of a side; a triangle comes with the first of its near corners. */
static void list_near(const hull_job *job, side *s, const double origin[2][3], double grown)
{
    const pel_hulls *hulls = job->hulls;
    s->vertex_count = s->face_count = s->edge_count = 0;
    for (int32_t i = s->hull->begin; i < s->hull->end; i++) {
        if (!s->is_near[i - s->hull->begin])
            continue;
        s->vertex_boxes[s->vertex_count] = box_of(job, &hulls->vertices[i], 1, origin, grown);
        s->vertices[s->vertex_count++] = hulls->vertices[i];
        for (int32_t f = hulls->fan_begin[i]; f < hulls->fan_begin[i + 1]; f++) {
            int32_t t = hulls->fans[f];
            const int32_t *v = hulls->tree->triangles[t];
            bool is_first = true;
            for (int k = 0; k < 3; k++)
                is_first &= hulls->place[v[k]] >= i || !is_near_vertex(job, s, v[k]);
            if (!is_first)
                continue;
            s->face_boxes[s->face_count] = box_of(job, v, 3, origin, grown);
            s->faces[s->face_count++] = t;
            add_edges(job, s, t, origin, grown);
        }
    }
}

/* drops features whose boxes do not overlap another one; returns how many stay */
static int32_t keep_overlapping(int32_t *features, pel_box *boxes, int32_t count, const pel_box *other)
{
    int32_t kept = 0;
    for (int32_t i = 0; i < count; i++) {
        features[kept] = features[i];
        boxes[kept] = boxes[i];
        kept += pel_box_overlaps(&boxes[i], other);
    }
    return kept;
}

static void drop_far(side *s, const side *other)
{
    pel_box all = pel_box_empty();
    for (int32_t i = 0; i < other->face_count; i++)
        all = pel_box_join(all, other->face_boxes[i]);
    s->vertex_count = keep_overlapping(s->vertices, s->vertex_boxes, s->vertex_count, &all);
    s->face_count = keep_overlapping(s->faces, s->face_boxes, s->face_count, &all);
    s->edge_count = keep_overlapping(s->edges, s->edge_boxes, s->edge_count, &all);
}

static bool add_pair(pel_pair_list *list, int32_t first, int32_t second)
{
    if (!pel_reserve((void **)&list->pairs, &list->capacity, list->count + 1, sizeof *list->pairs))
        return false;
    list->pairs[list->count++] = (pel_pair){first, second};
    return true;
}

static bool pair_features(pel_hull_part *p)
{
    const side *a = &p->sides[0], *b = &p->sides[1];
    bool fine = true;
    for (int i = 0; i < 2 && fine; i++) {
        const side *s = &p->sides[i], *other = &p->sides[1 - i];
        for (int32_t v = 0; v < s->vertex_count && fine; v++)
            for (int32_t f = 0; f < other->face_count && fine; f++)
                if (pel_box_overlaps(&s->vertex_boxes[v], &other->face_boxes[f]))
                    fine = add_pair(&p->lists[PEL_PAIR_VERTEX_FACE], s->vertices[v], other->faces[f]);
    }
    for (int32_t e = 0; e < a->edge_count && fine; e++)
        for (int32_t f = 0; f < b->edge_count && fine; f++)
            if (pel_box_overlaps(&a->edge_boxes[e], &b->edge_boxes[f])) {
                bool is_before = a->edges[e] < b->edges[f];
                fine = add_pair(&p->lists[1], is_before ? a->edges[e] : b->edges[f],
                                is_before ? b->edges[f] : a->edges[e]);
            }
    return fine;
}

static bool search_pair(const hull_job *job, pel_hull_part *p, pel_pair pair)
{
    const pel_hull *a = &job->hulls->items[pair.first], *b = &job->hulls->items[pair.second];
    double origin[2][3], reach = job->reach + slack_of(job, a, b, SLACK);
    double grown = 0.5 * job->reach + slack_of(job, a, b, FLOAT_SLACK);
    p->sides[0].hull = a;
    p->sides[1].hull = b;
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++)
            origin[end][k] = 0.5 * (a->low[end][k] + a->high[end][k]);
    if (choose_heights(job, p->sides, (const double(*)[3])origin) > reach)
        return true;
    mark_near(p->sides, reach);
    for (int i = 0; i < 2; i++)
        list_near(job, &p->sides[i], (const double(*)[3])origin, grown);
    drop_far(&p->sides[1], &p->sides[0]);
    drop_far(&p->sides[0], &p->sides[1]);
    return pair_features(p);
}

static void search_part(void *context, int32_t part)
{
    const hull_job *job = context;
    pel_hull_part *p = &job->hulls->parts[part];
    size_t count = job->hulls->pair_count, begin = count * (size_t)part / PEL_HULL_PARTS;
    size_t end = count * ((size_t)part + 1) / PEL_HULL_PARTS;
    p->lists[0].count = p->lists[1].count = 0;
    p->is_short = false;
    for (size_t i = begin; i < end && !p->is_short; i++)
        p->is_short = !search_pair(job, p, job->hulls->pairs[i]);
}

/* ---- all ---- */

static bool append(pel_pair_list *list, const pel_pair_list *more)
{
    if (!pel_reserve((void **)&list->pairs, &list->capacity, list->count + more->count, sizeof *list->pairs))
        return false;
    if (more->count > 0)
        memcpy(list->pairs + list->count, more->pairs, more->count * sizeof *more->pairs);
    list->count += more->count;
    return true;
}

pel_status pel_hulls_find(pel_hulls *hulls, const pel_motion *motion, double reach, const uint8_t *sought,
                          int64_t limit, pel_pool *pool, pel_pair_list *const lists[2], pel_error *error)
{
    hull_job job = {.hulls = hulls, .x = {motion->start, motion->end}, .reach = reach, .sought = sought};
    pel_pool_run(pool, PEL_HULL_PARTS, find_bounds, &job);
    for (int part = 0; part < PEL_HULL_PARTS; part++)
        if (job.bad[part] >= 0) {
            pel_fail(error, PEL_BAD_ARGUMENT, "the position of a vertex is not finite");
            pel_fail_element(error, "vertex", job.bad[part]);
            return PEL_BAD_ARGUMENT;
        }
    if (!list_pairs(&job))
        return pel_fail_memory(error);
    pel_pool_run(pool, PEL_HULL_PARTS, search_part, &job);
    for (int part = 0; part < PEL_HULL_PARTS; part++) {
        const pel_hull_part *p = &hulls->parts[part];
        if (p->is_short || !append(lists[0], &p->lists[0]) || !append(lists[1], &p->lists[1]))
            return pel_fail_memory(error);
    }
    return (int64_t)(lists[0]->count + lists[1]->count) > limit ? pel_pairs_refuse(limit, error) : PEL_OK;
}
