/* Surfaces in motion and brute-force searches of their pairs. */
#ifndef PEL_TESTS_BVH_SAMPLE_H
#define PEL_TESTS_BVH_SAMPLE_H

#include "check.h"
#include "random.h"

#include "bvh/frame.h"
#include "bvh/search.h"
#include "pellicle/shape.h"

#include <stdlib.h>

typedef struct surface {
    int32_t vertex_count, triangle_count;
    double (*start)[3], (*end)[3];
    int32_t (*triangles)[3];
} surface;

static inline surface make_surface(int32_t vertex_count, int32_t triangle_count)
{
    surface s = {vertex_count, triangle_count, calloc((size_t)vertex_count, sizeof *s.start),
                 calloc((size_t)vertex_count, sizeof *s.end), calloc((size_t)triangle_count, sizeof *s.triangles)};
    return s;
}

static inline void free_surface(surface *s)
{
    free(s->start);
    free(s->end);
    free(s->triangles);
}

/* triangles of random vertices near each other, many on common edges, in the unit cube */
static inline surface make_soup(int32_t triangle_count, double size, uint64_t seed)
{
    random_state random = {seed};
    int32_t vertex_count = triangle_count + 2;
    surface s = make_surface(vertex_count, triangle_count);
    double walk[3] = {0.5, 0.5, 0.5};
    for (int32_t v = 0; v < vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            walk[k] = fmin(fmax(walk[k] + size * random_normal(&random), 0), 1);
            s.start[v][k] = walk[k];
            s.end[v][k] = walk[k] + 0.05 * random_normal(&random);
        }
    for (int32_t t = 0; t < triangle_count; t++) {
        s.triangles[t][0] = t;
        s.triangles[t][1] = t + 1;
        s.triangles[t][2] = random_integer(&random, 0, 3) > 0 || t == triangle_count - 1
                                ? t + 2
                                : (t + 2 + vertex_count / 2) % vertex_count;
        if (s.triangles[t][2] == t || s.triangles[t][2] == t + 1)
            s.triangles[t][2] = t + 2;
    }
    return s;
}

static inline surface surface_of_mesh(pel_mesh *mesh, double noise)
{
    random_state random = {5};
    surface s = make_surface(mesh->vertex_count, mesh->triangle_count);
    memcpy(s.start, mesh->positions, (size_t)s.vertex_count * sizeof *s.start);
    memcpy(s.triangles, mesh->triangles, (size_t)s.triangle_count * sizeof *s.triangles);
    for (int32_t v = 0; v < s.vertex_count; v++)
        for (int k = 0; k < 3; k++)
            s.end[v][k] = s.start[v][k] + noise * random_between(&random, -1, 1);
    pel_mesh_destroy(mesh);
    return s;
}

/* unit sphere of 20 frequency^2 triangles */
static inline surface make_sphere(int32_t frequency, double noise)
{
    pel_shape_def def = pel_shape_def_default(PEL_SHAPE_GEODESIC_SPHERE);
    def.frequency = frequency;
    pel_mesh *mesh;
    assert_int_equal(pel_shape_create(&def, &mesh, NULL), PEL_OK);
    return surface_of_mesh(mesh, noise);
}

/* a square sheet of 2 n^2 triangles, folded over itself five times with little space between */
static inline surface make_folded_sheet(int32_t n, double noise)
{
    random_state random = {9};
    surface s = make_surface((n + 1) * (n + 1), 2 * n * n);
    for (int32_t v = 0; v < s.vertex_count; v++) {
        double u = (double)(v % (n + 1)) / n, w = (double)(v / (n + 1)) / n;
        const double place[3] = {0.2 * asin(sin(15 * u)), w, 0.05 * u};
        for (int k = 0; k < 3; k++) {
            s.start[v][k] = place[k];
            s.end[v][k] = place[k] + noise * random_between(&random, -1, 1);
        }
    }
    for (int32_t i = 0; i < n * n; i++) {
        int32_t v = i / n * (n + 1) + i % n;
        const int32_t corners[2][3] = {{v, v + 1, v + n + 2}, {v, v + n + 2, v + n + 1}};
        memcpy(s.triangles[2 * i], corners, sizeof corners);
    }
    return s;
}

/* ---- sets of pairs ---- */

typedef struct pair_set {
    pel_pair *pairs;
    size_t count, capacity;
} pair_set;

static inline void add_pair(pair_set *set, pel_pair pair)
{
    if (set->count == set->capacity) {
        set->capacity = 2 * set->capacity + 16;
        set->pairs = realloc(set->pairs, set->capacity * sizeof *set->pairs);
        assert_non_null(set->pairs);
    }
    set->pairs[set->count++] = pair;
}

static inline void clear_pairs(pair_set *set)
{
    free(set->pairs);
    *set = (pair_set){0};
}

static inline int compare_pairs(const void *a, const void *b)
{
    const pel_pair *p = a, *q = b;
    return p->first != q->first ? (p->first > q->first) - (p->first < q->first)
                                : (p->second > q->second) - (p->second < q->second);
}

/* compares as sets; a duplicate pair makes them differ. Sorts both. */
static inline bool pairs_equal(pair_set *a, pair_set *b)
{
    if (a->count != b->count)
        return false;
    if (a->count == 0)
        return true;
    qsort(a->pairs, a->count, sizeof *a->pairs, compare_pairs);
    qsort(b->pairs, b->count, sizeof *b->pairs, compare_pairs);
    return memcmp(a->pairs, b->pairs, a->count * sizeof *a->pairs) == 0;
}

/* ---- brute force ---- */

/* boxes of edges are at the half-edges that name them; boxes of other half-edges are empty */
typedef struct feature_boxes {
    pel_box *vertices, *edges, *triangles;
} feature_boxes;

static inline feature_boxes make_feature_boxes(const pel_tree *tree)
{
    return (feature_boxes){aligned_alloc(32, (size_t)tree->vertex_count * sizeof(pel_box)),
                           aligned_alloc(32, 3 * (size_t)tree->triangle_count * sizeof(pel_box)),
                           aligned_alloc(32, (size_t)tree->triangle_count * sizeof(pel_box))};
}

static inline void fill_feature_boxes(const pel_tree *tree, feature_boxes *boxes)
{
    for (int32_t h = 0; h < 3 * tree->triangle_count; h++)
        boxes->edges[h] = pel_tree_edge(tree, h) == h ? pel_tree_edge_box(tree, boxes->vertices, h) : pel_box_empty();
    for (int32_t t = 0; t < tree->triangle_count; t++)
        boxes->triangles[t] = pel_tree_triangle_box(tree, boxes->vertices, t);
}

static inline void free_feature_boxes(feature_boxes *boxes)
{
    free(boxes->vertices);
    free(boxes->edges);
    free(boxes->triangles);
}

static inline bool shares_vertex(const int32_t *a, int a_count, const int32_t *b, int b_count)
{
    for (int i = 0; i < a_count; i++)
        for (int j = 0; j < b_count; j++)
            if (a[i] == b[j])
                return true;
    return false;
}

static inline pair_set brute_vertex_face(const pel_tree *tree, const feature_boxes *boxes)
{
    pair_set set = {0};
    uint8_t *used = calloc((size_t)tree->vertex_count, 1);
    for (int32_t h = 0; h < 3 * tree->triangle_count; h++)
        used[tree->triangles[h / 3][h % 3]] = 1;
    for (int32_t v = 0; v < tree->vertex_count; v++)
        for (int32_t t = 0; t < tree->triangle_count && used[v]; t++)
            if (!shares_vertex(&v, 1, tree->triangles[t], 3) &&
                pel_box_overlaps(&boxes->vertices[v], &boxes->triangles[t]))
                add_pair(&set, (pel_pair){v, t});
    free(used);
    return set;
}

static inline pair_set brute_edge_edge(const pel_tree *tree, const feature_boxes *boxes)
{
    pair_set set = {0};
    for (int32_t e = 0; e < 3 * tree->triangle_count; e++)
        for (int32_t f = e + 1; f < 3 * tree->triangle_count; f++) {
            int32_t a[2], b[2];
            pel_tree_edge_ends(tree, e, a);
            pel_tree_edge_ends(tree, f, b);
            if (!shares_vertex(a, 2, b, 2) && pel_box_overlaps(&boxes->edges[e], &boxes->edges[f]))
                add_pair(&set, (pel_pair){e, f});
        }
    return set;
}

static inline pair_set brute_face_face(const pel_tree *tree, const feature_boxes *boxes)
{
    pair_set set = {0};
    for (int32_t s = 0; s < tree->triangle_count; s++)
        for (int32_t t = s + 1; t < tree->triangle_count; t++)
            if (pel_box_overlaps(&boxes->triangles[s], &boxes->triangles[t]))
                add_pair(&set, (pel_pair){s, t});
    return set;
}

static inline pair_set brute_between(const pel_box *a, int32_t a_count, const pel_box *b, int32_t b_count)
{
    pair_set set = {0};
    for (int32_t i = 0; i < a_count; i++)
        for (int32_t j = 0; j < b_count; j++)
            if (pel_box_overlaps(&a[i], &b[j]))
                add_pair(&set, (pel_pair){i, j});
    return set;
}

#endif
