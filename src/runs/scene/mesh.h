/* The meshes of a scene: shapes and files, moved into place. */
#ifndef PEL_SCENE_MESH_H
#define PEL_SCENE_MESH_H

#include "keys/value.h"

#include "pellicle/mesh.h"

/* Makes the mesh that the map `value` describes; a relative path starts at folder and becomes an absolute one in the
   tree. Free with pel_mesh_destroy; null on failure. Takes the next one of reader->made instead where that is given.
   */
pel_status pel_scene_mesh(pel_scene_reader *reader, pel_scene_value *value, const char *folder, pel_mesh **mesh);

/* Makes the path of an existing file in the tree absolute; `what` is the word for it in errors. */
pel_status pel_scene_resolve_path(pel_scene_reader *reader, const char *what, pel_scene_value *file,
                                  const char *folder);
/* The scale, rotation and translation of the map of a mesh. */
pel_status pel_scene_transform(pel_scene_reader *reader, const pel_scene_value *value, pel_transform *transform);

/* The numbers in the file, if its mesh was welded, of the vertices of a mesh that was made finer. */
pel_status pel_scene_keep_welding(pel_scene_reader *reader, const pel_mesh *mesh, pel_mesh *fine);

/* The scalar field of that name; PEL_BAD_SCENE at `name`, with the nearest name, if there is none. */
pel_status pel_scene_field(pel_scene_reader *reader, const pel_scene_value *name, const pel_mesh *mesh,
                           const double **values);

/* PEL_BAD_SCENE at the name of a field or group that a filled mesh has no more. */
pel_status pel_scene_fail_filled(pel_scene_reader *reader, const pel_scene_value *name, const char *what);

/* The rotation { axis, angle } as a quaternion x, y, z, w; null means none. */
pel_status pel_scene_rotation(pel_scene_reader *reader, const pel_scene_value *value, double rotation[4]);
/* The same as a rotation vector [rad], with whole turns kept. */
pel_status pel_scene_rotation_vector(pel_scene_reader *reader, const pel_scene_value *value, double vector[3]);

#endif
