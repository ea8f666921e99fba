/* Runs of one scene with other numbers, one after the other, that share what these numbers do not change. */
#ifndef PEL_RUN_KEPT_H
#define PEL_RUN_KEPT_H

#include "pellicle/run.h"

/* Made by the first run and used by the next ones; start from zeros. */
typedef struct pel_run_kept {
    pel_model *model; /* null = made by the next run */
    pel_sim *sim;     /* null = likewise */
    void *start;      /* its snapshot before the first step */
    bool is_at_start; /* the simulation is */
} pel_run_kept;

/* pel_run with what is kept, which has to be that of this scene. Without a folder or a session; the summary
   has no times of steps. kept null: as pel_run. */
pel_status pel_run_with(const pel_scene *scene, const pel_run_def *def, pel_run_kept *kept, pel_run_summary *summary,
                        pel_error *error);
/* Takes the simulation back to its start, with the numbers of loads and grasps that it was made with
   (pel_snapshot_rewind). Errors of pel_sim_load. */
pel_status pel_run_kept_rewind(pel_run_kept *kept, pel_error *error);
/* Forgets the simulation, or all of it. */
void pel_run_kept_drop(pel_run_kept *kept, bool with_model);

#endif
