#include "measure/star.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"

#include <string.h>

static const int sides[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

/* a tetrahedron at an edge, in the list of the edge's first vertex */
typedef struct pel_side {
    int32_t other, tetra;
} pel_side;

/* what is built */
typedef struct builder {
    const int32_t (*tetrahedra)[4];
    const double *young;
    pel_rest_tetra *rests; /* (tetrahedra) */
    int32_t *side_begin;   /* (vertices + 2) */
    pel_side *sides;       /* (6 tetrahedra) by first vertex, then by the other one */
    uint8_t *is_taken;     /* (tetrahedra) by a patch */
    int32_t *star_begin;   /* (edges + 1) into sides */
    int32_t edge_count;
    /* elements as they come; counts alone while nodes are null */
    int32_t count, node_count;
    int32_t *begin, *nodes;
    double (*gradients)[3], (*scales)[2];
} builder;

/* ---- edges ---- */

static void sort_sides(pel_side *list, int32_t count)
{
    for (int32_t i = 1; i < count; i++) {
        const pel_side own = list[i];
        int32_t j = i;
        for (; j > 0 && list[j - 1].other > own.other; j--)
            list[j] = list[j - 1];
        list[j] = own;
    }
}

/* Lists by owner: counts stand two places after their owner's number, sums make them begins one place after; filling
   moves each up to the start of the next owner. */
static void list_sides(builder *b, int32_t vertex_count, int32_t count)
{
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t t = 0; t < count; t++)
            for (int k = 0; k < 6; k++) {
                const int32_t one = b->tetrahedra[t][sides[k][0]], two = b->tetrahedra[t][sides[k][1]];
                const int32_t first = one < two ? one : two, other = one < two ? two : one;
                if (pass == 0)
                    b->side_begin[first + 2]++;
                else
                    b->sides[b->side_begin[first + 1]++] = (pel_side){other, t};
            }
        for (int32_t v = 0; pass == 0 && v < vertex_count; v++)
            b->side_begin[v + 2] += b->side_begin[v + 1];
    }
    for (int32_t v = 0; v < vertex_count; v++) {
        const int32_t end = b->side_begin[v + 1];
        sort_sides(b->sides + b->side_begin[v], end - b->side_begin[v]);
        for (int32_t i = b->side_begin[v]; i < end; i++)
            if (i == b->side_begin[v] || b->sides[i].other != b->sides[i - 1].other)
                b->star_begin[b->edge_count++] = i;
    }
    b->star_begin[b->edge_count] = 6 * count;
}

/* ---- elements ---- */

static int find_node(const int32_t *nodes, int count, int32_t v)
{
    int k = 0;
    while (k < count && nodes[k] != v)
        k++;
    return k;
}

/* the element of some tetrahedra: nodes, their gradients and the sum of Young's modulus times volume; returns the
   number of nodes, more than PEL_STAR_NODES if there are too many */
static int join(const builder *b, const int32_t *tetras, int32_t count, int32_t nodes[PEL_STAR_NODES],
                double gradients[PEL_STAR_NODES][3], double *energy)
{
    int node_count = 0;
    double volume = 0;
    *energy = 0;
    memset(gradients, 0, PEL_STAR_NODES * sizeof *gradients);
    for (int32_t i = 0; i < count; i++) {
        const pel_rest_tetra *rest = &b->rests[tetras[i]];
        volume += rest->volume;
        *energy += b->young[tetras[i]] * rest->volume;
        for (int k = 0; k < 4; k++) {
            const int at = find_node(nodes, node_count, b->tetrahedra[tetras[i]][k]);
            if (at == PEL_STAR_NODES)
                return PEL_STAR_NODES + 1;
            nodes[at] = b->tetrahedra[tetras[i]][k];
            node_count = at == node_count ? at + 1 : node_count;
            for (int c = 0; c < 3; c++)
                gradients[at][c] += rest->volume * rest->gradients[k][c];
        }
    }
    for (int k = 0; k < node_count; k++)
        for (int c = 0; c < 3; c++)
            gradients[k][c] /= volume;
    return node_count;
}

/* adds an element with shares of its energy in the part of the shape and in that of the size */
static void add_element(builder *b, const int32_t *tetras, int32_t count, double shape, double size)
{
    int32_t nodes[PEL_STAR_NODES];
    double gradients[PEL_STAR_NODES][3], energy;
    const int node_count = join(b, tetras, count, nodes, gradients, &energy);
    if (node_count > PEL_STAR_NODES) {
        for (int32_t i = 0; i < count; i++)
            add_element(b, tetras + i, 1, shape, size);
        return;
    }
    if (b->nodes != NULL) {
        memcpy(b->nodes + b->node_count, nodes, (size_t)node_count * sizeof *nodes);
        memcpy(b->gradients + b->node_count, gradients, (size_t)node_count * sizeof *gradients);
        b->scales[b->count][0] = shape * energy;
        b->scales[b->count][1] = size * energy;
        b->begin[b->count] = b->node_count;
    }
    b->count++;
    b->node_count += node_count;
}

/* the tetrahedra of a star, or those that no patch has yet; at most `limit` */
static int32_t list_star(const builder *b, int32_t edge, bool is_free, int32_t limit, int32_t *tetras)
{
    int32_t count = 0;
    for (int32_t i = b->star_begin[edge]; i < b->star_begin[edge + 1] && count < limit; i++)
        if (!is_free || !b->is_taken[b->sides[i].tetra])
            tetras[count++] = b->sides[i].tetra;
    return count;
}

enum { STAR_TETRAS = 2 * PEL_STAR_NODES };

static void add_star(builder *b, int32_t edge, const uint8_t *is_patch)
{
    int32_t tetras[STAR_TETRAS];
    const int32_t all = b->star_begin[edge + 1] - b->star_begin[edge];
    if (all <= STAR_TETRAS) {
        list_star(b, edge, false, STAR_TETRAS, tetras);
        add_element(b, tetras, all, 1.0 / 6, is_patch[edge] ? 1 : 0);
        return;
    }
    for (int32_t i = b->star_begin[edge]; i < b->star_begin[edge + 1]; i++)
        add_element(b, &b->sides[i].tetra, 1, 1.0 / 6, 0);
}

/* Patches, from the stars with the most free tetrahedra to those with one: whole stars are marked, parts of stars are
   elements of their own. */
static void add_patches(builder *b, int32_t tetra_count, uint8_t *is_patch)
{
    int32_t tetras[STAR_TETRAS], most = 1;
    memset(b->is_taken, 0, (size_t)tetra_count);
    memset(is_patch, 0, (size_t)b->edge_count);
    for (int32_t e = 0; e < b->edge_count; e++) {
        const int32_t all = b->star_begin[e + 1] - b->star_begin[e];
        most = all > most && all <= PEL_STAR_NODES - 2 ? all : most;
    }
    for (int32_t wanted = most; wanted > 0; wanted--)
        for (int32_t e = 0; e < b->edge_count; e++) {
            const int32_t all = b->star_begin[e + 1] - b->star_begin[e];
            if (all > STAR_TETRAS || list_star(b, e, true, STAR_TETRAS, tetras) != wanted)
                continue;
            for (int32_t i = 0; i < wanted; i++)
                b->is_taken[tetras[i]] = 1;
            is_patch[e] = wanted == all;
            if (wanted < all)
                add_element(b, tetras, wanted, 0, 1);
        }
    /* those at none but large stars */
    for (int32_t t = 0; t < tetra_count; t++)
        if (!b->is_taken[t])
            add_element(b, &t, 1, 0, 1);
}

static void add_elements(builder *b, int32_t tetra_count, uint8_t *is_patch)
{
    b->count = b->node_count = 0;
    add_patches(b, tetra_count, is_patch);
    for (int32_t e = 0; e < b->edge_count; e++)
        add_star(b, e, is_patch);
    if (b->begin != NULL)
        b->begin[b->count] = b->node_count;
}

/* by rising number of nodes */
static void sort_elements(const builder *b, pel_stars *stars)
{
    int32_t count = 0, node_count = 0;
    for (int32_t nodes = 4; nodes <= PEL_STAR_NODES; nodes++)
        for (int32_t e = 0; e < b->count; e++) {
            const int32_t from = b->begin[e];
            if (b->begin[e + 1] - from != nodes)
                continue;
            memcpy(stars->nodes + node_count, b->nodes + from, (size_t)nodes * sizeof *stars->nodes);
            memcpy(stars->gradients + node_count, b->gradients + from, (size_t)nodes * sizeof *stars->gradients);
            memcpy(stars->scales[count], b->scales[e], sizeof *stars->scales);
            stars->begin[count++] = node_count;
            node_count += nodes;
        }
    stars->begin[count] = node_count;
    stars->count = count;
}

static bool build(builder *b, const double (*positions)[3], int32_t vertex_count, int32_t count, uint8_t **is_patch,
                  pel_stars *stars)
{
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(b->rests, count), PEL_ROOM(b->side_begin, (size_t)vertex_count + 2),
                          PEL_ROOM(b->sides, 6 * (size_t)count), PEL_ROOM(b->is_taken, count),
                          PEL_ROOM(b->star_begin, 6 * (size_t)count + 1)))
        return false;
    for (int32_t t = 0; t < count; t++) {
        double x[4][3];
        for (int k = 0; k < 4; k++)
            memcpy(x[k], positions[b->tetrahedra[t][k]], sizeof x[k]);
        pel_rest_tetra_setup((const double(*)[3])x, &b->rests[t]);
    }
    list_sides(b, vertex_count, count);
    *is_patch = pel_allocate((size_t)b->edge_count + 1, 1);
    if (*is_patch == NULL)
        return false;
    add_elements(b, count, *is_patch);
    const size_t elements = (size_t)b->count, nodes = (size_t)b->node_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(b->begin, elements + 1), PEL_ROOM(b->nodes, nodes), PEL_ROOM(b->gradients, nodes),
                          PEL_ROOM(b->scales, elements), PEL_ROOM(stars->begin, elements + 1),
                          PEL_ROOM(stars->nodes, nodes), PEL_ROOM(stars->gradients, nodes),
                          PEL_ROOM(stars->scales, elements)))
        return false;
    add_elements(b, count, *is_patch);
    sort_elements(b, stars);
    return true;
}

pel_status pel_stars_create(const double (*positions)[3], int32_t vertex_count, const int32_t (*tetrahedra)[4],
                            int32_t count, const double *young, pel_stars **stars, pel_error *error)
{
    builder b = {.tetrahedra = tetrahedra, .young = young};
    uint8_t *is_patch = NULL;
    *stars = pel_allocate(1, sizeof **stars);
    const bool made = *stars != NULL && build(&b, positions, vertex_count, count, &is_patch, *stars);
    PEL_FREE_ALL(b.rests, b.side_begin, b.sides, b.is_taken, b.star_begin, b.begin, b.nodes, b.gradients, b.scales,
                 is_patch);
    if (made)
        return PEL_OK;
    pel_stars_destroy(*stars);
    *stars = NULL;
    return pel_fail_memory(error);
}

void pel_stars_destroy(pel_stars *stars)
{
    if (stars != NULL)
        PEL_FREE_ALL(stars->begin, stars->nodes, stars->gradients, stars->scales, stars);
}

/* ---- energy ---- */

pel_solid_law pel_star_law(const pel_solid_law *law, const double scales[2])
{
    const bool is_stvk = law->kind == PEL_VOLUME_STVK;
    const double shape = scales[0], size = scales[1];
    return (pel_solid_law){.kind = law->kind,
                           .a1 = shape * law->a1,
                           .a2 = shape * law->a2,
                           .b2 = (is_stvk ? size : shape) * law->b2,
                           .a4 = shape * law->a4,
                           .c = shape * law->c,
                           .k = is_stvk ? 0 : shape * law->shape_k + size * (law->k - law->shape_k),
                           .shape_k = shape * law->shape_k};
}

void pel_star_deformation(const pel_stars *stars, int32_t e, const double *x, double f[9])
{
    PEL_ASSERT_INDEX(e, stars->count);
    const int32_t begin = stars->begin[e];
    pel_patch_deformation(stars->begin[e + 1] - begin, (const double(*)[3])stars->gradients + begin, x, f);
}

double pel_star_tangent(const pel_stars *stars, int32_t e, const pel_solid_law *law, const double *x,
                        pel_tangent_kind kind, const pel_tangent_sum *sum)
{
    PEL_ASSERT_INDEX(e, stars->count);
    const int32_t begin = stars->begin[e];
    const pel_solid_law own = pel_star_law(law, stars->scales[e]);
    return pel_patch_tangent(stars->begin[e + 1] - begin, (const double(*)[3])stars->gradients + begin, &own, 1, x,
                             kind, sum);
}
