/* The numbers of a hole that a tear opens. */
#ifndef PEL_TEAR_HOLE_H
#define PEL_TEAR_HOLE_H

#include "pellicle/tear.h"

/* From aim and radii; the rest of the reading has to be 0. */
void pel_hole_measure(pel_hole_reading *hole);

#endif
