/* The forceps of the hand. */
#ifndef PEL_SESSION_GRASP_H
#define PEL_SESSION_GRASP_H

#include "pellicle/live.h"
#include "pellicle/scene.h"

/* Adds a tool that holds one connected patch of the surface around a hit, at least the nearest vertex. Forceps of the
   scene that lead a tear let go and leave.
   anew: with such forceps the new ones grasp the flap anew as they did.
   def: with the name and the radius, which becomes larger if no vertex is within it; key: at the hit.
   PEL_BAD_ARGUMENT, PEL_OUT_OF_MEMORY: nothing changes then. */
pel_status pel_grasp_begin(pel_sim *sim, const pel_scene *scene, const pel_pick_hit *hit, bool anew, pel_tool_def *def,
                           pel_pose_key *key, pel_error *error);

#endif
