/* Pellicle: reading and writing mesh files: OBJ, PLY (ASCII, binary little and big endian), STL (ASCII, binary), OFF,
   VTK PolyData (.vtp). Vertex order and connectivity are kept. Faces with more than three corners are split into
   triangles with the same winding. Numbers are read exactly, in any locale; NaN, infinity and indices that do not exist
   are refused.
   - OBJ: v and f with all kinds of indices. Colours of all vertices become the fields red, green and blue; names of
     objects, groups and materials become fields group:NAME, 1 at the vertices of their faces. Weights, normals, texture
     coordinates, points and lines are ignored.
   - PLY: scalar vertex properties other than x, y, z become fields; properties named n_0, n_1, ... become one vector
     field n. Strips of triangles (tristrips) become triangles; -1 begins a new strip. List properties of vertices, and
     other elements, are ignored.
   - STL: corners at exactly equal positions are welded in the order of their first appearance; triangles with two equal
     corners are removed.
   - VTP: see pel_vtp_read; point data become fields.
   - OFF: also COFF, NOFF, ..., whose colours and normals are ignored; not the binary variant. */
#ifndef PELLICLE_MESH_IO_H
#define PELLICLE_MESH_IO_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum pel_mesh_format {
    PEL_FORMAT_AUTO, /* by content and extension */
    PEL_FORMAT_OBJ,
    PEL_FORMAT_PLY,       /* reading: any; writing: binary little endian */
    PEL_FORMAT_PLY_ASCII, /* writing */
    PEL_FORMAT_PLY_BIG,   /* writing: binary big endian */
    PEL_FORMAT_STL,       /* reading: any; writing: binary */
    PEL_FORMAT_STL_ASCII, /* writing */
    PEL_FORMAT_OFF,
    PEL_FORMAT_VTP, /* reading: any encoding; writing: zlib, doubles */
    PEL_FORMAT_COUNT
} pel_mesh_format;

/* The format of a path's extension; PEL_FORMAT_AUTO for another extension. */
PEL_API pel_mesh_format pel_mesh_format_of_path(const char *path);

/* Reads a mesh file. log (nullable) receives notes: polygons triangulated, vertices welded, data ignored. Errors:
   PEL_BAD_FILE (missing, unreadable), PEL_BAD_FORMAT with line or byte offset, PEL_OUT_OF_MEMORY. Memory use is bounded
   by a small multiple of the file's size, independent of its header. Free with pel_mesh_destroy. */
PEL_API pel_status pel_mesh_read(const char *path, pel_mesh_format format, const pel_log *log, pel_mesh **mesh,
                                 pel_error *error);

/* The same from memory. `name` is the file name in messages; its extension is used if format is PEL_FORMAT_AUTO. */
PEL_API pel_status pel_mesh_parse(const char *name, const void *bytes, size_t size, pel_mesh_format format,
                                  const pel_log *log, pel_mesh **mesh, pel_error *error);

/* Writes a mesh. A round trip keeps coordinates bit for bit in all formats except binary STL, which stores floats. VTP
   files contain all fields. PLY files contain fields as vertex properties of type double, `name` or, for vectors,
   `name_0`, `name_1`, ...; red, green, blue and alpha are bytes if their values fit. Other formats omit fields, and PLY
   those whose names it cannot represent, with a note in log (nullable). The mesh is written to a temporary file, which
   is renamed at the end: after a failure there is no partial file, and an older file is unchanged. PEL_FORMAT_AUTO: by
   extension; PLY and STL binary. Errors: PEL_BAD_ARGUMENT (unknown extension, a value that is not finite or too large
   for binary STL), PEL_BAD_FILE (not writable, disk full), PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_mesh_write(const char *path, pel_mesh_format format, const pel_mesh *mesh, const pel_log *log,
                                  pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
