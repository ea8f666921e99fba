/* Pellicle: results as VTK PolyData (.vtp) with a .pvd series, for ParaView and for other tools. Every file is written
   under a temporary name and then renamed, so the folder never contains a partial file. */
#ifndef PELLICLE_RESULTS_H
#define PELLICLE_RESULTS_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A quantity on the vertices or triangles. */
typedef struct pel_vtp_field {
    const char *name;        /* not empty, shorter than PEL_NAME_SIZE */
    int32_t component_count; /* >= 1 */
    const double *values;    /* (vertex_count or triangle_count x component_count) */
} pel_vtp_field;

/* One surface at one time. */
typedef struct pel_vtp {
    int32_t vertex_count, triangle_count; /* >= 1 */
    const double *positions;              /* (vertex_count x 3), metres */
    const int32_t *triangles;             /* (triangle_count x 3), each 0 .. vertex_count - 1 */
    const pel_vtp_field *fields;          /* (field_count) point data */
    int32_t field_count;
    const pel_vtp_field *cell_fields; /* (cell_field_count) data on triangles; readers of Pellicle skip them */
    int32_t cell_field_count;
    double time;   /* s, stored as TimeValue */
    bool compress; /* compress the appended data with zlib; otherwise they are raw */
    bool float64;  /* positions and fields as Float64 instead of Float32 */
} pel_vtp;

/* Writes a .vtp file (VTK XML PolyData, appended data; Kitware, "VTK XML file formats").
   Errors: PEL_BAD_ARGUMENT (counts, field names), PEL_BAD_FILE (folder missing, disk full), PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_vtp_write(const char *path, const pel_vtp *vtp, pel_error *error);

/* Writes the files of a series. It keeps its memory between files, and encodes and compresses unchanged triangles only
   once. The files equal those of pel_vtp_write. One thread at a time may use a writer. */
typedef struct pel_vtp_writer pel_vtp_writer;

/* PEL_OUT_OF_MEMORY. Free with pel_vtp_writer_destroy, which permits null. */
PEL_API pel_status pel_vtp_writer_create(pel_vtp_writer **writer, pel_error *error);
PEL_API void pel_vtp_writer_destroy(pel_vtp_writer *writer);
/* Errors as above. The writer can be used after an error. */
PEL_API pel_status pel_vtp_writer_write(pel_vtp_writer *writer, const char *path, const pel_vtp *vtp, pel_error *error);

/* Reads a .vtp file with one piece, as VTK and ParaView write it: arrays as text, in base64, or in the appended section
   (raw or in base64), with or without zlib, in either byte order. Polygons and strips are split into triangles;
   vertices and lines are ignored. Point data become the fields of the mesh. time (nullable) receives TimeValue, 0 if
   there is none. Memory use is bounded by a multiple of the file's size, independent of its header. On failure *mesh is
   null. Free with pel_mesh_destroy. Errors: PEL_BAD_FILE, PEL_BAD_FORMAT with the byte offset or element,
   PEL_OUT_OF_MEMORY.
 */
PEL_API pel_status pel_vtp_read(const char *path, pel_mesh **mesh, double *time, pel_error *error);

/* The same from memory; `name` is the file name in messages. */
PEL_API pel_status pel_vtp_parse(const char *name, const void *bytes, size_t size, pel_mesh **mesh, double *time,
                                 pel_error *error);

/* Writes the collection file (.pvd) that ParaView opens as a series: file_names (frame_count, relative to the .pvd
   file) and times (frame_count) [s]. Errors: PEL_BAD_FILE, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_pvd_write(const char *path, const char *const *file_names, const double *times,
                                 int32_t frame_count, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
