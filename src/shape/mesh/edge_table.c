#include "mesh/edge_table.h"

#include "base/memory.h"
#include "base/room.h"

#include <string.h>

/* a half-edge by its ends, in the bucket of the lower one */
typedef struct bucket_entry {
    int32_t high, h;
} bucket_entry;

/* how often each vertex is the lower end of a half-edge, two places up: so filling moves each bucket's beginning into
   place */
static void count_low_vertices(const int32_t (*triangles)[3], int32_t triangle_count, const uint8_t *skip,
                               int32_t *offset)
{
    for (int32_t t = 0; t < triangle_count; t++) {
        if (skip != NULL && skip[t])
            continue;
        int32_t a = triangles[t][0], b = triangles[t][1], c = triangles[t][2];
        offset[(a < b ? a : b) + 2]++;
        offset[(b < c ? b : c) + 2]++;
        offset[(c < a ? c : a) + 2]++;
    }
}

static inline void put_entry(int32_t from, int32_t to, int32_t h, int32_t *offset, bucket_entry *sorted)
{
    int32_t low = from < to ? from : to;
    sorted[offset[low + 1]++] = (bucket_entry){from < to ? to : from, h};
}

/* half-edges in ascending order within each lower vertex v: sorted[offset[v]] .. sorted[offset[v + 1] - 1] */
static void sort_by_low_vertex(const int32_t (*triangles)[3], int32_t triangle_count, int32_t vertex_count,
                               const uint8_t *skip, int32_t *offset, bucket_entry *sorted)
{
    count_low_vertices(triangles, triangle_count, skip, offset);
    for (int32_t v = 0; v < vertex_count; v++)
        offset[v + 2] += offset[v + 1];
    for (int32_t t = 0; t < triangle_count; t++) {
        if (skip != NULL && skip[t])
            continue;
        const int32_t *v = triangles[t];
        put_entry(v[0], v[1], 3 * t, offset, sorted);
        put_entry(v[1], v[2], 3 * t + 1, offset, sorted);
        put_entry(v[2], v[0], 3 * t + 2, offset, sorted);
    }
}

/* chains half-edges with the same ends; edge_of_half_edge becomes the lowest half-edge of the chain */
static void link_chains(int32_t vertex_count, const int32_t *offset, const bucket_entry *sorted, int32_t *place_of_high,
                        pel_edge_table *table)
{
    for (int32_t v = 0; v < vertex_count; v++)
        place_of_high[v] = -1;
    for (int32_t v = 0; v < vertex_count; v++) {
        int32_t begin = offset[v];
        for (int32_t k = begin; k < offset[v + 1]; k++) {
            int32_t h = sorted[k].h, place = place_of_high[sorted[k].high], first = h;
            if (place >= begin) {
                int32_t before = sorted[place].h;
                table->next_in_edge[before] = h;
                first = table->edge_of_half_edge[before];
            }
            table->edge_of_half_edge[h] = first;
            table->next_in_edge[h] = -1;
            place_of_high[sorted[k].high] = k;
        }
    }
}

static void number_edges(int32_t half_edge_count, pel_edge_table *table)
{
    for (int32_t h = 0; h < half_edge_count; h++) {
        int32_t first = table->edge_of_half_edge[h];
        if (first == h) {
            table->edge_of_half_edge[h] = table->edge_count;
            table->half_edge_of_edge[table->edge_count++] = h;
        } else if (first >= 0) {
            table->edge_of_half_edge[h] = table->edge_of_half_edge[first];
        }
    }
}

pel_status pel_edge_table_build(const int32_t (*triangles)[3], int32_t triangle_count, int32_t vertex_count,
                                const uint8_t *skip, pel_edge_table *table)
{
    size_t half_edge_count = 3 * (size_t)triangle_count;
    memset(table, 0, sizeof *table);
    int32_t *offset, *place_of_high;
    bucket_entry *sorted;
    bool made = PEL_ALLOCATE_ALL(
        PEL_ROOM(table->edge_of_half_edge, half_edge_count), PEL_ROOM(table->half_edge_of_edge, half_edge_count),
        PEL_ROOM(table->next_in_edge, half_edge_count), PEL_ROOM(offset, (size_t)vertex_count + 2),
        PEL_ROOM(sorted, half_edge_count), PEL_ROOM(place_of_high, vertex_count));
    if (made) {
        if (skip != NULL) {
            memset(table->edge_of_half_edge, -1, half_edge_count * sizeof(int32_t));
            memset(table->next_in_edge, -1, half_edge_count * sizeof(int32_t));
        }
        sort_by_low_vertex(triangles, triangle_count, vertex_count, skip, offset, sorted);
        link_chains(vertex_count, offset, sorted, place_of_high, table);
        number_edges((int32_t)half_edge_count, table);
        int32_t *shrunk = pel_reallocate(table->half_edge_of_edge, (size_t)table->edge_count, sizeof *shrunk);
        if (shrunk != NULL)
            table->half_edge_of_edge = shrunk;
    }
    PEL_FREE_ALL(place_of_high, sorted, offset);
    if (!made) {
        pel_edge_table_clear(table);
        return PEL_OUT_OF_MEMORY;
    }
    return PEL_OK;
}

void pel_edge_table_clear(pel_edge_table *table)
{
    PEL_FREE_ALL(table->edge_of_half_edge, table->half_edge_of_edge, table->next_in_edge);
    memset(table, 0, sizeof *table);
}
