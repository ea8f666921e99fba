/* Constraints against tools. */
#ifndef PEL_CONSTRAINT_CONSTRAINT_TOOL_H
#define PEL_CONSTRAINT_CONSTRAINT_TOOL_H

#include "constraint/frame.h"

/* Constraints against all tools at the end of the step and the present poses, in place of all that were known; those
   that were known keep their loads. */
pel_status pel_minimise_contacts_find_tools(pel_sim *sim, pel_error *error);
/* Vertices that tools touch, and reactions. */
void pel_minimise_contacts_read(pel_sim *sim);

#endif
