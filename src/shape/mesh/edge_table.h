/* Half-edges grouped by undirected edge, for any triangles: the common ground of topology, check and repair.
   Half-edge h = 3 t + i as in pellicle/topology.h. Linear time: one counting sort by the lower vertex. */
#ifndef PEL_MESH_EDGE_TABLE_H
#define PEL_MESH_EDGE_TABLE_H

#include "pellicle/base.h"

typedef struct pel_edge_table {
    int32_t edge_count;
    int32_t *edge_of_half_edge; /* (3 triangle_count), -1 for skipped triangles */
    int32_t *half_edge_of_edge; /* (edge_count) the lowest half-edge of each edge; edges are numbered by it */
    int32_t *next_in_edge;      /* (3 triangle_count) the next higher half-edge on the same edge, -1 after the last */
} pel_edge_table;

/* triangles (triangle_count x 3) with indices in 0 .. vertex_count - 1, except skipped triangles; skip (triangle_count)
   nullable, non-zero = skip this triangle; 3 triangle_count fits int32_t. Returns PEL_OK or PEL_OUT_OF_MEMORY, with the
   table empty then. Free with pel_edge_table_clear. */
pel_status pel_edge_table_build(const int32_t (*triangles)[3], int32_t triangle_count, int32_t vertex_count,
                                const uint8_t *skip, pel_edge_table *table);
void pel_edge_table_clear(pel_edge_table *table);

/* number of triangles on an edge */
static inline int32_t pel_edge_table_valence(const pel_edge_table *table, int32_t e)
{
    int32_t count = 0;
    for (int32_t h = table->half_edge_of_edge[e]; h >= 0; h = table->next_in_edge[h])
        count++;
    return count;
}

#endif
