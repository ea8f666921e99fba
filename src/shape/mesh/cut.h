/* Cutting a surface apart where it is no manifold, without moving anything: pieces get vertices of their own. */
#ifndef PEL_MESH_CUT_H
#define PEL_MESH_CUT_H

#include "pellicle/base.h"

typedef struct pel_cut {
    int32_t *corners;   /* (3 triangle_count) the new vertex of each corner; corners of skipped triangles keep theirs */
    int32_t *source_of; /* (copy_count) the vertex that vertex vertex_count + i is a copy of */
    int32_t copy_count;
    int32_t edge_count; /* edges that are in more than two triangles still */
} pel_cut;

/* Finds the cuts of triangles (triangle_count x 3) with indices in 0 .. vertex_count - 1; skip as in the edge table.
   Every fan around a vertex gets its own vertex. PEL_OK or PEL_OUT_OF_MEMORY (empty then). Free with pel_cut_clear. */
pel_status pel_cut_find(const double (*positions)[3], int32_t vertex_count, const int32_t (*triangles)[3],
                        int32_t triangle_count, const uint8_t *skip, pel_cut *cut);
void pel_cut_clear(pel_cut *cut);

#endif
