/* Input of a picture: the frames of a run or one mesh, and the tools of the run. */
#ifndef PELLICLE_VIEW_RUN_H
#define PELLICLE_VIEW_RUN_H

#include "pellicle/frames.h"
#include "pellicle/scene.h"

typedef struct view_run {
    const char *path;           /* as the user named it */
    bool has_times;             /* false for a single mesh */
    pel_frames *frames;         /* null for a single mesh */
    pel_scene *scene;           /* of scene.yaml; null = there is none */
    int32_t tool_count;         /* of those that are drawn */
    pel_series *tool_positions; /* (tools x 3) columns of series.csv; null = the keys of the scene say all */
    int32_t peak;               /* frame with the largest displacement; the last one if series.csv does not tell */
} view_run;

/* Opens a run; with `tools` they are opened too; if they are unavailable, log receives the reason. Errors:
   PEL_BAD_FILE, PEL_BAD_FORMAT, PEL_OUT_OF_MEMORY; the run is empty then. */
pel_status view_run_open(view_run *run, const char *path, bool tools, const pel_log *log, pel_error *error);
void view_run_close(view_run *run);

int32_t view_run_frame_count(const view_run *run);
double view_run_time(const view_run *run, int32_t frame);
/* of an analysis, whose frames after the first are modes */
bool view_run_has_modes(const view_run *run);

/* Reads a frame; free the mesh with pel_mesh_destroy. */
pel_status view_run_read(const view_run *run, int32_t frame, pel_mesh **mesh, pel_error *error);

int32_t view_run_tool_count(const view_run *run);
/* the axis that points up in its scene: 0 x, 1 y, 2 z */
int32_t view_run_up(const view_run *run);
/* the tool's shape and where it is at a frame */
const pel_tool_def *view_run_tool(const view_run *run, int32_t tool, int32_t frame, double position[3],
                                  double rotation[4]);

#endif
