/* State that one run keeps for the next one, whose scene differs in some numbers: the scene is not read again if these
   may be overwritten (scene/patch.h), the model is not created again if it does not depend on them, nor the simulation
   if it reads them in each step; both take over new numbers that determine nothing else (pel_run_kept_refill). Rows
   have the same bits as without. */
#ifndef PEL_STUDY_KEPT_H
#define PEL_STUDY_KEPT_H

#include "run/kept.h"
#include "scene/patch.h"
#include "study/study.h"

/* start from zeros */
typedef struct pel_study_kept {
    pel_scene *scene; /* with the values of a run; null = nothing is kept */
    int64_t run;
    pel_parameter_place *places; /* (axis_count) null = another run needs a scene of its own */
    pel_run_number *numbers;     /* (axis_count) scratch; null likewise */
    pel_run_kept parts;
} pel_study_kept;

/* Makes the scene that of a run. patched tells whether it is not as it was read: an error of such a run has no place.
   Errors of pel_scene_parse; to be dropped then. */
pel_status pel_study_kept_take(const pel_study *study, pel_study_kept *kept, int64_t run, bool *patched,
                               pel_error *error);
void pel_study_kept_drop(pel_study_kept *kept);

/* pel_study_run without a folder, by one process after the other. */
pel_status pel_study_run_kept(const pel_study *study, pel_study_kept *kept, int64_t run, char *row, pel_error *error);

#endif
