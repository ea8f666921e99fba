/* Frames of a run: the file, the row of the series and the list. The content of a frame is copied from the simulation
   immediately; with more than one thread a separate thread writes it while the simulation continues. If a frame cannot
   be written, the run returns to the state of that frame. */
#ifndef PEL_RUN_FRAMES_H
#define PEL_RUN_FRAMES_H

#include "base/worker.h"
#include "choice/plan.h"
#include "results/folder.h"
#include "results/series.h"
#include "results/surface.h"
#include "results/tally.h"
#include "results/tool_surface.h"
#include "run/kept.h"
#include "run/swing.h"

/* numbers that are kept of each tool */
enum { PEL_TOOL_NUMBERS = 3 };

/* Totals over the run; stored in checkpoints unchanged. */
typedef struct pel_run_totals {
    int64_t frame_count;       /* frames written */
    int64_t frame_step;        /* step of the last one */
    double frame_seconds;      /* wall time of the steps since then */
    double step_seconds;       /* wall time of all steps */
    double worst_seconds;      /* of the longest of them */
    double wall_seconds;       /* of the calls of pel_run before this one */
    double max_displacement;   /* m, over the frames */
    double unbalanced_force;   /* N, largest over the frames */
    double volume_ratio;       /* of the last frame */
    int64_t rise_count;        /* frames whose volume exceeds that of the previous frame */
    double rise_sum, rise_max; /* of the volume ratio in these */
    pel_warning_tallies warnings;
    int64_t lost_count;             /* vertices that grasps have lost */
    int64_t tie_lost_count;         /* that attachments, stitches and springs of an animation have lost */
    pel_contact_statistics contact; /* at the last frame */
    double loss;                    /* J, dissipated_solver at the last frame */
    double free_loss;               /* J, of it in intervals between frames in which nothing touched */
    double bounce_loss, touch_loss; /* J, of it while something touched that has gone away since, and touches still */
    double most_kinetic;            /* J, in a frame */
    pel_swing swing;                /* of all steps */
} pel_run_totals;

/* A frame that was taken and is to be written. */
typedef struct pel_run_frame {
    pel_run_row row;
    double time;           /* s */
    double pressing;       /* N, largest force of a tool until then, of those that press at it; 0 = none does */
    pel_run_totals totals; /* before it; frame_count is its number */
    /* null when one thread does everything */
    double *tool_force;      /* (PEL_TOOL_NUMBERS x tool count) as in pel_run_state */
    unsigned char *snapshot; /* (snapshot_size) of the simulation */
} pel_run_frame;

/* While a frame is under way everything here belongs to the thread that writes. */
typedef struct pel_run_frames {
    const pel_scene *scene;
    const char *folder; /* null = no files */
    const pel_run_plan *plan;
    void (*row)(void *user, const char *line); /* as in pel_run_def; nullable */
    void *user;
    int32_t tool_count; /* of the scene */
    bool has_surface;   /* someone wants its triangles */
    pel_run_surface surface;
    pel_tool_surfaces tools;
    pel_run_series series;
    char series_path[PEL_RUN_FILE_SIZE];
    int64_t frame_count;          /* written */
    int64_t listed_count;         /* of them in frames.pvd */
    double listed_at;             /* wall clock when it was written */
    double max_displacement;      /* m, over the frames of this call */
    double unbalanced_force;      /* N, largest over them */
    pel_warning_tallies warnings; /* of the frames since the last settlement */
    double last_time;             /* s, of the last frame written; 0 = none by this call */
    _Atomic(double) max_force;    /* N, at the last frame written; may be read at any time */
    _Atomic(bool) failed;         /* may be read at any time */
    pel_error error;              /* why */
    pel_worker *worker;           /* null = one thread does everything */
    size_t snapshot_size, snapshot_room;
    pel_run_frame frame;
    unsigned skips;        /* of kept.h */
    int64_t measured_step; /* of the measures in its row; -1 = none yet */
} pel_run_frames;

/* Prepares everything in memory, with a thread when `sim_def` asks for more than one. Destroy also on failure. */
pel_status pel_run_frames_create(pel_run_frames *frames, const pel_sim_def *sim_def, const pel_sim *sim,
                                 pel_error *error);
void pel_run_frames_destroy(pel_run_frames *frames);

/* Starts series.csv, or appends after the existing frame_count frames and rewrites the list. */
pel_status pel_run_frames_begin(pel_run_frames *frames, const pel_sim *sim, int64_t frame_count, bool resume,
                                pel_error *error);

/* Writes the present state as the frame totals->frame_count, or queues it, and resets the totals per frame. Errors: as
   pel_run_frames_settle, also because of an earlier frame. */
pel_status pel_run_frames_add(pel_run_frames *frames, pel_sim *sim, pel_run_totals *totals, double *tool_force,
                              pel_error *error);

/* true when a frame that was handed over could not be written: time to settle */
bool pel_run_frames_failed(const pel_run_frames *frames);

/* Waits until all frames are written and brings totals->max_displacement up to date. If one could not be written, sim,
   totals and tool_force return to their state when it was added, and its error is returned. error is not null. */
pel_status pel_run_frames_settle(pel_run_frames *frames, pel_sim *sim, pel_run_totals *totals, double *tool_force,
                                 pel_error *error);

/* Brings frames.pvd up to date; only after pel_run_frames_settle. */
pel_status pel_run_frames_list(pel_run_frames *frames, pel_error *error);

/* The present state without the skipped parts (kept.h), which are 0. */
void pel_run_measure(pel_sim *sim, unsigned skips, pel_sim_measures *measures, pel_sim_ledger *ledger);

#endif
