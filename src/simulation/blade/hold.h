/* Blades and hooks: what they hold of a surface, and the force at which they cut it or let it go. */
#ifndef PEL_BLADE_HOLD_H
#define PEL_BLADE_HOLD_H

#include "tool/tool.h"

/* Keeps where tools and surfaces are before a step, and sets the forces of blades that drag. */
void pel_blades_begin(pel_sim *sim);
/* Adds these forces to those on the tools, at the new positions. */
void pel_blades_read(pel_sim *sim);
/* The edge at a share of the last step, 0 at its start and 1 at present; of scissors the segment that cuts. */
void pel_blade_edge_at(const pel_tool *tool, const pel_pose *pose, double at, double edge[2][3]);
/* Scissors are closed as their keys say at present; returns whether they close on. True of blades and hooks. */
bool pel_blade_close(const pel_sim *sim, pel_tool *tool);
/* whether it needs a force, and where it is a hook */
bool pel_blade_resists(const pel_sim *sim, const pel_tool *tool);
bool pel_blade_is_hook(const pel_sim *sim, const pel_tool *tool);

/* Holds a vertex of a mesh where it is; nothing if it cannot be held. */
void pel_blade_take(pel_sim *sim, pel_tool *tool, int32_t body, int32_t vertex);
void pel_blade_let_go(pel_sim *sim, pel_tool *tool, int32_t body, int32_t vertex);
/* Holds the vertex of a tip as the blade held the one before it: at the force that it had, or at none. */
void pel_blade_take_on(pel_sim *sim, pel_tool *tool, pel_blade_tip *tip);
/* After a step: the blade slides where the force on it exceeds `limit` [N] (tips), forgets where it is no more, and
   lets go what it pulls back. */
void pel_blade_slide(pel_sim *sim, pel_tool *tool,
                     double (*limit)(const pel_sim *, const pel_tool *, const pel_blade_tip *));
/* Sum of the forces [N] on vertices that are held without being tips: where the blade presses. */
double pel_blade_pressing(const pel_sim *sim, const pel_tool *tool);
/* Releases those. */
void pel_blade_pierce(pel_sim *sim, pel_tool *tool);

#endif
