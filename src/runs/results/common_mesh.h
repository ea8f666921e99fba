/* The finest common mesh of frames whose triangles change: all frames on one set of triangles, each with the very
   surface that it had. Frames that say where their vertices lie in the mesh of their body (fields mesh_vertices and
   mesh_weights, as runs with refinement write them) have one. */
#ifndef PEL_RESULTS_COMMON_MESH_H
#define PEL_RESULTS_COMMON_MESH_H

#include "pellicle/frames.h"

typedef struct pel_common_mesh pel_common_mesh;

/* true for the two fields */
bool pel_common_mesh_is_place(const char *field_name);

/* Checks that the frame has the places of its vertices; PEL_BAD_FORMAT if not. Errors: also those of
   pel_frames_read. */
pel_status pel_common_mesh_check(const pel_frames *frames, int32_t frame, pel_error *error);

/* Reads all frames. Errors: those of pel_frames_read; PEL_BAD_FORMAT with the frame if it lacks the fields or its
   triangles are not of a refined mesh; PEL_OUT_OF_MEMORY. On failure *common is null. */
pel_status pel_common_mesh_create(const pel_frames *frames, pel_common_mesh **common, pel_error *error);
/* null is fine */
void pel_common_mesh_destroy(pel_common_mesh *common);

int32_t pel_common_mesh_vertex_count(const pel_common_mesh *common);

/* The frame on the common mesh: vertices of the bodies' meshes first, body by body; fields are interpolated like
   positions, without level and the places. Errors: as above. For one thread at a time. */
pel_status pel_common_mesh_read(pel_common_mesh *common, int32_t frame, pel_mesh **mesh, pel_error *error);

#endif
