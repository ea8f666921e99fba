/* The reader and writer of each mesh format. A reader takes the whole file; a writer's failures show at commit. */
#ifndef PEL_IO_FORMATS_H
#define PEL_IO_FORMATS_H

#include "io/file.h"
#include "io/text_cursor.h"
#include "pellicle/mesh.h"

pel_status pel_obj_read(pel_text_cursor *scan, const pel_log *log, pel_mesh **mesh, pel_error *error);
pel_status pel_ply_read(pel_text_cursor *scan, const pel_log *log, pel_mesh **mesh, pel_error *error);
pel_status pel_stl_read(pel_text_cursor *scan, const pel_log *log, pel_mesh **mesh, pel_error *error);
pel_status pel_vtp_read_mesh(pel_text_cursor *scan, const pel_log *log, pel_mesh **mesh, pel_error *error);
pel_status pel_off_read(pel_text_cursor *scan, const pel_log *log, pel_mesh **mesh, pel_error *error);

/* A VTK XML file of an unstructured grid (vtp_read.c): cell c has the corners from ends[c - 1] on, of type types[c];
   the ends do not fall and do not exceed corner_count. Free with pel_vtk_grid_free. */
typedef struct pel_vtk_grid {
    double *points, *corners, *ends, *types;
    int64_t point_count, corner_count, cell_count;
} pel_vtk_grid;
pel_status pel_vtu_read(pel_text_cursor *scan, pel_vtk_grid *grid, pel_error *error);
void pel_vtk_grid_free(pel_vtk_grid *grid);

/* whether a file begins like this format (ASCII STL) */
bool pel_obj_matches(const pel_text_cursor *scan);
bool pel_ply_matches(const pel_text_cursor *scan);
bool pel_stl_matches(const pel_text_cursor *scan);
bool pel_off_matches(const pel_text_cursor *scan);
bool pel_vtp_matches(const pel_text_cursor *scan);
/* whether a file is as long as it must be to be binary STL, which no other file is by chance */
bool pel_stl_size_fits(const pel_text_cursor *scan);

typedef enum pel_encoding { PEL_ENCODING_ASCII, PEL_ENCODING_LITTLE, PEL_ENCODING_BIG } pel_encoding;

void pel_obj_write(pel_file_writer *writer, const pel_mesh *mesh);
void pel_off_write(pel_file_writer *writer, const pel_mesh *mesh);
pel_status pel_ply_write(pel_file_writer *writer, pel_encoding encoding, const pel_mesh *mesh, const pel_log *log,
                         pel_error *error);
/* ASCII or little endian; PEL_BAD_ARGUMENT when a coordinate does not fit the floats of binary STL */
pel_status pel_stl_write(pel_file_writer *writer, pel_encoding encoding, const pel_mesh *mesh, pel_error *error);

/* `before`, three numbers that read back to the same bits, and a line end */
void pel_write_numbers(pel_file_writer *writer, const char *before, const double values[3]);

#endif
