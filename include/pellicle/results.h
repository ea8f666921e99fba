/* Pellicle: writers of results: VTK PolyData (.vtp) with a .pvd series, and CSV. Every file is written to a temporary
   name and renamed, so that what stands in the folder is always whole. */
#ifndef PELLICLE_RESULTS_H
#define PELLICLE_RESULTS_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pel_vtp_field {
    const char *name;
    int32_t component_count;
    const double *values; /* (vertex_count x component_count) */
} pel_vtp_field;

/* One surface at one time. */
typedef struct pel_vtp {
    int32_t vertex_count, triangle_count;
    const double *positions;     /* (vertex_count x 3) */
    const int32_t *triangles;    /* (triangle_count x 3) */
    const pel_vtp_field *fields; /* (field_count) point data */
    int32_t field_count;
    double time;   /* s, stored as TimeValue */
    bool compress; /* zlib; otherwise raw appended data */
    bool float64;  /* positions and fields as Float64 instead of Float32 */
} pel_vtp;

pel_status pel_vtp_write(const char *path, const pel_vtp *vtp, pel_error *error);

/* Writes the collection file: file_names (relative to the .pvd) and times (frame_count). */
pel_status pel_pvd_write(const char *path, const char *const *file_names, const double *times, int32_t frame_count,
                         pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
