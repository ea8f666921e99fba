/* Places and sizes that scenes give by the bodies at rest: `position: { above: highest }`, `radius: auto`, rays. */
#ifndef PEL_SCENE_PLACE_H
#define PEL_SCENE_PLACE_H

#include "keys/value.h"

#include "pellicle/scene.h"
#include "pellicle/tool.h"

/* The vertex that a checked number names, by the numbers of the file; PEL_BAD_SCENE at its place if there is none. */
pel_status pel_scene_vertex(pel_scene_reader *reader, const pel_scene_value *value, const pel_mesh *mesh,
                            int32_t *vertex);

/* Where a ray first meets bodies (mesh_count), and the direction of their surface there, against the ray. normal (3)
   may be null. PEL_BAD_SCENE at the ray's place if it meets none. */
pel_status pel_scene_cast(pel_scene_reader *reader, const pel_scene_value *ray, const pel_mesh *const *meshes,
                          int32_t mesh_count, double point[3], double normal[3]);

/* Replaces `auto` in the dimensions of a tool by numbers. */
pel_status pel_scene_size_tool(pel_scene_reader *reader, pel_scene_value *tool, const pel_model_def *model);

/* Replaces a place above or below a body by the center (3) of the tool, whose numbers have been read and which is
   turned by `rotation`, a vector along the axis with the angle as its length. With contact it stands off by at least
   the thickness that contact keeps, unless it is to be pressed in. */
pel_status pel_scene_place_tool(pel_scene_reader *reader, pel_scene_value *position, const pel_scene *scene,
                                const pel_tool_def *tool, const double rotation[3]);

#endif
