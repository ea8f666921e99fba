/* Readers of files with tetrahedra: each fills a soup of points and tetrahedra, from which read.c makes a mesh. */
#ifndef PEL_TETRA_READ_H
#define PEL_TETRA_READ_H

#include "io/text_cursor.h"

typedef struct pel_tetra_soup {
    double (*points)[3];
    int32_t (*tetrahedra)[4]; /* numbers of points, from 0 */
    const char **places;      /* of the tetrahedra in the file; null = unknown */
    size_t point_count, point_limit, tetrahedron_count, tetrahedron_limit, place_limit;
    size_t quadratic_count; /* tetrahedra of ten nodes, of which four are used */
} pel_tetra_soup;

/* PEL_OUT_OF_MEMORY */
pel_status pel_tetra_soup_add_point(pel_tetra_soup *soup, const double x[3], pel_error *error);
/* corners: numbers of points, which are checked once all of them are known */
pel_status pel_tetra_soup_add(pel_tetra_soup *soup, const int64_t corners[4], const char *place, pel_error *error);

/* Each reads a whole file; PEL_BAD_FORMAT with the place. */
pel_status pel_msh_read(pel_text_cursor *scan, pel_tetra_soup *soup, pel_error *error);
pel_status pel_vtk_read(pel_text_cursor *scan, pel_tetra_soup *soup, pel_error *error);

/* a number of items that the rest of the file can hold, when each takes `smallest` bytes or more */
pel_status pel_tetra_read_count(pel_text_cursor *scan, const char *what, int64_t smallest, int64_t *count,
                                pel_error *error);
/* an integer, with PEL_BAD_FORMAT for anything else */
pel_status pel_tetra_read_integer(pel_text_cursor *scan, const char *what, int64_t *value, pel_error *error);
pel_status pel_tetra_read_point(pel_text_cursor *scan, double x[3], pel_error *error);
/* what a cell that is no tetrahedron says */
pel_status pel_tetra_refuse_cell(const pel_text_cursor *scan, const char *at, const char *shape, pel_error *error);

#endif
