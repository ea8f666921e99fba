/* Incisions: the way of a blade through a surface in a step, and the edges that open along it. */
#ifndef PEL_BLADE_INCISION_H
#define PEL_BLADE_INCISION_H

#include "tear/growth.h"
#include "tool/tool.h"

/* What a blade does to one body after a step. */
typedef struct pel_incision {
    pel_growth growth;                  /* edges that open; none = the rest is as it was */
    pel_blade_tip tips[PEL_BLADE_TIPS]; /* (tip_count) of all bodies, once these edges are open */
    int32_t tip_count;
} pel_incision;

/* Finds it from the places of blade and surface before the step (pel_blades_begin) and now. A blade that resists takes
   hold of the vertices that it comes to; a hook takes hold of rims alone. Free with pel_incision_clear, also on
   failure. PEL_BAD_ARGUMENT if the blade is in the surface at more places than it has tips, PEL_OUT_OF_MEMORY. */
pel_status pel_incision_find(pel_sim *sim, int32_t tool, int32_t body, pel_incision *incision, pel_error *error);
void pel_incision_clear(pel_incision *incision);

/* N, at which a blade cuts on at a tip, pierces the surface, or a hook lets go. */
double pel_incision_limit(const pel_sim *sim, const pel_tool *tool, const pel_blade_tip *tip);

#endif
