/* Pellicle: reading the folder of a run: the frames, one at a time, and columns of series.csv. */
#ifndef PELLICLE_FRAMES_H
#define PELLICLE_FRAMES_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The files of a run's folder; pellicle/run.h describes their contents. */
typedef enum pel_run_file {
    PEL_RUN_SCENE,
    PEL_RUN_SERIES,
    PEL_RUN_SUMMARY,
    PEL_RUN_FRAMES,
    PEL_RUN_FINAL,
    PEL_RUN_CHECKPOINT,
    PEL_RUN_FILE_COUNT
} pel_run_file;

/* The name of a file, such as "series.csv"; lives forever. Null for an unknown number. */
PEL_API const char *pel_run_file_name(pel_run_file file);

/* The frames that frames.pvd names, in its order. Plain data, owned by the list, not to be changed. */
typedef struct pel_frames {
    int32_t frame_count;
    char **paths;  /* (frame_count) .vtp files, with the folder */
    double *times; /* (frame_count) s */
    char *folder;
    /* tools: further parts of a frame, in files of their own */
    int32_t tool_count;
    char **tool_names; /* (tool_count) */
    char **tool_paths; /* (frame_count x tool_count) null = the frame does not have the tool */
} pel_frames;

/* Opens a folder of pel_run, finished or not. On failure *frames is null. Free with pel_frames_close. Errors:
   PEL_BAD_FILE (no folder, no frames.pvd), PEL_BAD_FORMAT (frames.pvd is damaged or names no frame; the run is of a
   newer version than this library), PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_frames_open(const char *folder, pel_frames **frames, pel_error *error);

/* Null is permitted. */
PEL_API void pel_frames_close(pel_frames *frames);

/* Reads frame `frame` (0 .. frame_count - 1) with its fields. On failure *mesh is null. Free with pel_mesh_destroy.
   Errors: those of pel_vtp_read, and PEL_BAD_FORMAT with the vertex when a field is NaN or infinite. */
PEL_API pel_status pel_frames_read(const pel_frames *frames, int32_t frame, pel_mesh **mesh, pel_error *error);

/* The surface of a tool (0 .. tool_count - 1) at its pose in a frame; if the tool is absent from the frame, *mesh is
   null and there is no error. Free with pel_mesh_destroy. Errors: those of pel_vtp_read. */
PEL_API pel_status pel_frames_read_tool(const pel_frames *frames, int32_t frame, int32_t tool, pel_mesh **mesh,
                                        pel_error *error);

/* Common properties of all frames. */
typedef struct pel_frames_outline {
    int32_t vertex_count, triangle_count; /* of the first frame */
    int32_t changed_frame;                /* the first frame with other triangles than frame 0; -1 = none */
    double low[3], high[3];               /* m, box around all frames */
} pel_frames_outline;

/* Reads all frames and returns their outline; also finds damage before anything is written. Errors: those of
   pel_frames_read. */
PEL_API pel_status pel_frames_check(const pel_frames *frames, pel_frames_outline *outline, pel_error *error);

/* Some columns of a series.csv. */
typedef struct pel_series {
    int32_t column_count;
    int64_t row_count; /* complete rows; a row that is being written does not count */
    double *values;    /* (column_count x row_count); NaN for a cell that is missing or not a number */
} pel_series;

/* Reads the columns with these names (name_count >= 1); a column that the file lacks is all NaN. On failure *series is
   null. Free with pel_series_destroy. Errors: PEL_BAD_ARGUMENT (no names), PEL_BAD_FILE, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_series_read(const char *path, const char *const *names, int32_t name_count, pel_series **series,
                                   pel_error *error);

/* Null is permitted. */
PEL_API void pel_series_destroy(pel_series *series);

/* One value; NaN for a row or column that does not exist. */
PEL_API double pel_series_value(const pel_series *series, int32_t column, int64_t row);

#ifdef __cplusplus
}
#endif
#endif
