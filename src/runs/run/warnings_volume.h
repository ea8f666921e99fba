/* Warnings about bodies of tetrahedra. */
#ifndef PEL_RUN_WARNINGS_VOLUME_H
#define PEL_RUN_WARNINGS_VOLUME_H

#include "run/warnings_bodies.h"

/* Before the first step: a slender body whose tetrahedra are too large to bend, or any that they lock. */
void pel_warnings_check_volume(pel_run_state *run, int32_t body);
void pel_tell_coarse_volume(const pel_warning_text *at);

#endif
