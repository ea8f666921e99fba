/* Pellicle: change a simulation at run time. Call these functions between two steps, from the thread that steps the
   simulation; they do not slow down the steps.

       pel_set_parameter(sim, "bodies.ball.membrane.young", 2e4, &error);
       if (pel_pick(sim, eye, ray, &hit, &error) == PEL_OK && hit.is_hit)
           pel_drag_begin(sim, &hit, 50, 0.05, &drag, &error);

   A change that is refused or runs out of memory leaves the simulation unchanged. After an accepted change the
   simulation continues from the present state as if created with the new value: substeps, masses, rest volumes, factors
   and stability limits are updated. A change before the first step gives the same bits as creation with the new value.
   The ledger books the change of energy as `work_setters`.

   Most changes recreate the simulation (docs/live.md has the times), some only write a number. */
#ifndef PELLICLE_LIVE_H
#define PELLICLE_LIVE_H

#include "sim_step.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- parameters ---- */

/* Type of the value of a parameter. */
typedef enum pel_parameter_kind {
    PEL_PARAMETER_NUMBER,
    PEL_PARAMETER_INTEGER,
    PEL_PARAMETER_SWITCH, /* 0 or 1 */
    PEL_PARAMETER_WORD,   /* index in `words` */
    PEL_PARAMETER_VECTOR  /* three numbers */
} pel_parameter_kind;

enum { PEL_PARAMETER_PATH_SIZE = 192 };

/* A parameter of a simulation and its present value. Paths are those of scene files; list elements are addressed by
   name, or by index from 0 if they have none ("bodies.head.anisotropy.0.stiffness"). */
typedef struct pel_parameter_info {
    char path[PEL_PARAMETER_PATH_SIZE];
    const char *row; /* path of the row in `pellicle reference`: "bodies[].membrane.young"; lives forever */
    pel_parameter_kind kind;
    const char *unit;   /* "" = none */
    double least, most; /* range of the value, or of each component; infinite = no bound */
    bool is_open;       /* `least` itself is not allowed */
    bool may_be_auto;   /* pel_set_parameter accepts NAN for `auto`, or for the default of the whole scene */
    bool may_be_keyed;  /* pel_set_parameter_keys accepts it */
    double preset[3];   /* value in a new def; NAN = auto */
    double value[3];    /* at the present time; NAN = auto */
    bool is_keyed;      /* follows keys over time */
    bool is_field;      /* varies over the body; value is that of the first vertex. Setting a number replaces it */
    const char *const *words; /* of PEL_PARAMETER_WORD, null-terminated; else null */
    bool is_live;             /* can change at run time */
    const char *refusal;      /* why not, one sentence without full stop; "" when is_live */
    const char *remedy;       /* what to do instead; "" when is_live */
} pel_parameter_info;

/* Number of parameters of a simulation; only existing parts have parameters. Adding or removing loads and tools changes
   it. */
PEL_API int32_t pel_parameter_count(const pel_sim *sim);
/* The parameter of an index 0 .. pel_parameter_count - 1, in the order of the reference page, body by body. */
PEL_API void pel_parameter_at(const pel_sim *sim, int32_t index, pel_parameter_info *info);
/* The parameter of a path. PEL_BAD_ARGUMENT names the nearest path for an unknown one. */
PEL_API pel_status pel_parameter_find(const pel_sim *sim, const char *path, pel_parameter_info *info, pel_error *error);

/* Sets a number, integer, switch (0 or 1) or word (its index); NAN is `auto` if may_be_auto. The number replaces keys
   or a field. PEL_BAD_ARGUMENT, with reason and remedy, for an unknown path, a value out of range or unsupported by the
   method, and a parameter fixed at run time; PEL_UNSTABLE with the limit if the method would be unstable;
   PEL_OUT_OF_MEMORY. Errors leave the simulation unchanged. */
PEL_API pel_status pel_set_parameter(pel_sim *sim, const char *path, double value, pel_error *error);
/* Sets a vector, such as "gravity" or "loads.pull.force". Errors as above. */
PEL_API pel_status pel_set_parameter_vector(pel_sim *sim, const char *path, const double value[3], pel_error *error);
/* Sets a curve over time (key_count >= 1, times increasing; copied). Errors as above. */
PEL_API pel_status pel_set_parameter_keys(pel_sim *sim, const char *path, const pel_key *keys, int32_t key_count,
                                          pel_error *error);
/* Sets any kind from text as in `--set`: "2e4", "true", "auto", "neo-hookean", "[0, 0, -9.81]". Errors as above. */
PEL_API pel_status pel_set_parameter_text(pel_sim *sim, const char *path, const char *text, pel_error *error);

/* ---- loads, tools, pins, forces ---- */

/* Adds a load or tool, validated as by pel_sim_create for the present state: a tool that would start inside a body is
   refused. Names are unique among loads and among tools. The new one has the last index, which is one less than
   the new count. Keys use the time of the simulation. */
PEL_API pel_status pel_sim_add_load(pel_sim *sim, const pel_load_def *def, pel_error *error);
PEL_API pel_status pel_sim_add_tool(pel_sim *sim, const pel_tool_def *def, pel_error *error);
/* Removes a load or tool; a tool releases its vertices. Later indices decrease by one. PEL_BAD_ARGUMENT for an index
   that does not exist. */
PEL_API pel_status pel_sim_remove_load(pel_sim *sim, int32_t load, pel_error *error);
PEL_API pel_status pel_sim_remove_tool(pel_sim *sim, int32_t tool, pel_error *error);
PEL_API int32_t pel_sim_load_count(const pel_sim *sim);
PEL_API const char *pel_sim_load_name(const pel_sim *sim, int32_t load); /* "" = none; lives until the next change */

/* New keys of a tool (key_count >= 1, times increasing; copied). From the next step on it follows them; they replace a
   pose set by the caller. */
PEL_API pel_status pel_sim_set_tool_keys(pel_sim *sim, int32_t tool, const pel_pose_key *keys, int32_t key_count,
                                         pel_error *error);

/* Replaces the pinned vertices of a body (mesh vertices; vertex_count 0 = none). They are held at their present
 * positions. */
PEL_API pel_status pel_sim_set_pins(pel_sim *sim, int32_t body, const int32_t *vertices, int32_t vertex_count,
                                    pel_error *error);

/* Forces [N] on the vertices of the body's mesh (mesh vertex_count x 3), added to the loads until the next call;
   null = none. Snapshots include them, and the ledger books their work as that of loads. Only the first call allocates.
 */
PEL_API pel_status pel_sim_set_forces(pel_sim *sim, int32_t body, const double *forces, pel_error *error);

/* ---- picking and dragging ---- */

/* First intersection of a ray with the surface of a body. */
typedef struct pel_pick_hit {
    bool is_hit; /* false: no intersection; the other members are zero */
    int32_t body;
    int32_t triangle;    /* in the order of pel_sim_get_triangles */
    int32_t vertices[3]; /* its corners, rows of pel_sim_get_positions */
    double weights[3];   /* barycentric, sum 1 */
    int32_t mesh_vertex; /* nearest mesh vertex: for pins and loads */
    double distance;     /* m, along the ray */
    double point[3];     /* m */
    double normal[3];    /* unit, of the triangle */
} pel_pick_hit;

/* Casts a ray from origin [m] along direction (any length but 0) at the present surfaces of all bodies; both sides of
   triangles count. The search tree is built at the first call and refitted after a step.
   PEL_BAD_ARGUMENT for numbers that are not finite, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_pick(pel_sim *sim, const double origin[3], const double direction[3], pel_pick_hit *hit,
                            pel_error *error);

/* A spring that holds vertices of a surface. */
typedef struct pel_drag pel_drag;
typedef struct pel_drag_reading {
    double point[3];    /* m, the held point of the surface */
    double target[3];   /* m, the other end of the spring */
    double force[3];    /* N, of the spring on the surface: stiffness times (target - point) */
    double reaction[3]; /* N, of the surface on the spring in the last step; at rest it is minus the force */
    int32_t held_count; /* vertices */
} pel_drag_reading;

/* Grasps the vertices within `reach` [m] of a hit (at least the nearest one) through a spring of `stiffness` [N/m] > 0.
   Adds a tool named "drag", "drag-2", ...; it ends with pel_drag_end or with the simulation. PEL_BAD_ARGUMENT,
   PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_drag_begin(pel_sim *sim, const pel_pick_hit *hit, double stiffness, double reach,
                                  pel_drag **drag, pel_error *error);
/* Sets the target [m]; call before each step. The held point follows until spring and surface are in equilibrium. */
PEL_API pel_status pel_drag_move(pel_drag *drag, const double target[3], pel_error *error);
PEL_API void pel_drag_get(const pel_drag *drag, pel_drag_reading *reading);
/* Releases the vertices and frees the drag, also on errors. After PEL_OUT_OF_MEMORY its tool remains, without vertices.
 */
PEL_API pel_status pel_drag_end(pel_drag *drag, pel_error *error);

/* ---- snapshots ---- */

/* The state of a simulation with its parameters, loads and tools, for reset and undo. */
typedef struct pel_snapshot pel_snapshot;

/* PEL_OUT_OF_MEMORY. Free with pel_snapshot_destroy, before or after the simulation. */
PEL_API pel_status pel_snapshot_create(const pel_sim *sim, pel_snapshot **snapshot, pel_error *error);
PEL_API void pel_snapshot_destroy(pel_snapshot *snapshot);
/* Restores the simulation of the snapshot, including everything added or changed since: the hash and the bits of later
   steps are equal. End open drags first. PEL_BAD_ARGUMENT for another simulation, PEL_OUT_OF_MEMORY; errors leave the
   simulation unchanged. */
PEL_API pel_status pel_snapshot_restore(pel_sim *sim, const pel_snapshot *snapshot, pel_error *error);
/* Size in bytes. */
PEL_API size_t pel_snapshot_size(const pel_snapshot *snapshot);

#ifdef __cplusplus
}
#endif
#endif
