/* What keys of a scene say about others that were left out. */
#ifndef PEL_SCENE_DEFAULTS_H
#define PEL_SCENE_DEFAULTS_H

#include "scene/value.h"

/* Fills in keys whose default depends on other keys; done before the tree is compared with the table, so that all of it
   stands in the resolved scene:
       membrane.preset gives the numbers of the material;
       membrane and mass share a thickness; a membrane without mass has that of its preset or 1000 kg/m3;
       a body with a membrane or bending has no springs unless it has the key;
       a body with a membrane has bending, but under pbd and pbd-distance;
       a scene with a membrane is stepped by xpbd (or by implicit: method.h);
       an analysis is one of the method static;
       stop.time and stop.frames give the duration; a static one is that of its keys, with a step for each of them.
   Values that are wrong are left to the checker. Errors: PEL_OUT_OF_MEMORY; PEL_BAD_SCENE for an unknown preset. */
pel_status pel_scene_fill_defaults(pel_scene_reader *reader, pel_scene_value *root);

#endif
