/* Loss factors of materials. */
#ifndef PEL_CHOICE_DAMPING_H
#define PEL_CHOICE_DAMPING_H

#include "keys/value.h"
#include "pellicle/scene.h"

/* Sets the retardations of bodies that have loss factors, from their lowest frequencies, with a line to the log.
 *any: there is one. PEL_BAD_SCENE where a body has no frequency; PEL_OUT_OF_MEMORY. */
pel_status pel_scene_take_loss_factors(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene,
                                       bool *any);

#endif
