/* Forces on the supports of bodies. */
#ifndef PEL_TOOL_SUPPORT_H
#define PEL_TOOL_SUPPORT_H

#include "stage/transfer.h"
#include "tool/tool.h"

/* After tools and supports of single components. PEL_OUT_OF_MEMORY. */
pel_status pel_supports_create(pel_sim *sim, pel_error *error);
void pel_supports_destroy(pel_sim *sim);
/* Reads the forces of supports after a part of a step, before it is accepted. */
void pel_supports_read(pel_sim *sim, double time);
/* Reactions (pel_sim_vertex_count x 3) [N] on the vertices of a body. Their sum is minus the force of
 * pel_sim_get_support. */
void pel_supports_get_reactions(pel_sim *sim, int32_t body, double *reactions);

/* a pel_transfer_part: reactions, and readings of supports of single components */
void pel_supports_transfer(pel_cursor *at, const pel_sim *sim, int32_t unused);
/* After a change: clears the reactions on vertices that were pinned and are not now. */
void pel_supports_release(const pel_sim *from, const pel_sim *to);

#endif
