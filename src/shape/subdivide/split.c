#include "subdivide/split.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "mesh/topology_check.h"

pel_level_size pel_level_size_of(const pel_topology *topology)
{
    return (pel_level_size){topology->vertex_count, topology->edge_count, topology->triangle_count};
}

pel_level_size pel_level_size_split(pel_level_size coarse)
{
    return (pel_level_size){coarse.vertex_count + coarse.edge_count, 2 * coarse.edge_count + 3 * coarse.triangle_count,
                            4 * coarse.triangle_count};
}

bool pel_level_size_fits(pel_level_size size)
{
    return size.triangle_count <= INT32_MAX / 3 && size.vertex_count <= INT32_MAX;
}

size_t pel_level_size_topology_bytes(pel_level_size size)
{
    return sizeof(int32_t) * (size_t)(9 * size.triangle_count + size.edge_count + size.vertex_count);
}

static int32_t next_corner(int32_t i)
{
    return i == 2 ? 0 : i + 1;
}

/* the two half-edges of the next level on the other side of half-edge g: towards its target, then from its origin */
static int32_t outer_twin(int32_t g)
{
    return g < 0 ? -1 : 3 * (4 * (g / 3) + next_corner(g % 3)) + 2;
}

static int32_t inner_twin(int32_t g)
{
    return g < 0 ? -1 : 3 * (4 * (g / 3) + g % 3);
}

void pel_topology_split_triangles(const pel_topology *coarse, int32_t (*triangles)[3])
{
    for (int32_t t = 0; t < coarse->triangle_count; t++) {
        const int32_t *corner = coarse->triangles[t], *edge = &coarse->edge_of_half_edge[3 * t];
        int32_t middle[3];
        for (int i = 0; i < 3; i++)
            middle[i] = coarse->vertex_count + edge[i];
        for (int32_t i = 0, before = 2; i < 3; before = i++) {
            int32_t *child = triangles[4 * t + i];
            child[0] = corner[i];
            child[1] = middle[i];
            child[2] = middle[before];
            triangles[4 * t + 3][i] = middle[i];
        }
    }
}

static void split_twins(const int32_t *coarse_twin, int32_t triangle_count, int32_t *twin)
{
    for (int32_t t = 0; t < triangle_count; t++) {
        int32_t *child = twin + 12 * (size_t)t;
        for (int32_t i = 0; i < 3; i++) {
            int32_t g = coarse_twin[3 * t + i], after = next_corner(i);
            child[3 * i] = outer_twin(g);
            child[3 * after + 2] = inner_twin(g);
            child[3 * after + 1] = 3 * (4 * t + 3) + i;
            child[9 + i] = 3 * (4 * t + after) + 1;
        }
    }
}

/* edges in the order of the lower of their half-edges */
static void number_edges(pel_topology *topology)
{
    int32_t e = 0;
    for (int32_t h = 0; h < 3 * topology->triangle_count; h++) {
        int32_t g = topology->twin[h];
        if (g >= 0 && g < h) {
            topology->edge_of_half_edge[h] = topology->edge_of_half_edge[g];
            continue;
        }
        topology->half_edge_of_edge[e] = h;
        topology->edge_of_half_edge[h] = e++;
    }
}

/* a new vertex is left by three half-edges on each side: towards m_(i-1), m_(i+1) and v_(i+1) */
static int32_t corner_of_edge_vertex(const pel_topology *coarse, int32_t e)
{
    PEL_ASSERT_INDEX(e, coarse->edge_count);
    int32_t h = coarse->half_edge_of_edge[e], t = h / 3, i = h % 3;
    if (coarse->twin[h] < 0)
        return 3 * (4 * t + next_corner(i)) + 2;
    return i == 2 ? 3 * (4 * t) + 2 : 3 * (4 * t + i) + 1;
}

static void split_corners(const pel_topology *coarse, int32_t *corner)
{
    for (int32_t v = 0; v < coarse->vertex_count; v++)
        corner[v] = inner_twin(coarse->corner_of_vertex[v]);
    for (int32_t e = 0; e < coarse->edge_count; e++)
        corner[coarse->vertex_count + e] = corner_of_edge_vertex(coarse, e);
}

static pel_topology *allocate_level(const pel_topology *coarse)
{
    pel_topology *fine = pel_allocate(1, sizeof *fine);
    if (fine == NULL)
        return NULL;
    pel_level_size size = pel_level_size_split(pel_level_size_of(coarse));
    fine->vertex_count = (int32_t)size.vertex_count;
    fine->triangle_count = (int32_t)size.triangle_count;
    fine->edge_count = (int32_t)size.edge_count;
    fine->boundary_edge_count = 2 * coarse->boundary_edge_count;
    size_t half_edge_count = 3 * (size_t)size.triangle_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(fine->triangles, size.triangle_count), PEL_ROOM(fine->twin, half_edge_count),
                          PEL_ROOM(fine->edge_of_half_edge, half_edge_count),
                          PEL_ROOM(fine->half_edge_of_edge, size.edge_count),
                          PEL_ROOM(fine->corner_of_vertex, size.vertex_count))) {
        pel_topology_destroy(fine);
        return NULL;
    }
    return fine;
}

pel_status pel_topology_split(const pel_topology *coarse, pel_topology **fine, pel_error *error)
{
    *fine = NULL;
    if (!pel_level_size_fits(pel_level_size_split(pel_level_size_of(coarse))))
        return pel_fail(error, PEL_BAD_ARGUMENT, "splitting %d triangles gives more than %d",
                        (int)coarse->triangle_count, INT32_MAX / 3);
    pel_topology *made = allocate_level(coarse);
    if (made == NULL)
        return pel_fail_memory(error);
    pel_topology_split_triangles(coarse, made->triangles);
    split_twins(coarse->twin, coarse->triangle_count, made->twin);
    number_edges(made);
    split_corners(coarse, made->corner_of_vertex);
    PEL_ASSERT_WHOLE(pel_topology_is_valid(made));
    *fine = made;
    return PEL_OK;
}
