/* Pellicle: a simulation: its def, steps, state, setters and snapshots. */
#ifndef PELLICLE_SIM_STEP_H
#define PELLICLE_SIM_STEP_H

#include "contact.h"
#include "joint.h"
#include "load.h"
#include "model.h"
#include "solver.h"
#include "support.h"
#include "tie.h"
#include "tool.h"
#include "wind.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pel_sim pel_sim;

/* A cut of a surface along edges at a time (pellicle/tear.h has cuts at once, and what is asked of a path). */
typedef struct pel_cut_def {
    double at; /* s: at the start of the first step that begins then or later; 0 = of the first one */
    int32_t body;
    const int32_t *vertices; /* (vertex_count) the path, each joined to the next one by an edge; copied */
    int32_t vertex_count;
} pel_cut_def;

/* A seam: edges of a surface that open by themselves, all at a time, or each one where the force across it is too
   large: the mean of what its two triangles carry, of tension and shear. A single edge inside the surface opens
   together with the next one. PEL_BAD_ARGUMENT of pel_sim_create names the seam: what pel_cut refuses, a seam that
   never opens. */
typedef struct pel_seam_def {
    int32_t body;
    const int32_t *path; /* (path_count) each joined to the next one by an edge; null = `vertices` is given; copied */
    int32_t path_count;
    const int32_t *vertices; /* (vertex_count) all edges between two of them; null = `path` is given; copied */
    int32_t vertex_count;
    double strength; /* N/m, force per length at rest across an edge; 0 (default) = no force opens it */
    double opens_at; /* s, at the start of the first step that begins then or later; below 0 (default) = no time does */
} pel_seam_def;

PEL_API pel_seam_def pel_seam_def_default(void);

/* Where tears may start, beside the ends of cuts, which grow in any case; in bodies with a toughness. */
typedef enum pel_tear_start {
    PEL_TEAR_NONE,    /* nowhere */
    PEL_TEAR_BORDERS, /* in sharp notches of the border, with an inner angle above 270 degrees, and where the stress at
                         the border exceeds the strength of the body, if it has one */
    PEL_TEAR_ANYWHERE /* also inside: a body has a strength then */
} pel_tear_start;

typedef struct pel_tear_def {
    pel_tear_start start; /* default: PEL_TEAR_BORDERS */
    int32_t max_tips;     /* tips of a body that grow in one step: the readiest; above 0; default: 64 */
} pel_tear_def;

typedef struct pel_sim_def {
    const pel_model *model;
    pel_solver_def solver;
    const pel_load_def *loads; /* (load_count), copied */
    int32_t load_count;
    const pel_tool_def *tools; /* (tool_count), copied */
    int32_t tool_count;
    const pel_support_def *supports; /* (support_count), copied */
    int32_t support_count;
    const pel_tie_def *ties; /* (tie_count), copied */
    int32_t tie_count;
    const pel_joint_def *joints; /* (joint_count), copied */
    int32_t joint_count;
    const pel_cut_def *cuts; /* (cut_count) in the order of their times, copied */
    int32_t cut_count;
    const pel_seam_def *seams; /* (seam_count), copied */
    int32_t seam_count;
    pel_tear_def tear;
    pel_wind_def wind; /* keys copied */
    pel_contact_def contact;
    bool record_contacts; /* stores contacts for pel_sim_get_contact_records; default: false */
    int32_t thread_count; /* 0 = the processors of this machine; results do not depend on it */
    /* Called often during long steps (static, implicit, descent, methods with 32 substeps or more, steps after one that
       contact divided or that took 0.03 s, the first step of large meshes), in the stepping thread; returning false
       ends the step with PEL_STOPPED. Must be fast, such as reading a flag. Nullable. */
    bool (*wanted)(void *user);
    void *user; /* passed to `wanted`; both must live as long as the simulation */
    /* True: `wanted` is called in all steps. Each takes a snapshot, some percent of a short one; default: false. */
    bool stops_short_steps;
    uint32_t cookie;
} pel_sim_def;

PEL_API pel_sim_def pel_sim_def_default(void);

/* Validates the def for the mesh: PEL_UNSTABLE with the limit if alpha or dt is too large, PEL_BAD_ARGUMENT for
   numbers out of range, a load on no vertex, a tool that starts inside a body; with contact: bodies that start
   intersecting (the number of pairs and the first ones are named), a thickness larger than the shortest edge. Free with
   pel_sim_destroy. */
PEL_API pel_status pel_sim_create(const pel_sim_def *def, pel_sim **sim, pel_error *error);
PEL_API void pel_sim_destroy(pel_sim *sim);

/* Substeps required by PEL_METHOD_XPBD on a model at rest, without the limit max_substeps. A body refined everywhere
   counts with its finest level. PEL_BAD_ARGUMENT as pel_sim_create, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_sim_needed_substeps(const pel_sim_def *def, int32_t *count, pel_error *error);

/* A dt [s] with which PEL_METHOD_EXPLICIT is stable on a model: half of the limit at rest, as materials stiffen in
   motion, with parameters over time at their largest and bodies that refine at their finest level. 0: forward Euler
   without damping is never stable. PEL_BAD_ARGUMENT as pel_sim_create, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_sim_stable_dt(const pel_sim_def *def, double *dt, pel_error *error);

/* One step of dt. PEL_DIVERGED (with the first bad vertex, the step and the likely parameter) restores the state before
   the step. PEL_STOPPED (`wanted` returned false in a long step) restores it too, and later steps have the same bits as
   without the stop. A step allocates no memory, with these exceptions: a snapshot in the first step that calls
   `wanted`; with contact, records of contacts, or tools under PEL_METHOD_DESCENT, in a step with more pairs than any
   before, after refinement and while surfaces are tangled. PEL_BAD_ARGUMENT for too many candidate pairs,
   PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_sim_step(pel_sim *sim, pel_error *error);

PEL_API double pel_sim_time(const pel_sim *sim); /* s, step count x dt */
/* Bytes that a step reads and writes; each array counts once. */
PEL_API size_t pel_sim_step_bytes(const pel_sim *sim);
PEL_API int64_t pel_sim_step_count(const pel_sim *sim); /* steps since the start */
PEL_API const pel_model *pel_sim_model(const pel_sim *sim);
PEL_API double pel_sim_alpha(const pel_sim *sim);       /* the alpha in use; 0 for the explicit method */
PEL_API double pel_sim_alpha_limit(const pel_sim *sim); /* stability limit of this mesh */

/* True if any body is a shell (membrane, bending, fibres or pressure). */
PEL_API bool pel_sim_has_shells(const pel_sim *sim);

/* Copies the rows of one body: (vertex_count x 3). Velocity of the last step. */
PEL_API void pel_sim_get_positions(const pel_sim *sim, int32_t body, double *positions);
PEL_API void pel_sim_get_velocities(const pel_sim *sim, int32_t body, double *velocities);
/* m/s, of the fastest vertex of all bodies in the last step */
PEL_API double pel_sim_max_speed(const pel_sim *sim);

/* Setters for use between steps. Values are validated like the defs. */
PEL_API pel_status pel_sim_set_positions(pel_sim *sim, int32_t body, const double *positions, pel_error *error);
PEL_API pel_status pel_sim_set_velocities(pel_sim *sim, int32_t body, const double *velocities, pel_error *error);
PEL_API pel_status pel_sim_set_load_force(pel_sim *sim, int32_t load, const double force[3], pel_error *error);
/* Replaces the keys of the tool by a pose of the caller (haptic device, mouse). */
PEL_API pel_status pel_sim_set_tool_pose(pel_sim *sim, int32_t tool, const double position[3], const double rotation[4],
                                         pel_error *error);

/* 64-bit hash of time, positions and velocities in mesh order: equal for equal bits. */
PEL_API uint64_t pel_sim_hash(const pel_sim *sim);

/* Saves all data with which pel_sim_load continues with the same bits, including contact statistics and ledger, into a
   buffer of pel_sim_save_size bytes. That is the size of the present state, which changes from step to step where
   surfaces touch: ask before each pel_sim_save, and give pel_sim_load the size at that time. pel_sim_load refuses
   (PEL_BAD_FORMAT, state unchanged) a snapshot that is damaged, of another version or precision, or of other defs, with
   the parts that differ ("made with other: gravity, tools"). Only a forged snapshot, with a valid checksum and numbers
   out of range, may change the state before it is refused. PEL_OUT_OF_MEMORY: load again before the next step. */
PEL_API size_t pel_sim_save_size(const pel_sim *sim);
PEL_API void pel_sim_save(const pel_sim *sim, void *bytes);
PEL_API pel_status pel_sim_load(pel_sim *sim, const void *bytes, size_t size, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
