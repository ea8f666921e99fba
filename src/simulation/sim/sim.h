/* Inside of the simulation: the state, copies of loads and tools, and scratch that is allocated once. */
#ifndef PEL_SIM_SIM_H
#define PEL_SIM_SIM_H

#include "batch/batches.h"
#include "contact/force.h"
#include "force/body_force.h"
#include "force/shell_force.h"
#include "geom/solid.h"
#include "math/pose.h"
#include "model/boundary.h"
#include "model/refined_model.h"
#include "pellicle/sim.h"
#include "sim/ledger.h"
#include "sim/stepper.h"
#include "sim/tool_search.h"
#include "solve/descent.h"
#include "solve/project.h"
#include "solve/relax.h"
#include "solve/softness.h"
#include "solve/stability.h"

typedef struct pel_load {
    char name[PEL_NAME_SIZE];
    double force[3];   /* N, on a vertex of weight 1 */
    int32_t *vertices; /* (vertex_count) in model order */
    double *weights;   /* (vertex_count) */
    int32_t vertex_count;
    /* on a body that refines: a load is proportional to area, like mass (levels.h) */
    double *base_weights;    /* (mesh vertices) */
    double *densities;       /* (vertices of the finest level) */
    double *weight_of_place; /* (places of the body) 0 = none */
    double from, until;
    pel_key *keys;
    int32_t key_count;
    int32_t body;
    pel_load_kind kind;
} pel_load;

/* a moment on one boundary edge (edge_load.c) */
typedef struct pel_edge_load {
    int32_t load, edge;
    double along[3]; /* m, the edge at rest */
} pel_edge_load;

/* a follower load on one boundary edge (follower.c) */
typedef struct pel_follower {
    int32_t load, vertices[3]; /* ends of the edge with its triangle to the left, tip */
    double rest[3][3];         /* its frame at rest */
    double length;             /* m at rest, times the weight of the load */
    /* of the last evaluation: N; turn of the frame by displacements of the vertices */
    double force[3], turns[3][3][3];
} pel_follower;

typedef enum pel_grasp_phase { PEL_GRASP_WAITING, PEL_GRASP_HOLDING, PEL_GRASP_DONE } pel_grasp_phase;

/* Action of one tool on one vertex during a step. */
typedef struct pel_contact_vertex {
    int32_t vertex;
    double push[3]; /* sum of the displacements, for the direction of the contact */
} pel_contact_vertex;

/* Where a triangle touched a tool: the point of the triangle, and the half space of the tool's frame,
   normal . x >= offset, in which it has to stay during the next step. */
typedef struct pel_contact_plane {
    double weights[3];
    double normal[3];
    double offset;
    int64_t triangle;
} pel_contact_plane;

/* planes a tool remembers at most; they matter where it touches few, large triangles */
enum { PEL_PLANE_LIMIT = 1024 };

/* History of a tool since the start. */
typedef struct pel_tool_tally {
    int64_t held_back_count, lost_count; /* steps; vertices */
    double held_back_time, lost_time;    /* s, of the first one; 0 = none yet */
} pel_tool_tally;

typedef struct pel_tool {
    char name[PEL_NAME_SIZE];
    pel_solid solid;                         /* of a mesh: the sphere about it */
    double press_margin;                     /* m, the largest distance from a body that it keeps */
    pel_real look_box[2][3];                 /* low, high: box of the criterion of tools in this step */
    double friction, restitution, thickness; /* its own; below 0: the value of contact */
    pel_mesh *mesh;                          /* null = the solid */
    struct pel_mesh_query *query;            /* of a mesh that grasps: finds vertices inside or near; else null */
    pel_pose_key *keys;
    double (*key_spins)[3]; /* (key_count) spin of the pose at each key */
    int32_t key_count;
    int32_t body;
    bool press, grasp;
    double grasp_from, grasp_until, reach;
    double grasp_max_force; /* N, 0 = no limit */

    pel_pose pose, pose_before; /* at present; at the start of the step */
    pel_pose pose_wanted;       /* at the end of the step, if nothing holds the tool back */
    pel_pose pose_start;        /* at the start of the step, of which the present one may be a part */
    pel_pose pose_substep;      /* at the start of the substep */
    bool blocked;               /* it was held back, and has not caught up with its keys yet */
    bool is_held_back;          /* the last step held it back */
    pel_tool_tally tally;       /* its history; in snapshots */
    bool driven;                /* the caller sets the pose, keys are not used any more */
    pel_pose driven_pose;
    pel_grasp_phase phase;
    int32_t held_count;
    int32_t *support; /* (support_count) of a keyed support: the places that it holds; else null */
    int32_t support_count;
    uint8_t *support_marks; /* (vertices of the finest level) 1 = of the support; null = its body does not refine */
    double center[3];       /* of a keyed support at rest */
    int32_t *held;          /* (held_count) vertices held */
    double (*anchors)[3];   /* (held_count) their places in the tool's frame */
    double force[3], torque[3];
    double force_sum[3], torque_sum[3]; /* of a step in parts: means over the parts done */
    bool was_held_back, hold_is_counted;
    bool is_on_its_way, blocked_before; /* during a step, which may fail: the values before it */
    double force_before[3], torque_before[3];
    int32_t contact_count;

    /* contacts of this step and of the one before, up to PEL_PLANE_LIMIT each */
    pel_contact_plane *planes, *planes_before;
    int32_t plane_count, plane_before_count;
    pel_contact_vertex *touches; /* (touch_count) of this step */
    int32_t touch_count;
    int32_t *touch_of_vertex; /* (vertex_count) its touch plus 1, 0 = none */
    pel_near_list near;       /* triangles that it may press in a step */
    pel_near_list in_reach;   /* those that a force loop looks at */
} pel_tool;

/* verdict of the criteria on a vertex */
typedef enum pel_request {
    PEL_REQUEST_NONE,
    PEL_REQUEST_MADE,   /* it requests the triangles around it */
    PEL_REQUEST_ENDING, /* still requests, and is in the list of those that stop */
    PEL_REQUEST_WAITING /* is in the list of candidates */
} pel_request;

/* State of the refinement of one body (refine.c). Lists are of vertices, numbered as in the forest. */
typedef struct pel_refine_body {
    int32_t *mark_counts; /* (nodes that can be red) how many vertices ask for it */
    uint8_t *requests;    /* (vertices of the finest level) pel_request */
    int64_t *warm_step;   /* (same) last step in which a hot vertex was above its lower threshold */
    double *strengths;    /* (same) largest measure over threshold, when it was last looked at */
    uint8_t *asked_level; /* (mesh vertices) by pel_sim_refine */
    int32_t *visited;     /* (vertices of the finest level) scratch of a walk over rings: number of the walk */
    int32_t *queue;       /* (same) scratch */
    int32_t *candidates;  /* (same) waiting ones of past rounds, then those found in this round */
    int32_t *leaving;     /* (same) those that stop to ask */
    int32_t *hot;         /* (same) those that ask, leaving ones included */
    int32_t *hot_place;   /* (same) their places in that list */
    int32_t walk, candidate_count, waiting_count, leaving_count, hot_count;
    int32_t part; /* of the round that comes next, 0 .. interval - 1 */
    int64_t revision;
    double *rest_curvatures; /* (curvature_count) by place, of the present surface at rest, NAN = not known */
    int32_t curvature_count; /* places of the body, 0 = not used */
    /* rows of the getters, made when asked for after an event */
    int32_t *output_vertices; /* (vertices of the finest level) */
    int32_t *output_vertex;
    pel_front_triangle *surface; /* (triangles of the finest level) */
    int64_t output_revision;
} pel_refine_body;

typedef struct pel_contact_set pel_contact_set;

/* State of contact in addition to the set. */
typedef struct pel_sim_contact {
    pel_contact_def def;
    int64_t *revisions; /* (body_count) of the surface in the set */
    bool is_loaded;     /* memory of the collider and revisions are of a snapshot, the surface of the set is not yet */
    double solved_energy; /* J, of the new positions and velocities before anything was corrected */
    void *before_event;   /* (event_size) snapshot, of models that refine; else null */
    size_t event_size;
} pel_sim_contact;

typedef struct pel_sim_solids pel_sim_solids;

/* Substeps of xpbd: present number and history; in snapshots. */
typedef struct pel_substeps_now {
    int32_t count, least, most;
    int32_t needed;     /* maximum over the run, without max_substeps */
    int32_t is_stale;   /* the surface or the state has changed: update before the next step */
    int32_t interval;   /* steps from the last look to the next one */
    int64_t next;       /* the step before which the next look is due */
    double softness;    /* the largest so far */
    pel_softness found; /* at the last look */
} pel_substeps_now;

typedef struct pel_sim_substeps {
    bool is_automatic;
    int32_t least; /* of automatic ones */
    pel_softness_scratch scratch;
    pel_substeps_now now;
} pel_sim_substeps;

/* Parts of a step (parts.c). Sizes are in units of a step over PEL_PART_LIMIT. */
enum { PEL_PART_LIMIT = 64 };
/* successful parts of one size before the next is twice as long; doubled after a failure */
enum { PEL_LEAST_PATIENCE = 4, PEL_MOST_PATIENCE = 256 };

/* in snapshots */
typedef struct pel_parts_now {
    int32_t size;     /* of the next part */
    int32_t calm;     /* parts of this size that went well */
    int32_t patience; /* number required before the next part is longer */
} pel_parts_now;

typedef struct pel_sim_parts {
    pel_parts_now now;
    int32_t at;        /* where the present part begins; 0 between steps */
    int32_t step_size; /* of the present part */
    int32_t substeps;  /* of a whole step */
    bool is_refused;   /* repeat the present part with a shorter step */
    bool divides;      /* method and contacts allow steps in parts; then their sizes are in snapshots */
    bool can_halve;    /* false = all steps are whole */
    bool is_kept;      /* `before` is the state before the present step: it may be stopped on its way */
    void *before;      /* (before_size) snapshot before a step in parts or a long one; null until there is one */
    size_t before_size;
} pel_sim_parts;

/* data of the method (descent.c) */
typedef struct pel_sim_descent pel_sim_descent;
/* (step_modes.h) of an analysis */
typedef struct pel_sim_modes pel_sim_modes;

/* (step_path.h) of a path by arc length */
typedef struct pel_sim_path pel_sim_path;

/* (hold.h) supports of single components */
typedef struct pel_sim_holds pel_sim_holds;

/* A pair of groups that collides (restitution.c). */
typedef struct pel_collision_state {
    uint8_t is_on;
    int32_t idle_steps;      /* since the pair pressed last */
    double approach;         /* m/s, maximum over the collision, at the contact */
    double normal[3];        /* unit, from the higher group to the lower one */
    double point[3];         /* m */
    double contact_distance; /* m, of the centers along the normal while they touched */
    double risen;            /* m, beyond that */
} pel_collision_state;

struct pel_sim {
    const pel_model *model; /* the given one, or the active one when any body refines */
    const pel_model *given;
    pel_model *own_model;      /* the given one, where a change has made it; else null */
    pel_sim_def def;           /* the def with all changes since creation */
    pel_copies copies;         /* its arrays */
    bool goes_on;              /* continues from a state: skip the checks of a start at rest */
    pel_refined_model *active; /* null = no body refines */
    pel_refine_body *refine;   /* (body_count) null as well */
    pel_state *state;
    pel_solver_def solver;
    const pel_stepper *stepper; /* of its method */
    double (*clock)(void);      /* s, from any origin; for solver.budget. Tests replace it */
    double deadline;            /* s by that clock, of the step at work; HUGE_VAL = none */
    pel_step step;
    pel_pool *pool;        /* null = one thread */
    double *chunk_longest; /* scratch of the step */
    double alpha_limit;
    pel_batches *batches;     /* the elements of all bodies */
    pel_projector *projector; /* position-based methods, else null */
    pel_shell_forces *shells; /* null = no body is a shell */
    pel_sim_descent *descent; /* null = another method */
    pel_sim_modes *modes;     /* null = no analysis */
    pel_sim_path *path;       /* null = loads by time */
    pel_relax *relax;         /* quasi-static method on bodies that refine, else null */
    double relax_shell_rate;
    pel_sim_substeps substeps;     /* of xpbd */
    pel_shell_energy shell_energy; /* of the present state, when force_is_present */
    pel_fingerprint fingerprint;   /* of the model and the def, in snapshots */
    pel_load *loads;
    int32_t load_count;
    pel_record *external;      /* (vertex_count) N, forces of the caller; null = none yet */
    pel_edge_load *edge_loads; /* (edge_load_count) null = none */
    int32_t edge_load_count;
    double edge_load_work;   /* J, in the step */
    pel_follower *followers; /* (follower_count) null = none */
    int32_t follower_count;
    pel_tool *tools;
    int32_t tool_count;
    pel_contact_set *contacts; /* (contact.h) null = none */
    pel_sim_contact contact;
    bool contact_in_loop;      /* the solver sweeps over them too */
    bool self_contact;         /* no body can cut itself */
    pel_record *force;         /* (vertex_count) scratch: forces, and loads on touched vertices */
    bool force_is_present;     /* it holds the forces of the present state */
    bool energies_are_present; /* and these its energies [J], when force_is_present */
    double spring_energy, volumetric_energy, kinetic_energy;
    pel_tool_search *tool_search; /* null without tools */
    int32_t *near_triangles;      /* (triangle_count) scratch of the tools; null without tools */
    int32_t *plane_of_triangle;   /* (triangle_count) its place in the planes of the tool at work plus 1, 0 = none */
    int64_t *looked_at;           /* (triangle_count) by place in near_triangles: pushes when it was looked at */
    int64_t *moved_at;            /* (vertex_count) push that moved it last */
    int64_t *cornered_at;         /* (vertex_count) the pressing that looked at it as a corner last */
    int64_t push_count;           /* of all steps */
    int64_t press_count;          /* likewise */
    uint8_t *held;                /* (vertex_count) 1 = a tool holds it */
    pel_boundary boundary;        /* vertices held by tools; its arrays: */
    int32_t *held_vertices;       /* (vertex_count) null when no tool grasps */
    double (*held_targets)[3];    /* (vertex_count) likewise */
    double (*grip_forces)[3];     /* (vertex_count) N, of each held vertex on its tool; null when no tool grasps */
    bool held_is_listed;          /* the boundary belongs to the tools */
    pel_sim_solids *solids;       /* (tool_solid.h) methods with substeps; null = no tool presses */
    double (*reactions)[3]; /* (vertex_count) N, of supports on vertices in the last step (support.c); null = none */
    pel_sim_holds *holds;   /* (hold.h) supports of single components; null = none */
    pel_contact_forces contact_forces;
    pel_collision_state *collisions; /* (pairs of contact_forces) null = no restitution */
    pel_ledger ledger;
    pel_sim_parts parts;
    int64_t state_number;          /* another one for each state */
    struct pel_observer *observer; /* (observe_field.h) null = nobody looked at a field */
    struct pel_picker *picker;     /* (pick.h) null = no ray was cast */
};

static inline bool pel_sim_is_explicit(const pel_sim *sim)
{
    return sim->stepper->is_explicit;
}

static inline bool pel_sim_has_self_contact(const pel_sim *sim)
{
    return sim->contacts != NULL && sim->self_contact;
}

/* contacts are swept over inside the solver */
static inline bool pel_sim_has_loop_contacts(const pel_sim *sim)
{
    return sim->contacts != NULL && sim->contact_in_loop;
}

static inline bool pel_sim_is_projected(const pel_sim *sim)
{
    return sim->stepper->has_substeps;
}

/* velocities are part of the state */
static inline bool pel_sim_has_velocity(const pel_sim *sim)
{
    return sim->stepper->has_velocity;
}

/* whether the new position of a vertex is within the bound; not so when it is NaN */
static inline bool pel_sim_is_inside(const pel_sim *sim, int32_t v)
{
    double bound = sim->step.bound, x[3];
    pel_vertex_position(sim->state->position_next, v, x);
    return pel_vec3_squared_length(x) < bound * bound;
}

/* Of an acceleration, to the new positions [s2] and velocities [s]. */
typedef struct pel_gains {
    double position, velocity;
} pel_gains;

/* ---- step_explicit.c ---- */
/* The true limit of stability instead of the safe bound. */
pel_status pel_sim_refine_stability(const pel_sim *sim, pel_stability *stability, pel_error *error);

/* ---- accessors.c ---- */
/* the first vertex of the new positions that is out of the bound, or -1 */
int32_t pel_sim_first_outside(const pel_sim *sim);
bool pel_sim_all_inside(const pel_sim *sim);
/* the longest edge of all surfaces at the new positions */
double pel_sim_longest_edge(const pel_sim *sim);

/* ---- softness.c ---- */
/* Fills automatic values of the def: iterations, the limit of substeps, second order. */
void pel_substeps_configure(pel_sim *sim, const pel_sim_def *def);
/* How many the state at the start needs, on the finest level that it has everywhere. PEL_OUT_OF_MEMORY. */
pel_status pel_substeps_count(pel_sim *sim, int32_t *count, pel_error *error);
/* Chooses the substeps for the state at the start. */
pel_status pel_substeps_create(pel_sim *sim, pel_error *error);
void pel_substeps_destroy(pel_sim *sim);
/* Updates them at the start of a step when due. */
void pel_substeps_follow(pel_sim *sim);
/* After a snapshot was loaded; false when its numbers are out of range. */
bool pel_substeps_restore(pel_sim *sim);
/* Transfers the count and the tallies to a changed simulation; the next step updates them. */
void pel_substeps_carry(const pel_sim *from, pel_sim *to);
/* the remedy of a run that diverged because xpbd is too soft */
void pel_substeps_remedy(const pel_sim *sim, pel_error *error);
void pel_substeps_read(const pel_sim *sim, pel_solver_reading *reading);

/* ---- parts.c ---- */
/* After contacts and restitution, before anything asks for the size of a snapshot. */
void pel_parts_create(pel_sim *sim);
void pel_parts_destroy(pel_sim *sim);
/* At the start of a step: chooses substeps and the size of the first part. PEL_OUT_OF_MEMORY. */
pel_status pel_parts_begin(pel_sim *sim, pel_error *error);
/* At the start of a step: if the caller may stop it midway, keeps the state to return to. */
pel_status pel_parts_keep(pel_sim *sim, pel_error *error);
/* Whether the present part may be refused and repeated in two halves. */
static inline bool pel_parts_can_halve(const pel_sim *sim)
{
    return sim->parts.can_halve && sim->parts.step_size > 1;
}
/* of the present part in its step */
static inline double pel_part_share(const pel_sim *sim)
{
    return (double)sim->parts.step_size / PEL_PART_LIMIT;
}

/* share of the present part in the rest of its step */
static inline double pel_part_share_left(const pel_sim *sim)
{
    return (double)sim->parts.step_size / (PEL_PART_LIMIT - sim->parts.at);
}

static inline bool pel_parts_are_last(const pel_sim *sim)
{
    return sim->parts.at + sim->parts.step_size == PEL_PART_LIMIT;
}
/* PEL_OUT_OF_MEMORY. */
pel_status pel_parts_halve(pel_sim *sim, pel_error *error);
/* After a part: the next one begins. */
void pel_parts_accept(pel_sim *sim);
/* After the last part, or the first failure, which takes the state back to the start of the step. */
void pel_parts_end(pel_sim *sim, pel_status status);
/* at the end of the present part [s] */
double pel_sim_next_time(const pel_sim *sim);
/* s, at a share of the present part of the step */
double pel_sim_part_time(const pel_sim *sim, double share);

/* ---- contact_event.c ---- */
/* Room for that, where bodies refine under contact. PEL_OUT_OF_MEMORY. */
pel_status pel_contacts_create_event(pel_sim *sim, pel_error *error);
/* Contact only: saves the data to revert an event of refinement; call before the event. */
void pel_contacts_before_event(pel_sim *sim);
/* True if the new surface does not cut itself; otherwise nothing changes. */
bool pel_contacts_accept_event(pel_sim *sim, int32_t body);

/* ---- loads.c ---- */
pel_status pel_loads_create(pel_sim *sim, const pel_load_def *defs, int32_t count, pel_error *error);
void pel_loads_destroy(pel_sim *sim);
/* Moves the new positions and velocities by the loads at the present time. False when a vertex leaves the bound. */
bool pel_loads_apply(pel_sim *sim, pel_gains gains);
/* there is one, gravity included */
bool pel_loads_exist(const pel_sim *sim);
/* the same, or a pressure from outside or inside */
bool pel_loads_act(const pel_sim *sim);
/* N m: the product of a load at a time with vectors on vertices (3 vertex_count) */
double pel_load_product(const pel_sim *sim, int32_t load, double time, const double *vectors);
/* Adds the loads at a time, gravity included, to force (vertex_count); follower loads at some positions, null = without
   these. */
void pel_loads_add(const pel_sim *sim, double time, const pel_record *positions, pel_record *force);

/* Work of the loads [J] over a step to position_next, from one time to another: mean force times displacement. */
double pel_loads_work(const pel_sim *sim, double from, double to);

/* Brings the loads on a body after the last event. */
void pel_loads_update(pel_sim *sim, int32_t body);
/* The same for all places, after a snapshot was loaded. */
void pel_loads_rebuild(pel_sim *sim, int32_t body);

/* Takes force and times of a def that differs in no other member, if they are right. PEL_BAD_ARGUMENT. */
pel_status pel_load_retime(pel_sim *sim, int32_t load, const pel_load_def *def, pel_error *error);

/* ---- restitution.c ---- */
/* After contacts. PEL_BAD_ARGUMENT for a number out of range or a method without velocities, PEL_OUT_OF_MEMORY. */
pel_status pel_restitution_create(pel_sim *sim, pel_error *error);
/* After a step that is accepted. */
void pel_restitution_apply(pel_sim *sim);

/* ---- support.c ---- */
/* After tools and supports of single components. PEL_OUT_OF_MEMORY. */
pel_status pel_supports_create(pel_sim *sim, pel_error *error);
void pel_supports_destroy(pel_sim *sim);
/* Reads the forces of supports after a part of a step, before it is accepted. */
void pel_supports_read(pel_sim *sim, double time);
/* Reactions (pel_sim_vertex_count x 3) [N] on the vertices of a body. Their sum is minus the force of
 * pel_sim_get_support. */
void pel_supports_get_reactions(pel_sim *sim, int32_t body, double *reactions);

/* ---- observe.c ---- */
/* Forces of bodies and loads at the present state, into sim->force. */
void pel_sim_compute_forces(pel_sim *sim);
/* Fills the energies of the present state; other members are unchanged. */
void pel_sim_sum_energies(pel_sim *sim, pel_sim_measures *measures);

/* elastic and kinetic energy [J] of the new positions and velocities */
double pel_sim_next_energy(pel_sim *sim);

/* ---- descent.c ---- */
void pel_sim_descent_destroy(pel_sim *sim);

/* ---- relax.c ---- */
/* On the base, before anything is refined: sets the relaxation of the active model. */
pel_status pel_sim_relax_create(pel_sim *sim, pel_error *error);
/* New positions of fine vertices, after those of all others. False if a vertex leaves the bound. */
bool pel_sim_relax(pel_sim *sim);

/* ---- bending_weight.c ---- */
/* the weights at the start */
void pel_bending_weights_start(pel_sim *sim);
/* Brings the automatic ones after the volumes of a step that was accepted. */
void pel_bending_weights_follow(pel_sim *sim);

/* ---- shells.c ---- */
/* Lists for the forces of shells. PEL_BAD_ARGUMENT for features that the method does not support. */
pel_status pel_shells_create(pel_sim *sim, pel_error *error);
void pel_shells_destroy(pel_sim *sim);
/* Adds the forces of shells at the present positions to the new positions and velocities. */
void pel_shells_apply(pel_sim *sim, pel_gains gains);
/* After an event of refinement: shells and constraints of the body on its new surface. */
void pel_shells_follow(pel_sim *sim, int32_t body);
/* the settle_edges of the stepper; null without mid-edge bending */
pel_tangent *pel_sim_settle_edges(const pel_sim *sim, const double **unknowns);
/* PEL_DIVERGED when a pressure turned a body inside out in this step */
pel_status pel_shells_check_volume(const pel_sim *sim, pel_error *error);

/* ---- snapshot.c ---- */
/* pel_sim_save without the checksum, for pel_snapshot_rewind alone. */
void pel_snapshot_keep(const pel_sim *sim, void *bytes);
/* Recomputes the checksum of a snapshot, for tests of damage. */
void pel_snapshot_seal(void *bytes, size_t size);
/* Restores a snapshot of the same simulation. Its defs must not have changed, except numbers that it reads in each
   step: those of loads and grasps, which have to be set again. Fingerprint and checksum are not checked. Errors of
   pel_sim_load. */
pel_status pel_snapshot_rewind(pel_sim *sim, const void *bytes, pel_error *error);
/* Transfers the state of a simulation to one of the same surfaces that was just created with other numbers. Tools are
   matched by name; others start at their keys. PEL_OUT_OF_MEMORY. */
pel_status pel_snapshot_carry(const pel_sim *from, pel_sim *to, pel_error *error);

/* ---- forces.c: forces of the caller ---- */
/* Allocates or frees them. PEL_OUT_OF_MEMORY: nothing changes. */
pel_status pel_sim_make_forces(pel_sim *sim, bool has_forces, pel_error *error);

/* ---- own_def.c ---- */
/* Copies the arrays of a def, except meshes. PEL_OUT_OF_MEMORY. */
pel_status pel_sim_def_copy(pel_copies *copies, pel_sim_def *def, pel_error *error);
/* The fingerprint of the present defs. */
void pel_sim_take_fingerprint(pel_sim *sim);

/* ---- sim_create.c ---- */
/* Sets up a simulation by its def, in a sim that is empty except goes_on; release it also on failure. */
pel_status pel_sim_build(pel_sim *sim, const pel_sim_def *def, pel_error *error);
/* Recomputes all constants of a simulation at its start after numbers of the solver in sim->def have changed and, with
   the model, after pel_model_refill. The result has the same bits as that of pel_sim_create. False if it must be
   created anew: another method than explicit and quasi-static, shells, refinement, tools, supports or contact, or the
   numbers are refused. It must be destroyed then. */
bool pel_sim_refill(pel_sim *sim, bool with_model);
/* Frees all that is in it. */
void pel_sim_release(pel_sim *sim);

/* ---- sim.c ---- */
/* keyed material numbers at a time */
void pel_sim_update_factors(pel_sim *sim, double time);

/* ---- refine.c ---- */
pel_status pel_refine_create(pel_sim *sim, pel_error *error);
void pel_refine_destroy(pel_sim *sim);
/* looks at a part of the vertices, refines and coarsens */
void pel_refine_step(pel_sim *sim);
/* the whole body on its finest level, or only the requested refinement; for stability checks */
void pel_refine_everywhere(pel_sim *sim, int32_t body, bool everywhere);
/* Initial refinement. PEL_BAD_ARGUMENT if a budget is too small for it. */
pel_status pel_refine_start(pel_sim *sim, pel_error *error);

/* ---- refine_criterion.c ---- */
typedef struct pel_verdict {
    double strength; /* largest measure over threshold; above 1 the vertex refines the triangles around it */
    bool warm;       /* a measure is above its lower threshold */
} pel_verdict;

/* Before the slices of a body are looked at in a step. */
void pel_refine_criterion_begin(pel_sim *sim, int32_t body);
/* the criteria at the vertices of a slice of a body, whose def uses any of them */
void pel_refine_criterion_slice(pel_sim *sim, int32_t body, int32_t slice, const pel_body_force *numbers,
                                pel_verdict verdicts[PEL_WIDTH]);
/* after loading a snapshot: resets data that it does not contain */
void pel_refine_criterion_forget(const pel_sim *sim, int32_t body);
static inline bool pel_refine_criterion_is_used(const pel_refine_def *def)
{
    return !def->everywhere && (def->above > 0 || def->curvature_above > 0 || def->near_tools > 0);
}

/* ---- surface_view.c ---- */
/* The rows of a body's arrays: vertex i of the mesh is row i, finer ones follow in the order of the forest. */
int32_t pel_output_vertex(const pel_sim *sim, int32_t body, int32_t v);
int32_t pel_output_count(const pel_sim *sim, int32_t body);
int32_t pel_output_model_index(const pel_sim *sim, int32_t body, int32_t row);
/* row of each vertex of the forest that is active; null = rows are the vertices of the mesh */
const int32_t *pel_output_numbers(const pel_sim *sim, int32_t body);
/* the triangles of the surface in an order that depends on the surface alone, for sums; null = triangles of the mesh in
   their order */
const pel_front_triangle *pel_surface_in_order(const pel_sim *sim, int32_t body);

/* ---- tool_create.c ---- */
pel_status pel_tools_create(pel_sim *sim, const pel_tool_def *defs, int32_t count, pel_error *error);
void pel_tools_destroy(pel_sim *sim);
/* Takes the numbers of the grasp of a def that differs in no other member, if they are right. PEL_BAD_ARGUMENT. */
pel_status pel_tool_regrasp(pel_sim *sim, int32_t tool, const pel_tool_def *def, pel_error *error);

/* its number, -1 = no such name */
int32_t pel_sim_find_tool(const pel_sim *sim, const char *name);

/* ---- tools.c ---- */
/* Begins a step: sets the wanted poses at `time` and updates grasps. The tools are moved to their wanted poses. */
void pel_tools_begin(pel_sim *sim, double time);
/* Before repeating the substeps of a step. */
void pel_tools_forget_step(pel_sim *sim);
/* Moves the tools to the end of a substep, at a share of their motion in this step, and finds where held vertices go.
 */
void pel_tools_place(pel_sim *sim, double share);
/* Moves the tools and their held vertices to the wanted poses. */
void pel_tools_move(pel_sim *sim, double time);
/* Returns them to the start of the step, if they have moved. */
void pel_tools_return(pel_sim *sim);
/* Moves the new positions out of the tools, or of spheres and capsules only. longest: spring length bound. */
void pel_tools_press(pel_sim *sim, double longest, bool only_round);

/* ---- tool_grip.c ---- */
/* Moves held vertices with them. */
void pel_tools_carry(pel_sim *sim);
/* After an accepted step to `time`: grasps lose vertices that exceed their force, tools that were held back are
   counted. */
void pel_tools_end_step(pel_sim *sim, double time);

/* ---- tool_reading.c ---- */
/* Reads the forces of the step. */
void pel_tools_read(pel_sim *sim, double time);

/* ---- tool_refine.c ---- */
/* Removes references of tools to triangles and places that the last event removed. */
void pel_tools_update(pel_sim *sim, int32_t body);

/* ---- tool_start.c ---- */
/* PEL_BAD_ARGUMENT for a tool that is in a body at present. */
pel_status pel_tool_check_start(pel_sim *sim, int32_t index, pel_error *error);
/* true when a point lies inside a closed body */
bool pel_tool_is_enclosed(const pel_sim *sim, const double point[3], int32_t body);

/* ---- observe.c ---- */
/* pel_sim_measure without areas, volumes and numbers of vertices, or without forces and energies: 0. */
void pel_sim_measure_parts(pel_sim *sim, bool has_surfaces, bool has_energies, pel_sim_measures *measures);

/* ---- step_beside.c ---- */
/* Features that pel_sim_step_beside refuses: PEL_BAD_ARGUMENT. */
pel_status pel_sim_check_beside(const pel_sim *sim, pel_sim *const *beside, int32_t count, pel_error *error);

/* whether there is such a body, for public functions that are given any number */
static inline bool pel_sim_has_body(const pel_sim *sim, int32_t body)
{
    return sim != NULL && body >= 0 && body < sim->model->body_count;
}

#endif
