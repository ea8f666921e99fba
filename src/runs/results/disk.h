/* The disk that a run will need, told before it begins. */
#ifndef PEL_RESULTS_DISK_H
#define PEL_RESULTS_DISK_H

#include "pellicle/error.h"
#include "results/surface.h"

/* What is still to be written. */
typedef struct pel_disk_need {
    double frame_count, checkpoint_count;
    double frame_bytes, checkpoint_bytes;
    double frame_seconds, checkpoint_seconds; /* of simulated time between two of them */
    bool may_take_less; /* a rule may end the run before, or an older run goes: what is too much is told, not refused */
} pel_disk_need;

/* Bytes of a frame of the surface and of its row, at least. */
double pel_run_frame_bytes(const pel_run_surface *surface, const pel_output_def *output);

/* Refuses what the disk of the folder, which need not be there yet, has no room for, and more than ten million
   files; tells in log what takes much of it. PEL_BAD_SCENE. */
pel_status pel_run_check_disk(const char *folder, const pel_disk_need *need, const pel_log *log, pel_error *error);

#endif
