/* The quasi-static method on fine vertices. */
#ifndef PEL_METHOD_RELAX_H
#define PEL_METHOD_RELAX_H

#include "solve/relax.h"
#include "stage/stage.h"

/* On the base, before anything is refined: sets the relaxation of the active model. */
pel_status pel_sim_relax_create(pel_sim *sim, pel_error *error);
/* New positions of fine vertices, after those of all others. False if a vertex leaves the bound. */
bool pel_sim_relax(pel_sim *sim);

#endif
