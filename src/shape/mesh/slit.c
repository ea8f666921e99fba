/*          b                     b
           /|\                   / \            a b c is flat, c lies on the edge from a to b, which has the triangle
          / c \  (flat)         /   \           b a d beyond. Afterwards they are c a d and b c d, and what was at the
         /  |  d       becomes c-----d          edges from b to c and from c to a is closed again.
          \ | /                 \   /
           \|/                   \ /
            a                     a                                                                              */
#include "mesh/slit.h"

#include "base/memory.h"
#include "mesh/edge_table.h"
#include "mesh/flat_triangle.h"

typedef struct work {
    const double (*positions)[3];
    int32_t (*triangles)[3];
    uint8_t *changed;
    int32_t *twin;  /* (3 triangle_count) the other half-edge where there are two that run against each other; -1 */
    int32_t *stack; /* triangles to be looked at */
    size_t room, count;
} work;

static bool is_flat(const work *w, int32_t a, int32_t b, int32_t c)
{
    return pel_triangle_is_flat(w->positions[a], w->positions[b], w->positions[c]);
}

static bool is_flat_triangle(const work *w, int32_t t)
{
    return is_flat(w, w->triangles[t][0], w->triangles[t][1], w->triangles[t][2]);
}

static int32_t longest_half_edge(const work *w, int32_t t)
{
    int longest = 0;
    double most = -1;
    for (int i = 0; i < 3; i++) {
        double length = pel_vec3_distance(w->positions[w->triangles[t][i]], w->positions[w->triangles[t][(i + 1) % 3]]);
        if (length > most) {
            most = length;
            longest = i;
        }
    }
    return 3 * t + longest;
}

static void link(work *w, int32_t g, int32_t h)
{
    w->twin[g] = h;
    if (h >= 0)
        w->twin[h] = g;
}

static bool push(work *w, int32_t t)
{
    void *stack = w->stack;
    bool grown = pel_reserve(&stack, &w->room, w->count + 1, sizeof *w->stack);
    w->stack = stack;
    if (grown)
        w->stack[w->count++] = t;
    return grown;
}

/* swaps the longest edge of a flat triangle; false when nothing can be done */
static bool flip(work *w, int32_t t)
{
    int32_t h = longest_half_edge(w, t), g = w->twin[h];
    if (g < 0)
        return false;
    int32_t n = g / 3, i = h % 3, j = g % 3;
    int32_t a = w->triangles[t][i], b = w->triangles[t][(i + 1) % 3], c = w->triangles[t][(i + 2) % 3],
            d = w->triangles[n][(j + 2) % 3];
    if (c == d || is_flat(w, c, a, d) || is_flat(w, b, c, d))
        return false;
    int32_t bc = w->twin[3 * t + (i + 1) % 3], ca = w->twin[3 * t + (i + 2) % 3], ad = w->twin[3 * n + (j + 1) % 3],
            db = w->twin[3 * n + (j + 2) % 3];
    const int32_t first[3] = {c, a, d}, second[3] = {b, c, d};
    for (int k = 0; k < 3; k++) {
        w->triangles[t][k] = first[k];
        w->triangles[n][k] = second[k];
    }
    link(w, 3 * t, ca);
    link(w, 3 * t + 1, ad);
    link(w, 3 * t + 2, 3 * n + 1);
    link(w, 3 * n, bc);
    link(w, 3 * n + 2, db);
    w->changed[t] = w->changed[n] = 1;
    return true;
}

/* flat triangles next to the two may become removable */
static bool push_neighbours(work *w, int32_t t)
{
    for (int32_t h = 3 * t; h < 3 * t + 3; h++)
        if (w->twin[h] >= 0 && is_flat_triangle(w, w->twin[h] / 3) && !push(w, w->twin[h] / 3))
            return false;
    return true;
}

/* each flip leaves one flat triangle less, so this ends */
static pel_status flip_all(work *w, int32_t *flip_count)
{
    while (w->count > 0) {
        int32_t t = w->stack[--w->count];
        if (!is_flat_triangle(w, t))
            continue;
        int32_t beyond = w->twin[longest_half_edge(w, t)] / 3;
        if (!flip(w, t))
            continue;
        ++*flip_count;
        if (!push_neighbours(w, t) || !push_neighbours(w, beyond))
            return PEL_OUT_OF_MEMORY;
    }
    return PEL_OK;
}

static void find_twins(work *w, const pel_edge_table *edges, int32_t half_edge_count)
{
    for (int32_t h = 0; h < half_edge_count; h++)
        w->twin[h] = -1;
    for (int32_t e = 0; e < edges->edge_count; e++) {
        int32_t h = edges->half_edge_of_edge[e], g = edges->next_in_edge[h];
        if (pel_edge_table_valence(edges, e) == 2 && w->triangles[h / 3][h % 3] != w->triangles[g / 3][g % 3])
            link(w, h, g);
    }
}

pel_status pel_slits_close(const double (*positions)[3], int32_t vertex_count, int32_t (*triangles)[3],
                           int32_t triangle_count, const uint8_t *skip, uint8_t *changed, int32_t *flip_count)
{
    work w = {.positions = positions, .triangles = triangles, .changed = changed};
    pel_edge_table edges = {0};
    pel_status status = PEL_OK;
    for (int32_t t = triangle_count - 1; status == PEL_OK && t >= 0; t--)
        if (!skip[t] && is_flat_triangle(&w, t) && !push(&w, t))
            status = PEL_OUT_OF_MEMORY;
    if (status == PEL_OK && w.count > 0)
        status = pel_edge_table_build((const int32_t(*)[3])triangles, triangle_count, vertex_count, skip, &edges);
    if (status == PEL_OK && w.count > 0) {
        w.twin = pel_allocate(3 * (size_t)triangle_count, sizeof *w.twin);
        status = w.twin != NULL ? PEL_OK : PEL_OUT_OF_MEMORY;
    }
    if (status == PEL_OK && w.count > 0) {
        find_twins(&w, &edges, 3 * triangle_count);
        status = flip_all(&w, flip_count);
    }
    pel_edge_table_clear(&edges);
    pel_free(w.twin);
    pel_free(w.stack);
    return status;
}
