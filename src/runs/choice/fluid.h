/* Liquids that fill bodies. */
#ifndef PEL_CHOICE_FLUID_H
#define PEL_CHOICE_FLUID_H

#include "keys/value.h"
#include "pellicle/scene.h"

/* Keeps the volume of bodies that a liquid fills, where the scene gives no `pressure`, with a line to the log. */
void pel_scene_keep_fillings(pel_scene_reader *reader, const pel_scene *scene);

#endif
