/* Cutting one polygon into triangles. */
#ifndef PEL_GEOM_POLYGON_H
#define PEL_GEOM_POLYGON_H

#include <stdint.h>

/* Cuts a polygon of `count` >= 3 corners (indices into positions) into count - 2 triangles that keep its winding: a fan
   from the first corner when that turns no triangle over, else ear by ear (a concave quad is cut along the diagonal
   that lies inside). Polygons of more than 64 corners are always fanned. */
void pel_polygon_cut(const double (*positions)[3], const int32_t *corners, int32_t count, int32_t (*triangles)[3]);

#endif
