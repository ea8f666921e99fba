/* Defaults that depend on other keys of a scene. */
#ifndef PEL_SCENE_DEFAULTS_H
#define PEL_SCENE_DEFAULTS_H

#include "keys/value.h"

/* Fills in keys whose default depends on other keys, before the tree is checked against the table, so that the resolved
   scene has all of them:
       membrane.preset gives the numbers of the material; membrane and mass share a thickness; a membrane without mass
       has the density of its preset or 1000 kg/m3; a body with a membrane or bending has no springs unless it has the
       key; a body with a membrane has bending, except under pbd and pbd-distance; a scene with a membrane is stepped by
       xpbd (or by implicit: method.h); several bodies have contact between them (apart.c); an analysis uses the method
   static; stop.time and stop.frames give the duration; the duration of a static run is that of its keys, with a step
   for each of them. The checker reports wrong values. Errors: PEL_OUT_OF_MEMORY; PEL_BAD_SCENE for an unknown preset.
 */
pel_status pel_scene_fill_defaults(pel_scene_reader *reader, pel_scene_value *root);

/* Removes the defaults of keys that rigid bodies refuse, so that the printed scene can be read. */
void pel_scene_forget_soft_keys(pel_scene_value *root);

#endif
