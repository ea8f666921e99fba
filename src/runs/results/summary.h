/* summary.json: how a run ended. */
#ifndef PEL_RESULTS_SUMMARY_H
#define PEL_RESULTS_SUMMARY_H

#include "io/json.h"
#include "pellicle/run.h"
#include "pellicle/tear.h"

/* Input of the file. */
typedef struct pel_run_ending {
    const char *folder, *scene_path;
    const char *method_name; /* the word of the method in scenes */
    pel_method method;
    const pel_run_summary *summary;
    const pel_sim *sim;       /* at the end */
    int32_t tool_count;       /* of the scene: a session may have added some */
    const double *tool_force; /* (tool_count) N, largest over the run */
    const pel_error *cause;   /* error that ended the run; null if it is done */
} pel_run_ending;

/* PEL_BAD_FILE, PEL_OUT_OF_MEMORY */
pel_status pel_results_write_summary(const pel_run_ending *ending, pel_error *error);

/* The measures of a hole, into an object that is open. */
void pel_results_put_hole(pel_json *json, const pel_hole_reading *hole);
void pel_results_put_forces(pel_json *json, const pel_score *score);

#endif
