/* A warning about the state of rest in which a motion ended. */
#ifndef PEL_RUN_WARNINGS_REST_H
#define PEL_RUN_WARNINGS_REST_H

#include "run/warnings_bodies.h"

/* At the end: bodies that stayed where they were, though their equilibrium is unstable, because nothing pushes a
   symmetric one aside. */
void pel_warnings_check_balance(pel_run_state *run, int64_t frame);

#endif
