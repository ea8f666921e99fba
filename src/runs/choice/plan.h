/* Schedule of a run: the steps of frames and checkpoints, and the end. */
#ifndef PEL_RUN_PLAN_H
#define PEL_RUN_PLAN_H

#include "pellicle/scene.h"
#include "results/disk.h"

typedef struct pel_run_plan {
    double dt;                /* s */
    double steps_per_frame;   /* >= 1, not whole when dt does not divide the time between frames */
    int64_t step_total;       /* to the end of the scene's duration */
    int64_t frame_total;      /* number of the frame at that step */
    int64_t frame_end;        /* number of the frame that ends the run */
    int64_t checkpoint_steps; /* between checkpoints; 0 = none */
    double settled_time;      /* s, from here on loads, tools and materials change no more */
} pel_run_plan;

/* max_frames as in pel_run_def */
pel_run_plan pel_run_plan_make(const pel_scene *scene, int64_t max_frames);

/* The step after which a frame is written: frame 0 is the initial state, the last step always gives a frame. */
int64_t pel_run_plan_step(const pel_run_plan *plan, int64_t frame);

double pel_run_plan_time(const pel_run_plan *plan, int64_t frame);

/* What is written from a frame and a step on, but for the sizes. */
pel_disk_need pel_run_plan_need(const pel_run_plan *plan, const pel_scene *scene, int64_t frame, int64_t step);

#endif
