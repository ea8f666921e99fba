#include "pellicle/topology.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"
#include "mesh/edge_table.h"
#include "mesh/patch.h"
#include "mesh/topology_check.h"

#include <string.h>

static const char remedy[] =
    "run `pellicle check FILE` for a list of all such places and `pellicle check FILE --fix OUT` "
    "to repair; split the places that remain in a mesh editor";

static pel_status check_triangles(const pel_mesh *mesh, pel_error *error)
{
    if (mesh->vertex_count < 1 || mesh->triangle_count < 1 || mesh->triangle_count > INT32_MAX / 3)
        return pel_fail(
            error, PEL_BAD_ARGUMENT,
            "mesh has %d vertices and %d triangles; at least one of each and at most %d triangles are needed",
            (int)mesh->vertex_count, (int)mesh->triangle_count, (int)(INT32_MAX / 3));
    for (int32_t t = 0; t < mesh->triangle_count; t++) {
        const int32_t *triangle = mesh->triangles[t];
        for (int i = 0; i < 3; i++) {
            if (triangle[i] < 0 || triangle[i] >= mesh->vertex_count)
                return pel_refuse_element(error, PEL_BAD_MESH, "triangle", t, remedy,
                                          "vertex index %d is outside 0..%d", (int)triangle[i],
                                          (int)mesh->vertex_count - 1);
        }
        if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
            return pel_refuse_element(error, PEL_BAD_MESH, "triangle", t, remedy,
                                      "triangle has a vertex twice (%d, %d, %d)", (int)triangle[0], (int)triangle[1],
                                      (int)triangle[2]);
    }
    return PEL_OK;
}

/* whether no winding makes the surface around a triangle consistent; false also when memory is out */
static bool is_one_sided(const pel_topology *topology, int32_t triangle)
{
    const int32_t(*triangles)[3] = (const int32_t(*)[3])topology->triangles;
    pel_edge_table edges;
    pel_patches patches;
    if (pel_edge_table_build(triangles, topology->triangle_count, topology->vertex_count, NULL, &edges) != PEL_OK)
        return false;
    bool built = pel_patches_build(triangles, topology->triangle_count, &edges, &patches) == PEL_OK;
    bool one_sided = built && patches.non_orientable[patches.patch_of_triangle[triangle]] != 0;
    pel_patches_clear(&patches);
    pel_edge_table_clear(&edges);
    return one_sided;
}

/* the place of the error stays */
static pel_status refuse_one_sided(pel_error *error)
{
    pel_fail_remedy(error, "the surface has one side only, like a Moebius strip: cut it open along a row of edges in a "
                           "mesh editor");
    return PEL_BAD_MESH;
}

/* turns the chain of each edge into a pair of twins, in place */
static pel_status pair_twins(pel_topology *topology, pel_error *error)
{
    topology->boundary_edge_count = 0;
    for (int32_t e = 0; e < topology->edge_count; e++) {
        int32_t h = topology->half_edge_of_edge[e], other = topology->twin[h];
        if (other < 0) {
            topology->boundary_edge_count++;
            continue;
        }
        int32_t a = pel_half_edge_origin(topology, h), b = pel_half_edge_target(topology, h);
        if (topology->twin[other] >= 0)
            return pel_refuse_element(
                error, PEL_BAD_MESH, "edge", e, remedy,
                "more than two triangles (%d, %d, %d, ...) share the edge between vertices %d and %d", (int)h / 3,
                (int)other / 3, (int)topology->twin[other] / 3, (int)a, (int)b);
        if (pel_half_edge_origin(topology, other) == a) {
            pel_refuse_element(error, PEL_BAD_MESH, "edge", e, remedy,
                               "triangles %d and %d have opposite winding at the edge between vertices %d and %d",
                               (int)h / 3, (int)other / 3, (int)a, (int)b);
            return is_one_sided(topology, h / 3) ? refuse_one_sided(error) : PEL_BAD_MESH;
        }
        topology->twin[other] = h;
    }
    return PEL_OK;
}

/* the lowest outgoing half-edge of each vertex, or the one on the boundary; corner_count: triangles around it */
static pel_status find_corners(pel_topology *topology, int32_t *corner_count, pel_error *error)
{
    memset(topology->corner_of_vertex, -1, (size_t)topology->vertex_count * sizeof(int32_t));
    memset(corner_count, 0, (size_t)topology->vertex_count * sizeof(int32_t));
    for (int32_t h = 0; h < 3 * topology->triangle_count; h++) {
        int32_t v = pel_half_edge_origin(topology, h);
        int32_t corner = topology->corner_of_vertex[v];
        corner_count[v]++;
        if (topology->twin[h] < 0 && corner >= 0 && topology->twin[corner] < 0)
            return pel_refuse_element(error, PEL_BAD_MESH, "vertex", v, remedy,
                                      "triangles %d and %d touch in this vertex only", (int)corner / 3, (int)h / 3);
        if (corner < 0 || topology->twin[h] < 0)
            topology->corner_of_vertex[v] = h;
    }
    return PEL_OK;
}

/* one turn about a vertex must visit all its triangles */
static pel_status check_fans(const pel_topology *topology, const int32_t *corner_count, pel_error *error)
{
    for (int32_t v = 0; v < topology->vertex_count; v++) {
        int32_t begin = topology->corner_of_vertex[v], h = begin, visited = 0;
        while (h >= 0) {
            visited++;
            h = pel_half_edge_turn(topology, h);
            if (h == begin)
                break;
        }
        if (visited != corner_count[v])
            return pel_refuse_element(error, PEL_BAD_MESH, "vertex", v, remedy,
                                      "the %d triangles of this vertex do not form one fan", (int)corner_count[v]);
    }
    return PEL_OK;
}

static pel_status allocate_topology(const pel_mesh *mesh, pel_topology **topology)
{
    pel_topology *made = pel_allocate(1, sizeof *made);
    if (made == NULL)
        return PEL_OUT_OF_MEMORY;
    *topology = made;
    made->vertex_count = mesh->vertex_count;
    made->triangle_count = mesh->triangle_count;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(made->triangles, mesh->triangle_count),
                          PEL_ROOM(made->corner_of_vertex, mesh->vertex_count)))
        return PEL_OUT_OF_MEMORY;
    memcpy(made->triangles, mesh->triangles, (size_t)mesh->triangle_count * sizeof *made->triangles);
    return PEL_OK;
}

/* ---- sound meshes: one pass over the half-edges ---- */

/* a half-edge that has not met its twin, in the list of its origin */
typedef struct waiting {
    int32_t h, target, next;
} waiting;

/* scratch of the pass */
typedef struct matching {
    int32_t *list_of_vertex; /* (vertex_count) -1 = empty */
    waiting *pool;           /* (3 triangle_count); few are used at a time, so that they stay in the cache */
    int32_t pool_count, unused;
} matching;

/* takes the half-edge from a to b off its list; -1 when it does not wait */
static int32_t take_waiting(matching *scratch, int32_t a, int32_t b, int64_t *steps)
{
    int32_t *link = &scratch->list_of_vertex[a];
    for (; *link >= 0; link = &scratch->pool[*link].next, (*steps)++) {
        waiting *found = &scratch->pool[*link];
        if (found->target != b)
            continue;
        int32_t at = *link;
        *link = found->next;
        found->next = scratch->unused;
        scratch->unused = at;
        return found->h;
    }
    return -1;
}

static void put_waiting(matching *scratch, int32_t a, int32_t b, int32_t h)
{
    int32_t at = scratch->unused;
    if (at >= 0)
        scratch->unused = scratch->pool[at].next;
    else
        at = scratch->pool_count++;
    scratch->pool[at] = (waiting){h, b, scratch->list_of_vertex[a]};
    scratch->list_of_vertex[a] = at;
}

/* Pairs each half-edge with the one that runs back and numbers the edges. False when that takes long: triangles in no
   order about vertices of very many. */
static bool match_half_edges(pel_topology *topology, matching *scratch)
{
    int64_t steps = 0, limit = 24 * (int64_t)topology->triangle_count + 1000;
    memset(scratch->list_of_vertex, -1, (size_t)topology->vertex_count * sizeof(int32_t));
    scratch->pool_count = topology->edge_count = 0;
    scratch->unused = -1;
    for (int32_t t = 0; t < topology->triangle_count && steps <= limit; t++)
        for (int i = 0; i < 3; i++) {
            int32_t a = topology->triangles[t][i], b = topology->triangles[t][i == 2 ? 0 : i + 1], h = 3 * t + i;
            int32_t g = take_waiting(scratch, b, a, &steps);
            topology->twin[h] = g;
            if (g >= 0) {
                topology->twin[g] = h;
                topology->edge_of_half_edge[h] = topology->edge_of_half_edge[g];
                continue;
            }
            put_waiting(scratch, a, b, h);
            topology->half_edge_of_edge[topology->edge_count] = h;
            topology->edge_of_half_edge[h] = topology->edge_count++;
        }
    topology->boundary_edge_count = 2 * topology->edge_count - 3 * topology->triangle_count;
    return steps <= limit;
}

/* One turn about each vertex visits all its triangles, and leaves for each neighbour once: of three half-edges on an
   edge, or of two that run the same way, two leave the same end. seen: (vertex_count) scratch. */
static bool is_sound(const pel_topology *topology, const int32_t *corner_count, int32_t *seen)
{
    memset(seen, -1, (size_t)topology->vertex_count * sizeof *seen);
    for (int32_t v = 0; v < topology->vertex_count; v++) {
        int32_t begin = topology->corner_of_vertex[v], h = begin, visited = 0;
        bool again = false;
        while (h >= 0) {
            int32_t w = pel_half_edge_target(topology, h);
            again |= seen[w] == v;
            seen[w] = v;
            visited++;
            h = pel_half_edge_turn(topology, h);
            if (h == begin)
                break;
        }
        if (again || visited != corner_count[v])
            return false;
    }
    return true;
}

/* builds the table of a valid mesh; otherwise sets *sound to false and leaves the arrays to the slow path */
static pel_status fill_sound(pel_topology *topology, int32_t *corner_count, bool *sound)
{
    size_t half_edge_count = 3 * (size_t)topology->triangle_count;
    matching scratch = {.unused = -1};
    bool room = PEL_ALLOCATE_ALL(PEL_ROOM(scratch.list_of_vertex, topology->vertex_count),
                                 PEL_ROOM(scratch.pool, half_edge_count), PEL_ROOM(topology->twin, half_edge_count),
                                 PEL_ROOM(topology->edge_of_half_edge, half_edge_count),
                                 PEL_ROOM(topology->half_edge_of_edge, half_edge_count));
    *sound = room && match_half_edges(topology, &scratch) && find_corners(topology, corner_count, NULL) == PEL_OK &&
             is_sound(topology, corner_count, scratch.list_of_vertex);
    if (*sound) {
        int32_t *shrunk = pel_reallocate(topology->half_edge_of_edge, (size_t)topology->edge_count, sizeof *shrunk);
        if (shrunk != NULL)
            topology->half_edge_of_edge = shrunk;
    }
    pel_free(scratch.list_of_vertex);
    pel_free(scratch.pool);
    return room ? PEL_OK : PEL_OUT_OF_MEMORY;
}

/* ---- other meshes: collect all half-edges of an edge, to name the defect ---- */

static pel_status fill_any(pel_topology *topology, int32_t *corner_count, pel_error *error)
{
    pel_edge_table edges;
    PEL_FREE_ALL(topology->twin, topology->edge_of_half_edge, topology->half_edge_of_edge);
    topology->twin = topology->edge_of_half_edge = topology->half_edge_of_edge = NULL;
    if (pel_edge_table_build((const int32_t(*)[3])topology->triangles, topology->triangle_count, topology->vertex_count,
                             NULL, &edges) != PEL_OK)
        return pel_fail_memory(error);
    topology->edge_count = edges.edge_count;
    topology->edge_of_half_edge = edges.edge_of_half_edge;
    topology->half_edge_of_edge = edges.half_edge_of_edge;
    topology->twin = edges.next_in_edge;
    pel_status status = pair_twins(topology, error);
    if (status == PEL_OK)
        status = find_corners(topology, corner_count, error);
    if (status == PEL_OK)
        status = check_fans(topology, corner_count, error);
    return status;
}

static pel_status fill_topology(pel_topology *topology, pel_error *error)
{
    bool sound;
    int32_t *corner_count = pel_allocate((size_t)topology->vertex_count, sizeof *corner_count);
    if (corner_count == NULL)
        return pel_fail_memory(error);
    pel_status status = fill_sound(topology, corner_count, &sound);
    if (status != PEL_OK)
        pel_fail_memory(error);
    else if (!sound)
        status = fill_any(topology, corner_count, error);
    pel_free(corner_count);
    return status;
}

pel_status pel_topology_create(const pel_mesh *mesh, pel_topology **topology, pel_error *error)
{
    PEL_REFUSE_NULL(mesh, error);
    PEL_REFUSE_NULL(topology, error);
    *topology = NULL;
    pel_status status = check_triangles(mesh, error);
    if (status != PEL_OK)
        return status;
    pel_topology *made = NULL;
    if (allocate_topology(mesh, &made) != PEL_OK)
        status = pel_fail_memory(error);
    else
        status = fill_topology(made, error);
    if (status != PEL_OK) {
        pel_topology_destroy(made);
        return status;
    }
    PEL_ASSERT_WHOLE(pel_topology_is_valid(made));
    *topology = made;
    return PEL_OK;
}

void pel_topology_destroy(pel_topology *topology)
{
    if (topology == NULL)
        return;
    PEL_FREE_ALL(topology->triangles, topology->twin, topology->corner_of_vertex, topology->edge_of_half_edge,
                 topology->half_edge_of_edge, topology);
}
