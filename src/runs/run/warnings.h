/* Warnings of a run: reasons to doubt its numbers. Each kind is counted during the run and reported once. */
#ifndef PEL_RUN_WARNINGS_H
#define PEL_RUN_WARNINGS_H

#include "results/tally.h"

struct pel_run_state;

/* Before the first step: softness, meshes. PEL_OUT_OF_MEMORY. */
pel_status pel_warnings_check_scene(struct pel_run_state *run, pel_error *error);
/* After each step: convergence, jams, tools. */
void pel_warnings_check_step(struct pel_run_state *run);
/* At the end of a run, with its measures: remaining contacts and forces. */
void pel_warnings_check_end(struct pel_run_state *run);

/* Writes the warnings that hold at present to `warnings` (PEL_RUN_WARNING_LIMIT); returns their number. */
int32_t pel_warnings_list(const struct pel_run_state *run, pel_run_warning *warnings);
/* Tells the log those that it was not told yet: of the scene, and the others when the run is over. */
void pel_warnings_tell(struct pel_run_state *run, bool is_over);

#endif
