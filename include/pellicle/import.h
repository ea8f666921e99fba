/* Pellicle: reading mesh files of many formats. In the library pellicle_scene (CMake target pellicle::scene). */
#ifndef PELLICLE_IMPORT_H
#define PELLICLE_IMPORT_H

#include "sequence.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a mesh file. OBJ, PLY, STL, OFF and VTP go to pel_mesh_read.
   glTF 2.0 (.gltf, .glb) has a reader of its own: triangles, strips and fans with indices of all types; nodes with
   matrices or translation, rotation and scale, and their instances; quantised positions (KHR_mesh_quantization);
   sparse accessors; morph targets with the default weights; bones where their nodes stand in the file; numbers in the
   file, in its chunk, or in files of its own folder. A file that requires an extension that we do not know is refused
   by its name. Points, lines, materials and animations are omitted (pel_sequence_read reads these). The vertices and
   corners of all instances together are at most a million and 64 for each byte of the file. USD as
   text (.usda, .usd) has one too: all visible meshes where their prims stand at the first time code, in metres by
   metersPerUnit; without a unit as they are. References, layers, variants, skeletons and shapes that are no meshes are
   left out, with a note. FBX, DAE, 3DS, 3MF, AMF, DXF, LWO and X3D are read through the library assimp, by the program
   `pellicle` in a process of its own: with 60 s of processor time, 1 GiB and 100 bytes for each byte of the file, and
   no other files than those of the mesh's folder that it names. If it dies of the file, that is an error. The program
   is the first of: the environment variable PELLICLE_PROGRAM, which then must be right; `pellicle` or `bin/pellicle` in
   the folder of this library or up to two folders above it, or of the running program; `pellicle` in the absolute
   folders of PATH. It belongs to the user or to root. All meshes of a scene, each placed by its node and in the units
   of the file, are joined, polygons are split into triangles, and seams are welded: borders at exactly equal positions
   that run against each other, because such files split vertices where normals or texture coordinates differ. Bodies
   that merely touch stay apart. log (nullable) receives notes on what was joined, welded and omitted. On failure *mesh
   is null; free with pel_mesh_destroy. Errors: PEL_BAD_FILE (missing, unreadable), PEL_BAD_FORMAT (unknown format,
   damaged, no triangles), PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_mesh_import(const char *path, const pel_log *log, pel_mesh **mesh, pel_error *error);

/* The process that pel_mesh_import starts, for `pellicle --import-child FILE`: lowers the limits of this process, reads
   the file and writes the mesh to standard output. Returns the exit status. */
PEL_API int pel_mesh_import_child(const char *path);

/* Reads positions over time: the animation of a .glb or .gltf file, with nodes, bones and morph targets, for the
   vertices that pel_mesh_import gives; the samples of a .usda file, at their time codes; a point cache (.pc2); all mesh
   files of a folder that pel_mesh_import reads; or the files of a pattern with one * in the file name, such as
   walk/step_*.obj. Files are sorted by name, numbers in them by value. All have the vertices and triangles of the first
   one; a polygon may be split along another diagonal. Frame i is at i / fps [s], that of a point cache at i times its
   sample rate / fps, its start frame is ignored; an animation also has a frame at its end. animation: name of one of a
   glTF file with several, or its number from 0; null = the only one, and for all else. On failure *sequence is null;
   free with pel_sequence_destroy. Errors: PEL_BAD_FILE (missing, no file that matches), PEL_BAD_FORMAT (damaged, other
   vertices or triangles, no such animation; with the file and the counts or names), PEL_BAD_ARGUMENT (fps not above 0,
   an animation of another file), PEL_OUT_OF_MEMORY.
 */
PEL_API pel_status pel_sequence_read(const char *path, const char *animation, double fps, pel_sequence **sequence,
                                     pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
