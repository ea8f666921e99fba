/* Pellicle: the simulation. One pel_sim steps one state of one model under loads and tools.

       pel_sim_def def = pel_sim_def_default();
       def.model = model;
       pel_sim_create(&def, &sim, &error);
       while (pel_sim_time(sim) < 5.0)
           if (pel_sim_step(sim, &error) != PEL_OK) ...

   A pel_sim is used by one thread at a time (it uses threads of its own inside a step); different sims are independent.
   Vertex numbers and arrays are in the order of the body's mesh. A body that refines has more vertices than its mesh at
   times: rows of arrays are the vertices of the mesh first, then the finer ones that are active, coarser levels first.
 */
#ifndef PELLICLE_SIM_H
#define PELLICLE_SIM_H

#include "geometry.h"
#include "model.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum pel_method {
    PEL_METHOD_QUASI_STATIC, /* x += alpha F dt^2 / m (paper A, eq. A-5) */
    PEL_METHOD_EXPLICIT,     /* Euler's method on m a = F (paper A's baseline); symplectic it is the leapfrog */
    PEL_METHOD_PBD,          /* paper B: each energy is a constraint, met by `iterations` sweeps of Gauss-Seidel */
    PEL_METHOD_PBD_DISTANCE, /* position-based dynamics on edge lengths alone */
    PEL_METHOD_XPBD,         /* extended position-based dynamics, strain form, `substeps` of one iteration each */
    PEL_METHOD_DESCENT, /* energy minimisation step by step, under tools and contacts: L-BFGS or gradient descent */
    PEL_METHOD_STATIC,  /* states of rest by Newton's method, under tools and contacts */
    PEL_METHOD_IMPLICIT /* m a = F at the end of a step (BDF2, implicit midpoint), by Newton's method */
} pel_method;

/* A choice that may be left to the library. */
typedef enum pel_choice { PEL_AUTO = -1, PEL_NO = 0, PEL_YES = 1 } pel_choice;

/* static: what is asked of the state of rest */
typedef enum pel_analysis {
    PEL_ANALYSIS_NONE,
    PEL_ANALYSIS_MODAL,   /* step n shows the mode of the n-th lowest frequency about the state under the loads */
    PEL_ANALYSIS_BUCKLING /* step n shows the mode of the n-th lowest factor of the loads, all alike, that buckles the
                             body by linear theory */
} pel_analysis;

/* static: which loads the steps go through */
typedef enum pel_path {
    PEL_PATH_TIME,      /* those at the time of each step */
    PEL_PATH_ARC_LENGTH /* loads, gravity and given pressure times one factor that starts at 0: each step goes a length
                           along the path of balances, also where the factor falls (limit points). The path ends where
                           the factor reaches 1. For loads without keys, without tools and contact */
} pel_path;

typedef struct pel_solver_def {
    pel_method method;
    double dt;          /* s, one step */
    double alpha;       /* quasi-static: size of a step; 0 = a safe value for this mesh */
    bool keep_velocity; /* quasi-static: F(x, v) with v = (x_t - x_(t-1)) / dt; false: v = 0 (damping has no effect) */
    bool symplectic;    /* explicit: v first, then x with the new v; false: forward Euler as in the paper */
    int32_t iterations; /* pbd, xpbd, descent: sweeps in a step or substep; 0 = 5, 1 and 500. descent with tools or
                           contact: in each of up to 12 rounds of a step; 0 = 50 */
    int32_t substeps;   /* pbd, xpbd: a step of dt is done in this many. 0 = 1 for pbd; for xpbd as many as keep stretch
                           within 5 % of the material's, chosen anew while running (pel_sim_softness) */
    int32_t max_substeps;    /* xpbd: automatic substeps, at most; 0 = 200 */
    pel_choice second_order; /* xpbd: second order in time (BDF2), not for bodies that touch. PEL_AUTO: without tools,
                                contact, gas and target volumes */
    double drag;             /* 1/s: velocities fall by exp(-drag t); pbd, xpbd, explicit */
    bool gradient_only;      /* descent: plain gradient descent (paper B's comparison) instead of L-BFGS */
    pel_analysis analysis;   /* static; tools and contact have no part in modes */
    int32_t mode_count;      /* of an analysis: modes to find, 1 to 1000 */
    pel_path path;           /* static, without an analysis */
    double
        budget; /* s, static and implicit: a step ends after the linear solve that is at work then, at the best state
                   by then (pel_solver_reading tells the residual); what comes out depends on the machine. 0 = none */
} pel_solver_def;

/* What a load's force means. */
typedef enum pel_load_kind {
    PEL_LOAD_TOTAL,      /* N, shared out evenly over the vertices of the load */
    PEL_LOAD_PER_VERTEX, /* N on each of them */
    PEL_LOAD_PER_LENGTH, /* N/m at rest, on boundary edges with both ends among them; half of each edge to each end */
    PEL_LOAD_MOMENT      /* N m per metre of these edges: the part of `force` along each edge at rest turns the surface
                            about the edge. Static and implicit, PEL_BENDING_MIDEDGE. For edges that keep their
                            direction */
} pel_load_kind;

/* A force on some vertices during some time. */
typedef struct pel_load_def {
    const char *name; /* nullable */
    int32_t body;
    pel_load_kind kind;
    double force[3];
    bool follower; /* PEL_LOAD_PER_LENGTH: the force turns with each edge and its triangle, from where they are at rest;
                      quasi-static and descent take it as it is at the start of a step. Without potential, so not along
                      a path, for modes and for derivatives */
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
    PEL_TOOL_SUPPORT  /* a support that moves on keys: no surface; holds `vertices` of `body` from the first step on */
} pel_tool_shape;

/* Pose of a tool at a time: x -> exp(rotation_vector) rotation x + position.

   Between two keys positions are linear. Quaternions are interpolated spherically, along the shorter arc. Rotation
   vectors about one axis are linear in the angle as written: 0 and 2 pi are a full turn, 0 and 4 pi two. Between
   different axes the whole turns of either are linear, and what remains of both is interpolated spherically. */
typedef struct pel_pose_key {
    double time;               /* s */
    double position[3];        /* m */
    double rotation[4];        /* unit quaternion x, y, z, w */
    double rotation_vector[3]; /* rad, axis times angle, after `rotation`; at most 1e6 turns; 0 = none */
} pel_pose_key;

/* A rigid instrument that pushes bodies out of its way (press) and can hold vertices (grasp). */
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
    bool grasp;   /* holds the vertices that are inside it or within `reach` of its surface at grasp_from, until
                     grasp_until. A mesh has an inside when it is closed; of an open one its surface counts */
    double grasp_from, grasp_until; /* s */
    double reach;                   /* m */
    double friction;        /* Coulomb's coefficient, see pel_contact_def; below 0, as by default: that of contact */
    double restitution;     /* the same, see pel_contact_def */
    double thickness;       /* m; the same */
    double grasp_max_force; /* N; 0 = no limit. Largest sum of the magnitudes of the forces on the held vertices. Where
                               a step ends above it, the vertices with the largest forces are released first, until the
                               forces of the rest are within it */
    /* PEL_TOOL_SUPPORT: x = R (X - center) + position with the vertex at rest X and the pose (R, position) of the keys,
       so position = center and no rotation is the shape at rest, where the support starts. Where the body refines, a
       vertex between two of them is held as well */
    const int32_t *vertices; /* (vertex_count) mesh vertices of `body`, none of them pinned, each once; copied */
    int32_t vertex_count;
    double center[3]; /* m, at rest */
} pel_tool_def;

PEL_API pel_tool_def pel_tool_def_default(void);
/* The pose (position 3, unit quaternion 4) that the keys of a tool give at a time [s]; before the first key and after
   the last it stands still. */
PEL_API void pel_tool_def_pose(const pel_tool_def *def, double time, double position[3], double rotation[4]);

/* A support of vertices: holds components of their positions, rigidly or by springs, and the rotation of edges. For the
   methods static and implicit. A pinned or grasped vertex is held by its pin or tool alone. */
typedef struct pel_support_def {
    const char *name;
    int32_t body;            /* one that does not refine */
    const int32_t *vertices; /* (vertex_count) of the mesh; copied */
    int32_t vertex_count;
    double axes[3][3];      /* rows are orthonormal axes; default: x, y, z */
    bool fix[3];            /* components along the axes that are held; default: all */
    double displacement[3]; /* m, along the axes, from the place at rest; of components that are held */
    const pel_key *keys;    /* (key_count) factor on the displacement over time; null = 1 */
    int32_t key_count;
    double stiffness;  /* N/m of each vertex: components are held by springs; 0 = rigid */
    double foundation; /* N/m3, elastic foundation of Winkler: springs of this stiffness per area at rest, over the
                          triangles with all corners among the vertices, a third of each to each; instead of stiffness;
                          0 = none */
    bool fix_rotation; /* edges with both ends among the vertices keep their normals (PEL_BENDING_MIDEDGE): an edge that
                          is held in space is clamped, one that slides in a plane of symmetry stays normal to it */
} pel_support_def;

PEL_API pel_support_def pel_support_def_default(void);

/* When contacts are solved. */
typedef enum pel_contact_response {
    PEL_CONTACT_IN_LOOP, /* in every sweep of pbd and xpbd, in the minimisation of descent, and after the step until
                            nothing is too near */
    PEL_CONTACT_AFTER    /* paper B: one correction after the step */
} pel_contact_response;

/* Contact of surfaces (paper B, section 4). When it is enabled, no step ends with two triangles that cut each other, in
   one body, of two bodies, or of a body and a tool, provided that the step began so: what contacts cannot keep apart is
   stepped back along its way, in the worst case to where it was. Tools too are held back where a body cannot give way;
   they catch up when it can. */
typedef struct pel_contact_def {
    bool enabled;
    bool self;                 /* parts of one body touch each other */
    bool between;              /* different bodies touch each other */
    double thickness;          /* m, of bodies and tools that have none of their own; a pair keeps the sum of both
                                  halves as distance; 0 = relative_thickness */
    double relative_thickness; /* times the diagonal of the box about all bodies; at most half the shortest edge is
                                  taken, see pel_sim_contact_thickness */
    double friction; /* Coulomb's coefficient of bodies and tools that have none of their own; a pair has the geometric
                        mean of both (the mixing rule of Box2D: a smooth partner makes the pair smooth) */
    double restitution; /* 0 .. 1, of bodies and tools that have none of their own; a pair has the larger one. The rigid
                           motions of a pair part with this share of the normal velocity with which they met, from an
                           approach of 2 g dt on; an impulse adds no more energy than the run has lost. Below 0, as by
                           default: vertices stop at each other, and bodies part as their elasticity makes them. Methods
                           with velocities only */
    pel_ccd_method method; /* how contacts are found; what guards the end of a step is always conservative */
    pel_contact_response response;
    bool allow_tangled; /* a start with intersections is accepted: those pairs are left alone until they are apart */
    int32_t sweeps;     /* over the contacts after a step, at most; 0 = 10 */
    int32_t limit;      /* the most contacts; 0 = 64 per vertex. What does not fit is left to the guard */
    int64_t
        memory_limit; /* bytes for pairs that come near each other in a step; 0 = 1 GiB, or 4 KiB per triangle if that
                         is more. A step that needs more fails with PEL_BAD_ARGUMENT: a shorter one needs less */
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
    bool record_contacts; /* keeps what pel_sim_get_contact_records reads; false by default */
    int32_t thread_count; /* 0 = as many as the machine has; the results do not depend on it */
    /* Asked many times in each long step (static, implicit, descent, and methods with 32 substeps or more), in the
       thread that steps; false ends the step with PEL_STOPPED. Has to be quick: a look at a flag. Nullable. */
    bool (*wanted)(void *user);
    void *user; /* handed to `wanted`; both have to live as long as the simulation */
    uint32_t cookie;
} pel_sim_def;

PEL_API pel_sim_def pel_sim_def_default(void);

/* Checks everything against the mesh: PEL_UNSTABLE with the limit when alpha or dt is too large, PEL_BAD_ARGUMENT for
   numbers out of range, a load on no vertex, a tool that starts inside a body; with contact: bodies that start
   intersecting (the number of pairs and the first ones are named), a thickness larger than the shortest edge. Free with
   pel_sim_destroy. */
PEL_API pel_status pel_sim_create(const pel_sim_def *def, pel_sim **sim, pel_error *error);
PEL_API void pel_sim_destroy(pel_sim *sim);

/* Substeps that PEL_METHOD_XPBD needs on a model at rest: what `substeps = 0` takes as far as max_substeps allows. A
   body that is refined everywhere counts on its finest level. PEL_BAD_ARGUMENT as pel_sim_create, PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_sim_needed_substeps(const pel_sim_def *def, int32_t *count, pel_error *error);

/* One step of dt. PEL_DIVERGED (with the first bad vertex, the step and the likely parameter) leaves the state as it
   was before the step. PEL_STOPPED (`wanted` of the def said no) leaves it so too, with all that the next steps depend
   on: they have the same bits as without the stop. No memory is allocated, but for a snapshot by the first step that
   asks; with contact, with records of contacts, and by tools under PEL_METHOD_DESCENT, only where a step has more pairs
   than any before, after refinement and while surfaces are tangled. PEL_BAD_ARGUMENT when far too many pairs come near,
   PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_sim_step(pel_sim *sim, pel_error *error);

PEL_API double pel_sim_time(const pel_sim *sim); /* s, step count x dt */
/* bytes that a step has to read and write, each array counted once */
PEL_API size_t pel_sim_step_bytes(const pel_sim *sim);
PEL_API int64_t pel_sim_step_count(const pel_sim *sim); /* steps done */
PEL_API const pel_model *pel_sim_model(const pel_sim *sim);
PEL_API double pel_sim_alpha(const pel_sim *sim);       /* the alpha in use; 0 for the explicit method */
PEL_API double pel_sim_alpha_limit(const pel_sim *sim); /* the stability limit found for this mesh */

/* The surface of a body at present. Without refinement these are the counts and triangles of its mesh. */
PEL_API int32_t pel_sim_vertex_count(const pel_sim *sim, int32_t body);
PEL_API int32_t pel_sim_triangle_count(const pel_sim *sim, int32_t body);
/* true when the body has levels of detail */
PEL_API bool pel_sim_refines(const pel_sim *sim, int32_t body);
/* (triangle_count x 3) rows of their corners; in the order of the mesh, refined triangles replaced by their children */
PEL_API void pel_sim_get_triangles(const pel_sim *sim, int32_t body, int32_t *triangles);
/* (vertex_count x 3) rest position of each row */
PEL_API void pel_sim_get_rest_positions(const pel_sim *sim, int32_t body, double *positions);
/* (vertex_count) level of detail on which the vertex appears, 0 = of the mesh */
PEL_API void pel_sim_get_levels(const pel_sim *sim, int32_t body, int32_t *levels);
/* Where each row lies in the body's mesh: triangle (vertex_count) and the weights (vertex_count x 3) of its corners. */
PEL_API void pel_sim_get_mesh_places(const pel_sim *sim, int32_t body, int32_t *triangles, double *weights);
/* (vertex_count) kg */
PEL_API void pel_sim_get_masses(const pel_sim *sim, int32_t body, double *masses);
/* Number of events so far that changed a body's surface; while it stays, counts and triangles stay. */
PEL_API int64_t pel_sim_surface_revision(const pel_sim *sim, int32_t body);

/* Asks that the `rings` (of the body's refine def) around a vertex of the mesh be on a level at least, whatever the
   criterion says; level 0 takes that back. PEL_BAD_ARGUMENT for a body without refinement, a vertex or level that does
   not exist, and when the budget would be exceeded (nothing changes then). Allocates nothing. */
PEL_API pel_status pel_sim_refine(pel_sim *sim, int32_t body, int32_t vertex, int32_t level, pel_error *error);

/* Copies out for one body: (vertex_count x 3). Velocity is that of the last step. Force is the sum of all forces of
   eq., of the shell and of the loads on each vertex at the present state, contact excluded [N]. */
PEL_API void pel_sim_get_positions(const pel_sim *sim, int32_t body, double *positions);
PEL_API void pel_sim_get_velocities(const pel_sim *sim, int32_t body, double *velocities);
PEL_API void pel_sim_get_forces(pel_sim *sim, int32_t body, double *forces);
/* m/s, of the fastest vertex of all bodies in the last step */
PEL_API double pel_sim_max_speed(const pel_sim *sim);
/* Elastic energy on each vertex (vertex_count) [J]: half of each spring at it plus its volumetric spring. */
PEL_API void pel_sim_get_energies(const pel_sim *sim, int32_t body, double *spring, double *volumetric);
/* Energies of a shell on each vertex (vertex_count) [J]: a third of membrane, fibres and mid-edge bending of each
   triangle, a quarter of the bending of each hinge at it; zeros when the body is no shell. */
PEL_API void pel_sim_get_shell_energies(const pel_sim *sim, int32_t body, double *membrane, double *bending,
                                        double *fibre);
/* Force of the body's pressure on each vertex (vertex_count x 3) [N]; zeros without pressure. */
PEL_API void pel_sim_get_pressure_forces(pel_sim *sim, int32_t body, double *forces);
/* Virial of springs and shell on each vertex (vertex_count) [J]: half of tension times length of each spring at it, a
   third of that of each triangle of a shell. Over twice the vertex's area this is the mean tension of the net or sheet
   [N/m], positive where it is stretched; the sum over all vertices is the derivative of the energy of springs, membrane
   and fibres by the logarithm of the body's size. */
PEL_API void pel_sim_get_spring_virials(const pel_sim *sim, int32_t body, double *virials);
/* A triangle of a shell. Tensors lie in its plane and have the components xx, yy, zz, xy, yz, xz along the axes of
   space: strain and piola_stress in the plane at rest, the others in the present one. Positive moments stretch the
   outer side (that of the normal). Bending follows small strain theory: the moment is that of a plate on the rest
   shape, carried along. The moments of hinges are those conjugate to their angles, so Poisson's ratio in bending is
   that of hinges. */
typedef struct pel_triangle_mechanics {
    double area, rest_area; /* m2, present and at rest */
    double thickness;       /* m, present: h J^(-nu / (1 - nu)), exact for incompressible sheets; 0 = none */
    double strain[6];       /* Green strain */
    double piola_stress[6]; /* Pa, second Piola-Kirchhoff, of membrane and fibres */
    double force[6];        /* N/m, resultant N of membrane and fibres per present length */
    double moment[6];       /* N, resultant M of bending per length */
    double membrane_energy, fibre_energy, bending_energy; /* J/m2, per area at rest */
} pel_triangle_mechanics;

/* Reads the triangles of a body (triangle_count) in the order of pel_sim_get_triangles; zeros when it is no shell. */
PEL_API void pel_sim_get_mechanics(pel_sim *sim, int32_t body, pel_triangle_mechanics *triangles);
/* Forces of contacts on each vertex (vertex_count x 3) [N], of other bodies, of the body itself and of tools, grasps
   included; a mean over the last step for methods with velocities, else at its end. Over a body the forces of the body
   itself add up to zero, over all bodies those of a tool to the force on it with the other sign, also where vertices
   are pinned. Zeros without contact and tools. */
PEL_API void pel_sim_get_contact_forces(const pel_sim *sim, int32_t body, double *forces);
/* Sum of the forces of other bodies on a body in the last step [N], tools excluded. */
PEL_API void pel_sim_get_body_contact(const pel_sim *sim, int32_t body, double force[3]);

/* One contact of the last step: a place where two features of surfaces, or a feature and a tool, act on each other. A
   feature is a vertex, a point of an edge or of a triangle, given by its corners and their weights.

   The corner i has weights[i] times the force; over all records of a body these sum to pel_sim_get_contact_forces, over
   those of a tool to the force on it (pel_tool_reading) with the other sign. Forces are means over the step as there,
   and weights are means over its substeps: on a vertex the sum differs by what contacts slide in a step. */
typedef struct pel_contact_record {
    int32_t bodies[2];   /* of the first and the second side; -1 on the second side = the tool */
    int32_t tool;        /* -1 = both sides are of bodies */
    int32_t vertices[4]; /* rows of the body's arrays; -1 = unused */
    double weights[4]; /* above 0 on the first side, where they sum to 1, below 0 on the second, where they sum to -1 */
    double point[3];   /* m, of the first side, at present */
    double normal[3];  /* unit, from the second side to the first; of what a grasp holds, out of the tool */
    double force[3];   /* N, on the first side */
    double gap;        /* m, between both sides along the normal, at present; below 0 = inside of the tool */
} pel_contact_record;

/* Contacts that had a force in the last step, in the order in which they first acted. Zero unless the def has
   record_contacts, before the first step and after a snapshot was loaded. Impulses of restitution between whole bodies
   are no contacts of features and are left out. */
PEL_API int64_t pel_sim_contact_record_count(const pel_sim *sim);
/* Reads them (pel_sim_contact_record_count). The gaps to tools that are meshes take a look at all of their triangles.
   PEL_OUT_OF_MEMORY when there was no memory for a record in the last step. */
PEL_API pel_status pel_sim_get_contact_records(const pel_sim *sim, pel_contact_record *records, pel_error *error);

/* 1 where a tool touches or holds the vertex, or it is in contact with a surface, else 0 (vertex_count). */
PEL_API void pel_sim_get_contacts(const pel_sim *sim, int32_t body, double *contact);

/* Setters between steps. Values are checked like the defs. */
PEL_API pel_status pel_sim_set_positions(pel_sim *sim, int32_t body, const double *positions, pel_error *error);
PEL_API pel_status pel_sim_set_velocities(pel_sim *sim, int32_t body, const double *velocities, pel_error *error);
PEL_API pel_status pel_sim_set_load_force(pel_sim *sim, int32_t load, const double force[3], pel_error *error);
/* From now on the tool's pose is what the caller sets, not its keys (haptic device, mouse). */
PEL_API pel_status pel_sim_set_tool_pose(pel_sim *sim, int32_t tool, const double position[3], const double rotation[4],
                                         pel_error *error);

PEL_API int32_t pel_sim_tool_count(const pel_sim *sim);
PEL_API const char *pel_sim_tool_name(const pel_sim *sim, int32_t tool);
/* Present pose and what the bodies did to the tool in the last step. */
typedef struct pel_tool_reading {
    double position[3];
    double rotation[4];
    double force[3];         /* N, on the tool */
    double torque[3];        /* N m about the tool's position */
    int32_t contact_count;   /* vertices touched or held */
    int32_t held_count;      /* vertices that the grasp holds from now on */
    bool is_held_back;       /* contact held the tool back in the last step, because a body could not give way */
    int64_t lost_count;      /* vertices that tore out of the grasp since the start (grasp_max_force) */
    double lost_time;        /* s, end of the step that lost the first ones; 0 = none yet */
    int64_t held_back_count; /* steps in which the tool was held back, since the start */
    double held_back_time;   /* s, end of the first of them; 0 = none yet */
} pel_tool_reading;
PEL_API void pel_sim_get_tool(const pel_sim *sim, int32_t tool, pel_tool_reading *reading);

/* What a body does to its supports: pinned vertices, tools of PEL_TOOL_SUPPORT, and supports of the def.

   Position-based methods: the multipliers of the constraints at the pinned vertices and the loads on them, mean of the
   last step. Methods static and implicit: the forces in the balance that the last step ended with. Other methods: the
   forces of the body and the loads at the pinned vertices in the present state. The weight of the pinned vertices
   counts, and so do contacts on them in the last step. */
typedef struct pel_support_reading {
    double force[3];      /* N, on the supports */
    double torque[3];     /* N m, about the origin */
    int32_t vertex_count; /* vertices pinned or held by them; 0 = the body has no support */
} pel_support_reading;
PEL_API void pel_sim_get_support(pel_sim *sim, int32_t body, pel_support_reading *reading);

/* Supports of the def, one by one: the force along the components that each holds. Zero before the first step. */
PEL_API int32_t pel_sim_support_count(const pel_sim *sim);
PEL_API const char *pel_sim_support_name(const pel_sim *sim, int32_t support);
PEL_API void pel_sim_get_support_part(const pel_sim *sim, int32_t support, pel_support_reading *reading);

/* What contact did and cost, summed over all steps since the start. All zero without contact. */
typedef struct pel_contact_statistics {
    int64_t candidates;                                /* pairs whose boxes overlapped, of all searches */
    int64_t passed_filter;                             /* not ruled out by the non-penetration filter */
    int64_t passed_hull;                               /* nor by separating axes */
    int64_t cubics;                                    /* solved for a time of impact */
    int64_t contacts;                                  /* records of contacts, all steps */
    int64_t dropped;                                   /* contacts that did not fit */
    int64_t rounds;                                    /* of search and correction */
    int64_t fall_backs;                                /* vertices that were stepped back, all steps */
    int64_t tools_held;                                /* tools that were held back, all steps */
    int64_t tangled;                                   /* pairs of triangles that intersect still, at present */
    double find_seconds, solve_seconds, guard_seconds; /* searching, correcting, guarding the end of the step */
} pel_contact_statistics;
PEL_API void pel_sim_get_contact_statistics(const pel_sim *sim, pel_contact_statistics *statistics);

/* m, thickness of bodies and tools that have none of their own; 0 without contact */
PEL_API double pel_sim_contact_thickness(const pel_sim *sim);

/* Pairs of triangles of the present surfaces, tools included, that cut each other, by the exact test
   (pel_mesh_self_intersections); spheres and capsules take no part. PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_sim_intersections(pel_sim *sim, int64_t *count, pel_error *error);

/* xpbd: how much further springs and shells stretch than their material, as a share (0.1 = 10 %), because one sweep in
   a substep does not converge. It goes with the square of the substep (docs/shells.md: derivation and measurements), at
   the state of the last look: at the start, every 8 to 32 steps, after refinement. 0 for other methods. */
PEL_API double pel_sim_softness(const pel_sim *sim);

/* How the last step of PEL_METHOD_DESCENT, STATIC or IMPLICIT went, and the substeps of position-based methods; zero
   for others. */
typedef struct pel_solver_reading {
    bool solves; /* the method solves for balanced forces in each step: the next members say how far it came */
    int32_t iterations;
    int32_t evaluations; /* of energy and forces */
    double energy;       /* J, with the potential of loads and pressure */
    double residual;     /* N, root of the sum of squares of the forces, contact included, on all that can move */
    bool unstable;       /* static: the state is a balance but no minimum of the energy, and none was found beside it */
    int32_t stray_body;  /* static, descent: only contact holds it, and it went farther than all ways of the tools by
                            half its size or more; -1 = none */
    double stray_way;    /* m, that it went */
    bool has_budget;     /* solver.budget is set */
    bool converged;   /* every gap is within tolerance, and residual is at most 1e-6 (2e-3 in float) of the forces that
                         act: loads, pressure, contacts, grasps; where none acts, of the largest that acted before */
    int32_t substeps; /* of the last step; of the next one before the first step */
    int32_t least_substeps, most_substeps; /* of all steps so far */
    int32_t needed_substeps;               /* xpbd: the most that automatic substeps would be without max_substeps */
    bool second_order;                     /* xpbd: in use */
    double softness, most_softness;        /* pel_sim_softness, and the largest so far */
} pel_solver_reading;
PEL_API void pel_sim_get_solver(const pel_sim *sim, pel_solver_reading *reading);

/* Of an analysis, after its first step: Hz, or factors of the loads, ascending; values (at most mode_count) may be
   null. Returns their number, 0 before. Modes are drawn with a largest displacement of 5 % of the largest body. */
PEL_API int32_t pel_sim_get_modes(const pel_sim *sim, double *values);
PEL_API pel_analysis pel_sim_analysis(const pel_sim *sim);
/* that of the mode that the present state shows; 0 = none */
PEL_API double pel_sim_mode_value(const pel_sim *sim);

/* The factor of all loads, gravity and given pressure in the present state: 1 but along PEL_PATH_ARC_LENGTH. */
PEL_API double pel_sim_load_factor(const pel_sim *sim);
PEL_API pel_path pel_sim_path_kind(const pel_sim *sim);

/* Whether further steps along PEL_PATH_ARC_LENGTH go on; at its end they change nothing. */
typedef enum pel_path_end {
    PEL_PATH_GOES_ON,
    PEL_PATH_END_FULL_LOAD, /* the factor is 1 */
    PEL_PATH_END_LOST       /* no step however short finds a balance: two paths cross, or the bodies give way */
} pel_path_end;
PEL_API pel_path_end pel_sim_get_path_end(const pel_sim *sim);

/* Derivatives of a function f of the positions by the numbers of one body's material. Bending goes with young,
   thickness and poisson where its stiffness was left to follow from them. */
typedef struct pel_adjoint_material {
    double young, thickness; /* by a factor, 1 at present, on all of it: df/dE = young / E for a uniform E */
    double poisson;          /* by the ratio */
    double bending;          /* by a factor on the stiffness of bending alone */
    double pressure;         /* by a factor on the pressure */
} pel_adjoint_material;

/* What pel_sim_adjoint reads and fills; start from zeros. Arrays of vertices: bodies one after the other, vertices of
 * their meshes. */
typedef struct pel_adjoint {
    const double *positions; /* (vertices x 3) df/dx [1/m] at the present state */
    /* results, nullable */
    double *forces;                  /* (vertices x 3) by a force on each vertex, 1/N; 0 where it is held */
    double *rest_positions;          /* (vertices x 3) by rest positions, 1/m, of membranes and mid-edge bending; masses
                                        and forces of vertices as they are, what is held goes along */
    double *loads;                   /* (load_count of the def) by a factor, 1 at present, on each load */
    double *gravity;                 /* (3) by gravity, s2/m */
    pel_adjoint_material *materials; /* (body_count) */
} pel_adjoint;

/* Derivatives of a function of the positions by the numbers of the model, all from one linear system with the matrix of
   the present state (adjoint method: Strang, Computational Science and Engineering, section 8.7). PEL_METHOD_STATIC: of
   the state of rest, which must have converged; bodies that nothing holds stay where three of their vertices are.
   PEL_METHOD_IMPLICIT: of the end of the last step, with the state at its start as it is. Not along time.

   Without tools and contact; pressure with a potential. PEL_BAD_ARGUMENT for what cannot be asked, where the state is
   not a stable balance, and under the method implicit before a step since the start or pel_sim_load; PEL_OUT_OF_MEMORY.
   Changes nothing in the simulation. */
PEL_API pel_status pel_sim_adjoint(pel_sim *sim, const pel_adjoint *def, pel_error *error);

/* A state on a path of steps, and what a function of the path changes with it. */
typedef struct pel_adjoint_point {
    int64_t step;                         /* of these, from 1 */
    const double *positions, *velocities; /* (vertices x 3) m, m/s after it; vertices as in pel_adjoint */
    double *by_positions,
        *by_velocities; /* (vertices x 3) derivatives of the function [1/m, s/m]; 0 if left as they are
                         */
} pel_adjoint_point;

/* What pel_sim_adjoint_steps reads and fills; start from zeros. */
typedef struct pel_adjoint_steps {
    int64_t step_count;
    /* Called with the state after the last step, or, for a function of the whole path, after each of them, from the
       last to the first. False ends with PEL_STOPPED. */
    bool (*gradient)(void *user, const pel_adjoint_point *point);
    void *user;
    bool is_running;     /* the function is of the whole path */
    pel_adjoint results; /* `positions` is not read; forces, loads, numbers are those of all steps together */
    /* (vertices x 3) by the state where the steps begin [1/m, s/m]; what is held 0. Nullable. Rest positions leave it
       as it is: where the bodies start at rest it goes along, so that the two have to be added. */
    double *start_positions, *start_velocities;
} pel_adjoint_steps;

/* Takes step_count steps of PEL_METHOD_IMPLICIT and gives the derivatives of a function of them
   (src/sim/adjoint_steps.c has the equations). The steps are solved to rounding, so that they differ a little from
   those of pel_sim_step; the simulation is at their end afterwards, at their begin when this fails. Takes the time of
   three to five times as many steps, and memory for 2 sqrt(step_count) snapshots.

   What pel_sim_adjoint refuses is refused, and so are refinement, damping of volumetric springs, fibres along principal
   directions, moments on edges, a budget of time, and steps that do not converge: PEL_BAD_ARGUMENT. PEL_STOPPED by the
   gradient; PEL_OUT_OF_MEMORY. Masses and drag are as they are. */
PEL_API pel_status pel_sim_adjoint_steps(pel_sim *sim, const pel_adjoint_steps *def, pel_error *error);

/* Takes a step of sim and, beside it, one of each of `beside` (count): simulations of the same bodies that differ by
   small changes of numbers and have taken the same steps. They are solved by chord iterations with the matrix of sim at
   the end of its step, some two or three solutions instead of the factors of Newton's method
   (src/solve/newton_beside.c). With two simulations that have a number a little smaller and a little larger, the
   difference of any of their readings over the difference of the number is its derivative along the path of steps.

   PEL_METHOD_STATIC, along a path by arc length too, and PEL_METHOD_IMPLICIT, without tools, contact, refinement,
   analyses and a budget of time. A step is taken whole; one that does not converge is refused. After a failure the
   simulations are not at the same step any more. PEL_BAD_ARGUMENT for what is refused, for simulations that do not
   match, and where a change is too large to go beside sim; PEL_OUT_OF_MEMORY; errors of pel_sim_step. */
PEL_API pel_status pel_sim_step_beside(pel_sim *sim, pel_sim *const *beside, int32_t count, pel_error *error);

/* Sums over all bodies; the first columns of series.csv. */
typedef struct pel_sim_measures {
    double volume_ratio;       /* enclosed volume of closed bodies over that at rest; 1 when none is closed */
    double least_volume_ratio; /* the same of the body where it is least; at most 0 where a body is inside out */
    double area_ratio;         /* area over area at rest */
    double kinetic_energy;     /* J, at the time of the positions (the leapfrog keeps velocities half a step before) */
    double elastic_energy;     /* J, the sum of the five that follow */
    double spring_energy;      /* J */
    double volumetric_energy;  /* J */
    double membrane_energy, bending_energy, fibre_energy; /* J, of shells */
    double max_displacement;                              /* m, from the rest position */
    double max_force;                                     /* N, largest vertex force as in pel_sim_get_forces */
    double unbalanced_force; /* N, sum of the magnitudes of these on vertices that are free: neither pinned, held nor
                                touched */
    int64_t vertex_count, triangle_count, contact_count;
} pel_sim_measures;
PEL_API void pel_sim_measure(pel_sim *sim, pel_sim_measures *measures);
/* volume_ratio alone, without the cost of forces */
PEL_API double pel_sim_volume_ratio(const pel_sim *sim);
/* true when any body is a shell (membrane, bending, fibres or pressure) */
PEL_API bool pel_sim_has_shells(const pel_sim *sim);

/* Energy balance since the start, in J: what went in, what is there, what damping took, and what is left over.

     energy_error - dissipated_solver = elastic + kinetic - elastic_start - kinetic_start
                                        - work_tools - ... - work_setters + dissipated_drag

   A left-over below 0 is dissipation that nothing else accounts for: friction, contact, and the numerical damping of
   implicit, quasi-static and position-based methods. Above 0 energy appears: the step is too long, the method does not
   follow the material, or contact and tools put energy in. docs/results.md has the rule of each work. */
typedef struct pel_sim_ledger {
    double work_tools;    /* by tools, grasps and supports on bodies: from their readings and motions */
    double work_loads;    /* mean force times displacement */
    double work_pressure; /* of the given pressure, enclosed gas or target volume */
    double work_gravity;
    double work_material; /* of numbers that change in time: keyed stiffness of springs, active fibres */
    double work_setters; /* change of energy by pel_sim_set_positions and pel_sim_set_velocities after the first step */
    double elastic, kinetic;             /* at present; kinetic is 0 for methods without velocities */
    double elastic_start, kinetic_start; /* before the first step */
    double dissipated_drag;              /* by drag of the solver and damping of vertices */
    double dissipated_solver;            /* the left-over below 0, as a number above 0 */
    double energy_error;                 /* the left-over above 0 */
    double supplied;  /* largest sum by now of the energies at the start and the sizes of all works */
    double tolerance; /* an energy_error beyond it is worth an alarm: 5 % of supplied, and rounding */
} pel_sim_ledger;
/* Works of all steps are summed up as the steps go; the energies are evaluated here. */
PEL_API void pel_sim_get_ledger(pel_sim *sim, pel_sim_ledger *ledger);

/* 64-bit hash of time, positions and velocities in mesh order: equal for equal bits. */
PEL_API uint64_t pel_sim_hash(const pel_sim *sim);

/* Snapshot: everything a later pel_sim_load needs to continue with the same bits, statistics of contact and ledger
   included, in a buffer of pel_sim_save_size bytes (fixed for one sim). Load refuses (PEL_BAD_FORMAT) a snapshot that
   was made with any other number of the defs, and names the parts that differ ("made with other: gravity, tools"); one
   of another version or precision; one that is damaged. The state stays as it was. Only of a forged one, with a right
   checksum and numbers out of range, a part may be loaded before it is refused. */
PEL_API size_t pel_sim_save_size(const pel_sim *sim);
PEL_API void pel_sim_save(const pel_sim *sim, void *bytes);
PEL_API pel_status pel_sim_load(pel_sim *sim, const void *bytes, size_t size, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
