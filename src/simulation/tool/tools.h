/* Tools over a step. */
#ifndef PEL_TOOL_TOOLS_H
#define PEL_TOOL_TOOLS_H

#include "stage/transfer.h"
#include "tool/tool.h"

/* Begins a step: sets the wanted poses at `time` and updates grasps. The tools are moved to their wanted poses. */
void pel_tools_begin(pel_sim *sim, double time);
/* Moves the tools to the end of a substep, at a share of their motion in this step, and finds where held vertices go.
 */
void pel_tools_place(pel_sim *sim, double share);
/* A grasp begins or ends in the coming part of the step. */
bool pel_tools_grasps_change(const pel_sim *sim);
/* Before a substep but the first: grasps that begin or end, by the time in its middle. */
void pel_tools_follow_grasps(pel_sim *sim, double time);
/* Moves the tools and their held vertices to the wanted poses. */
void pel_tools_move(pel_sim *sim, double time);
/* Returns them to the start of the step, if they have moved. */
void pel_tools_return(pel_sim *sim);
/* Moves the new positions out of the tools, or of spheres and capsules only. longest: spring length bound. */
void pel_tools_press(pel_sim *sim, double longest, bool only_round);

/* a pel_transfer_part of one tool */
void pel_tool_transfer(pel_cursor *at, const pel_sim *sim, int32_t tool);
/* After all tools were loaded: false, and nothing touched or held, when the numbers of a tool are out of range. */
bool pel_tools_restore(pel_sim *sim);

#endif
