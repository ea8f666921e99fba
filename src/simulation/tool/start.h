/* Tools that start in a body. */
#ifndef PEL_TOOL_START_H
#define PEL_TOOL_START_H

#include "tool/tool.h"

/* PEL_BAD_ARGUMENT for a tool that is in a body at present. */
pel_status pel_tool_check_start(pel_sim *sim, int32_t index, pel_error *error);
/* True when a point lies inside a closed body that is filled. A membrane without volumetric springs is a bag: a tool in
   it is its content, which carries it along. */
bool pel_tool_starts_within(const pel_sim *sim, const double point[3], int32_t body);

/* PEL_BAD_ARGUMENT with that way */
pel_status pel_tool_refuse_inside(const pel_sim *sim, int32_t index, int32_t body, pel_error *error);
/* the same where a solid starts inside a body */
pel_status pel_tool_check_outside(const pel_sim *sim, int32_t index, pel_error *error);

#endif
