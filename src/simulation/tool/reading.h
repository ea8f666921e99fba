/* Forces on tools. */
#ifndef PEL_TOOL_READING_H
#define PEL_TOOL_READING_H

#include "tool/tool.h"

/* its number, -1 = no such name */
int32_t pel_sim_find_tool(const pel_sim *sim, const char *name);
/* Reads the forces of the step. */
void pel_tools_read(pel_sim *sim, double time);

/* Point of action of the mean force of a step on a held vertex: the mean of its arms at both ends of the step. With the
   last arm alone, an inward pull on a turning rim would drive the rotation. */
void pel_tool_mean_point(const pel_sim *sim, const pel_tool *tool, int32_t v, double point[3]);

#endif
