/* Blades and hooks that are refused. */
#ifndef PEL_BLADE_CHECK_H
#define PEL_BLADE_CHECK_H

#include "tool/tool.h"

/* Checks all of them and makes room for their forces. PEL_BAD_ARGUMENT for an edge without length, numbers out of
   range, bodies that refine or cannot be cut, and an edge that is in a surface at the start. */
pel_status pel_blades_create(pel_sim *sim, pel_error *error);
/* Whether the edge of a tool is in a surface: PEL_BAD_ARGUMENT with the place. */
pel_status pel_blade_check_start(const pel_sim *sim, int32_t tool, pel_error *error);

#endif
