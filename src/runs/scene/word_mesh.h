/* Meshes named by one word, in addition to those of a scene: pressing tools of a hand. */
#ifndef PEL_SCENE_WORD_MESH_H
#define PEL_SCENE_WORD_MESH_H

#include "pellicle/mesh.h"
#include "pellicle/scene.h"

/* Whether the word names a mesh: a closed built-in shape ("torus"), or a file by its ending (OBJ, PLY, STL,
   OFF, VTP). */
bool pel_word_mesh_is_one(const char *word);
/* Makes the mesh: a shape with its default sizes, or the file, from the folder of the scene unless the path is
   absolute. Spaces of a path are written as %20. Writes a word that names it from any folder, a file by its absolute
   path, to full (size). Free with pel_mesh_destroy; null on failure. PEL_BAD_ARGUMENT (no such shape, a path that is
   too long), PEL_BAD_FILE, errors of pel_mesh_import. */
pel_status pel_word_mesh_create(const pel_scene *scene, const char *word, pel_mesh **mesh, char *full, size_t size,
                                pel_error *error);
/* Calls take for each word that suits the scene: the closed shapes, then the mesh files of its folder, 100 at most, in
   any order. The word lives during the call. */
void pel_word_mesh_list(const pel_scene *scene, void (*take)(void *user, const char *word), void *user);

#endif
