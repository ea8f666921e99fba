/* The lips of cuts under contact. */
#ifndef PEL_TOUCH_LIPS_H
#define PEL_TOUCH_LIPS_H

#include "stage/stage.h"

/* Fills sim->touch->origins: of each vertex the one that it was before cuts; null without cuts. PEL_OUT_OF_MEMORY. */
pel_status pel_lips_find_origins(pel_sim *sim, pel_error *error);
/* After a cut: moves copies that lie on each other apart, each into its own side, by the gap of kin.
   Momenta and the kinetic energy stay. PEL_OUT_OF_MEMORY. */
pel_status pel_lips_part(pel_sim *sim, pel_error *error);

#endif
