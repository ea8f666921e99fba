/* Collects vertices and polygons of any size while a file is read, then cuts the polygons into triangles. A triangle
   mesh passes through without a copy. */
#ifndef PEL_IO_POLYGON_SOUP_H
#define PEL_IO_POLYGON_SOUP_H

#include "io/text_cursor.h"
#include "pellicle/mesh.h"

typedef struct pel_polygon_soup {
    double (*positions)[3];
    size_t vertex_count, vertex_capacity;
    int32_t *corners; /* of all polygons, one after the other */
    size_t corner_count, corner_capacity;
    int32_t *sizes; /* corners of each polygon */
    size_t polygon_count, polygon_capacity;
    size_t ignored_count;      /* polygons with fewer than three corners */
    size_t dropped_count;      /* loose triangles with two corners at the same place */
    int32_t index_base;        /* number of the first vertex in the file: 0 or 1 */
    int64_t largest_corner;    /* largest vertex index read, from 0; -1 = none */
    const char *largest_place; /* where in the file it stands */
} pel_polygon_soup;

void pel_polygon_soup_init(pel_polygon_soup *builder, int32_t index_base);
/* frees memory that no mesh has taken over */
void pel_polygon_soup_free(pel_polygon_soup *builder);

/* Each returns false when out of memory. */
bool pel_polygon_soup_reserve_vertices(pel_polygon_soup *builder, size_t count);
bool pel_polygon_soup_add_vertex(pel_polygon_soup *builder, const double position[3]);
/* Adds a corner (vertex >= 0) to the polygon that pel_polygon_soup_end_polygon ends. An index beyond the last vertex is
   found at the end, because a file may hold faces before vertices. */
bool pel_polygon_soup_add_corner(pel_polygon_soup *builder, int32_t vertex, const char *place);
bool pel_polygon_soup_end_polygon(pel_polygon_soup *builder, size_t corner_count);
/* a whole polygon of three corners */
bool pel_polygon_soup_add_triangle(pel_polygon_soup *builder, const int32_t vertices[3], const char *place);

/* Formats without shared vertices: each corner gets its own vertex, welded at the end; a triangle with two corners at
   the same place is dropped, with its vertices. */
bool pel_polygon_soup_add_loose_corner(pel_polygon_soup *builder, const double position[3], const char *place);
bool pel_polygon_soup_end_loose_polygon(pel_polygon_soup *builder, size_t corner_count);

/* Joins vertices at exactly equal positions in the order of their first appearance, with a note. All corners must be in
   range. PEL_OUT_OF_MEMORY, also beyond INT32_MAX vertices. */
pel_status pel_polygon_soup_weld(pel_polygon_soup *builder, const pel_log *log, pel_error *error);

/* Cuts polygons into triangles (noted), makes the mesh and empties the builder. Errors, with the place in the scan:
   PEL_BAD_FORMAT for no vertices, no polygons, too many of them, an index beyond the last vertex. */
pel_status pel_polygon_soup_finish(pel_polygon_soup *builder, const pel_text_cursor *scan, const pel_log *log,
                                   pel_mesh **mesh, pel_error *error);

#endif
