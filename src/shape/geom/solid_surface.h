/* The surface of a solid as triangles, wound outward: what results and pictures show. */
#ifndef PEL_GEOM_SOLID_SURFACE_H
#define PEL_GEOM_SOLID_SURFACE_H

#include "geom/solid.h"

typedef struct pel_solid_surface {
    int32_t vertex_count, triangle_count;
} pel_solid_surface;

pel_solid_surface pel_solid_surface_size(const pel_solid *solid);
/* vertices (vertex_count x 3) [m] in the frame of the solid, triangles (triangle_count x 3) */
void pel_solid_surface_fill(const pel_solid *solid, double (*vertices)[3], int32_t (*triangles)[3]);

#endif
