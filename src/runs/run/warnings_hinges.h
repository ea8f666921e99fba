/* Warnings about the bending of hinges. */
#ifndef PEL_RUN_WARNINGS_HINGES_H
#define PEL_RUN_WARNINGS_HINGES_H

#include "run/warnings_bodies.h"

/* At the end: flat sheets that bend more than they stretch, and whose hinges store another energy than a plate does. */
void pel_warnings_check_hinges(pel_run_state *run, int64_t frame);
void pel_tell_hinges(const pel_warning_text *at);

#endif
