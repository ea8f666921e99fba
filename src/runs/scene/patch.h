/* Other numbers in a scene that was read already, where no other value of the scene follows from them. */
#ifndef PEL_SCENE_PATCH_H
#define PEL_SCENE_PATCH_H

#include "pellicle/scene.h"
#include "sim/parameter.h"

/* The place of a number in the scene or an override that may be overwritten. False if the scene has to be read again
   for another value: it is not a number of the model or the simulation, or defaults of the scene may depend on it. */
bool pel_scene_patch_find(const pel_scene *scene, const char *path, pel_parameter_place *place);
/* Writes it; the text of the scene stays. False where the text is no plain value of this number. */
bool pel_scene_patch(pel_scene *scene, pel_parameter_place place, const char *text);

#endif
