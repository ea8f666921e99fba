/* Bodies that nothing holds. */
#ifndef PEL_MINIMISE_FREE_BODY_H
#define PEL_MINIMISE_FREE_BODY_H

#include "constraint/frame.h"

/* Refuses a body that nothing holds against the net of some forces (vertex_count) at a time. PEL_BAD_ARGUMENT. */
pel_status pel_minimise_check_held(const pel_sim *sim, const pel_record *force, double time, pel_error *error);
/* The same for the loads of the first step, and at the times of later ones. Clears sim->force. */
pel_status pel_minimise_check_start(pel_sim *sim, pel_error *error);
/* Finds a body that only contact holds and that has got away by the end of the step of a static method. */
void pel_minimise_find_stray(pel_sim *sim);

#endif
