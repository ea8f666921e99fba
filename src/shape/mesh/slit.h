/* Triangles without area whose third corner lies on their longest edge: dropped, they would leave a slit between the
   triangle beyond that edge and those at the corner. */
#ifndef PEL_MESH_SLIT_H
#define PEL_MESH_SLIT_H

#include "pellicle/base.h"

/* Swaps the longest edge of each such triangle for the one from its third corner to the far corner of the triangle
   beyond: the surface does not move and the flat triangle disappears. Nothing changes if that would make another flat
   triangle, or if the edge is on the boundary or has more than two triangles. triangles (triangle_count x 3) are wound
   consistently, with indices in 0 .. vertex_count - 1 and no vertex twice, except skipped triangles. Adds to
   flip_count, and sets changed (triangle_count) of both triangles. PEL_OK or PEL_OUT_OF_MEMORY. */
pel_status pel_slits_close(const double (*positions)[3], int32_t vertex_count, int32_t (*triangles)[3],
                           int32_t triangle_count, const uint8_t *skip, uint8_t *changed, int32_t *flip_count);

#endif
