/* Triangles near a tool. */
#ifndef PEL_TOOL_NEAR_H
#define PEL_TOOL_NEAR_H

#include "tool/tool.h"

/* Box about the tool grown by a width on all sides of its own frame, and a margin, along the axes of the world. */
pel_search_box pel_tool_box(const pel_tool *tool, double width, double margin);
/* Lists the triangles that reach within a margin of the tool's box in sim->tools->near_triangles, in rising order;
   returns how many. The sweeps depend on this order, which must not change when a triangle without contact enters or
   leaves. list: kept for this tool and kind of margin alone; it makes no difference to the result. */
int32_t pel_tool_near_triangles(pel_sim *sim, const pel_tool *tool, pel_near_list *list, const pel_record *positions,
                                double margin);

#endif
