/* The step of a scene that leaves it to the program. */
#ifndef PEL_SCENE_TIME_STEP_H
#define PEL_SCENE_TIME_STEP_H

#include "keys/value.h"
#include "pellicle/scene.h"

/* Sets dt of the method implicit, in the def and in the tree, with a line to the log, where motion goes on that steps
   of the default would not resolve: neither tools, contact, drag nor damping, and a shorter vibration or load. Only in
   scenes that give no dt and count no steps. PEL_OUT_OF_MEMORY. */
pel_status pel_scene_choose_dt(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene);

#endif
