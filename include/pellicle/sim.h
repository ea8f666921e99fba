/* Pellicle: the simulation. One pel_sim steps one state of one model under loads and tools.

       pel_sim_def def = pel_sim_def_default();
       def.model = model;
       pel_sim_create(&def, &sim, &error);
       while (pel_sim_time(sim) < 5.0)
           if (pel_sim_step(sim, &error) != PEL_OK) ...

   One thread at a time may use a pel_sim (inside a step, it uses threads of its own); different sims are independent.
   Vertex numbers and arrays are in the order of the body's mesh. A refined body has more vertices than its mesh: the
   rows of arrays are first the vertices of the mesh, then the active vertices of finer levels, coarser levels first. */
#ifndef PELLICLE_SIM_H
#define PELLICLE_SIM_H

#include "geometry.h"
#include "model.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum pel_method {
    PEL_METHOD_QUASI_STATIC, /* x += alpha F dt^2 / m (paper A, eq. A-5) */
    PEL_METHOD_EXPLICIT,     /* Euler's method on m a = F (paper A's baseline); the symplectic form is leapfrog */
    PEL_METHOD_PBD,          /* paper B: each energy is a constraint, solved by `iterations` Gauss-Seidel sweeps */
    PEL_METHOD_PBD_DISTANCE, /* position-based dynamics on edge lengths only */
    PEL_METHOD_XPBD,         /* extended position-based dynamics, strain form, `substeps` of one iteration each */
    PEL_METHOD_DESCENT, /* energy minimisation step by step, under tools and contacts: L-BFGS or gradient descent */
    PEL_METHOD_STATIC,  /* static equilibria by Newton's method, under tools and contacts */
    PEL_METHOD_IMPLICIT /* m a = F at the end of a step (BDF2, implicit midpoint), by Newton's method */
} pel_method;

/* A choice; PEL_AUTO leaves it to the library. */
typedef enum pel_choice { PEL_AUTO = -1, PEL_NO = 0, PEL_YES = 1 } pel_choice;

/* static: analysis of the equilibrium */
typedef enum pel_analysis {
    PEL_ANALYSIS_NONE,
    PEL_ANALYSIS_MODAL,   /* step n shows the mode of the n-th lowest frequency around the loaded state */
    PEL_ANALYSIS_BUCKLING /* step n shows the mode of the n-th lowest common factor of the loads that buckles the body
                             by linear theory */
} pel_analysis;

/* static: sequence of the loads */
typedef enum pel_path {
    PEL_PATH_TIME,      /* the loads at the time of each step */
    PEL_PATH_ARC_LENGTH /* one factor, starting at 0, multiplies loads, gravity and prescribed pressure. Each step
                           advances by an arc length along the equilibrium path, also where the factor decreases (limit
                           points). The path ends when the factor reaches 1. For loads without keys, tools and contact
                         */
} pel_path;

typedef struct pel_solver_def {
    pel_method method;
    double dt;          /* s, one step */
    double alpha;       /* quasi-static: step size; 0 = a stable value for this mesh */
    bool keep_velocity; /* quasi-static: F(x, v) with v = (x_t - x_(t-1)) / dt; false: v = 0 (damping has no effect) */
    bool symplectic;    /* explicit: v first, then x with the new v; false: forward Euler as in the paper */
    int32_t iterations; /* pbd, xpbd, descent: iterations per step or substep; 0 = 5, 1 and 500. descent with tools or
                           contact: per round, with up to 12 rounds per step; 0 = 50 */
    int32_t substeps; /* pbd, xpbd: substeps of a step. 0 = 1 for pbd; for xpbd the number that keeps stretch within 5 %
                         of the material's, updated during the run (pel_sim_softness) */
    int32_t max_substeps;    /* xpbd: maximum of automatic substeps; 0 = 200 */
    pel_choice second_order; /* xpbd: second order in time (BDF2), except for touching vertices. PEL_AUTO: without
                                tools, contact, gas and target volumes */
    double drag;             /* 1/s: velocities fall by exp(-drag t); pbd, xpbd, explicit */
    bool gradient_only;      /* descent: plain gradient descent (paper B's comparison) instead of L-BFGS */
    pel_analysis analysis;   /* static; modes ignore tools and contact */
    pel_path path;           /* static, without an analysis */
    int32_t mode_count;      /* of an analysis: number of modes, 1 to 1000 */
    double budget; /* s, static and implicit: a step ends after the linear solve in progress at this time, with the best
                      state so far (pel_solver_reading has the residual); results depend on the machine. 0 = none */
} pel_solver_def;

/* Meaning of a load's force. */
typedef enum pel_load_kind {
    PEL_LOAD_TOTAL,      /* N, distributed evenly over the vertices of the load */
    PEL_LOAD_PER_VERTEX, /* N on each vertex */
    PEL_LOAD_PER_LENGTH, /* N/m at rest, on boundary edges with both ends among them; half of each edge to each end */
    PEL_LOAD_MOMENT /* N m per metre of these edges: the component of `force` along each rest edge turns the surface
                       about the edge. For static and implicit with PEL_BENDING_MIDEDGE, on edges that keep
                       their direction */
} pel_load_kind;

/* A force on vertices during an interval of time. */
typedef struct pel_load_def {
    const char *name; /* nullable */
    int32_t body;
    pel_load_kind kind;
    double force[3];
    bool follower; /* PEL_LOAD_PER_LENGTH: the force rotates with each edge and its triangle, relative to rest;
                      quasi-static and descent hold it at its value from the start of the step. It has no potential, so
                      paths, modes and derivatives refuse it */
    const int32_t *vertices; /* (vertex_count); null = all vertices of the body */
    int32_t vertex_count;
    const double *weights; /* (vertex_count) factor per vertex (falloff); null = 1 */
    double from, until;    /* s; acts while from <= t < until */
    const pel_key *keys;   /* (key_count) factor over time; nullable */
    int32_t key_count;
} pel_load_def;

PEL_API pel_load_def pel_load_def_default(void);

typedef enum pel_tool_shape {
    PEL_TOOL_SPHERE,  /* radius */
    PEL_TOOL_CAPSULE, /* radius; axis along the tool's z from -half_length to +half_length */
    PEL_TOOL_BOX,     /* half_extents; sharp */
    PEL_TOOL_MESH,    /* mesh; needs contact (pel_contact_def) */
    PEL_TOOL_SUPPORT  /* a support with keys: no surface; holds `vertices` of `body` from the first step on */
} pel_tool_shape;

enum { PEL_TOOL_SHAPE_COUNT = PEL_TOOL_SUPPORT + 1 }; /* number of shapes */

/* Pose of a tool at a time: x -> exp(rotation_vector) rotation x + position.

   Between two keys positions are interpolated linearly, quaternions spherically along the shorter arc. Rotation
   vectors about one axis are interpolated linearly in the angle: from 0 to 2 pi is one full turn, from 0 to 4 pi two.
   Between different axes whole turns are interpolated linearly and the remaining rotations spherically. */
typedef struct pel_pose_key {
    double time;               /* s */
    double position[3];        /* m */
    double rotation[4];        /* unit quaternion x, y, z, w */
    double rotation_vector[3]; /* rad, axis times angle, after `rotation`; at most 1e6 turns; 0 = none */
} pel_pose_key;

/* A rigid instrument that pushes bodies away (press) and can hold vertices (grasp). */
typedef struct pel_tool_def {
    const char *name; /* unique, not empty */
    pel_tool_shape shape;
    double radius;            /* m */
    double half_length;       /* m */
    double half_extents[3];   /* m */
    const pel_mesh *mesh;     /* in the tool's frame, any surface; copied */
    const pel_pose_key *keys; /* (key_count >= 1), times increasing */
    int32_t key_count;
    int32_t body; /* the body it acts on; -1 = all */
    bool press;   /* keeps the body out of the tool */
    bool grasp;   /* holds the vertices inside it or within `reach` of its surface at grasp_from, until
                     grasp_until. Only a closed mesh has an inside */
    double grasp_from, grasp_until; /* s */
    double reach;                   /* m */
    double friction;                /* Coulomb's coefficient; below 0 (default): that of pel_contact_def */
    double restitution;             /* likewise */
    double thickness;               /* m, likewise */
    double grasp_max_force; /* N; 0 = no limit. Maximum sum of the magnitudes of the forces on the held vertices. If a
                               step ends above it, the vertices with the largest forces are released until the rest is
                               within it */
    /* PEL_TOOL_SUPPORT: x = R (X - center) + position with the rest position X and the pose (R, position) of the keys.
       The support starts at rest: position = center without rotation. If the body refines, a new vertex between two of
       them is held as well */
    const int32_t *vertices; /* (vertex_count) mesh vertices of `body`, none of them pinned, each once; copied */
    int32_t vertex_count;
    double center[3]; /* m, at rest */
} pel_tool_def;

PEL_API pel_tool_def pel_tool_def_default(void);
/* The surface of a tool in its own frame, wound outward, as results show it; of PEL_TOOL_MESH a copy of its mesh. Free
   with pel_mesh_destroy. PEL_BAD_ARGUMENT for PEL_TOOL_SUPPORT, no mesh and dimensions that are not finite,
   PEL_OUT_OF_MEMORY; *mesh is null then. */
PEL_API pel_status pel_tool_def_surface(const pel_tool_def *def, pel_mesh **mesh, pel_error *error);
/* The pose (position 3, unit quaternion 4) of the keys of a tool at a time [s]; constant before the first key and after
   the last. */
PEL_API void pel_tool_def_pose(const pel_tool_def *def, double time, double position[3], double rotation[4]);

/* A support of vertices: holds components of their positions, rigidly or by springs, and the rotation of edges. For the
   methods static and implicit. Pins and grasps take precedence. */
typedef struct pel_support_def {
    const char *name;
    int32_t body;            /* one that does not refine */
    const int32_t *vertices; /* (vertex_count) of the mesh; copied */
    int32_t vertex_count;
    double axes[3][3];      /* rows are orthonormal axes; default: x, y, z */
    bool fix[3];            /* held components along the axes; default: all */
    double displacement[3]; /* m, along the axes, from the rest position; of held components */
    double foundation;   /* N/m3, Winkler foundation: springs of this stiffness per rest area of the triangles with all
                            corners among the vertices, a third for each corner; replaces stiffness; 0 = none */
    const pel_key *keys; /* (key_count) factor on the displacement over time; null = 1 */
    int32_t key_count;
    double stiffness;  /* N/m of each vertex: springs hold the components; 0 = rigid */
    bool fix_rotation; /* edges with both ends among the vertices keep their normals (PEL_BENDING_MIDEDGE): an edge
                          held in space is clamped, one in a plane of symmetry keeps the surface normal to it */
} pel_support_def;

PEL_API pel_support_def pel_support_def_default(void);

/* When contacts are solved. */
typedef enum pel_contact_response {
    PEL_CONTACT_IN_LOOP, /* in every sweep of pbd and xpbd, in the minimisation of descent, and after the step until all
                            distances hold */
    PEL_CONTACT_AFTER    /* paper B: one correction after the step */
} pel_contact_response;

/* Contact of surfaces (paper B, section 4). If enabled, a step that starts without intersecting triangles (within a
   body, of two bodies, or of a body and a tool) ends without: the guard steps remaining violations back along their
   displacement, in the worst case to the start of the step. A tool stops while a body is trapped, and catches up
   afterwards. */
typedef struct pel_contact_def {
    bool enabled;
    bool self;                 /* contact within a body */
    bool between;              /* contact between bodies */
    double thickness;          /* m, default of bodies and tools; a pair keeps half of each thickness as distance;
                                  0 = relative_thickness */
    double relative_thickness; /* times the diagonal of the bounding box of all bodies, at most half the shortest edge,
                                  see pel_sim_contact_thickness */
    double friction; /* Coulomb's coefficient, default of bodies and tools; a pair has the geometric mean of both (the
                        mixing rule of Box2D: a frictionless partner makes the pair frictionless) */
    double restitution; /* 0 .. 1, default of bodies and tools; a pair has the larger one. The rigid motions of a pair
                           separate with this share of their normal approach velocity if that is at least 2 g dt; an
                           impulse adds no more energy than the run has dissipated. Below 0 (default): vertices stop at
                           each other, and elasticity decides the rebound. Methods with velocities only */
    pel_ccd_method method; /* detection of contacts; the guard at the end of a step is always conservative */
    pel_contact_response response;
    bool allow_tangled;   /* accept a start with intersections: ignore these pairs until they separate */
    int32_t sweeps;       /* maximum number of sweeps over the contacts after a step; 0 = 10 */
    int32_t limit;        /* maximum number of contacts; 0 = 64 per vertex. The guard handles the excess */
    int64_t memory_limit; /* bytes for the candidate pairs of a step; 0 = the larger of 1 GiB and 4 KiB per triangle. A
                             step that needs more fails with PEL_BAD_ARGUMENT; use a shorter step */
} pel_contact_def;

typedef struct pel_sim pel_sim;

typedef struct pel_sim_def {
    const pel_model *model;
    pel_solver_def solver;
    const pel_load_def *loads; /* (load_count), copied */
    int32_t load_count;
    const pel_tool_def *tools; /* (tool_count), copied */
    int32_t tool_count;
    const pel_support_def *supports; /* (support_count), copied */
    int32_t support_count;
    pel_contact_def contact;
    bool record_contacts; /* stores contacts for pel_sim_get_contact_records; default: false */
    int32_t thread_count; /* 0 = the processors of this machine; results do not depend on it */
    /* Called often during long steps (static, implicit, descent, and methods with 32 substeps or more), in the stepping
       thread; returning false ends the step with PEL_STOPPED. Must be fast, such as reading a flag. Nullable. */
    bool (*wanted)(void *user);
    void *user; /* passed to `wanted`; both must live as long as the simulation */
    /* True: `wanted` is also called in short steps with contact, PEL_METHOD_PBD or PEL_METHOD_XPBD. Such a step takes
       no snapshot, so after PEL_STOPPED the caller must load one. For callers that keep snapshots, such as sessions;
       default: false. */
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

/* The present surface of a body. Without refinement these are the counts and triangles of its mesh. */
PEL_API int32_t pel_sim_vertex_count(const pel_sim *sim, int32_t body);
PEL_API int32_t pel_sim_triangle_count(const pel_sim *sim, int32_t body);
/* true if the body has levels of detail */
PEL_API bool pel_sim_refines(const pel_sim *sim, int32_t body);
/* (triangle_count x 3) rows of the corners; in the order of the mesh, refined triangles replaced by their children */
PEL_API void pel_sim_get_triangles(const pel_sim *sim, int32_t body, int32_t *triangles);
/* (vertex_count x 3) rest position of each row */
PEL_API void pel_sim_get_rest_positions(const pel_sim *sim, int32_t body, double *positions);
/* (vertex_count) level of detail on which the vertex appears, 0 = of the mesh */
PEL_API void pel_sim_get_levels(const pel_sim *sim, int32_t body, int32_t *levels);
/* Place of each row in the body's mesh: triangle (vertex_count) and barycentric weights (vertex_count x 3). */
PEL_API void pel_sim_get_mesh_places(const pel_sim *sim, int32_t body, int32_t *triangles, double *weights);
/* (vertex_count) kg */
PEL_API void pel_sim_get_masses(const pel_sim *sim, int32_t body, double *masses);
/* Number of events that changed a body's surface; counts and triangles change only with it. */
PEL_API int64_t pel_sim_surface_revision(const pel_sim *sim, int32_t body);

/* Requests a minimum level for the `rings` (of the body's refine def) around a vertex of the mesh, regardless of the
   criterion; level 0 cancels the request. PEL_BAD_ARGUMENT for a body without refinement, for a vertex or level that
   does not exist, and if it would exceed the budget (nothing changes). Allocates nothing. */
PEL_API pel_status pel_sim_refine(pel_sim *sim, int32_t body, int32_t vertex, int32_t level, pel_error *error);

/* Copies the rows of one body: (vertex_count x 3). Velocity of the last step. Force on each vertex at the present
   state: the sum of eq., shell and loads, without contact [N]. */
PEL_API void pel_sim_get_positions(const pel_sim *sim, int32_t body, double *positions);
PEL_API void pel_sim_get_velocities(const pel_sim *sim, int32_t body, double *velocities);
PEL_API void pel_sim_get_forces(pel_sim *sim, int32_t body, double *forces);
/* m/s, of the fastest vertex of all bodies in the last step */
PEL_API double pel_sim_max_speed(const pel_sim *sim);
/* Elastic energy on each vertex (vertex_count) [J]: half of each spring at it plus its volumetric spring. */
PEL_API void pel_sim_get_energies(const pel_sim *sim, int32_t body, double *spring, double *volumetric);
/* Energies of a shell on each vertex (vertex_count) [J]: a third of membrane, fibres and mid-edge bending of each
   triangle, a quarter of the bending of each hinge at it; zeros if the body is no shell. */
PEL_API void pel_sim_get_shell_energies(const pel_sim *sim, int32_t body, double *membrane, double *bending,
                                        double *fibre);
/* Force of the body's pressure on each vertex (vertex_count x 3) [N]; zeros without pressure. */
PEL_API void pel_sim_get_pressure_forces(pel_sim *sim, int32_t body, double *forces);
/* Virial of springs and shell on each vertex (vertex_count) [J]: half of tension times length of each spring at it, and
   a third of the virial of each shell triangle at it. Divided by twice the vertex's area it is the mean tension of the
   net or sheet [N/m], positive in tension; the sum over all vertices is the derivative of the energy of springs,
   membrane and fibres with respect to the logarithm of the body's size. */
PEL_API void pel_sim_get_spring_virials(const pel_sim *sim, int32_t body, double *virials);
/* A triangle of a shell. Tensors lie in its plane and have the components xx, yy, zz, xy, yz, xz along the axes of
   space: strain and piola_stress in the rest plane, the others in the present one. Positive moments stretch the outer
   side (that of the normal). Bending follows small strain theory: the moment of a plate on the rest shape, rotated with
   the triangle. The moments of hinges are conjugate to their angles, so they have the Poisson's ratio of hinges. */
typedef struct pel_triangle_mechanics {
    double area, rest_area; /* m2, present and at rest */
    double thickness;       /* m, present: h J^(-nu / (1 - nu)), exact for incompressible sheets; 0 = none */
    double strain[6];       /* Green strain */
    double piola_stress[6]; /* Pa, second Piola-Kirchhoff, of membrane and fibres */
    double force[6];        /* N/m, resultant N of membrane and fibres per present length */
    double moment[6];       /* N, resultant M of bending per length */
    double membrane_energy, fibre_energy, bending_energy; /* J/m2, per area at rest */
} pel_triangle_mechanics;

/* Reads the triangles of a body (triangle_count) in the order of pel_sim_get_triangles; zeros if it is no shell. */
PEL_API void pel_sim_get_mechanics(pel_sim *sim, int32_t body, pel_triangle_mechanics *triangles);
/* Forces of contacts on each vertex (vertex_count x 3) [N], of other bodies, of the body itself and of tools, grasps
   included; a mean over the last step for methods with velocities, else at its end. The forces of a body on itself sum
   to zero, the forces of a tool on all bodies to minus the force on it, also at pinned vertices. Zeros without contact
   and tools. */
PEL_API void pel_sim_get_contact_forces(const pel_sim *sim, int32_t body, double *forces);
/* Sum of the forces of other bodies on a body in the last step [N], tools excluded. */
PEL_API void pel_sim_get_body_contact(const pel_sim *sim, int32_t body, double force[3]);

/* One contact of the last step, between two features of surfaces or a feature and a tool. A feature is a vertex or a
   point of an edge or triangle, given by its corners and their weights.

   The force on corner i is weights[i] times the force; over all records of a body these sum to
   pel_sim_get_contact_forces, over those of a tool to minus the force on it (pel_tool_reading). Forces are means over
   the step as there, and weights are means over its substeps: on a vertex the sums differ if contacts slide during the
   step. */
typedef struct pel_contact_record {
    int32_t bodies[2];   /* of the first and the second side; second side -1 = the tool */
    int32_t tool;        /* -1 = both sides belong to bodies */
    int32_t vertices[4]; /* rows of the body's arrays; -1 = unused */
    double weights[4]; /* above 0 on the first side, where they sum to 1, below 0 on the second, where they sum to -1 */
    double point[3];   /* m, of the first side, at present */
    double normal[3];  /* unit, from the second side to the first; for held vertices, out of the tool */
    double force[3];   /* N, on the first side */
    double gap;        /* m, between both sides along the normal, at present; below 0 = inside of the tool */
} pel_contact_record;

/* Number of contacts with a force in the last step, in the order in which they first acted. Zero without
   record_contacts, before the first step and after loading a snapshot. Excludes impulses of restitution between whole
   bodies. */
PEL_API int64_t pel_sim_contact_record_count(const pel_sim *sim);
/* Reads the contacts (pel_sim_contact_record_count). Gaps to mesh tools test all of their triangles. PEL_OUT_OF_MEMORY
   if memory for a record was missing in the last step. */
PEL_API pel_status pel_sim_get_contact_records(const pel_sim *sim, pel_contact_record *records, pel_error *error);

/* 1 if a tool touches or holds the vertex or it is in contact with a surface, else 0 (vertex_count). */
PEL_API void pel_sim_get_contacts(const pel_sim *sim, int32_t body, double *contact);

/* Setters for use between steps. Values are validated like the defs. */
PEL_API pel_status pel_sim_set_positions(pel_sim *sim, int32_t body, const double *positions, pel_error *error);
PEL_API pel_status pel_sim_set_velocities(pel_sim *sim, int32_t body, const double *velocities, pel_error *error);
PEL_API pel_status pel_sim_set_load_force(pel_sim *sim, int32_t load, const double force[3], pel_error *error);
/* Replaces the keys of the tool by a pose of the caller (haptic device, mouse). */
PEL_API pel_status pel_sim_set_tool_pose(pel_sim *sim, int32_t tool, const double position[3], const double rotation[4],
                                         pel_error *error);

PEL_API int32_t pel_sim_tool_count(const pel_sim *sim);
PEL_API const char *pel_sim_tool_name(const pel_sim *sim, int32_t tool);
/* Present pose, and loads of the bodies on the tool in the last step. */
typedef struct pel_tool_reading {
    double position[3];
    double rotation[4];
    double force[3];         /* N, on the tool */
    double torque[3];        /* N m about the tool's position */
    int32_t contact_count;   /* vertices touched or held */
    int32_t held_count;      /* vertices held by the grasp after the step */
    bool is_held_back;       /* contact stopped the tool in the last step, because a body was trapped */
    int64_t lost_count;      /* vertices released by grasp_max_force since the start */
    double lost_time;        /* s, end of the step that lost the first ones; 0 = none yet */
    int64_t held_back_count; /* steps in which the tool was stopped, since the start */
    double held_back_time;   /* s, end of the first of them; 0 = none yet */
} pel_tool_reading;
PEL_API void pel_sim_get_tool(const pel_sim *sim, int32_t tool, pel_tool_reading *reading);

/* Load of a body on its supports: pinned vertices, tools of PEL_TOOL_SUPPORT, and supports of the def.

   Position-based methods: the multipliers of the constraints at the pinned vertices and the loads on them, mean of the
   last step. Methods static and implicit: the forces of the equilibrium at the end of the last step. Other methods: the
   forces of the body and the loads at the pinned vertices in the present state. All include the weight of the pinned
   vertices and contacts on them in the last step. */
typedef struct pel_support_reading {
    double force[3];      /* N, on the supports */
    double torque[3];     /* N m, about the origin */
    int32_t vertex_count; /* vertices pinned or held by them; 0 = the body has no support */
} pel_support_reading;
PEL_API void pel_sim_get_support(pel_sim *sim, int32_t body, pel_support_reading *reading);

/* Single supports of the def: the force along the held components. Zero before the first step. */
PEL_API int32_t pel_sim_support_count(const pel_sim *sim);
PEL_API const char *pel_sim_support_name(const pel_sim *sim, int32_t support);
PEL_API void pel_sim_get_support_part(const pel_sim *sim, int32_t support, pel_support_reading *reading);

/* Statistics of contact, summed over all steps since the start. All zero without contact. */
typedef struct pel_contact_statistics {
    int64_t candidates;                                /* pairs with overlapping boxes, of all searches */
    int64_t passed_filter;                             /* not excluded by the non-penetration filter */
    int64_t passed_hull;                               /* nor by separating axes */
    int64_t cubics;                                    /* solved for a time of impact */
    int64_t contacts;                                  /* records of contacts, all steps */
    int64_t dropped;                                   /* contacts beyond the limit */
    int64_t rounds;                                    /* of search and correction */
    int64_t fall_backs;                                /* vertices stepped back, all steps */
    int64_t tools_held;                                /* tools stopped, all steps */
    int64_t tangled;                                   /* pairs of triangles that intersect at present */
    double find_seconds, solve_seconds, guard_seconds; /* searching, correcting, guarding the end of the step */
} pel_contact_statistics;
PEL_API void pel_sim_get_contact_statistics(const pel_sim *sim, pel_contact_statistics *statistics);

/* m, default thickness of bodies and tools; 0 without contact */
PEL_API double pel_sim_contact_thickness(const pel_sim *sim);

/* Number of intersecting pairs of triangles of the present surfaces and tools, by the exact test
   (pel_mesh_self_intersections); excludes spheres and capsules. PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_sim_intersections(pel_sim *sim, int64_t *count, pel_error *error);

/* xpbd: excess stretch of springs and shells relative to their material (0.1 = 10 %), because one sweep per substep
   does not converge. It is proportional to the square of the substep (docs/shells.md: derivation and measurements) and
   estimated at the start, every 8 to 32 steps and after refinement. 0 for other methods. */
PEL_API double pel_sim_softness(const pel_sim *sim);

/* Convergence of the last step of PEL_METHOD_DESCENT, STATIC or IMPLICIT, and the substeps of position-based methods;
   zero for others. */
typedef struct pel_solver_reading {
    bool solves; /* the method solves for balanced forces in each step: the next members are valid */
    int32_t iterations;
    int32_t evaluations; /* of energy and forces */
    double energy;       /* J, with the potential of loads and pressure */
    double residual;     /* N, root of the sum of squares of the forces, contact included, on all free components */
    bool unstable;       /* static: an equilibrium that is no minimum of the energy; none was found nearby */
    int32_t stray_body;  /* static, descent: a body held only by contact that moved farther than all tools by at least
                            half its size; -1 = none */
    double stray_way;    /* m, displacement of this body */
    bool has_budget;     /* solver.budget is set */
    bool converged;   /* every gap is within tolerance, and residual is at most 1e-6 (2e-3 in float) of the forces that
                         act: loads, pressure, contacts, grasps; without any, of the largest earlier ones */
    int32_t substeps; /* of the last step; of the next one before the first step */
    int32_t least_substeps, most_substeps; /* of all steps taken */
    int32_t needed_substeps;               /* xpbd: largest automatic number without the limit max_substeps */
    bool second_order;                     /* xpbd: in use */
    double softness, most_softness;        /* pel_sim_softness, and its maximum over the steps */
} pel_solver_reading;
PEL_API void pel_sim_get_solver(const pel_sim *sim, pel_solver_reading *reading);

/* Results of an analysis after its first step: Hz, or load factors, ascending; values (at most mode_count) may be null.
   Returns their number, 0 before. Modes have a largest displacement of 5 % of the largest body. */
PEL_API int32_t pel_sim_get_modes(const pel_sim *sim, double *values);
PEL_API pel_analysis pel_sim_analysis(const pel_sim *sim);
/* value of the mode shown by the present state; 0 = none */
PEL_API double pel_sim_mode_value(const pel_sim *sim);

/* Factor of all loads, gravity and prescribed pressure in the present state: 1 except along PEL_PATH_ARC_LENGTH. */
PEL_API double pel_sim_load_factor(const pel_sim *sim);
PEL_API pel_path pel_sim_path_kind(const pel_sim *sim);

/* State of a path along PEL_PATH_ARC_LENGTH; steps beyond its end change nothing. */
typedef enum pel_path_end {
    PEL_PATH_GOES_ON,
    PEL_PATH_END_FULL_LOAD, /* the factor is 1 */
    PEL_PATH_END_LOST       /* no step, however short, finds an equilibrium: bifurcation or collapse */
} pel_path_end;
PEL_API pel_path_end pel_sim_get_path_end(const pel_sim *sim);

/* Derivatives of a function f of the positions with respect to one body's material. Those for young, thickness and
   poisson include bending if its stiffness is automatic. */
typedef struct pel_adjoint_material {
    double young, thickness; /* for a factor, 1 at present, on the whole body: df/dE = young / E for a uniform E */
    double poisson;          /* for the ratio */
    double bending;          /* for a factor on the flexural rigidity only */
    double pressure;         /* for a factor on the pressure */
} pel_adjoint_material;

/* Inputs and results of pel_sim_adjoint; initialise with zeros. Arrays of vertices: body after body, vertices of their
 * meshes. */
typedef struct pel_adjoint {
    const double *positions; /* (vertices x 3) df/dx [1/m] at the present state */
    /* results, nullable */
    double *forces;                  /* (vertices x 3) for a force on each vertex, 1/N; 0 where held */
    double *rest_positions;          /* (vertices x 3) for rest positions, 1/m, of membranes and mid-edge bending; with
                                        constant masses and vertex forces; held vertices move along */
    double *loads;                   /* (load_count of the def) for a factor, 1 at present, on each load */
    double *gravity;                 /* (3) for gravity, s2/m */
    pel_adjoint_material *materials; /* (body_count) */
} pel_adjoint;

/* Derivatives of a function of the positions with respect to parameters of the model, from one linear system with the
   matrix of the present state (adjoint method: Strang, Computational Science and Engineering, section 8.7).
   PEL_METHOD_STATIC: of the equilibrium, which must have converged; free bodies are fixed at three of their vertices.
   PEL_METHOD_IMPLICIT: of the end of the last step for a constant state at its start, not along time.

   Without tools and contact; pressure with a potential. PEL_BAD_ARGUMENT for unsupported features, if the state is no
   stable equilibrium, and under the method implicit before the first step after the start or pel_sim_load;
   PEL_OUT_OF_MEMORY. Does not change the simulation. */
PEL_API pel_status pel_sim_adjoint(pel_sim *sim, const pel_adjoint *def, pel_error *error);

/* A state of a sequence of steps, and the derivatives of a function with respect to it. */
typedef struct pel_adjoint_point {
    int64_t step;                         /* number within the sequence, from 1 */
    const double *positions, *velocities; /* (vertices x 3) m, m/s after it; vertices as in pel_adjoint */
    double *by_positions, *by_velocities; /* (vertices x 3) derivatives of the function [1/m, s/m]; default: 0
                                           */
} pel_adjoint_point;

/* Inputs and results of pel_sim_adjoint_steps; initialise with zeros. */
typedef struct pel_adjoint_steps {
    int64_t step_count;
    /* Called with the state after the last step or, if is_running, after each step from the last to the first.
       Returning false ends with PEL_STOPPED. */
    bool (*gradient)(void *user, const pel_adjoint_point *point);
    void *user;
    bool is_running;     /* the function depends on all steps */
    pel_adjoint results; /* `positions` is not read; derivatives are summed over all steps */
    /* (vertices x 3) for the initial state [1/m, s/m]; 0 where held. Nullable. Derivatives for rest positions assume a
       constant initial state: for bodies that start at rest add the two. */
    double *start_positions, *start_velocities;
} pel_adjoint_steps;

/* Takes step_count steps of PEL_METHOD_IMPLICIT and computes the derivatives of a function of them
   (src/simulation/sim/adjoint_steps.c has the equations). The steps are solved to rounding, so they differ slightly
   from those of pel_sim_step. The simulation ends after the steps, or at their start on failure. Takes the time of
   three to five times as many steps, and memory for 2 sqrt(step_count) snapshots.

   PEL_BAD_ARGUMENT as pel_sim_adjoint, and for refinement, damping of volumetric springs, fibres along principal
   directions, moments on edges, a budget, and steps that do not converge. PEL_STOPPED by the gradient;
   PEL_OUT_OF_MEMORY. Masses and drag are constant. */
PEL_API pel_status pel_sim_adjoint_steps(pel_sim *sim, const pel_adjoint_steps *def, pel_error *error);

/* Takes a step of sim and, beside it, one of each of `beside` (count): simulations of the same bodies that differ by
   small changes of numbers and have taken the same steps. They are solved by chord iterations with the matrix of sim at
   the end of its step: two or three solutions per step instead of the factorizations of Newton's method
   (src/solver/newton/beside.c). To get the derivative of a reading with respect to a number along the steps, use
   two simulations, in which the number is slightly smaller and slightly larger, and divide the difference of the
   reading by the difference of the number. For PEL_METHOD_STATIC (including arc length) and PEL_METHOD_IMPLICIT,
   without tools, contact, refinement, analyses and a time budget. The call fails if a step does not converge; the
   simulations may then be at different steps. PEL_BAD_ARGUMENT for unsupported features, for simulations that do not
   match, and for changes that are too large; PEL_OUT_OF_MEMORY; errors of pel_sim_step. */
PEL_API pel_status pel_sim_step_beside(pel_sim *sim, pel_sim *const *beside, int32_t count, pel_error *error);

/* Sums over all bodies; the first columns of series.csv. */
typedef struct pel_sim_measures {
    double volume_ratio;       /* enclosed volume of closed bodies relative to rest; 1 if none is closed */
    double least_volume_ratio; /* smallest volume ratio of a body; at most 0 if it is inside out */
    double area_ratio;         /* area relative to rest */
    double kinetic_energy;     /* J, at the time of the positions (velocities of leapfrog are half a step earlier) */
    double elastic_energy;     /* J, the sum of the five below */
    double spring_energy;      /* J */
    double volumetric_energy;  /* J */
    double membrane_energy, bending_energy, fibre_energy; /* J, of shells */
    double max_displacement;                              /* m, from the rest position */
    double max_force;                                     /* N, largest vertex force as in pel_sim_get_forces */
    double unbalanced_force; /* N, sum of the magnitudes of these forces on free vertices: neither pinned, held nor
                                touched */
    int64_t vertex_count, triangle_count, contact_count;
} pel_sim_measures;
PEL_API void pel_sim_measure(pel_sim *sim, pel_sim_measures *measures);
/* Only volume_ratio, without the cost of forces. */
PEL_API double pel_sim_volume_ratio(const pel_sim *sim);
/* True if any body is a shell (membrane, bending, fibres or pressure). */
PEL_API bool pel_sim_has_shells(const pel_sim *sim);

/* Energy balance since the start, in J: supplied, stored and dissipated energy, and the remainder.

     energy_error - dissipated_solver = change + dissipated_drag - work
     change = elastic + kinetic - elastic_start - kinetic_start
     work = work_tools + work_loads + ... + work_setters

   A negative remainder is dissipation by friction, contact, and the numerical damping of implicit, quasi-static and
   position-based methods. A positive one is energy that appeared: the step is too long, the method does not follow the
   material, or contact and tools add energy. docs/results.md has the rule of each work. */
typedef struct pel_sim_ledger {
    double work_tools;    /* by tools, grasps and supports on bodies: from their readings and motions */
    double work_loads;    /* mean force times displacement */
    double work_pressure; /* of prescribed pressure, enclosed gas or target volume */
    double work_gravity;
    double work_material; /* of time-dependent parameters: keyed stiffness of springs, active fibres */
    double work_setters; /* change of energy by pel_sim_set_positions and pel_sim_set_velocities after the first step */
    double elastic, kinetic;             /* at present; kinetic is 0 for methods without velocities */
    double elastic_start, kinetic_start; /* before the first step */
    double dissipated_drag;              /* by drag of the solver and damping of vertices */
    double dissipated_solver;            /* magnitude of a negative remainder */
    double energy_error;                 /* a positive remainder */
    double supplied;  /* largest sum, over the steps, of the start energies and the magnitudes of all works */
    double tolerance; /* raise an alarm if energy_error exceeds it: 5 % of supplied, plus rounding */
} pel_sim_ledger;
/* Works are summed in each step; the energies are evaluated here. */
PEL_API void pel_sim_get_ledger(pel_sim *sim, pel_sim_ledger *ledger);

/* 64-bit hash of time, positions and velocities in mesh order: equal for equal bits. */
PEL_API uint64_t pel_sim_hash(const pel_sim *sim);

/* Saves all data with which pel_sim_load continues with the same bits, including contact statistics and ledger, into a
   buffer of pel_sim_save_size bytes (constant for one sim). pel_sim_load refuses (PEL_BAD_FORMAT, state unchanged) a
   snapshot that is damaged, of another version or precision, or of other defs, with the parts that differ ("made with
   other: gravity, tools"). Only a forged snapshot, with a valid checksum and numbers out of range, may change the state
   before it is refused. */
PEL_API size_t pel_sim_save_size(const pel_sim *sim);
PEL_API void pel_sim_save(const pel_sim *sim, void *bytes);
PEL_API pel_status pel_sim_load(pel_sim *sim, const void *bytes, size_t size, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
