/* Liquids that fill bodies. */
#ifndef PEL_CHOICE_FLUID_H
#define PEL_CHOICE_FLUID_H

#include "keys/value.h"
#include "pellicle/scene.h"

/* Keeps the volume of bodies that a liquid fills, where the scene gives no `pressure`, and of closed bodies for which
   it gives no material (defaults.c), with a line to the log for each. PEL_OUT_OF_MEMORY. */
pel_status pel_scene_keep_fillings(pel_scene_reader *reader, pel_scene_value *root, const pel_scene *scene);

#endif
