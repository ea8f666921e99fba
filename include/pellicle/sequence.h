/* Pellicle: positions of vertices over time, such as an animated figure that a simulation follows. Files of them are
   read by pel_sequence_read (pellicle/import.h). */
#ifndef PELLICLE_SEQUENCE_H
#define PELLICLE_SEQUENCE_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Immutable; a simulation that follows it keeps its own share. Between two frames positions are linear in time, before
   the first and after the last they are constant. */
typedef struct pel_sequence pel_sequence;

/* Copies frame_count x vertex_count x 3 numbers [m] and the rising times of the frames [s]. Free with
   pel_sequence_destroy. PEL_BAD_ARGUMENT with the frame: no frame, no vertex, a number that is not finite, times that
   do not rise; PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_sequence_create(const double *positions, const double *times, int32_t frame_count,
                                       int32_t vertex_count, pel_sequence **sequence, pel_error *error);

/* Null is fine. */
PEL_API void pel_sequence_destroy(pel_sequence *sequence);

/* 0 for null. */
PEL_API int32_t pel_sequence_frame_count(const pel_sequence *sequence);
PEL_API int32_t pel_sequence_vertex_count(const pel_sequence *sequence);
/* s, of a frame; 0 for null and for a frame that does not exist. */
PEL_API double pel_sequence_time(const pel_sequence *sequence, int32_t frame);
/* Writes the positions (vertex_count x 3) at a time [s]; nothing where a pointer is null. */
PEL_API void pel_sequence_at(const pel_sequence *sequence, double time, double *positions);

/* A new sequence: row i is vertex rows[i] of the first one, moved like a mesh by the transform (null = not at all), and
   `shift` [s] later. Free with pel_sequence_destroy. PEL_BAD_ARGUMENT for rows and numbers out of range;
   PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_sequence_map(const pel_sequence *sequence, const int32_t *rows, int32_t row_count,
                                    const pel_transform *transform, double shift, pel_sequence **mapped,
                                    pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
