/* Consecutive runs of one scene with different numbers that share the parts which do not depend on them. */
#ifndef PEL_RUN_KEPT_H
#define PEL_RUN_KEPT_H

#include "pellicle/run.h"
#include "sim/parameter.h"

/* Results of a run at its frames and its end. */
enum {
    PEL_RUN_SURFACES = 1, /* areas, volumes, numbers of vertices and triangles */
    PEL_RUN_ENERGIES = 2, /* forces, energies, the ledger */
    PEL_RUN_HASH = 4,
    PEL_RUN_WARNINGS = 8, /* of frames and the end, which take the first two */
};

/* Made by the first run and used by the next ones; start from zeros. */
typedef struct pel_run_kept {
    pel_model *model; /* null = made by the next run */
    pel_sim *sim;     /* null = likewise */
    void *start;      /* its snapshot before the first step */
    bool is_at_start; /* the simulation is */
    unsigned skips;   /* parts that nobody reads: the summary has 0 for them */
} pel_run_kept;

/* pel_run with kept parts, which must belong to this scene. Without a folder or a session; the summary has no times of
   steps. kept null: as pel_run. */
pel_status pel_run_with(const pel_scene *scene, const pel_run_def *def, pel_run_kept *kept, pel_run_summary *summary,
                        pel_error *error);
/* Takes the simulation back to its start, with the numbers of loads and grasps that it was made with
   (pel_snapshot_rewind). Errors of pel_sim_load. */
pel_status pel_run_kept_rewind(pel_run_kept *kept, pel_error *error);
/* Another value of a parameter. */
typedef struct pel_run_number {
    pel_parameter_place place;
    const char *text; /* as scenes have it */
} pel_run_number;

/* Writes numbers of bodies and the solver into the simulation, back at its start, and into the model with the bodies'.
   False if it must be forgotten: it was not created yet, or pel_model_refill or pel_sim_refill returns false. */
bool pel_run_kept_refill(pel_run_kept *kept, const pel_run_number *numbers, int32_t count, bool with_model);
/* Forgets the simulation, or all of it. */
void pel_run_kept_drop(pel_run_kept *kept, bool with_model);

#endif
