/* Reads the defs of the library out of a checked tree of values. */
#ifndef PEL_SCENE_BUILD_H
#define PEL_SCENE_BUILD_H

#include "scene/value.h"

#include "pellicle/scene.h"

/* Bodies (build_body.c): makes the meshes, resolves their paths in the tree. The meshes belong to the caller, who frees
   mesh_count of them also when this fails. */
pel_status pel_scene_build_bodies(pel_scene_reader *reader, const pel_scene_value *root, const char *folder,
                                  pel_scene *scene, pel_mesh **meshes, int32_t *mesh_count);
/* Loads, tools, contact, solver, output, duration, stop; default names of bodies are added to the tree. The meshes of
   tools are added to those of the bodies. */
pel_status pel_scene_build_sim(pel_scene_reader *reader, const pel_scene_value *root, const char *folder,
                               pel_scene *scene, pel_mesh **meshes, int32_t *mesh_count);
/* Supports of single components of all bodies (build_support.c). */
pel_status pel_scene_build_supports(pel_scene_reader *reader, const pel_scene_value *bodies, pel_scene *scene);
/* Contact (build_contact.c); a null value is none. */
pel_status pel_scene_build_contact(pel_scene_reader *reader, const pel_scene_value *value, pel_contact_def *contact);

/* The tree of a scene, as long as that lives (scene.c). */
const pel_scene_value *pel_scene_root(const pel_scene *scene);

/* input of one body */
typedef struct pel_scene_body_source {
    pel_scene_reader *reader;
    const pel_scene_value *value;
    const pel_mesh *mesh;
} pel_scene_body_source;

/* The quantity at a key of a map (nullable: 0), row_path is that of the map's row. */
pel_status pel_scene_build_quantity(const pel_scene_body_source *source, const pel_scene_value *map, const char *key,
                                    const char *row_path, pel_quantity *quantity);

/* The vertices of a region, listed even if it is all of them; a null value means none. */
pel_status pel_scene_read_vertices(const pel_scene_body_source *source, const pel_scene_value *value,
                                   const int32_t **vertices, int32_t *count);

/* Masses and springs of a body (build_tissue.c). */
pel_status pel_scene_build_tissue(const pel_scene_body_source *source, pel_body_def *body);

/* Membrane, bending, fibres and pressure of a body (build_shell.c). */
pel_status pel_scene_build_shell(const pel_scene_body_source *source, pel_shell_def *shell);

/* [[t, value], ...] with increasing times; a null list gives no keys */
pel_status pel_scene_build_keys(pel_scene_reader *reader, const pel_scene_value *list, const pel_key **keys,
                                int32_t *key_count);
/* every `name` of a list of maps stands once */
pel_status pel_scene_check_names(pel_scene_reader *reader, const pel_scene_value *list);

#endif
