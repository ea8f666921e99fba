/* Pellicle: scene files (YAML 1.2 or JSON): reading them into defs, and listings of the table of keys. In the library
   pellicle_scene (CMake target pellicle::scene), because it needs libfyaml and assimp. Runs are in run.h. */
#ifndef PELLICLE_SCENE_H
#define PELLICLE_SCENE_H

#include "sim_step.h"

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Output of a run. */
typedef struct pel_output_def {
    double every;        /* s between frames; 0 = use every_frame */
    int32_t every_frame; /* steps between frames when every is 0; >= 1 */
    double checkpoint;   /* s between checkpoints; 0 = only the last good one when a run fails or is stopped */
    bool compress;       /* zlib in the .vtp files */
    bool float64;
    const char *const *fields; /* (field_count) names of vertex fields to write */
    int32_t field_count;
} pel_output_def;

/* A command of a recorded session (pellicle/session.h). */
typedef struct pel_scene_command {
    int64_t step;               /* number of steps at the end of the run */
    const char *line;           /* the command */
    int32_t at_line, at_column; /* its place in the scene, from 1 */
} pel_scene_command;

/* A scene that was read, checked and resolved: defs ready for the library, arrays and meshes owned by it. */
typedef struct pel_scene {
    const char *path;
    const char *title; /* "" if there is none */
    int32_t up;        /* axis that points up: 0 x, 1 y, 2 z */
    pel_model_def model;
    pel_sim_def sim; /* sim.model is null: create the model first */
    pel_output_def output;
    bool hinges_are_implied;       /* no body names its model of bending */
    bool contact_is_implied;       /* several bodies and no `contact`: they touch each other, but not themselves */
    int32_t needed_substeps;       /* of xpbd in a step, by which its cost is told; 0 = not known */
    double duration;               /* s */
    int32_t imperfection_mode;     /* buckling mode that the meshes have been changed by, from 1 */
    double imperfection_amplitude; /* m, its largest displacement; 0 = none */
    double rest_speed;         /* m/s; a run ends if loads and tools have ended and no vertex is faster; 0 = never */
    double least_volume_ratio; /* a run ends if the ratio of the volume to that at rest is smaller; 0 = never */
    bool stop_at_contact;      /* a run ends if a body touches itself or another body */
    int64_t frame_limit;       /* steps after which a run ends; 0 = no limit */
    double time_limit;         /* s, simulated time after which a run ends; 0 = no limit */
    const pel_scene_command *session; /* (session_count) steps do not decrease; empty = none */
    int32_t session_count;
    const char *const *mesh_files; /* (mesh_file_count) absolute paths of the meshes that were read */
    int32_t mesh_file_count;
    void *inner; /* storage */
} pel_scene;

/* Reads a scene file (YAML 1.2 or JSON) and its meshes; paths are relative to the scene. overrides (override_count,
   nullable): "a.b=c" as after --set, applied in order, with list elements as bodies.0.springs.stiffness=5 or
   bodies.ball.springs.stiffness=5 (by name). The number after the last element adds one; an alternative replaces the
   others (bodies.0.mesh.file=x.ply replaces a shape); an empty value or null removes the key. log (nullable) receives
   the notes of the mesh reader. Errors: PEL_BAD_SCENE with file:line:column (or the override as file) and remedy;
   PEL_BAD_FILE for the scene itself and, at its place in the scene, for a mesh file; errors of the mesh reader;
   PEL_OUT_OF_MEMORY. On failure *scene is null. Free with pel_scene_destroy, which permits null. */
PEL_API pel_status pel_scene_load(const char *path, const char *const *overrides, int32_t override_count,
                                  const pel_log *log, pel_scene **scene, pel_error *error);
PEL_API void pel_scene_destroy(pel_scene *scene);

/* The same from text (size bytes). path is its name in messages; paths of meshes are relative to the folder of path. */
PEL_API pel_status pel_scene_parse(const char *path, const char *text, size_t size, const char *const *overrides,
                                   int32_t override_count, const pel_log *log, pel_scene **scene, pel_error *error);

/* The resolved scene as YAML, with the values of all defaults and absolute paths of meshes: reading it from any folder
   gives the same scene and the same text. Zero-terminated; lives as long as the scene. */
PEL_API const char *pel_scene_text(const pel_scene *scene);

/* Hz: the lowest frequency of a body about its rest, alone, with its pins and its supports where they are at the end of
   the scene; without loads, pressure, tools and contact. A modal analysis, whose status is returned; 0 if it fails or
   nothing vibrates. PEL_BAD_ARGUMENT for a body that does not exist. */
PEL_API pel_status pel_scene_frequency(const pel_scene *scene, int32_t body, double *frequency);

/* Adds the place in the scene to an error of pel_model_create or pel_sim_create: that of the body, load or tool in the
   error, that of alpha or dt for PEL_UNSTABLE, otherwise only the file. Other errors do not change. */
PEL_API void pel_scene_locate(const pel_scene *scene, pel_error *error);

/* Listings of the table of scene keys. Each function writes to an open file and flushes it. Errors: PEL_BAD_FILE,
   PEL_OUT_OF_MEMORY. */

/* JSON Schema (draft 7) of scene files, with which editors check and complete keys. */
PEL_API pel_status pel_scene_write_schema(FILE *file, pel_error *error);
/* The reference page of all keys in Markdown. */
PEL_API pel_status pel_scene_write_reference(FILE *file, pel_error *error);
/* All paths for --set, one per line, with 0 for list elements: for completion in a shell. */
PEL_API pel_status pel_scene_write_parameters(FILE *file, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
