/* Forces of the caller on vertices, and the forces of bodies and loads. */
#ifndef PEL_BOUNDARY_FORCES_H
#define PEL_BOUNDARY_FORCES_H

#include "stage/stage.h"
#include "stage/transfer.h"

/* Allocates or frees them. PEL_OUT_OF_MEMORY: nothing changes. */
pel_status pel_sim_make_forces(pel_sim *sim, bool has_forces, pel_error *error);
/* a pel_transfer_part: forces of the caller */
void pel_forces_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);
/* Forces of bodies and loads at the present state, into sim->force. */
void pel_sim_compute_forces(pel_sim *sim);

#endif
