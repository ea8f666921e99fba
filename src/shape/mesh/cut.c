/* The corners of triangles that stay together across an edge are joined; the joined corners at a vertex are a fan, and
   each fan becomes a vertex. Across an edge with two triangles both ends are joined. Around an edge with more
   triangles, neighbours in space are joined in pairs if their windings fit, either through the inside of the body or
   through the outside; the others get a boundary:

           \ 2 | 1 /        looking along the edge: triangles 1 and 2 face each other through the inside of one body,
            \  |  /         3 and 4 through that of another. Joined (1 2) (3 4) the bodies come apart; joined (2 3)
         ----  o  ----      (4 1) they would stay one that touches itself in the edge, and both ends of it would still
            /     \         be the same two vertices.
           / 3   4 \

   Which of the two separates depends on the mesh, so both are tried until no edge is left. */
#include "mesh/cut.h"

#include "base/memory.h"
#include "base/room.h"
#include "math/functions.h"
#include "math/vec3.h"
#include "mesh/edge_table.h"
#include "mesh/union_find.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum cut_way { THROUGH_INSIDE, THROUGH_OUTSIDE, ALL_APART, WAY_COUNT } cut_way;

/* a triangle at an edge */
typedef struct spoke {
    double angle; /* around the edge */
    int32_t half_edge;
    bool forward; /* it runs from the lower vertex to the higher one */
} spoke;

typedef struct work {
    const double (*positions)[3];
    const int32_t (*triangles)[3];
    int32_t vertex_count, triangle_count;
    const uint8_t *skip;
    pel_edge_table edges;
    int32_t *parent; /* (3 triangle_count) corners that are joined */
    spoke *spokes;   /* (most triangles at an edge) */
} work;

/* the corner where a half-edge ends; it starts at corner h */
static int32_t end_of(int32_t h)
{
    return h % 3 == 2 ? h - 2 : h + 1;
}

static int32_t vertex_at(const work *w, int32_t corner)
{
    return w->triangles[corner / 3][corner % 3];
}

static void join(work *w, int32_t g, int32_t h)
{
    bool same = vertex_at(w, g) == vertex_at(w, h);
    pel_union_find_join(w->parent, g, same ? h : end_of(h));
    pel_union_find_join(w->parent, end_of(g), same ? end_of(h) : h);
}

static int by_angle(const void *a, const void *b)
{
    const spoke *p = a, *q = b;
    if (p->angle != q->angle)
        return p->angle < q->angle ? -1 : 1;
    return (p->half_edge > q->half_edge) - (p->half_edge < q->half_edge);
}

/* the component across the edge of the vector from its lower vertex to the third corner */
static void arm_of(const work *w, int32_t h, const double axis[3], const double origin[3], double arm[3])
{
    pel_vec3_subtract(w->positions[vertex_at(w, end_of(end_of(h)))], origin, arm);
    double along = pel_vec3_dot(arm, axis);
    for (int i = 0; i < 3; i++)
        arm[i] -= along * axis[i];
}

/* the triangles at an edge in their order around it; returns how many */
static int32_t sort_spokes(work *w, int32_t e)
{
    int32_t h = w->edges.half_edge_of_edge[e], a = vertex_at(w, h), b = vertex_at(w, end_of(h)), count = 0;
    int32_t low = a < b ? a : b;
    double axis[3], first[3], second[3], arm[3];
    pel_vec3_subtract(w->positions[low == a ? b : a], w->positions[low], axis);
    double length = pel_vec3_length(axis);
    for (int i = 0; i < 3; i++)
        axis[i] /= length > 0 ? length : 1;
    arm_of(w, h, axis, w->positions[low], first);
    pel_vec3_cross(axis, first, second);
    for (; h >= 0; h = w->edges.next_in_edge[h], count++) {
        arm_of(w, h, axis, w->positions[low], arm);
        w->spokes[count] =
            (spoke){pel_atan2(pel_vec3_dot(arm, second), pel_vec3_dot(arm, first)), h, vertex_at(w, h) == low};
    }
    qsort(w->spokes, (size_t)count, sizeof *w->spokes, by_angle);
    return count;
}

/* a triangle that runs forward has its outside where the angle grows */
static void join_spokes(work *w, int32_t count, cut_way way)
{
    for (int32_t i = 0; way != ALL_APART && i < count; i++) {
        const spoke *one = &w->spokes[i], *next = &w->spokes[(i + 1) % count];
        if (one->forward == (way == THROUGH_OUTSIDE) && next->forward != one->forward)
            join(w, one->half_edge, next->half_edge);
    }
}

static void join_all(work *w, cut_way way)
{
    pel_union_find_reset(w->parent, 3 * w->triangle_count);
    for (int32_t e = 0; e < w->edges.edge_count; e++) {
        int32_t h = w->edges.half_edge_of_edge[e], valence = pel_edge_table_valence(&w->edges, e);
        if (valence == 2)
            join(w, h, w->edges.next_in_edge[h]);
        else if (valence > 2)
            join_spokes(w, sort_spokes(w, e), way);
    }
}

/* numbers the fans: the first one of each vertex keeps its number. Fills cut->corners and the count of copies. */
static void number_fans(work *w, uint8_t *taken, pel_cut *cut)
{
    cut->copy_count = 0;
    memset(taken, 0, (size_t)w->vertex_count);
    for (int32_t c = 0; c < 3 * w->triangle_count; c++) {
        int32_t v = vertex_at(w, c), root = pel_union_find_root(w->parent, c);
        cut->corners[c] = v;
        if (w->skip != NULL && w->skip[c / 3])
            continue;
        if (root < c)
            cut->corners[c] = cut->corners[root];
        else if (taken[v])
            cut->corners[c] = w->vertex_count + cut->copy_count++;
        taken[v] = 1;
    }
}

static pel_status count_edges(const work *w, pel_cut *cut)
{
    pel_edge_table edges = {0};
    pel_status status = pel_edge_table_build((const int32_t(*)[3])cut->corners, w->triangle_count,
                                             w->vertex_count + cut->copy_count, w->skip, &edges);
    cut->edge_count = 0;
    for (int32_t e = 0; status == PEL_OK && e < edges.edge_count; e++)
        cut->edge_count += pel_edge_table_valence(&edges, e) > 2;
    pel_edge_table_clear(&edges);
    return status;
}

static pel_status try_way(work *w, cut_way way, uint8_t *taken, pel_cut *cut)
{
    join_all(w, way);
    number_fans(w, taken, cut);
    return count_edges(w, cut);
}

/* the first way that leaves no edge, else the one that leaves fewest */
static pel_status find_way(work *w, uint8_t *taken, pel_cut *cut)
{
    cut_way best = THROUGH_INSIDE;
    pel_status status = try_way(w, best, taken, cut);
    int32_t least = cut->edge_count;
    for (cut_way way = THROUGH_OUTSIDE; status == PEL_OK && cut->edge_count > 0 && way < WAY_COUNT; way++) {
        status = try_way(w, way, taken, cut);
        if (cut->edge_count < least) {
            least = cut->edge_count;
            best = way;
        }
    }
    if (status == PEL_OK && cut->edge_count > least)
        status = try_way(w, best, taken, cut);
    return status;
}

static pel_status find_sources(const work *w, pel_cut *cut)
{
    cut->source_of = pel_allocate((size_t)cut->copy_count, sizeof *cut->source_of);
    if (cut->source_of == NULL)
        return PEL_OUT_OF_MEMORY;
    for (int32_t c = 0; c < 3 * w->triangle_count; c++)
        if (cut->corners[c] >= w->vertex_count)
            cut->source_of[cut->corners[c] - w->vertex_count] = vertex_at(w, c);
    return PEL_OK;
}

static int32_t largest_valence(const pel_edge_table *edges)
{
    int32_t most = 0;
    for (int32_t e = 0; e < edges->edge_count; e++) {
        int32_t valence = pel_edge_table_valence(edges, e);
        most = valence > most ? valence : most;
    }
    return most;
}

pel_status pel_cut_find(const double (*positions)[3], int32_t vertex_count, const int32_t (*triangles)[3],
                        int32_t triangle_count, const uint8_t *skip, pel_cut *cut)
{
    work w = {.positions = positions,
              .triangles = triangles,
              .vertex_count = vertex_count,
              .triangle_count = triangle_count,
              .skip = skip};
    *cut = (pel_cut){0};
    uint8_t *taken = pel_allocate((size_t)vertex_count, 1);
    w.parent = pel_allocate(3 * (size_t)triangle_count, sizeof *w.parent);
    cut->corners = pel_allocate(3 * (size_t)triangle_count, sizeof *cut->corners);
    pel_status status = taken != NULL && w.parent != NULL && cut->corners != NULL ? PEL_OK : PEL_OUT_OF_MEMORY;
    if (status == PEL_OK)
        status = pel_edge_table_build(triangles, triangle_count, vertex_count, skip, &w.edges);
    if (status == PEL_OK) {
        w.spokes = pel_allocate((size_t)largest_valence(&w.edges), sizeof *w.spokes);
        status = w.spokes != NULL ? find_way(&w, taken, cut) : PEL_OUT_OF_MEMORY;
    }
    if (status == PEL_OK)
        status = find_sources(&w, cut);
    pel_edge_table_clear(&w.edges);
    PEL_FREE_ALL(w.spokes, w.parent, taken);
    if (status != PEL_OK)
        pel_cut_clear(cut);
    return status;
}

void pel_cut_clear(pel_cut *cut)
{
    pel_free(cut->corners);
    pel_free(cut->source_of);
    *cut = (pel_cut){0};
}
