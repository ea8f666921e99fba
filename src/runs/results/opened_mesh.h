/* Frames of a surface that cuts open: all on the triangles of the frame with the most vertices. Triangles keep their
   numbers, so that a corner says which vertex of another frame a vertex was: copies lie where their vertex is until
   they part. */
#ifndef PEL_RESULTS_OPENED_MESH_H
#define PEL_RESULTS_OPENED_MESH_H

#include "pellicle/frames.h"

typedef struct pel_opened_mesh {
    const pel_frames *frames;
    int32_t vertex_count, triangle_count;
    int32_t (*triangles)[3];
    int32_t *corners; /* (vertex_count) a corner of each vertex */
} pel_opened_mesh;

/* Reads all frames. *opened is null, without an error, if they are not of such a surface: another number of triangles,
   or corners that part and come together. Errors: those of pel_frames_read, PEL_OUT_OF_MEMORY. */
pel_status pel_opened_mesh_create(const pel_frames *frames, pel_opened_mesh **opened, pel_error *error);
/* null is fine */
void pel_opened_mesh_destroy(pel_opened_mesh *opened);
/* A frame with its fields on the common triangles. Errors: as above, and PEL_BAD_FORMAT if the file has changed. */
pel_status pel_opened_mesh_read(const pel_opened_mesh *opened, int32_t frame, pel_mesh **mesh, pel_error *error);

#endif
