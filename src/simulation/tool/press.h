/* Tools push surfaces out of themselves. */
#ifndef PEL_TOOL_PRESS_H
#define PEL_TOOL_PRESS_H

#include "tool/pose.h"
#include "tool/tool.h"

/* the position, or what else a record keeps of vertices, at a point of a triangle */
void pel_tool_point(const pel_record *values, const int32_t vertices[3], const double weights[3], double point[3]);
/* the solid that the body of a vertex is kept out of */
pel_solid pel_tool_press_solid(const pel_sim *sim, const pel_tool *tool, int32_t v);
/* Depth of one triangle in the tool, with the deepest point and the way out in the tool's frame (see pel_solid_depth).
 */
double pel_tool_triangle_depth(const pel_sim *sim, const pel_tool *tool, const pel_solid *solid,
                               const pel_record *positions, int32_t t, double weights[3], double normal[3]);
/* Keeps the half space in which a triangle has to stay during the next step; the latest one of a triangle counts. */
void pel_tool_remember(const pel_sim *sim, pel_tool *tool, const pel_contact_plane *plane);
/* the depth that pressing leaves [m] */
double pel_tool_press_tolerance(const pel_sim *sim, const pel_tool *tool);
/* Coulomb's coefficient between a tool and the body of a vertex, 0 without contact */
double pel_sim_friction(const pel_sim *sim, const pel_tool *tool, int32_t v);
/* sum w b^2 of a point of a triangle: 0 where what cannot move holds nearly all of it, since the rest would be thrown
 */
double pel_tool_inertia(const pel_sim *sim, const int32_t vertices[3], const double weights[3]);
/* Pushes the new positions out of one tool; true when anything moved. longest: bound of the length of an edge. */
bool pel_tool_press(pel_sim *sim, pel_tool *tool, double longest);

#endif
