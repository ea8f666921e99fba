/* Forceps that lead a tear around an axis. */
#ifndef PEL_TEAR_FORCEPS_H
#define PEL_TEAR_FORCEPS_H

#include "stage/stage.h"

/* Before a step: where the tools that lead a tear go in it, and what they grasp anew. */
void pel_forceps_lead(pel_sim *sim);

/* The first tool that leads a tear; null = none. */
static inline const pel_tool_def *pel_forceps_first(const pel_sim_def *def)
{
    for (int32_t t = 0; t < def->tool_count; t++)
        if (def->tools[t].leads)
            return &def->tools[t];
    return NULL;
}

#endif
