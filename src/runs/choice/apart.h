#ifndef PEL_CHOICE_APART_H
#define PEL_CHOICE_APART_H

#include "keys/value.h"
#include "pellicle/scene.h"

/* Sets contact_is_implied; takes implied contact back, with a line in the log, where two bodies intersect at the start.
   PEL_OUT_OF_MEMORY. */
pel_status pel_scene_keep_apart(pel_scene_reader *reader, pel_scene_value *root, pel_scene *scene);
#endif
