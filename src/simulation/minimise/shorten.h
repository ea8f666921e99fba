/* A part of a step in time that takes a state which is no balance. */
#ifndef PEL_MINIMISE_SHORTEN_H
#define PEL_MINIMISE_SHORTEN_H

#include "constraint/frame.h"

/* Shortens the way of what touches (groups whose number is set in newton->collided), of all tools and of what they
   hold, as far as energy would appear or surfaces would meet on it: to none at the least. Its velocities are those of
   that way. PEL_OUT_OF_MEMORY. */
pel_status pel_minimise_shorten(pel_sim *sim, pel_error *error);

#endif
