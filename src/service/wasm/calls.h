/* The functions that JavaScript calls (web/pellicle/pellicle.js), over a scene in memory: numbers, zero-terminated
   texts and pointers into the memory of the module. A pointer that is returned lives until the next call with the same
   handle. One thread. Native builds compile them too, for tests. */
#ifndef PEL_WASM_CALLS_H
#define PEL_WASM_CALLS_H

#include "pellicle/base.h"

/* the linker keeps it and exports it */
#define PEL_WASM __attribute__((used, visibility("default")))

/* ---- texts ---- */

/* JSON of `size` bytes; text is null when out of memory */
typedef struct pel_wasm_text {
    const char *text;
    int32_t size;
} pel_wasm_text;

/* ---- a simulation ---- */

typedef struct pel_wasm_sim pel_wasm_sim;

/* Reads a scene (`size` bytes; `path` is its place in the file system of the module, where its meshes are) with
   overrides as after --set, and creates simulation and session. Null when out of memory; otherwise the handle is to be
   destroyed, and pel_wasm_sim_status says whether it can be used. */
PEL_WASM pel_wasm_sim *pel_wasm_sim_create(const char *path, const char *text, int32_t size,
                                           const char *const *overrides, int32_t override_count);
PEL_WASM void pel_wasm_sim_destroy(pel_wasm_sim *sim);
/* pel_status of the last call that can fail: creation, step, apply, undo, reset, field, pick, tips, record, scene */
PEL_WASM int32_t pel_wasm_sim_status(const pel_wasm_sim *sim);

/* The last failure as an object: status, message (whole), what, remedy, file, line, column. */
PEL_WASM const pel_wasm_text *pel_wasm_sim_error(pel_wasm_sim *sim);
/* Notes of the mesh reader, as an array of texts. */
PEL_WASM const pel_wasm_text *pel_wasm_sim_notes(pel_wasm_sim *sim);
/* Title, dt, bodies, tools and fields; parameters; time, step, hash, hand, tools and measures
 * (src/service/live/message.h). */
PEL_WASM const pel_wasm_text *pel_wasm_sim_hello(pel_wasm_sim *sim);
PEL_WASM const pel_wasm_text *pel_wasm_sim_parameters(pel_wasm_sim *sim);
PEL_WASM const pel_wasm_text *pel_wasm_sim_summary(pel_wasm_sim *sim);
/* The session as a scene, plain text instead of JSON. */
PEL_WASM const pel_wasm_text *pel_wasm_sim_scene(pel_wasm_sim *sim);

/* Does steps up to the first failure; returns the status. */
PEL_WASM int32_t pel_wasm_sim_step(pel_wasm_sim *sim, int32_t count);
/* A command of pellicle/session.h; returns the status. */
PEL_WASM int32_t pel_wasm_sim_apply(pel_wasm_sim *sim, const char *line);
/* Returns 1 when a mark was left, 0 when none was, -1 on failure. */
PEL_WASM int32_t pel_wasm_sim_undo(pel_wasm_sim *sim);
/* Returns the status. */
PEL_WASM int32_t pel_wasm_sim_reset(pel_wasm_sim *sim);
/* s */
PEL_WASM double pel_wasm_sim_time(const pel_wasm_sim *sim);
PEL_WASM double pel_wasm_sim_step_count(const pel_wasm_sim *sim);

/* ---- arrays; null when out of memory, counts 0 for a body that does not exist ---- */

PEL_WASM int32_t pel_wasm_sim_vertex_count(const pel_wasm_sim *sim, int32_t body);
PEL_WASM int32_t pel_wasm_sim_triangle_count(const pel_wasm_sim *sim, int32_t body);
/* (vertex_count x 3), m. The address stays while the vertex count does. */
PEL_WASM const float *pel_wasm_sim_positions(pel_wasm_sim *sim, int32_t body);
/* (triangle_count x 3) */
PEL_WASM const int32_t *pel_wasm_sim_triangles(pel_wasm_sim *sim, int32_t body);
/* grows whenever the triangles of a body change */
PEL_WASM double pel_wasm_sim_revision(const pel_wasm_sim *sim, int32_t body);
/* (vertex_count x components) of a field by its index in hello; null on failure too */
PEL_WASM const float *pel_wasm_sim_field(pel_wasm_sim *sim, int32_t field, int32_t body);
/* Casts a ray: hit (0 or 1), body, triangle, mesh vertex, distance, point (3), normal (3), corners (3), weights (3): 17
   numbers. Null on failure. */
PEL_WASM const double *pel_wasm_sim_pick(pel_wasm_sim *sim, double ox, double oy, double oz, double dx, double dy,
                                         double dz);

/* Tips of a body (pel_sim_tips): count, then for each the vertex, position (3), ahead (3), force (3), release and rate:
   12 numbers. Null on failure. The address stays until the next call. */
PEL_WASM const double *pel_wasm_sim_tips(pel_wasm_sim *sim, int32_t body);
/* Place and motion of a rigid body (pel_sim_get_rigid): mass, center (3), rotation (4), velocity (3), spin (3),
   momentum (3), angular momentum (3), kinetic energy: 21 numbers. Null for a body that deforms or does not exist. */
PEL_WASM const double *pel_wasm_sim_rigid(pel_wasm_sim *sim, int32_t body);
/* What a joint does (pel_sim_get_joint): position, speed, force (3), torque (3), load, work: 10 numbers. Null for a
   name that no joint has. */
PEL_WASM const double *pel_wasm_sim_joint(pel_wasm_sim *sim, const char *name);

/* ---- a simulation in real time, as served by `pellicle live` ---- */

typedef struct pel_wasm_live pel_wasm_live;

/* As pel_wasm_sim_create. */
PEL_WASM pel_wasm_live *pel_wasm_live_create(const char *path, const char *text, int32_t size,
                                             const char *const *overrides, int32_t override_count);
PEL_WASM void pel_wasm_live_destroy(pel_wasm_live *live);
/* PEL_OK, or why creation failed */
PEL_WASM int32_t pel_wasm_live_status(const pel_wasm_live *live);
PEL_WASM const pel_wasm_text *pel_wasm_live_error(pel_wasm_live *live);
/* A line from the page, as sent to a server: "received", those of src/service/live/player.c, and commands of a session.
 */
PEL_WASM void pel_wasm_live_line(pel_wasm_live *live, const char *line);
/* Does lines and steps that are due, for at most as long as a picture lasts; returns the seconds until the next turn.
 */
PEL_WASM double pel_wasm_live_turn(pel_wasm_live *live);
/* The next message for the page; size 0 if there is none. */
PEL_WASM const pel_wasm_text *pel_wasm_live_take(pel_wasm_live *live);
/* Whether that message is binary. */
PEL_WASM int32_t pel_wasm_live_is_binary(const pel_wasm_live *live);

#endif
