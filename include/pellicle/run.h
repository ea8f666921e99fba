/* Pellicle: runs. A run steps a scene to its end and writes a folder:

       scene.yaml         the resolved scene; comment lines at its end name the program version and the state's hash
       series.csv         one row per frame
       summary.json       status and final numbers
       frames/f00000.vtp  the surface of all bodies with the requested fields; frame 0 is the initial state
       frames/t00000-0.vtp  the surface of tool 0 in that frame
       frames.pvd         the frames with their times, for ParaView; tools are further parts, with their names
       final.ply          the surface at the end
       checkpoint         the last good state: when the run stops, fails or reaches max_frames, at the checkpoints of
                          the scene (also as checkpoint-STEP.pel), and every keep_seconds during the run

   Files are written completely or not at all; series.csv always ends with a complete row. At any time, also after a
   kill, the contents of the folder are valid. With more than one thread, a separate thread writes the frames in order
   from snapshots; the run is then at most three frames ahead of its folder. If a frame cannot be written, the run
   returns to it, so the results are the same for any number of threads. If the folder contains an older run, the files
   above are removed or replaced; other files are kept. In the library pellicle_scene. */
#ifndef PELLICLE_RUN_H
#define PELLICLE_RUN_H

#include "scene.h"
#include "sim_ledger.h"
#include "sim_reading.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Longest path of an output folder, terminating zero included. */
#define PEL_RUN_PATH_SIZE 3072

/* Progress of a run. */
typedef struct pel_run_progress {
    int64_t step, step_total;   /* completed, and total unless the run stops earlier */
    int64_t frame, frame_total; /* the same for frames, without frame 0; some may not be written yet */
    double time;                /* s, simulated */
    double steps_per_second;    /* of this call of pel_run, 0 at its start */
    double remaining;           /* s, wall time to the end at this speed; -1 = unknown */
    double max_force;           /* N, worst residual: largest vertex force at the last frame */
} pel_run_progress;

/* Further runs that are stepped together with a run (pel_sim_step_beside): scenes that differ from its scene by small
   changes of numbers. */
typedef struct pel_run_beside {
    const pel_scene *const *scenes;
    int32_t count;
    /* Called with each row of the series of the scene of that number, in the calling thread; with more than one thread
       `row` of the run comes from another one, before or after. Nullable. */
    void (*row)(void *user, int32_t scene, const char *line);
    void *user;
} pel_run_beside;

typedef struct pel_run_def {
    const char *folder; /* created with its parents if missing; null = write no files, only the summary and `row`. It
                           gets a mark, the file .pellicle-run; without the mark it must be empty, and nothing in it is
                           changed. An older run moves aside to the first free of NAME.1, NAME.2, ... */
    bool overwrite;     /* the files of the older run are removed instead */
    int64_t max_frames; /* ends the run (status "done") at this frame; frame 0 is the initial state; 0 = at the scene's
                           duration */
    int32_t thread_count; /* 0 = as in the scene; 1 = everything in the calling thread, including frames; results do not
                             depend on it */
    const char *resume;   /* checkpoint file to resume, in the folder of its run; null = start at the beginning */
    /* Called before the first step and after every step; returning false stops the run. Nullable. */
    bool (*progress)(void *user, const pel_run_progress *progress);
    /* Called with each line of the series (CSV, newline included), the header first, before it is written; possibly
       in another thread, but one at a time and never after pel_run. Nullable. */
    void (*row)(void *user, const char *line);
    /* Called between and, in long steps, within steps, from one thread at a time; returning false stops the run within
       0.5 s (meshes of about 100,000 triangles). Nullable. */
    bool (*wanted)(void *user);
    /* Called with each simulation at the end of a run without an error: first the run's own (-1), then the ones beside
       it. Nullable. */
    void (*ended)(void *user, int32_t scene, pel_sim *sim);
    void *user;
    const pel_run_beside *beside; /* only for runs without a folder, of scenes without a session; null = none */
    /* s of wall time between saves of the state in `checkpoint`, from which a killed run can resume; longer if saving
       would take more than 2 % of the time. 0 = never. A failed save is a note in the log. */
    double keep_seconds;
    bool skip_intersections; /* does not compute self_intersections_final: for many small runs */
    const pel_log *log;      /* notes; nullable */
    const pel_log *warnings; /* receives each warning of the summary once: warnings of the scene before the first step,
                                others at the end; nullable */
    uint32_t cookie;         /* set by pel_run_def_default */
} pel_run_def;

/* No folder, saves the state every 10 s, everything else off. */
PEL_API pel_run_def pel_run_def_default(void);

/* Maximum number of warnings of a run: one of each code. */
enum { PEL_RUN_WARNING_LIMIT = 40 };

/* Maximum number of modes of an analysis in a summary and in summary.json. */
enum { PEL_RUN_MODE_LIMIT = 1000 };

/* A reason to doubt the numbers of a run. docs/results.md lists the codes with their thresholds. */
typedef struct pel_run_warning {
    const char *code;    /* such as "unconverged"; lives forever */
    int64_t first_frame; /* first frame with the warning; 0 = before the first step */
    int64_t count;       /* steps, frames or bodies with it */
    char text[400];      /* the problem with its value, and the remedy */
} pel_run_warning;

/* Result of a run, as in summary.json. */
typedef struct pel_run_summary {
    const char *status; /* "done", "stopped", "diverged", "failed"; lives forever; "" if nothing was written */
    int64_t frames;     /* rows of the series, frame 0 included */
    int64_t steps;
    double time_simulated;     /* s */
    double wall_s;             /* s, of all calls of pel_run for this run */
    double steps_per_second;   /* steps per wall time of stepping only */
    double worst_step_ms;      /* wall time of the longest step */
    double volume_final;       /* m3, enclosed by closed bodies */
    double volume_ratio_final; /* the same relative to rest; NaN if each body is open, or flat at rest */
    double area_ratio_final;
    double max_displacement;      /* m, largest over all frames */
    double residual_displacement; /* m, largest at the end */
    double max_tool_force;        /* N, largest over all tools and steps */
    int64_t vertices_final, triangles_final;
    int64_t self_intersections_final; /* pairs of triangles of all bodies that intersect or touch at the end, within a
                                         body and between bodies (pel_mesh_self_intersections); -1 = unknown */
    uint64_t state_hash;
    double alpha, alpha_limit;
    int32_t threads;
    pel_solver_reading solver;        /* of the last step */
    int32_t mode_count;               /* of an analysis, 0 without */
    double modes[PEL_RUN_MODE_LIMIT]; /* (mode_count) Hz, or load factors */
    int64_t unconverged_steps;        /* steps of static, implicit or descent with forces or gaps beyond tolerance */
    const char *stop_reason; /* "duration", "max_frames" or a key of the scene's `stop`; "" if it was stopped or
                              failed; lives forever */
    int64_t volume_rises;    /* frames with a larger volume than the previous frame */
    double volume_rise_sum, volume_rise_max; /* of the volume relative to rest, in these frames */
    pel_sim_ledger ledger;                   /* at the end */
    int32_t warning_count;
    pel_run_warning warnings[PEL_RUN_WARNING_LIMIT]; /* (warning_count) */
    char checkpoint[PEL_RUN_PATH_SIZE + 64];         /* path of the last good state, empty if none was written */
} pel_run_summary;

/* Makes the folder one of a run before the run, for those who put files of their own into it first: an older run moves
   aside or, with overwrite, stays to be removed. Then run with def.overwrite. Errors as for the folder of pel_run. */
PEL_API pel_status pel_run_take_folder(const char *folder, bool overwrite, const pel_log *log, pel_error *error);

/* Runs a scene. With `resume` the series is truncated to the checkpoint and continued with the same bits: except for
   wall times, all files equal those of an uninterrupted run. Returns PEL_OK; PEL_STOPPED (progress or wanted returned
   false); PEL_DIVERGED; PEL_BAD_FILE (folder cannot be made or written: nothing is written then; disk full: the file is
   named); PEL_BAD_FORMAT (the checkpoint is damaged, or of another scene or version); PEL_BAD_ARGUMENT;
   PEL_OUT_OF_MEMORY; and errors of pel_model_create and pel_sim_create (nothing is written then). After a failure
   during the run the remedy names the checkpoint to resume. Always fills summary. */
PEL_API pel_status pel_run(const pel_scene *scene, const pel_run_def *def, pel_run_summary *summary, pel_error *error);

/* Adds fields (name_count names of pellicle/observe.h) to all frames of a run, computed from the positions of the
   frames and the run's scene.yaml: displacements, elastic energies, curvatures, and the strains and stresses of shells.
   Positions of frames are rounded to float unless the scene has `output.precision: double`, so strains are exact to
   about 1e-6. Values that a frame has are kept; those on triangles are computed again. Each frame is replaced as a
   whole. PEL_BAD_ARGUMENT: a field that does not exist or depends on velocities, contacts, loads or the past; bodies
   that refine, are cut or have fibres, a session, material that changes over time. PEL_BAD_FORMAT: frames of another
   mesh. Errors of pel_frames_open, pel_scene_load and pel_vtp_write. */
PEL_API pel_status pel_run_add_fields(const char *folder, const char *const *names, int32_t name_count,
                                      pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
