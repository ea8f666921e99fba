/* A scene that can go elsewhere with its meshes. */
#ifndef PEL_SCENE_PORTABLE_H
#define PEL_SCENE_PORTABLE_H

#include "pellicle/scene.h"

/* pel_scene_text with the mesh files called names[i] (mesh_file_count) instead of by their absolute paths: a new text
   (pel_free), null when out of memory. */
char *pel_scene_portable_text(const pel_scene *scene, const char *const *names);

#endif
