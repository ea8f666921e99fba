/* Grasps: which vertices tools hold, and their forces. */
#ifndef PEL_TOOL_GRIP_H
#define PEL_TOOL_GRIP_H

#include "tool/tool.h"

/* Moves held vertices with them. */
void pel_tools_carry(pel_sim *sim);
/* After an accepted step to `time`: grasps lose vertices that exceed their force, tools that were held back are
   counted. */
void pel_tools_end_step(pel_sim *sim, double time);

/* Holds a vertex where it is at rest in the frame of a support. */
void pel_tool_hold_at_rest(pel_sim *sim, pel_tool *tool, int32_t v);
/* Begins or ends the grasp; true if the held vertices change. */
bool pel_tool_update_grasp(pel_sim *sim, pel_tool *tool, double time, const pel_record *positions);
/* lists holders and held vertices, for methods that need them in every substep */
void pel_tools_list_held(pel_sim *sim);
/* Lets go of all, goes to a vertex, and takes the patch around it. */
void pel_tool_take_patch(pel_sim *sim, pel_tool *tool, int32_t v);
/* Takes the i-th held vertex from the list of a tool; the place stays without mobility. */
void pel_tool_let_go(pel_sim *sim, pel_tool *tool, int32_t i);

#endif
