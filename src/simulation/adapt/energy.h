/* The elastic energy over an event of refinement.

   The placement of new vertices (refined/refine_transfer.c) and the loss of detail by coarsening change the elastic
   energy. So vertices of the event move along their forces until the energy is as before: first the new ones, if any,
   then all whose triangles changed. This is the projection of one constraint, energy - energy before = 0, with a
   parabola through each trial, as the energy of a bent sheet is far from linear. Velocities, and so momentum, do not
   change. Volumetric springs, which are proportional to area, are not included: they would bend springs that a rigid
   motion leaves at rest. */
#ifndef PEL_ADAPT_ENERGY_H
#define PEL_ADAPT_ENERGY_H

#include "stage/stage.h"

/* Energy of the shells, before an event. */
double pel_refine_energy_before(pel_sim *sim, int32_t body);

/* After the event, when springs, shells and loads have followed. */
void pel_refine_keep_energy(pel_sim *sim, int32_t body, double shells_before);

#endif
