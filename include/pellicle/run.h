/* Pellicle: whole runs. A run steps a scene to its end and leaves a folder:

       scene.yaml         the resolved scene; comment lines at its end name the program version and the state's hash
       series.csv         one row per frame
       summary.json       how it ended and the numbers of the end
       frames/f00000.vtp  the surface of all bodies with the fields asked for, frame 0 is the initial state
       frames/t00000-0.vtp  the surface of tool 0 in that frame
       frames.pvd         the frames with their times, for ParaView; tools are further parts, with their names
       final.ply          the surface at the end
       checkpoint         the last good state, when the run was stopped, failed or reached max_frames, each time when
   the scene asks for checkpoints, then also as checkpoint-STEP.pel, and every keep_seconds while the run goes

   Every file but series.csv is written whole or not at all; series.csv always ends with a whole row. At any moment,
   also after a kill, everything in the folder is valid. With more than one thread, a thread beside those of the steps
   writes the frames, from snapshots and in order; a run is at most three frames ahead of its folder then, and a frame
   that cannot be written takes it back to that frame: what is left is the same with any number of threads. A folder
   that holds an older run is taken over: the files above are removed or replaced, all others are left alone. In the
   library pellicle_scene. */
#ifndef PELLICLE_RUN_H
#define PELLICLE_RUN_H

#include "scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Longest path of an output folder, terminating zero included. */
#define PEL_RUN_PATH_SIZE 3072

/* Where a run stands. */
typedef struct pel_run_progress {
    int64_t step, step_total;   /* done, and at the end of the run unless it stops earlier */
    int64_t frame, frame_total; /* the same of frames, frame 0 not counted; some may still be being written */
    double time;                /* s, simulated */
    double steps_per_second;    /* of this call of pel_run, 0 at its begin */
    double remaining;           /* s of wall time to the end at this speed; -1 = not known yet */
    double max_force;           /* N, worst residual: largest vertex force at the last frame */
} pel_run_progress;

/* Runs beside a run, step by step (pel_sim_step_beside): scenes that differ from its by small changes of numbers. */
typedef struct pel_run_beside {
    const pel_scene *const *scenes;
    int32_t count;
    /* Called with each row of the series of the scene of that number, after `row` of the run. Nullable. */
    void (*row)(void *user, int32_t scene, const char *line);
    void *user;
} pel_run_beside;

typedef struct pel_run_def {
    const char *folder; /* made with its parents when missing; null = write no files, the summary and `row` are all */
    int64_t max_frames; /* ends the run (status "done") with the frame of this number, frame 0 being the initial state;
                           0 = goes to the scene's duration */
    int32_t thread_count; /* 0 = what the scene says; 1 = everything in the calling thread, frames included; the results
                             do not depend on it */
    const char *resume;   /* checkpoint file to go on from, in the folder of its run; null = from the beginning */
    /* Called before the first step and after every step; returning false stops the run. Nullable. */
    bool (*progress)(void *user, const pel_run_progress *progress);
    /* Called with each line of the series (CSV, newline included), the header first, before it is written; maybe in
       another thread than the caller's, but one at a time and never after pel_run. Nullable. */
    void (*row)(void *user, const char *line);
    /* Asked between and, in long steps, within steps, from one thread at a time; returning false stops the run after
       0.5 s at most (meshes of some 100,000 triangles). Nullable. */
    bool (*wanted)(void *user);
    /* Called with the simulation at the end of a run without an error: that of the run (-1), then those beside it.
       Nullable. */
    void (*ended)(void *user, int32_t scene, pel_sim *sim);
    void *user;
    const pel_run_beside *beside; /* without a folder and sessions; null = none */
    /* s of wall time after which the state is kept in `checkpoint`, so that a killed run can go on from there; later
       when that would take more than 2 % of the time. 0 = never. A state that cannot be kept is a note in the log. */
    double keep_seconds;
    bool skip_intersections; /* leaves self_intersections_final unknown: for many small runs */
    const pel_log *log;      /* notes; nullable */
    const pel_log *warnings; /* each warning of the summary, once: those of the scene before the first step, the others
                                at the end; nullable */
    uint32_t cookie;         /* set by pel_run_def_default */
} pel_run_def;

/* No folder yet, the state is kept every 10 s, everything else off. */
PEL_API pel_run_def pel_run_def_default(void);

/* Warnings of a run at most: one of each code. */
enum { PEL_RUN_WARNING_LIMIT = 16 };

/* Modes of an analysis that a summary tells, and summary.json with it. */
enum { PEL_RUN_MODE_LIMIT = 1000 };

/* What makes the numbers of a run doubtful. docs/results.md lists the codes with their thresholds. */
typedef struct pel_run_warning {
    const char *code;    /* such as "unconverged"; lives forever */
    int64_t first_frame; /* in which it was seen first; 0 = before the first step */
    int64_t count;       /* of steps, frames or bodies in which it was seen */
    char text[400];      /* what is wrong, with its value, and the remedy */
} pel_run_warning;

/* How a run ended; the same as in summary.json. */
typedef struct pel_run_summary {
    const char *status; /* "done", "stopped", "diverged", "failed"; lives forever; "" when nothing was written */
    int64_t frames;     /* rows of the series, frame 0 included */
    int64_t steps;
    double time_simulated;   /* s */
    double wall_s;           /* s, of all calls of pel_run that made this run */
    double steps_per_second; /* steps over the wall time of stepping alone */
    double volume_ratio_final, area_ratio_final;
    double max_displacement;      /* m, largest over all frames */
    double residual_displacement; /* m, largest at the end */
    double max_tool_force;        /* N, largest over all tools and steps */
    int64_t vertices_final, triangles_final;
    int64_t
        self_intersections_final; /* pairs of triangles, of all bodies, that cut or touch each other at the end, within
                                     a body and between bodies (pel_mesh_self_intersections); -1 = not known */
    uint64_t state_hash;
    double alpha, alpha_limit;
    int32_t threads;
    pel_solver_reading solver;        /* of the last step */
    int32_t mode_count;               /* of an analysis, 0 without */
    double modes[PEL_RUN_MODE_LIMIT]; /* (mode_count) Hz, or load factors */
    int64_t unconverged_steps;        /* of the method descent: steps whose forces or gaps are not within tolerance */
    const char *stop_reason; /* what ended the run: "duration", "max_frames" or a key of the scene's `stop`; "" when it
                              was stopped or failed; lives forever */
    int64_t volume_rises;    /* frames whose volume is more than that of the frame before */
    double volume_rise_sum, volume_rise_max; /* of volume over that at rest, in these */
    pel_sim_ledger ledger;                   /* at the end */
    int32_t warning_count;
    pel_run_warning warnings[PEL_RUN_WARNING_LIMIT]; /* (warning_count) */
    char checkpoint[PEL_RUN_PATH_SIZE + 64];         /* path of the last good state, empty when none was written */
} pel_run_summary;

/* Runs a scene. With `resume` the series is cut back to the checkpoint and continued with the same bits: all files are
   those of a run without interruption, wall times apart.
   Returns PEL_OK; PEL_STOPPED (progress or wanted returned false); PEL_DIVERGED; PEL_BAD_FILE (folder cannot be made or
   written: nothing is written then; disk full: the file is named); PEL_BAD_FORMAT (the checkpoint is damaged, or of
   another scene or version); PEL_BAD_ARGUMENT; PEL_OUT_OF_MEMORY; and what pel_model_create and pel_sim_create return
   (nothing is written then). After a failure on the way the remedy names the checkpoint to go on from. summary is
   filled in any case. */
PEL_API pel_status pel_run(const pel_scene *scene, const pel_run_def *def, pel_run_summary *summary, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
