/* Shells under the methods that use forces, and the volume of bodies under pressure. */
#ifndef PEL_STAGE_SHELLS_H
#define PEL_STAGE_SHELLS_H

#include "force/tangent_body.h"
#include "stage/stage.h"

/* Lists for the forces of shells. PEL_BAD_ARGUMENT for features that the method does not support. */
pel_status pel_shells_create(pel_sim *sim, pel_error *error);
void pel_shells_destroy(pel_sim *sim);
/* Adds the forces of shells at the present positions, with pressure over a span, to the new positions and velocities.
 */
void pel_shells_apply(pel_sim *sim, pel_span span, pel_gains gains);
/* After an event of refinement: shells and constraints of the body on its new surface. */
void pel_shells_follow(pel_sim *sim, int32_t body);
/* the settle_edges of the stepper; null without mid-edge bending */
pel_tangent *pel_sim_settle_edges(const pel_sim *sim, const double **unknowns);
/* How much a body with mid-edge bending gives way more than the plate, as a share of its energy; 0 for others. */
double pel_sim_bending_error(const pel_sim *sim, int32_t body);
/* PEL_DIVERGED when a pressure turned a body inside out in this step */
pel_status pel_shells_check_volume(const pel_sim *sim, pel_error *error);

#endif
