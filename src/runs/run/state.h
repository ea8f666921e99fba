/* Internals of a run, shared by its parts. */
#ifndef PEL_RUN_STATE_H
#define PEL_RUN_STATE_H

#include "math/extremes.h"
#include "pellicle/run.h"
#include "pellicle/session.h"
#include "run/frames.h"
#include "run/kept.h"
#include "touch/thickness.h"

#include <math.h>

typedef struct pel_run_state {
    const pel_scene *scene;
    const pel_run_def *def;
    pel_run_kept *kept; /* owns model and simulation; null = this does */
    pel_model *model;
    pel_sim *sim;
    int32_t tool_count;   /* of the scene: a session adds some and takes them away */
    pel_session *session; /* null if the scene has none */
    int32_t thread_count;
    uint64_t fingerprint; /* of the scene with its meshes and of the program version */
    pel_run_plan plan;
    pel_run_frames frames;
    pel_run_totals totals;
    double *tool_force; /* (PEL_TOOL_NUMBERS x tool count) N, largest since the last frame, then largest over the run;
                           then the number of vertices that the tool touched at the latter */
    unsigned char *checkpoint; /* (checkpoint_size) buffer of a checkpoint */
    size_t checkpoint_size, checkpoint_room;
    char checkpoint_path[PEL_RUN_FILE_SIZE]; /* the last good one; empty = none */
    int64_t checkpoint_step;
    double start;                          /* wall clock at the beginning of this call */
    double keep_at;                        /* wall clock at which the state is kept again */
    int lock;                              /* of the folder; -1 = none */
    int64_t start_step;                    /* step at the beginning of this call */
    bool settled;                          /* a rule of the scene's `stop` ended the run */
    const char *stop_reason;               /* which one; null = none */
    pel_sim_measures measures;             /* of the end */
    pel_sim_ledger ledger;                 /* the same */
    pel_contact_statistics contact_before; /* before the last step */
    pel_flagged_body flagged[PEL_WARN_COUNT];
    pel_start_gap start_gap;    /* of the warning about it */
    bool told[PEL_WARN_COUNT];  /* to the log */
    int64_t intersection_count; /* pairs of triangles at the end; -1 = not known */
    /* beside.c: of def->beside, each (count); null = none */
    pel_model **models_beside;
    pel_sim **sims_beside;
    pel_run_series *series_beside;
} pel_run_state;

/* m, over the frames that are written and now */
static inline double pel_run_max_displacement(const pel_run_state *run)
{
    return pel_max(run->totals.max_displacement, run->measures.max_displacement);
}

/* N, largest force of a tool over the run; 0 without tools */
static inline double pel_run_max_tool_force(const pel_run_state *run)
{
    double largest = 0;
    for (int32_t t = 0; t < run->tool_count; t++)
        largest = pel_max(largest, run->tool_force[run->tool_count + t]);
    return largest;
}

/* ---- beside.c ---- */

/* Creates the simulations beside that of the run. Errors of their creation; PEL_BAD_ARGUMENT for runs that do not
   support them. */
pel_status pel_run_beside_create(pel_run_state *run, pel_error *error);
void pel_run_beside_destroy(pel_run_state *run);
/* Gives their rows of the frame that the run is to add. */
void pel_run_beside_add_frame(pel_run_state *run);
void pel_run_beside_end(pel_run_state *run);

/* ---- checkpoint.c ---- */

/* Allocates the buffer, so that a checkpoint can be written when memory is exhausted. */
pel_status pel_run_checkpoint_prepare(pel_run_state *run, pel_error *error);
/* Writes the present state to `checkpoint`, and to checkpoint-STEP.pel too when numbered. */
pel_status pel_run_checkpoint_write(pel_run_state *run, bool numbered, pel_error *error);
/* Restores the state in a file. PEL_BAD_FORMAT if it is damaged or does not belong to this scene. */
pel_status pel_run_checkpoint_read(pel_run_state *run, const char *path, pel_error *error);

/* ---- summary.c ---- */

void pel_run_summary_fill(const pel_run_state *run, pel_status status, pel_run_summary *summary);
/* error: cause of the end of the run, null if it is done */
pel_status pel_run_summary_write(const pel_run_state *run, const pel_run_summary *summary, const pel_error *cause,
                                 pel_error *error);

#endif
