/* Reads the defs of the library out of a checked tree of values. */
#ifndef PEL_SCENE_BUILD_H
#define PEL_SCENE_BUILD_H

#include "def/row.h"
#include "keys/value.h"

#include "pellicle/scene.h"

/* Bodies (build_body.c): makes their meshes, then those of shapes at rest, and resolves their paths in the tree. The
   meshes belong to the caller, who frees mesh_count of them also when this fails. `opened` has the cuts and seams of
   the scene. */
pel_status pel_scene_build_bodies(pel_scene_reader *reader, const pel_scene_value *root, const char *folder,
                                  pel_scene *scene, pel_mesh **meshes, int32_t *mesh_count, pel_sim_def *opened);
/* The sequence that a body follows (build_follow.c), among reader->sequences. Moves the mesh of a body that follows as
   a whole to its start. */
pel_status pel_scene_build_follow(pel_scene_reader *reader, const pel_scene_value *value, const char *folder,
                                  int32_t body, pel_mesh *mesh);
/* the support that holds the vertices that follow */
pel_status pel_scene_read_follow(pel_scene_reader *reader, const pel_scene_value *value, const pel_body_def *body,
                                 int32_t number, pel_tool_def *tool);
/* Attachments and stitches, after tools (build_tie.c). */
pel_status pel_scene_build_ties(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene);
/* the index of the body that a value names */
pel_status pel_scene_find_body(pel_scene_reader *reader, const pel_scene_value *name, const pel_model_def *model,
                               int32_t *body);
/* A map without body means the only one, whose name is added to the tree; `what` is the word for the map. */
pel_status pel_scene_fill_body(pel_scene_reader *reader, pel_scene_value *map, const pel_model_def *model,
                               const char *what);
/* Joints, after bodies (build_tie.c). */
pel_status pel_scene_build_joints(pel_scene_reader *reader, const pel_scene_value *root, pel_scene *scene);
/* `until` is after `from` */
pel_status pel_scene_check_times(pel_scene_reader *reader, const pel_scene_value *value, double from, double until);

/* a body while its mesh is made */
typedef struct pel_scene_owner {
    const char *name;
    int32_t body, count; /* of all bodies */
    pel_mesh *mesh;
} pel_scene_owner;
/* Makes the mesh of a body that can tear finer by `tear.level`, before cuts and regions are read (build_cuts.c).
   PEL_BAD_SCENE where the body cannot have more vertices; PEL_OUT_OF_MEMORY. */
pel_status pel_scene_refine_torn(pel_scene_reader *reader, const pel_scene_value *root, const pel_scene_value *body,
                                 pel_mesh **mesh);
/* Cuts and seams (build_cuts.c): room for all of them; those of one body, which move vertices of its mesh onto their
   paths, before anything else reads it; then whether each has found its body. */
pel_status pel_scene_take_cuts(pel_scene_reader *reader, const pel_scene_value *root, pel_sim_def *sim);
pel_status pel_scene_build_cuts(pel_scene_reader *reader, const pel_scene_value *root, const pel_scene_owner *of,
                                pel_sim_def *sim);
pel_status pel_scene_check_cuts(pel_scene_reader *reader, const pel_scene_value *root, const pel_scene *scene);
/* Loads, tools, contact, solver, output, duration, stop; default names of bodies are added to the tree. The meshes of
   tools are added to those of the bodies. */
pel_status pel_scene_build_sim(pel_scene_reader *reader, const pel_scene_value *root, const char *folder,
                               pel_scene *scene, pel_mesh **meshes, int32_t *mesh_count);
/* Supports of single components of all bodies (build_support.c). */
pel_status pel_scene_build_supports(pel_scene_reader *reader, const pel_scene_value *bodies, pel_scene *scene);
/* The tree of a scene, as long as that lives (scene.c). */
const pel_scene_value *pel_scene_root(const pel_scene *scene);

/* a part of a scene, such as a body */
typedef struct pel_scene_part {
    pel_scene_reader *reader;
    const pel_scene_value *value;
    const pel_mesh *mesh; /* of the fields of numbers that vary over a body; null = none */
} pel_scene_part;

/* Reads all numbers, words, vectors and keys of a def that are given (members.c). Other members keep their values. */
pel_status pel_scene_read_members(const pel_scene_part *part, pel_def_kind kind, void *def);

/* The vertices of a region, listed even if it is all of them; a null value means none. */
pel_status pel_scene_read_vertices(const pel_scene_part *source, const pel_scene_value *value, const int32_t **vertices,
                                   int32_t *count);

/* Replaces the mesh of a body with `volume` by one filled with tetrahedra, with a line to the log (build_volume.c).
   PEL_BAD_SCENE where it cannot be filled; PEL_OUT_OF_MEMORY. */
pel_status pel_scene_fill_mesh(pel_scene_reader *reader, const pel_scene_value *body, pel_mesh **mesh);

/* The kind of mass of a body, and automatic thicknesses and depths (build_tissue.c). */
pel_status pel_scene_build_tissue(const pel_scene_part *source, pel_body_def *body);

/* Fibres of a body, and the kind and region of its pressure (build_shell.c). */
pel_status pel_scene_build_shell(const pel_scene_part *source, pel_shell_def *shell);

/* Makes the meshes (body_count and more) of bodies with `refine: auto` finer around small loads and tools; *any: there
   is such a body, and what was built with its old mesh is void (fine_spots.c). PEL_BAD_SCENE for bodies that are
   neither shells nor solids; PEL_OUT_OF_MEMORY. */
pel_status pel_scene_refine_meshes(pel_scene_reader *reader, pel_scene_value *root, const pel_scene *scene,
                                   pel_mesh **meshes, bool *any);
/* A body has `refine: auto`. */
bool pel_scene_is_fine(const pel_scene *scene, int32_t body);
/* PEL_BAD_SCENE for loads per vertex that have more vertices than before. */
pel_status pel_scene_check_refined_loads(pel_scene_reader *reader, const pel_scene_value *root,
                                         const pel_sim_def *before, const pel_sim_def *after);

/* Changes the meshes (mesh_count) of the bodies by the buckling mode of `imperfection` (imperfection.c). PEL_BAD_SCENE
   where there is no such mode; PEL_OUT_OF_MEMORY. */
pel_status pel_scene_make_imperfect(pel_scene_reader *reader, pel_scene_value *root, pel_scene *scene,
                                    pel_mesh *const *meshes, int32_t mesh_count);

/* every `name` of a list of maps stands once */
pel_status pel_scene_check_names(pel_scene_reader *reader, const pel_scene_value *list);

#endif
