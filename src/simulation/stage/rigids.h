/* Rigid bodies in a step: what owns their vertices, beside the state of the others. Kicks, drifts and their ends are of
   position-based methods; for those of Newton see minimise/rigid_part.h. */
#ifndef PEL_STAGE_RIGIDS_H
#define PEL_STAGE_RIGIDS_H

#include "stage/stage.h"

/* Null where the model has no rigid body. PEL_BAD_ARGUMENT of methods that do not move any, PEL_OUT_OF_MEMORY. */
pel_status pel_rigids_create(pel_sim *sim, pel_error *error);
void pel_rigids_destroy(pel_sim *sim);

/* At the start of a step, or of a part of it. */
void pel_rigids_begin(pel_sim *sim);
/* At the start of a substep of length h [s] at positions (vertex_count): momenta by sim->force, which becomes 0 for
   their vertices; air (vertex_count): drag [N s/m] as fourth number, null = none. */
void pel_rigids_kick(pel_sim *sim, const pel_record *positions, double h, const pel_record *air);
/* After the prediction of all vertices: the rigid ones go where their bodies are. */
void pel_rigids_drift(pel_sim *sim, double h);
/* At the end of a substep; of the last one, or where all count, velocities of vertices. reaction (vertex_count): adds
   the forces on pins [N]; null = not asked for. */
void pel_rigids_finish(pel_sim *sim, double h, pel_record *reaction, bool is_last);
/* The state at the end of the step, with what contact and the guard have changed. */
void pel_rigids_keep(pel_sim *sim);

/* After positions or velocities of the vertices of a body were set: the rigid motion that is nearest to them. */
void pel_rigids_follow_positions(pel_sim *sim, int32_t body);
void pel_rigids_follow_velocities(pel_sim *sim, int32_t body);
/* Momenta of a body whose vertices move like this (both vertex_count), as it stands. */
void pel_rigids_take_motion(const pel_sim *sim, pel_rigid *rigid, const pel_record *positions,
                            const pel_record *velocities);
/* An impulse [N s] at a point of a body, between two steps. */
void pel_rigids_hit(pel_sim *sim, int32_t body, const double point[3], const double impulse[3]);

/* J, by which the kinetic energies of rigid bodies differ from those of their vertices: at the start of the step, or,
   in the step, at its end; velocities (vertex_count) may be null: 0. */
double pel_rigids_extra_energy(const pel_sim *sim, const pel_rigid_state *states, const pel_record *velocities);

#endif
