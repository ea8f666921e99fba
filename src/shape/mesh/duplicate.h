/* Triangles with the same three vertices. */
#ifndef PEL_MESH_DUPLICATE_H
#define PEL_MESH_DUPLICATE_H

#include "pellicle/base.h"

/* first_like (triangle_count) receives the lowest triangle with the same vertices in any order: the triangle itself if
   none precedes it, -1 for skipped ones (skip non-zero; nullable). PEL_OK or PEL_OUT_OF_MEMORY. */
pel_status pel_find_duplicate_triangles(const int32_t (*triangles)[3], int32_t triangle_count, const uint8_t *skip,
                                        int32_t *first_like);

#endif
