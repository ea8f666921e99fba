/* The method of a scene that leaves it to the program. */
#ifndef PEL_SCENE_METHOD_H
#define PEL_SCENE_METHOD_H

#include "pellicle/scene.h"
#include "scene/value.h"

/* Where xpbd would need more than max_substeps, the method becomes implicit, or descent where the surface refines and
   the bodies have a state of rest; and implicit where a step of it costs less than the substeps that xpbd needs, unless
   max_substeps is written; and implicit where the scene has what xpbd does not know (supports, moments on edges,
   mid-edge bending): in the def and in the tree, with a line to the log. Only in scenes that give neither the method
   nor substeps or iterations. PEL_OUT_OF_MEMORY; other errors of the model are left to its creation. */
pel_status pel_scene_choose_method(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene);

/* Where the method solves for the edges, bodies whose bending has no model of their own take mid-edge bending: in the
   def and in the tree. Regions that curl need hinges. */
void pel_scene_choose_bending(const pel_scene_value *root, pel_scene *scene);

#endif
