/* Tools on surfaces that refine. */
#ifndef PEL_TOOL_REFINE_H
#define PEL_TOOL_REFINE_H

#include "tool/tool.h"

/* Removes references of tools to triangles and places that the last event removed. */
void pel_tools_update(pel_sim *sim, int32_t body);

#endif
