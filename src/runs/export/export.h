/* Common part of the exports: the frames on one set of triangles, bodies first, then tools. */
#ifndef PEL_EXPORT_EXPORT_H
#define PEL_EXPORT_EXPORT_H

#include "pellicle/export.h"
#include "results/common_mesh.h"
#include "results/opened_mesh.h"

#include <float.h>
#include <math.h>

typedef struct pel_export_source {
    const pel_frames *frames;
    pel_common_mesh *common; /* of a surface that refines */
    pel_opened_mesh *opened; /* of one that cuts open; both null: constant triangles, frames are read unchanged */
    pel_frames_outline outline;
    int32_t body_vertex_count;
    int32_t vertex_count; /* with tools */
    int32_t body_count;
    pel_mesh **tools; /* (frames->tool_count) where each is first there; null = nowhere */
} pel_export_source;

/* Reads all frames. Errors: those of pel_frames_check and pel_common_mesh_create. Close also on failure. */
pel_status pel_export_open(pel_export_source *source, const pel_frames *frames, pel_error *error);
void pel_export_close(pel_export_source *source);

/* A frame as a mesh with the same triangles as all others. With tools its field `body` numbers the parts of all
   vertices: bodies, then tools. A tool stands where it is first there until it is there, and where its surface is
   another one. */
pel_status pel_export_read(const pel_export_source *source, int32_t frame, pel_mesh **mesh, pel_error *error);

/* The bodies alone. */
pel_status pel_export_read_bodies(const pel_export_source *source, int32_t frame, pel_mesh **mesh, pel_error *error);
/* A tool alone that is there in any frame, with the same triangles in all. */
pel_status pel_export_read_tool(const pel_export_source *source, int32_t frame, int32_t tool, pel_mesh **mesh,
                                pel_error *error);

/* Parts of a mesh by its field `body`; 1 without it. */
int32_t pel_export_part_count(const pel_mesh *mesh);
/* The name of a tool; of a body null. */
const char *pel_export_tool_name(const pel_export_source *source, int32_t part);

/* refuses a frame whose triangles differ from frame 0 */
pel_status pel_export_fail_changed(const pel_frames *frames, int32_t frame, pel_error *error);

/* refuses a frame with coordinates that no float holds */
pel_status pel_export_fail_large(const pel_frames *frames, int32_t frame, pel_error *error);

/* The times of the keys of an animation must grow: PEL_BAD_FORMAT with the first frame whose time does not. */
pel_status pel_export_check_times(const pel_frames *frames, pel_error *error);
/* Coordinates of bodies must fit into floats. */
pel_status pel_export_check_size(const pel_export_source *source, pel_error *error);

static inline bool pel_export_fits_float(double value)
{
    return fabs(value) <= (double)FLT_MAX;
}

#endif
