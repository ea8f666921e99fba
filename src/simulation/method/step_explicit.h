/* The explicit method. */
#ifndef PEL_METHOD_STEP_EXPLICIT_H
#define PEL_METHOD_STEP_EXPLICIT_H

#include "solve/stability.h"
#include "stage/stage.h"

/* The true limit of stability instead of the safe bound. */
pel_status pel_sim_refine_stability(const pel_sim *sim, pel_stability *stability, pel_error *error);
/* The largest stable dt, at rest and on the finest level of detail; 0 where forward Euler has none. PEL_OUT_OF_MEMORY.
 */
pel_status pel_explicit_limit(pel_sim *sim, double *limit, pel_error *error);

/* Names a stable dt as the remedy where the bodies have stiffened so much that dt is none any more; else false. */
bool pel_explicit_advise(const pel_sim *sim, pel_error *error);

#endif
