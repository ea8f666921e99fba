#include "mesh/opening.h"

#include "base/assert.h"
#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"

#include <string.h>

int32_t pel_topology_edge_between(const pel_topology *topology, int32_t a, int32_t b)
{
    PEL_ASSERT_INDEX(a, topology->vertex_count);
    PEL_ASSERT_INDEX(b, topology->vertex_count);
    int32_t first = topology->corner_of_vertex[a], h = first;
    do {
        int32_t back = pel_half_edge_previous(h);
        if (pel_half_edge_target(topology, h) == b)
            return topology->edge_of_half_edge[h];
        if (pel_half_edge_origin(topology, back) == b)
            return topology->edge_of_half_edge[back];
        h = pel_half_edge_turn(topology, h);
    } while (h >= 0 && h != first);
    return -1;
}

/* scratch: the outgoing half-edges around a vertex, and the first of each sector */
typedef struct fan {
    int32_t *half_edges, *sectors;
    int32_t count, sector_count;
} fan;

static bool is_open(const pel_topology *topology, const uint8_t *marks, int32_t h)
{
    return topology->twin[h] < 0 || marks[topology->edge_of_half_edge[h]] != 0;
}

/* in the order of the turn, from the first one behind an open edge if there is any */
static void find_fan(const pel_topology *topology, const uint8_t *marks, int32_t v, fan *around)
{
    int32_t first = topology->corner_of_vertex[v], h = first;
    around->count = around->sector_count = 0;
    while (!is_open(topology, marks, h)) {
        h = pel_half_edge_turn(topology, h);
        if (h == first)
            break;
    }
    first = h;
    do {
        if (around->count == 0 || is_open(topology, marks, h))
            around->sectors[around->sector_count++] = around->count;
        around->half_edges[around->count++] = h;
        h = pel_half_edge_turn(topology, h);
    } while (h >= 0 && h != first);
    around->sectors[around->sector_count] = around->count;
}

/* the sector with the lowest triangle */
static int32_t lowest_sector(const fan *around)
{
    int32_t lowest = 0, best = 0;
    for (int32_t s = 0; s < around->sector_count; s++)
        for (int32_t i = around->sectors[s]; i < around->sectors[s + 1]; i++)
            if (around->half_edges[i] < around->half_edges[lowest]) {
                lowest = i;
                best = s;
            }
    return best;
}

static void split_vertex(pel_opening *opening, const fan *around, int32_t v)
{
    int32_t kept = lowest_sector(around);
    for (int32_t s = 0; s < around->sector_count; s++) {
        if (s == kept)
            continue;
        for (int32_t i = around->sectors[s]; i < around->sectors[s + 1]; i++)
            opening->triangles[around->half_edges[i] / 3][around->half_edges[i] % 3] = opening->vertex_count;
        opening->parents[opening->vertex_count++] = v;
    }
}

/* each sector of a vertex that is split begins at a marked edge or at the boundary */
static int32_t most_vertices(const pel_topology *topology, const uint8_t *marks)
{
    int32_t count = topology->vertex_count;
    for (int32_t e = 0; e < topology->edge_count; e++)
        count += marks[e] != 0 ? 2 : 0;
    return count;
}

static int32_t count_opened(const pel_topology *topology, const uint8_t *marks, const pel_opening *opening)
{
    int32_t count = 0;
    for (int32_t e = 0; e < topology->edge_count; e++) {
        int32_t h = topology->half_edge_of_edge[e], g = topology->twin[h];
        if (marks[e] == 0 || g < 0)
            continue;
        int32_t next = pel_half_edge_next(h), back = pel_half_edge_next(g);
        count += opening->triangles[h / 3][h % 3] != opening->triangles[back / 3][back % 3] ||
                 opening->triangles[next / 3][next % 3] != opening->triangles[g / 3][g % 3];
    }
    return count;
}

pel_status pel_opening_find(const pel_topology *topology, const uint8_t *marks, pel_opening *opening, pel_error *error)
{
    int32_t corner_count = 3 * topology->triangle_count;
    fan around = {0};
    *opening = (pel_opening){.vertex_count = topology->vertex_count};
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(opening->triangles, topology->triangle_count),
                          PEL_ROOM(opening->parents, most_vertices(topology, marks)),
                          PEL_ROOM(around.half_edges, corner_count), PEL_ROOM(around.sectors, corner_count + 1)))
        return pel_fail_memory(error);
    memcpy(opening->triangles, topology->triangles, (size_t)topology->triangle_count * sizeof *opening->triangles);
    for (int32_t v = 0; v < topology->vertex_count; v++) {
        opening->parents[v] = v;
        if (topology->corner_of_vertex[v] < 0)
            continue;
        find_fan(topology, marks, v, &around);
        if (around.sector_count > 1)
            split_vertex(opening, &around, v);
    }
    opening->edge_count = count_opened(topology, marks, opening);
    PEL_FREE_ALL(around.half_edges, around.sectors);
    return PEL_OK;
}

void pel_opening_clear(pel_opening *opening)
{
    PEL_FREE_ALL(opening->triangles, opening->parents);
    *opening = (pel_opening){0};
}
