/* Tools stop surfaces whose method has velocities of its own. */
#ifndef PEL_TOOL_STOP_H
#define PEL_TOOL_STOP_H

#include "tool/tool.h"

/* Stops what would enter a tool by the end of the step: velocities, positions and forces. The first near_count of
   sim->tools->near_triangles are near. What is in the tool from the start of the step on keeps its depth. True when
   anything moved; false too if memory lacks, which leaves the pushes of pel_tool_press. */
bool pel_tool_stop(pel_sim *sim, pel_tool *tool, int32_t near_count);

#endif
