/* Pellicle: scene files (YAML 1.2) and whole runs that leave a folder of results. In the library pellicle_scene
   (CMake target pellicle::scene), because it needs libfyaml and assimp. */
#ifndef PELLICLE_SCENE_H
#define PELLICLE_SCENE_H

#include "sim.h"

#ifdef __cplusplus
extern "C" {
#endif

/* When and what a run writes. */
typedef struct pel_output_def {
    double every;        /* s between frames; 0 = use every_frame */
    int32_t every_frame; /* steps between frames when every is 0; >= 1 */
    double checkpoint;   /* s between checkpoints; 0 = only the last good one when a run fails or is stopped */
    bool compress;       /* zlib in the .vtp files */
    bool float64;
    const char *const *fields; /* (field_count) names of vertex fields to write */
    int32_t field_count;
} pel_output_def;

/* A scene that was read, checked and resolved: defs ready for the library, arrays and meshes owned by it. */
typedef struct pel_scene {
    const char *path;
    pel_model_def model;
    pel_sim_def sim; /* sim.model is null: create the model first */
    pel_output_def output;
    double duration; /* s */
    void *inner;     /* storage */
} pel_scene;

/* Reads a scene file and its meshes (paths relative to the scene). overrides (override_count): "a.b=c" as after --set,
   with list elements as bodies.0.springs.stiffness=5 or bodies.ball.springs.stiffness=5 (by name).
   Errors: PEL_BAD_SCENE and PEL_BAD_FILE with file:line:column and remedy. Free with pel_scene_destroy. */
pel_status pel_scene_load(const char *path, const char *const *overrides, int32_t override_count, const pel_log *log,
                          pel_scene **scene, pel_error *error);
void pel_scene_destroy(pel_scene *scene);

/* The resolved scene as YAML (all defaults filled in), zero-terminated; lives as long as the scene. */
const char *pel_scene_text(const pel_scene *scene);

#ifdef __cplusplus
}
#endif
#endif
