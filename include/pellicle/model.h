/* Pellicle: the model (what never changes while simulating) and the state (what does).
   A model joins all bodies into one set of arrays; a state belongs to one model.

   Internally vertices are reordered for locality and padded to whole slices; everything public takes and gives values
   in the order of the body's mesh. */
#ifndef PELLICLE_MODEL_H
#define PELLICLE_MODEL_H

#include "mesh.h"
#include "shell.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How the mass of a body is given. */
typedef enum pel_mass_kind {
    PEL_MASS_PER_VERTEX, /* mass [kg] on each vertex (paper A: 1) */
    PEL_MASS_TOTAL,      /* mass [kg] of the body, spread evenly over its vertices (paper A: total / number) */
    PEL_MASS_DENSITY     /* mass = density [kg/m3] x thickness [m] x a third of the area of the triangles around */
} pel_mass_kind;

/* Spring constants where the mesh is finer than the body's own. */
typedef enum pel_refine_springs {
    PEL_REFINE_VAN_GELDER, /* by the area of the triangles beside the edge over its squared length, scaled so that each
                              edge of the body's mesh has the given stiffness (van Gelder 1998) */
    PEL_REFINE_UNCHANGED   /* the given stiffness on all levels */
} pel_refine_springs;

/* Dynamic local refinement (paper A, section 3): levels of detail by modified butterfly are made once, and the surface
   takes finer triangles from them where a criterion asks for them. Neighbours differ by one level at most; triangles
   between two levels are bisected. Mass, damping and volumetric springs are shared out by area, so that mass and linear
   momentum stay and the stiffness does not depend on the level. */
typedef struct pel_refine_def {
    int32_t levels;  /* finest level; each one halves the edges. 0 (default) = no refinement */
    bool everywhere; /* all of the body on the finest level from the start; no criterion is used */
    /* Criteria, any number of them; none = only what pel_sim_refine asks for. A vertex above one of the
       thresholds refines the triangles around it; a vertex that stays below all of them for `dwell` steps coarsens. No
       measure depends on the level where the deformation is smooth, so that refinement does not remove its own cause.
     */
    double above, below; /* N/m2: elastic force of a vertex over its share of the area (paper A, section 3.2); below <
                            above, above 0 = not used */
    double curvature_above, curvature_below; /* 1/m: change of the mean curvature since rest, whatever the sign: where
                                                the surface bends or folds; below < above, above 0 = not used */
    double near_tools;     /* m: triangles that are this near to a tool, before it touches; given up beyond 1.25 times
                              that. A tool should take twice `interval` steps for this way. 0 = not used */
    const int32_t *region; /* (region_count) vertices of the mesh: the triangles at them are on level region_levels at
                              least, always; null = none */
    int32_t region_count;
    int32_t region_levels; /* 1 to levels; 0 (default) = levels */
    int32_t rings;         /* rings of triangles around a vertex, on each level: 1 to 3; 2 by default */
    int32_t dwell;         /* steps; 50 by default */
    int32_t interval;      /* steps in which every vertex is looked at once; 10 by default */
    int32_t budget; /* the body never has more triangles than this, 0 = no limit. The strongest candidates win, by
                       measure over threshold; one that is twice as strong displaces a weaker one */
    pel_refine_springs springs;
    size_t memory_limit; /* bytes that the levels of detail may take; 2 GiB by default, 0 = no limit */
} pel_refine_def;

/* One body. Arrays are read during pel_model_create only; the mesh is copied. */
typedef struct pel_body_def {
    const char *name;     /* not empty, unique, shorter than PEL_NAME_SIZE */
    const pel_mesh *mesh; /* oriented manifold, boundary allowed, no triangle without area; outward or inward */
    pel_mass_kind mass_kind;
    double mass;                       /* kg, kg or kg/m3 by kind; > 0 */
    pel_quantity thickness;            /* m, for PEL_MASS_DENSITY; no keys */
    pel_quantity spring_stiffness;     /* N/m on each edge (paper A, k; eq. A-3); >= 0 */
    pel_quantity spring_damping;       /* N s/m on each vertex (paper A, d; eq. A-2); >= 0 */
    pel_quantity volumetric_stiffness; /* N/m on each vertex (paper A, k'; eq. A-4); 0 = no volumetric springs */
    pel_quantity volumetric_damping;   /* N s/m (paper A, d'; eq. A-4) */
    bool volumetric_by_area; /* the volumetric numbers and spring_damping are those of a vertex with 1/reference_count
                                of the body's area and scale with nodal area (theory: consistent under refinement) */
    int32_t reference_count; /* 252 by default: the vertices of paper A's sphere */
    /* Springs by Young's modulus, so that the response does not depend on the fineness of the mesh. Both are 0 by
       default: the numbers above are those of each edge and vertex. */
    double
        spring_thickness; /* m; above 0: spring_stiffness is the Young's modulus [Pa] of a sheet of this thickness. An
                             edge has it times the thickness times the area of its triangles over its squared length
                             (van Gelder 1998), and spring_damping is a drag [1/s] on the mass of each vertex */
    double volumetric_depth; /* m; above 0: volumetric_stiffness is the Young's modulus [Pa] of a filling of this depth.
                                A vertex has it times its area over the depth (an elastic foundation), and
                                volumetric_damping is a drag [1/s] on its mass. volumetric_by_area is not used */
    const int32_t *pinned;   /* (pinned_count) vertices that never move; nullable */
    int32_t pinned_count;
    double velocity[3];         /* m/s, of all vertices at the start; 0 for methods without velocities */
    double angular_velocity[3]; /* rad/s, about the centre of mass, added to it */
    double
        friction; /* Coulomb's coefficient in contact, see pel_contact_def; below 0, as by default: that of contact */
    double restitution;       /* the same, see pel_contact_def */
    double contact_thickness; /* m; the same */
    pel_refine_def refine;
    pel_shell_def shell; /* membrane, bending, fibres, pressure; the default has none */
    uint32_t cookie;     /* set by pel_body_def_default */
} pel_body_def;

/* Paper A's numbers: mass 1 per vertex, k 3, d 0.5, k' 1.5, d' 0.5; no mesh and no name yet. */
PEL_API pel_body_def pel_body_def_default(void);

typedef struct pel_model_def {
    const pel_body_def *bodies; /* (body_count) */
    int32_t body_count;
    double gravity[3]; /* m/s2 */
    uint32_t cookie;
} pel_model_def;

PEL_API pel_model_def pel_model_def_default(void);

typedef struct pel_model pel_model;
typedef struct pel_state pel_state;

/* Checks the defs (PEL_BAD_ARGUMENT with body and value, PEL_BAD_MESH with element) and builds everything that stays.
   The model may be shared by any number of simulations in any threads. Free with pel_model_destroy after them. */
PEL_API pel_status pel_model_create(const pel_model_def *def, pel_model **model, pel_error *error);
PEL_API void pel_model_destroy(pel_model *model);

PEL_API int32_t pel_model_body_count(const pel_model *model);
/* The body's index by name, -1 when there is none. */
PEL_API int32_t pel_model_find_body(const pel_model *model, const char *name);
/* The mesh of a body as given (rest positions, triangles, fields), with closed parts that are inside out turned over.
   Lives as long as the model. */
PEL_API const pel_mesh *pel_model_mesh(const pel_model *model, int32_t body);
/* How many triangles that were: each part (connected by edges) without boundary whose signed volume is below 0, unless
   it is a cavity within the rest of the mesh. The order of triangles and vertices stays, the last two corners of these
   triangles change places. So pressure acts on the enclosed volume whichever way the mesh was turned. */
PEL_API int32_t pel_model_turned_count(const pel_model *model, int32_t body);
/* Vertices of a body's mesh that are pinned. */
PEL_API int32_t pel_model_pinned_count(const pel_model *model, int32_t body);
/* True when the body's mesh has no boundary: it encloses a volume. */
PEL_API bool pel_model_is_closed(const pel_model *model, int32_t body);
PEL_API const char *pel_model_body_name(const pel_model *model, int32_t body);

#ifdef __cplusplus
}
#endif
#endif
