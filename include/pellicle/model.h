/* Pellicle: the model, which is constant during a simulation. The state of a simulation (pellicle/sim.h) changes.
   A model stores all bodies in one set of arrays; a state belongs to one model.

   Internally vertices are reordered for locality and padded to whole slices; the public interface uses the order of the
   body's mesh. */
#ifndef PELLICLE_MODEL_H
#define PELLICLE_MODEL_H

#include "mesh.h"
#include "shell.h"
#include "volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Unit of the mass of a body. */
typedef enum pel_mass_kind {
    PEL_MASS_PER_VERTEX, /* mass [kg] on each vertex (paper A: 1) */
    PEL_MASS_TOTAL,      /* mass [kg] of the body, distributed by area: a third of the adjacent triangles */
    PEL_MASS_DENSITY     /* mass = density [kg/m3] x thickness [m] x a third of the area of the adjacent triangles */
} pel_mass_kind;

/* Spring constants on refined levels. */
typedef enum pel_refine_springs {
    PEL_REFINE_VAN_GELDER, /* area of the triangles at the edge over its squared length, scaled so that each edge of the
                              body's mesh has the given stiffness (van Gelder 1998) */
    PEL_REFINE_UNCHANGED   /* the given stiffness on all levels */
} pel_refine_springs;

/* Dynamic local refinement (paper A, section 3): levels of detail by modified butterfly are computed once, and finer
   triangles replace coarse ones where a criterion exceeds its threshold. Neighbours differ by at most one level;
   triangles between two levels are bisected. Mass, damping and volumetric springs are distributed by area, which
   conserves mass and linear momentum and makes the stiffness independent of the level. */
typedef struct pel_refine_def {
    int32_t levels;  /* number of levels; each level halves the edges. 0 (default) = no refinement */
    bool everywhere; /* the whole body on the finest level from the start; no criterion is used */
    /* Any number of criteria; none = only requests of pel_sim_refine. A vertex above one of the thresholds refines the
       triangles around it; a vertex below all of them for `dwell` steps coarsens. For smooth deformations no measure
       depends on the level, so refinement does not remove its own cause. */
    double above, below; /* N/m2: elastic force of a vertex per area (paper A, section 3.2); below < above; above 0 =
                            not used */
    double curvature_above, curvature_below; /* 1/m: absolute change of the mean curvature since rest, for bends and
                                                folds; below < above; above 0 = not used */
    double near_tools;     /* m: triangles within this distance of a tool; coarsens beyond 1.25 times it. A tool should
                              take at least 2 `interval` steps for this distance; before each step of static and
                              descent the surface refines completely. 0 = not used */
    const int32_t *region; /* (region_count) vertices of the mesh whose triangles are always at least on level
                              region_levels; null = none */
    int32_t region_count;
    int32_t region_levels; /* 1 to levels; 0 (default) = levels */
    int32_t rings;         /* rings of triangles around a vertex, on each level: 1 to 3; default: 2 */
    int32_t dwell;         /* steps; default: 50 */
    int32_t interval;      /* number of steps in which every vertex is tested once; default: 10 */
    int32_t budget; /* maximum number of triangles of the body, 0 = no limit. Candidates are ranked by measure over
                       threshold; one that is twice as strong replaces a weaker one */
    pel_refine_springs springs;
    size_t memory_limit; /* bytes for the levels of detail; default: 2 GiB; 0 = no limit */
} pel_refine_def;

/* A rigid body: its mesh never deforms. Masses, springs and volumetric springs of the body are not read. With one
   pinned vertex it swings about that (a ball joint), with several on a line it turns about the line (a hinge); with
   others it stands. Methods xpbd, pbd, pbd-distance, implicit, explicit and static; no membrane, bending, fibres,
   pressure, volume, liquid, refinement and cuts. */
typedef struct pel_rigid_def {
    bool on;          /* default: false */
    double density;   /* kg/m3, of the filling of a closed mesh, or of a sheet; default: 1000 */
    double mass;      /* kg of the body, in place of the density; 0 (default) = by density */
    double thickness; /* m, of the sheet that the triangles are, also of a closed mesh, which then is hollow; 0
                         (default) = the mesh is filled, and has to be closed */
    bool sphere; /* a ball: mass and inertia of the sphere through the vertices, which it collides as; methods xpbd,
                    pbd, pbd-distance and explicit; default: false */
} pel_rigid_def;

/* One body. Arrays are read during pel_model_create only; the mesh is copied. */
typedef struct pel_body_def {
    const char *name;     /* not empty, unique, shorter than PEL_NAME_SIZE */
    const pel_mesh *mesh; /* oriented manifold with or without boundary, no degenerate triangle; facing outward or
                             inward */
    const pel_mesh *rest; /* the shape without stress, with the vertices and triangles of `mesh`, which is the shape at
                             the start then; fields and regions are those of `mesh`, displacements and volumes relative
                             to `rest`. Null (default) = mesh. No refinement, no tetrahedra, no cuts */
    pel_mass_kind mass_kind;
    double mass;                       /* kg, kg or kg/m3 by kind; > 0 */
    pel_quantity thickness;            /* m, for PEL_MASS_DENSITY; no keys */
    pel_quantity spring_stiffness;     /* N/m on each edge (paper A, k; eq. A-3); >= 0 */
    pel_quantity spring_damping;       /* N s/m on each vertex (paper A, d; eq. A-2); >= 0 */
    pel_quantity volumetric_stiffness; /* N/m on each vertex (paper A, k'; eq. A-4); 0 = no volumetric springs */
    pel_quantity volumetric_damping;   /* N s/m (paper A, d'; eq. A-4) */
    bool volumetric_by_area; /* volumetric numbers and spring_damping refer to a vertex with 1/reference_count of the
                                body's area and scale with nodal area (theory: consistent under refinement) */
    int32_t reference_count; /* default: 252, the vertices of paper A's sphere */
    /* Springs by Young's modulus, with a stiffness independent of the mesh. Both default to 0: the numbers above apply
       to each edge and vertex. */
    double spring_thickness; /* m; above 0: spring_stiffness is the Young's modulus [Pa] of a sheet of this thickness.
                                An edge has the stiffness young x thickness x area of its triangles / length^2 (van
                                Gelder 1998), and spring_damping is a drag [1/s] on the mass of each vertex */
    double fluid_density;    /* kg/m3, of a liquid in the body; 0 = none. It fills a closed body: its mass is on the
                                vertices in proportion to theirs, its weight presses as the depth asks for. Methods
                                implicit, static, xpbd, pbd and explicit */
    double fluid_level; /* m, height of its surface against gravity, about the origin; then it presses below that and
                           has no mass. Default: HUGE_VAL, it fills the body */
    double spring_retardation;     /* s, >= 0: as that of pel_membrane_def, of the lengths of springs */
    pel_quantity spring_toughness; /* J/m2, like that of a membrane, for springs with a thickness and without a
                                      membrane; 0 (default) = cuts do not grow; no keys */
    pel_quantity spring_strength;  /* Pa, likewise; 0 (default) = tears start at no stress; no keys */
    double volumetric_depth; /* m; above 0: volumetric_stiffness is the Young's modulus [Pa] of a filling of this depth.
                                A vertex has the stiffness young x area / depth (an elastic foundation), and
                                volumetric_damping is a drag [1/s] on its mass. volumetric_by_area is not used */
    double adhesion;         /* Pa; above 0: a volumetric spring leaves its vertex for ever once it pulls it inward or
                                along the surface by more than this times the area around the vertex. Does not refine */
    const int32_t *released; /* (released_count) vertices that have no volumetric spring any more; nullable */
    int32_t released_count;
    const int32_t *pinned; /* (pinned_count) vertices that never move; nullable */
    int32_t pinned_count;
    double velocity[3];         /* m/s, of all vertices at the start; 0 for methods without velocities */
    double angular_velocity[3]; /* rad/s, about the centre of mass, added to it */
    double friction;            /* Coulomb's coefficient in contact; below 0 (default): that of pel_contact_def */
    double restitution;         /* likewise */
    double contact_thickness;   /* m, likewise */
    /* Of a mesh that was cut: (origin_count = vertices of the mesh) the vertex before all cuts that each vertex is a
       copy of, itself if it is none; copies come last. Masses, springs, dampings and loads of vertices and edges are
       divided among their copies by area, so that sums stay. Does not refine. Null = no cuts */
    const int32_t *origins;
    int32_t origin_count;
    pel_refine_def refine;
    pel_shell_def shell;   /* membrane, bending, fibres, pressure; default: none */
    pel_volume_def volume; /* the tetrahedra of a mesh that is filled. PEL_MASS_TOTAL and PEL_MASS_DENSITY then
                              distribute the mass by volume: a quarter of the adjacent tetrahedra, density [kg/m3]
                              without a thickness. Methods implicit, static, xpbd, explicit and descent; no cuts, no
                              refinement */
    pel_rigid_def rigid;   /* default: deformable */
    uint32_t cookie;       /* set by pel_body_def_default */
} pel_body_def;

/* The numbers of paper A: 1 kg per vertex, k = 3 N/m, d = 0.5 N s/m, k' = 1.5 N/m, d' = 0.5 N s/m; no mesh and no name.
 */
PEL_API pel_body_def pel_body_def_default(void);

/* A sheet without springs: a membrane of Young's modulus `young` [Pa] and its mass, by thickness [m] and density
   [kg/m3]. The law of the membrane and all else are those of pel_body_def_default; bending is shell.bending. */
PEL_API pel_body_def pel_body_def_sheet(const char *name, const pel_mesh *mesh, double young, double thickness,
                                        double density);

typedef struct pel_model_def {
    const pel_body_def *bodies; /* (body_count) */
    int32_t body_count;
    double gravity[3]; /* m/s2 */
    uint32_t cookie;
} pel_model_def;

PEL_API pel_model_def pel_model_def_default(void);

typedef struct pel_model pel_model;
typedef struct pel_state pel_state;

/* Validates the defs (PEL_BAD_ARGUMENT with body and value, PEL_BAD_MESH with element) and builds the model. Any number
   of simulations in any threads may share it. Free with pel_model_destroy after them. */
PEL_API pel_status pel_model_create(const pel_model_def *def, pel_model **model, pel_error *error);
PEL_API void pel_model_destroy(pel_model *model);

PEL_API int32_t pel_model_body_count(const pel_model *model);
/* The body's index by name, -1 if there is none. */
PEL_API int32_t pel_model_find_body(const pel_model *model, const char *name);
/* The mesh of a body as given (rest positions, triangles, fields), with inside-out closed parts turned outward. Lives
   as long as the model. */
PEL_API const pel_mesh *pel_model_mesh(const pel_model *model, int32_t body);
/* Number of triangles that pel_model_create turned: those of each component without boundary and with negative signed
   volume, unless the component is a cavity within the rest of the mesh. The order of triangles and vertices is kept;
   the last two corners of these triangles are swapped. So pressure acts on the enclosed volume for both orientations.
 */
PEL_API int32_t pel_model_turned_count(const pel_model *model, int32_t body);
/* Number of pinned vertices of a body's mesh. */
PEL_API int32_t pel_model_pinned_count(const pel_model *model, int32_t body);
/* True if the body's mesh has no boundary, so it encloses a volume. */
PEL_API bool pel_model_is_closed(const pel_model *model, int32_t body);
PEL_API const char *pel_model_body_name(const pel_model *model, int32_t body);

#ifdef __cplusplus
}
#endif
#endif
