/* The elastic energy over an event of refinement.

   Where a new vertex is placed (model/transfer.c), and a coarser surface that lacks what finer vertices showed, change
   the elastic energy. So vertices of the event move along their forces until the energy is what it was: the new ones
   first, where there are any, then all whose triangles changed. This is the projection of one constraint, energy -
   energy before = 0, with a parabola through each trial, as the energy of a bent sheet is far from linear. Velocities
   stay, and so does momentum. Volumetric springs, which go with area, do not take part: they would bend springs that a
   rigid motion leaves at rest. */
#ifndef PEL_SIM_REFINE_ENERGY_H
#define PEL_SIM_REFINE_ENERGY_H

#include "sim/sim.h"

/* Energy of the shells, before an event. */
double pel_refine_energy_before(pel_sim *sim, int32_t body);

/* After the event, when springs, shells and loads have followed. */
void pel_refine_keep_energy(pel_sim *sim, int32_t body, double shells_before);

#endif
