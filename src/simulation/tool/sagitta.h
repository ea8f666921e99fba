/* Round tools on flat triangles. */
#ifndef PEL_TOOL_SAGITTA_H
#define PEL_TOOL_SAGITTA_H

#include "tool/tool.h"

/* Whether triangles at a vertex may cut into a tool: a sphere or capsule on a body with a filling by Young's modulus,
   without contact between surfaces. */
bool pel_tool_cuts(const pel_sim *sim, const pel_tool *tool, int32_t v);
/* the solid that keeps whole triangles out: pel_tool_press_solid less the sagitta where they may cut in */
pel_solid pel_tool_triangle_solid(const pel_sim *sim, const pel_tool *tool, int32_t t);

#endif
