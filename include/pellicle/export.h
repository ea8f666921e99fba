/* Pellicle: export of runs to other programs: point caches, glTF with morph targets, USD, numbered mesh files. Each
   export reads the frames twice: first to find damage, so that nothing is written if a frame is damaged. At any time,
   memory contains only a few frames.

   The triangles of bodies that refine change between frames. The exports then convert every frame to the finest common
   mesh: a triangle that is split in any frame is split in all frames, and the surface of each frame does not change.
   The vertices of the bodies' meshes come first, body by body; fields are interpolated; the fields level, mesh_vertices
   and mesh_weights are omitted. Tools are separate parts after the bodies, with their pose in each frame. A tool that
   was added during the run has its first pose in the frames before. */
#ifndef PELLICLE_EXPORT_H
#define PELLICLE_EXPORT_H

#include "frames.h"
#include "mesh_io.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Writes a point cache PC2 (Blender's Mesh Cache modifier, Maya, 3ds Max): OUT.pc2 has the positions of the bodies in
   all frames, one sample per frame from frame 0, and OUT-bodies.obj the mesh for it. Each tool has its own cache and
   mesh, OUT-NAME.pc2 and OUT-NAME.obj; characters of its name other than letters, digits, - and _ become _, and its
   number is added. Without refinement the cache of the bodies also fits final.ply. Errors: those of pel_frames_read;
   PEL_BAD_FORMAT with the frame, if the triangles change and a frame lacks the fields mesh_vertices and mesh_weights,
   which contain the places of its vertices in the mesh; PEL_BAD_FILE. */
PEL_API pel_status pel_export_pc2(const char *path, const pel_frames *frames, pel_error *error);

/* Writes a binary glTF 2.0 file with a node for each body and each tool: frame 0 as a mesh with normals, every further
   frame as a morph target, and one animation that blends from frame to frame at the times of the frames.
   Nodes of tools have their names, nodes of several bodies are "body 0", "body 1", ...; all nodes convert from z up to
   the y up of glTF. Errors: as above, and PEL_BAD_ARGUMENT if the file would exceed the format's limit of 4 GiB. */
PEL_API pel_status pel_export_glb(const char *path, const pel_frames *frames, pel_error *error);

/* The same for one mesh without motion; a node for each number of its field `body`. */
PEL_API pel_status pel_export_glb_mesh(const char *path, const pel_mesh *mesh, pel_error *error);

/* Writes a USD file as text (.usda): a mesh for each body and each tool with time samples of points, normals and
   extent, z up, in metres. Frames at equal intervals have the time codes 0, 1, ... and the frame rate of the run;
   others are at their times with 24 codes per second. Texture coordinates are primvars:st if the frames have a field st
   or uv of two components, or two fields s and t, u and v, or texture_u and texture_v. The frames are read twice for
   each body and tool. Errors: as for pel_export_glb, without the limit. */
PEL_API pel_status pel_export_usd(const char *path, const pel_frames *frames, pel_error *error);

/* The same for one mesh without motion. PEL_BAD_ARGUMENT for a coordinate that no float holds. */
PEL_API pel_status pel_export_usd_mesh(const char *path, const pel_mesh *mesh, pel_error *error);

/* Longest path of a numbered file, terminating zero included. */
#define PEL_EXPORT_PATH_SIZE 4096

/* The name of the numbered file of frame `frame`: out/ball.obj gives out/ball_00012.obj. Returns text. */
PEL_API const char *pel_export_numbered_path(char text[PEL_EXPORT_PATH_SIZE], const char *path, int32_t frame);

/* Writes every frame as a separate, numbered mesh file. With tools the field `body` numbers bodies, then tools; an OBJ
   file has an object for each number. Files of these names are replaced; after a failure the written ones are removed.
   log (nullable) receives the notes of the first frame. Errors: those of pel_export_pc2 and pel_mesh_write. */
PEL_API pel_status pel_export_sequence(const char *path, pel_mesh_format format, const pel_frames *frames,
                                       const pel_log *log, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
