/* Getters between the order of the model and that of the mesh, and sums over everything. */
#ifndef PEL_OBSERVE_OBSERVE_H
#define PEL_OBSERVE_OBSERVE_H

#include "pellicle/sim_ledger.h"
#include "stage/stage.h"

/* Fills the energies of the present state; other members are unchanged. */
void pel_sim_sum_energies(pel_sim *sim, pel_sim_measures *measures);

/* elastic and kinetic energy [J] of the new positions and velocities */
double pel_sim_next_energy(pel_sim *sim);

/* pel_sim_measure without areas, volumes and numbers of vertices, or without forces and energies: 0. */
void pel_sim_measure_parts(pel_sim *sim, bool has_surfaces, bool has_energies, pel_sim_measures *measures);

#endif
