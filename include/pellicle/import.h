/* Pellicle: reading mesh files of many formats. In the library pellicle_scene (CMake target pellicle::scene). */
#ifndef PELLICLE_IMPORT_H
#define PELLICLE_IMPORT_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a mesh file. OBJ, PLY, STL and OFF go to pel_mesh_read. Everything else (glTF, FBX, 3MF, Collada, ...) goes
   through the assimp library: all meshes of the scene, each placed by its node and in the units of the file, are
   joined, polygons are split into triangles, and vertices at exactly equal positions are welded, because such files
   split them where normals or texture coordinates differ. Points, lines, materials, bones and animation are omitted.
   log (nullable) receives notes on what was joined, welded and omitted. On failure *mesh is null; free with
   pel_mesh_destroy.
   Errors: PEL_BAD_FILE (missing, unreadable), PEL_BAD_FORMAT (unknown format, damaged, no triangles),
   PEL_OUT_OF_MEMORY. For formats that assimp reads, memory use is not bounded as in pel_mesh_read. */
PEL_API pel_status pel_mesh_import(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
