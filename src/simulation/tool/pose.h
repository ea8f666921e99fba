/* Poses of tools: keys, and the pose of a step. */
#ifndef PEL_TOOL_POSE_H
#define PEL_TOOL_POSE_H

#include "tool/tool.h"

/* finite, with a unit quaternion and not too many turns */
bool pel_tool_is_key(const pel_pose_key *key);
/* after the keys are there */
void pel_tool_sum_spins(pel_tool *tool);
/* a keyed pose at a time */
pel_pose pel_tool_pose_at(const pel_tool *tool, double time);
/* the pose that a tool moves to in the step to `time` */
pel_pose pel_tool_next_pose(const pel_sim *sim, const pel_tool *tool, double time);

/* the solid that the body of a vertex is kept out of */
pel_solid pel_tool_press_solid(const pel_sim *sim, const pel_tool *tool, int32_t v);

#endif
