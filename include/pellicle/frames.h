/* Pellicle: reading back what a run left: the frames of its folder, one at a time. */
#ifndef PELLICLE_FRAMES_H
#define PELLICLE_FRAMES_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The frames that frames.pvd names, in its order. Plain data, owned by the list, not to be changed. */
typedef struct pel_frames {
    int32_t frame_count;
    char **paths;  /* (frame_count) each a .vtp file, the folder in front */
    double *times; /* (frame_count) s */
    char *folder;
} pel_frames;

/* Opens a folder that pel_run wrote, also while the run goes on. On failure *frames is null. Free with
   pel_frames_close. Errors: PEL_BAD_FILE (no folder, no frames.pvd), PEL_BAD_FORMAT (frames.pvd is damaged or names no
   frame; the run is of a newer version than this library), PEL_OUT_OF_MEMORY. */
pel_status pel_frames_open(const char *folder, pel_frames **frames, pel_error *error);

/* null is fine */
void pel_frames_close(pel_frames *frames);

/* Reads frame `frame` (0 .. frame_count - 1) with its fields. On failure *mesh is null. Free with pel_mesh_destroy.
   Errors: those of pel_vtp_read, and PEL_BAD_FORMAT with the vertex when a field is NaN or infinite. */
pel_status pel_frames_read(const pel_frames *frames, int32_t frame, pel_mesh **mesh, pel_error *error);

/* What all frames have in common. */
typedef struct pel_frames_outline {
    int32_t vertex_count, triangle_count; /* of the first frame */
    int32_t changed_frame;                /* the first frame with other triangles than frame 0; -1 = none */
    double low[3], high[3];               /* m, box around all frames */
} pel_frames_outline;

/* Reads all frames and tells their outline; also the way to find damage before anything is written.
   Errors: those of pel_frames_read. */
pel_status pel_frames_check(const pel_frames *frames, pel_frames_outline *outline, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
