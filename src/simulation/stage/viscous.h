/* What damping of the material takes out in a step of a method that has no tangent of its own. */
#ifndef PEL_STAGE_VISCOUS_H
#define PEL_STAGE_VISCOUS_H

#include "stage/stage.h"

/* Room where a body has such damping, else nothing. Errors of pel_tangent_create. */
pel_status pel_viscous_create(pel_sim *sim, pel_error *error);
void pel_viscous_destroy(pel_sim *sim);
/* after the surface has changed */
void pel_viscous_follow_surface(pel_sim *sim);

/* J, of the step from position to position_next, by its mean rates of strain; 0 without such damping. */
double pel_viscous_find_loss(pel_sim *sim);

#endif
