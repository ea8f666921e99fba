/* Supports that follow a sequence of positions: where a held vertex goes. */
#ifndef PEL_TOOL_FOLLOW_H
#define PEL_TOOL_FOLLOW_H

#include "tool/tool.h"

/* Takes a share of the sequence of a support; nothing without one. PEL_BAD_ARGUMENT for another number of vertices, a
   body that refines, and a start far from the body at rest; PEL_OUT_OF_MEMORY. */
pel_status pel_tool_follow_create(pel_sim *sim, const pel_tool_def *def, int32_t index, pel_error *error);
void pel_tool_follow_destroy(pel_tool *tool);

/* m, how far a pose is along the sequence at a time [s]; 0 without one. */
double pel_tool_along(const pel_tool *tool, double time);

/* The place of a held vertex in the frame of the tool; `offset` is its place in the frame, or with a sequence the place
   less that of the sequence. */
typedef struct pel_tool_path {
    const pel_tool *tool;
    const pel_pose *pose;
    pel_sequence_moment moment;
} pel_tool_path;

pel_tool_path pel_tool_path_at(const pel_tool *tool, const pel_pose *pose);
/* where the i-th held vertex of the tool is then */
void pel_tool_path_target(const pel_tool_path *path, int32_t i, double target[3]);
/* the anchor of a vertex that is at x then */
void pel_tool_path_anchor(const pel_tool_path *path, int32_t v, const double x[3], double anchor[3]);

/* J: work of the tools on vertices that follow a sequence, beyond that of their poses, in the part of a step that ends
   at the new positions. Books the present forces for methods without velocities. */
double pel_tools_follow_work(pel_sim *sim);

#endif
