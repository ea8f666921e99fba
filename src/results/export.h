/* What the exports share: the frames on one set of triangles. */
#ifndef PEL_RESULTS_EXPORT_H
#define PEL_RESULTS_EXPORT_H

#include "pellicle/export.h"
#include "results/common_mesh.h"

#include <float.h>
#include <math.h>

typedef struct pel_export_source {
    const pel_frames *frames;
    pel_common_mesh *common; /* null: the triangles stay, and the frames are read as they are */
    pel_frames_outline outline;
    int32_t vertex_count;
} pel_export_source;

/* Reads all frames. Errors: those of pel_frames_check and pel_common_mesh_create. Close also on failure. */
pel_status pel_export_open(pel_export_source *source, const pel_frames *frames, pel_error *error);
void pel_export_close(pel_export_source *source);

/* A frame as a mesh with the same triangles as all others. */
pel_status pel_export_read(const pel_export_source *source, int32_t frame, pel_mesh **mesh, pel_error *error);

/* refuses a frame whose triangles are not those of frame 0 */
pel_status pel_export_fail_changed(const pel_frames *frames, int32_t frame, pel_error *error);

/* refuses a frame with coordinates that no float holds */
pel_status pel_export_fail_large(const pel_frames *frames, int32_t frame, pel_error *error);

static inline bool pel_export_fits_float(double value)
{
    return fabs(value) <= (double)FLT_MAX;
}

#endif
