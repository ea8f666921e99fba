/* Warnings about the supports, loads and modes of shells (warnings.h). */
#ifndef PEL_RUN_WARNINGS_SHELL_H
#define PEL_RUN_WARNINGS_SHELL_H

#include "run/warnings_bodies.h"

/* Stiff shells that one row of vertices holds, or two; in a modal analysis those that turn. PEL_OUT_OF_MEMORY. */
pel_status pel_warnings_check_rows(pel_run_state *run, pel_error *error);
/* Before the first step: pressures that no state of the body balances. */
void pel_warnings_check_pressures(pel_run_state *run, int64_t frame);
/* After a step of an analysis: waves of the mode that are short against the edges, bodies that turn about a row. */
void pel_warnings_check_mode(pel_run_state *run);
/* at the end of a run: the slowest vibrations of what still swings */
void pel_warnings_check_vibrations(pel_run_state *run);
/* At the end of a run, with its measures: loads on few vertices. */
void pel_warnings_check_loads(pel_run_state *run);
/* At rest: bodies whose mid-edge bending gives way more than the plate; after the loads. */
void pel_warnings_check_bending(pel_run_state *run, int64_t frame);
void pel_tell_coarse_bending(const pel_warning_text *at);

/* their texts */
void pel_warnings_tell_row(const pel_run_state *run, char *text, size_t size);
void pel_warnings_tell_pressure(const pel_run_state *run, char *text, size_t size);
void pel_warnings_tell_mode(const pel_run_state *run, char *text, size_t size);
void pel_warnings_tell_load(const pel_run_state *run, char *text, size_t size);

#endif
