/* Creation of tools from their defs. */
#ifndef PEL_TOOL_CREATE_H
#define PEL_TOOL_CREATE_H

#include "tool/tool.h"

pel_status pel_tools_create(pel_sim *sim, const pel_tool_def *defs, int32_t count, pel_error *error);
void pel_tools_destroy(pel_sim *sim);
/* Takes the numbers of the grasp of a def that differs in no other member, if they are right. PEL_BAD_ARGUMENT. */
pel_status pel_tool_regrasp(pel_sim *sim, int32_t tool, const pel_tool_def *def, pel_error *error);

#endif
