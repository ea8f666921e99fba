#include "model/vertex_order.h"

#include "base/memory.h"
#include "base/room.h"
#include "base/status.h"

/* vertices of one window are re-sorted by valence; small enough to stay in the first-level cache */
enum { WINDOW = 64 };

typedef struct adjacency {
    int32_t *begin;     /* (vertex_count + 1) */
    int32_t *neighbour; /* (2 edge_count, and 12 for each tetrahedron) */
} adjacency;

static void add_neighbour(adjacency *adjacent, int32_t from, int32_t to)
{
    adjacent->neighbour[adjacent->begin[from + 1]++] = to;
}

/* counts the edges of the surface at each vertex, then those of tetrahedra */
static void count_edges(const pel_topology *topology, const pel_mesh *filled, int32_t *begin, int32_t *valence)
{
    for (int32_t e = 0; e < topology->edge_count; e++) {
        int32_t h = topology->half_edge_of_edge[e];
        begin[pel_half_edge_origin(topology, h) + 2]++;
        begin[pel_half_edge_target(topology, h) + 2]++;
    }
    for (int32_t v = 0; v < topology->vertex_count; v++)
        valence[v] = begin[v + 2];
    for (int32_t t = 0; filled != NULL && t < filled->tetrahedron_count; t++)
        for (int k = 0; k < 4; k++)
            begin[filled->tetrahedra[t][k] + 2] += 3;
}

static pel_status build_adjacency(const pel_topology *topology, const pel_mesh *filled, adjacency *adjacent,
                                  int32_t *valence, pel_error *error)
{
    int32_t vertex_count = topology->vertex_count, tetrahedra = filled != NULL ? filled->tetrahedron_count : 0;
    if (!PEL_ALLOCATE_ALL(PEL_ROOM(adjacent->begin, (size_t)vertex_count + 2),
                          PEL_ROOM(adjacent->neighbour, 2 * (size_t)topology->edge_count + 12 * (size_t)tetrahedra)))
        return pel_fail_memory(error);
    int32_t *begin = adjacent->begin;
    count_edges(topology, filled, begin, valence);
    for (int32_t v = 0; v <= vertex_count; v++)
        begin[v + 1] += begin[v];
    /* begin[v + 1] is the fill position of v now and its end afterwards */
    for (int32_t e = 0; e < topology->edge_count; e++) {
        int32_t h = topology->half_edge_of_edge[e];
        int32_t a = pel_half_edge_origin(topology, h), b = pel_half_edge_target(topology, h);
        add_neighbour(adjacent, a, b);
        add_neighbour(adjacent, b, a);
    }
    for (int32_t t = 0; t < tetrahedra; t++)
        for (int k = 0; k < 12; k++)
            add_neighbour(adjacent, filled->tetrahedra[t][k / 3], filled->tetrahedra[t][(k / 3 + k % 3 + 1) % 4]);
    return PEL_OK;
}

/* appends everything connected to start to order[count..], marking it with `mark`; returns the new count */
static int32_t breadth_first(const adjacency *adjacent, int32_t start, int32_t *order, int32_t count, uint8_t *marks,
                             uint8_t mark)
{
    int32_t head = count;
    order[count++] = start;
    marks[start] = mark;
    while (head < count) {
        int32_t v = order[head++];
        for (int32_t i = adjacent->begin[v]; i < adjacent->begin[v + 1]; i++) {
            int32_t other = adjacent->neighbour[i];
            if (marks[other] < mark) {
                marks[other] = mark;
                order[count++] = other;
            }
        }
    }
    return count;
}

/* stable insertion sort by falling valence */
static void sort_window(int32_t *order, int32_t count, const int32_t *valence)
{
    for (int32_t i = 1; i < count; i++) {
        int32_t v = order[i], j = i;
        for (; j > 0 && valence[order[j - 1]] < valence[v]; j--)
            order[j] = order[j - 1];
        order[j] = v;
    }
}

pel_status pel_vertex_order_vertices(const pel_topology *topology, const pel_mesh *filled, int32_t *order,
                                     int32_t *valence, pel_error *error)
{
    int32_t vertex_count = topology->vertex_count;
    adjacency adjacent = {0};
    uint8_t *marks = pel_allocate((size_t)vertex_count, 1);
    pel_status status =
        marks == NULL ? pel_fail_memory(error) : build_adjacency(topology, filled, &adjacent, valence, error);
    if (status == PEL_OK) {
        int32_t count = 0;
        for (int32_t v = 0; v < vertex_count; v++) {
            if (marks[v] != 0)
                continue;
            /* the last vertex reached from anywhere lies at an end of the component: start there */
            int32_t end = breadth_first(&adjacent, v, order, count, marks, 1);
            count = breadth_first(&adjacent, order[end - 1], order, count, marks, 2);
        }
        for (int32_t first = 0; first < vertex_count; first += WINDOW)
            sort_window(order + first, vertex_count - first < WINDOW ? vertex_count - first : WINDOW, valence);
    }
    PEL_FREE_ALL(adjacent.begin, adjacent.neighbour, marks);
    return status;
}
