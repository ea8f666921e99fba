/* Patches: triangles connected across edges with exactly two triangles, and the winding that makes each consistent. */
#ifndef PEL_MESH_PATCH_H
#define PEL_MESH_PATCH_H

#include "mesh/edge_table.h"

typedef struct pel_patches {
    int32_t patch_count;
    int32_t *patch_of_triangle; /* (triangle_count) numbered by first triangle; -1 = skipped by the edge table */
    uint8_t *flipped;           /* (triangle_count) 1 = wound against the first triangle of its patch */
    uint8_t *non_orientable;    /* (patch_count) 1 = no winding is consistent */
} pel_patches;

/* Breadth first from the lowest triangle. PEL_OK or PEL_OUT_OF_MEMORY (empty then). Free with pel_patches_clear. */
pel_status pel_patches_build(const int32_t (*triangles)[3], int32_t triangle_count, const pel_edge_table *edges,
                             pel_patches *patches);
void pel_patches_clear(pel_patches *patches);

#endif
