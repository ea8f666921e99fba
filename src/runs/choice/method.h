/* The method of a scene that leaves it to the program. */
#ifndef PEL_CHOICE_METHOD_H
#define PEL_CHOICE_METHOD_H

#include "keys/value.h"
#include "pellicle/scene.h"

/* Sets the method to implicit, in the def and in the tree, with a line to the log: where a step of implicit costs less
   than the substeps that xpbd needs, or, if max_substeps is written or surfaces refine, where those are more than
   max_substeps; and where the scene has supports, moments on edges or mid-edge bending, which xpbd lacks. Where xpbd
   needs more substeps than max_substeps by default and is cheaper, it gets as many as cost less than implicit. Only in
   scenes that give neither the method nor substeps or iterations, and no strain limit, region that caves in or rigid
   sphere, which implicit lacks.
   PEL_OUT_OF_MEMORY; other errors of the model are left to its creation. */
pel_status pel_scene_choose_method(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene);

/* a rigid body is a sphere, which methods that minimise lack */
bool pel_scene_has_balls(const pel_scene *scene);

/* systems of a step of static, at least */
enum { PEL_STATIC_SYSTEMS = 3 };

/* ms of one core, of a usual step of implicit, from counts; where bodies jam it takes longer */
double pel_scene_step_cost(const pel_scene *scene);
/* ms of one core, of a substep of xpbd or a step of explicit, from counts */
double pel_scene_substep_cost(const pel_scene *scene);
/* Tells how long the run takes, in the log, where that is long: under static, implicit and xpbd. */
void pel_scene_tell_cost(pel_scene_reader *reader, const pel_scene *scene);

/* If the method solves for the edges, bodies without an explicit bending model get mid-edge bending, in the def and in
   the tree. Regions that curl need hinges. */
void pel_scene_choose_bending(const pel_scene_value *root, pel_scene *scene);

#endif
