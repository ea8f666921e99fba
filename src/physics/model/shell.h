/* The shell of a body, in addition to springs: triangles and hinges, fibres and pressure, with vertices by their places
   in the model's order: the reference from which solvers lay out their own data (colour batches, lists by vertex). Only
   values that differ from element to element are stored. Rest shapes follow from the mesh and are computed on demand; a
   body that refines keeps those of its present surface. Storing everything took 156 bytes a triangle. */
#ifndef PEL_MODEL_SHELL_H
#define PEL_MODEL_SHELL_H

#include "base/assert.h"
#include "law/bending_model.h"
#include "law/membrane.h"
#include "measure/midedge.h"
#include "measure/plastic.h"
#include "measure/star.h"
#include "measure/tetra.h"
#include "model/model.h"
#include "pellicle/bending.h"
#include "pellicle/element.h"

/* Bending of a triangle, as hinges between its parts and its mid-edge element take it. */
typedef struct pel_shell_part_bending {
    double stiffness; /* D, N m; 0 = unknown */
    double curl;      /* factor on rest angles */
} pel_shell_part_bending;

/* Two triangles that share an edge: vertices as in pellicle/bending.h. */
typedef struct pel_shell_hinge {
    int32_t number;
    int32_t vertices[4];
    int32_t triangles[2]; /* of the shell, left and right */
    double stiffness;     /* D, N m; 0 = unknown (no membrane and none given) */
    double fold;          /* rad, plastic change of its rest angle; the caller's, 0 at first */
} pel_shell_hinge;

/* Fibres of one region in one triangle. */
typedef struct pel_shell_fibre {
    int32_t triangle;
    double direction[2]; /* in the rest frame; of PEL_FIBRE_PRINCIPAL any */
    double weight;       /* mean of the corners, > 0; of muscles times the activation over the body */
} pel_shell_fibre;

typedef struct pel_shell_region {
    pel_anisotropy_def def; /* pointers null */
    pel_curve course; /* over time of the rest length of active fibres, of the activation of muscles; with `amount` */
    double amount;    /* as its factor */
    int32_t fibre_count, fibre_limit; /* 0 for PEL_FIBRE_CURL */
    int32_t *triangles;               /* (fibre_count) with fibres, rising; null = all */
    double *weights;                  /* (fibre_count) null = 1 */
    double (*directions)[2];          /* (fibre_count) null = as in the rest shape */
} pel_shell_region;

/* Young's modulus [Pa] and thickness [m] of a triangle: means of its corners. */
typedef struct pel_shell_sheet {
    double young, thickness;
} pel_shell_sheet;

struct pel_shell {
    bool has_membrane;
    pel_membrane_material material; /* young and thickness: of the first triangle */
    pel_membrane_law law;           /* for young and thickness 1; without a membrane its poisson is that of bending */
    const pel_mesh *mesh;           /* of the body: the rest shape, but where `rests` has it */
    /* limits: room in the arrays; the counts themselves unless the body refines (shell_front.h) */
    int32_t triangle_count, triangle_limit;
    const int32_t (*corners)[3];   /* (triangle_count) places; not owned */
    pel_rest_triangle *rests;      /* (triangle_count) of a body that refines, else null */
    pel_shell_sheet *sheets;       /* (triangle_count) null = the material's */
    double (*axes)[PEL_LAW_AXIS];  /* (triangle_count) the warp in the rest frames; null = nothing depends on it */
    double direction[3];           /* the warp in space, or along the gradient of: */
    double *coordinate;            /* (vertices of the mesh) else null */
    pel_shell_part_bending *parts; /* (triangle_count) of a body that can refine or has mid-edge bending, else null */

    double strain_limit;                              /* principal stretches stay within 1 +- this; 0 = none */
    double membrane_retardation, bending_retardation; /* s: viscous stress over stiffness times the rate of strain */

    const pel_bending_traits *bending;
    pel_plate plate;        /* of all triangles, but for its axis */
    bool bends_as_membrane; /* no stiffness is given: it follows from the membrane */
    double bending_weight;  /* k_B; negative = automatic */
    int32_t hinge_count, hinge_limit;
    int32_t (*hinge_sides)[2]; /* (hinge_count) half-edges 3 t + i of the left and the right triangle; by rising edge
                                  number of the topology; none without bending */
    double hinge_stiffness;    /* D of every hinge, unless they differ: */
    double *hinge_stiffnesses; /* (hinge_count) else null */
    double *rest_angles;       /* (hinge_count) rad, with curls applied; null = as in the rest shape */
    double *yield_angles;      /* (hinge_count) rad, of hinges that have not folded; null = they never do */
    double hardening;          /* of folds */
    int32_t first_fold;        /* of the state */
    bool yields;               /* its triangles do */
    double *growths;           /* (triangle_count) rest_scale - 1; null = they do not grow */
    pel_curve growth_course;   /* over time of its share; no keys = 1 */
    int32_t first_flow;        /* of the state */

    int32_t region_count;
    pel_shell_region *regions;

    pel_pressure_def pressure; /* pointers null */
    pel_curve outside, target; /* over time, times the def's values; no keys = 1 */
    double *pressure_weights;  /* (triangle_count) region times field of `outside`; null = 1 */
    double mean_edge;          /* m, at rest */

    /* of a filled body */
    pel_solid_law solid;
    double solid_poisson;
    double tetra_young;   /* Pa */
    double *tetra_youngs; /* (tetrahedron_count) null = the same in all */
    int32_t tetrahedron_count;
    int32_t (*tetrahedra)[4]; /* places */
    pel_stars *stars;         /* of smooth tetrahedra, nodes as places; null = linear ones */
};

/* hinges with an energy: others only give rest angles */
static inline int32_t pel_shell_elastic_hinges(const pel_shell *shell)
{
    return shell->bending->has_hinges ? shell->hinge_count : 0;
}

/* the corners of an element, for loops in double */
static inline void pel_load_points(const pel_record *position, const int32_t *vertices, int count, double x[][3])
{
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            x[i][c] = (double)position[vertices[i]][c];
}

/* true if its material resists rates of strain */
static inline bool pel_body_is_viscous(const pel_body *body)
{
    const pel_shell *shell = body->shell;
    return body->spring_retardation > 0 ||
           (shell != NULL && (shell->membrane_retardation > 0 || shell->bending_retardation > 0));
}

/* ---- elements ---- */

static inline pel_shell_sheet pel_shell_sheet_of(const pel_shell *shell, int32_t t)
{
    PEL_ASSERT_INDEX(t, shell->triangle_count);
    return shell->sheets != NULL ? shell->sheets[t]
                                 : (pel_shell_sheet){shell->material.young, shell->material.thickness};
}
/* of triangle t */
static inline pel_membrane_law pel_shell_law(const pel_shell *shell, int32_t t)
{
    PEL_ASSERT_INDEX(t, shell->triangle_count);
    pel_membrane_law law = shell->law;
    pel_shell_sheet sheet = pel_shell_sheet_of(shell, t);
    law.modulus *= sheet.young * sheet.thickness;
    if (shell->axes != NULL && pel_law_is_oriented(pel_membrane_law_traits(law.kind)))
        for (int i = 0; i < PEL_LAW_AXIS; i++)
            law.numbers[i] = shell->axes[t][i];
    return law;
}
/* The law and the shape at rest of triangle t in a state, whose flows may be null. */
static inline pel_membrane_law pel_shell_law_now(const pel_shell *shell, int32_t t, const pel_flow *flows)
{
    pel_membrane_law law = pel_shell_law(shell, t);
    if (shell->yields && flows != NULL)
        law.numbers[0] = flows[shell->first_flow + t].slip;
    return law;
}
pel_rest_triangle pel_shell_rest_now(const pel_shell *shell, int32_t t, const pel_flow *flows);
static inline bool pel_shell_flows(const pel_shell *shell)
{
    return shell->yields || shell->growths != NULL;
}
/* The share of its growth at a time, and flows of the state with a share. */
double pel_shell_growth(const pel_shell *shell, double time);
void pel_shell_grow(const pel_shell *shell, double share, pel_flow *flows);
/* bending of triangle t over its stiffness along the first axis */
static inline pel_plate pel_shell_plate(const pel_shell *shell, int32_t t)
{
    PEL_ASSERT_INDEX(t, shell->triangle_count);
    pel_plate plate = shell->plate;
    for (int i = 0; shell->axes != NULL && i < PEL_LAW_AXIS; i++)
        plate.axis[i] = shell->axes[t][i];
    return plate;
}
/* The warp in space of triangle t of the mesh, with its corners at x. Where a vector [x, y, z] is normal to the
   triangle, [z, x, y] is meant. */
void pel_shell_warp(const pel_shell *shell, int32_t t, const double x[3][3], double along[3]);
/* Bending of a sheet of a law over its stiffness along the first axis, and D along it for a thickness [m] for which the
   law has been made: d11 h^2 / 12. */
pel_plate pel_shell_plate_of(const pel_membrane_law *law);
/* The stiffness of a hinge between these half-edges over D, from its direction. */
double pel_shell_hinge_share(const pel_shell *shell, const int32_t sides[2]);
pel_rest_triangle pel_shell_rest(const pel_shell *shell, int32_t t);

static inline double pel_shell_hinge_stiffness(const pel_shell *shell, int32_t i)
{
    PEL_ASSERT_INDEX(i, shell->hinge_count);
    return shell->hinge_stiffnesses != NULL ? shell->hinge_stiffnesses[i] : shell->hinge_stiffness;
}
pel_shell_hinge pel_shell_hinge_of(const pel_shell *shell, int32_t i);
double pel_shell_rest_angle(const pel_shell *shell, int32_t i);
/* Folds in a state of the model: one for each hinge of bodies whose bending yields; flows: one for each triangle of
   those whose membrane yields or grows. */
int32_t pel_model_fold_count(const pel_model *model);
int32_t pel_model_flow_count(const pel_model *model);
/* The yield angle of hinge i at present, and its share beyond; folds are those of the state. */
static inline pel_yield pel_shell_yield(const pel_shell *shell, int32_t i, const pel_fold *folds)
{
    PEL_ASSERT_INDEX(i, shell->hinge_count);
    return (pel_yield){shell->yield_angles[i] + shell->hardening * folds[shell->first_fold + i].slip,
                       pel_fold_share(shell->hardening)};
}

/* fibres with an energy of their own: caving in and curls have none, and the push of PEL_FIBRE_NORMAL has no potential
 */
static inline bool pel_shell_region_is_elastic(const pel_shell_region *region)
{
    return region->def.mode == PEL_FIBRE_STRAIN || region->def.mode == PEL_FIBRE_ACTIVE ||
           region->def.mode == PEL_FIBRE_MUSCLE;
}
/* true if a region has this mode */
bool pel_shell_has_mode(const pel_shell *shell, pel_fibre_mode mode);

static inline int32_t pel_shell_fibre_triangle(const pel_shell_region *region, int32_t i)
{
    PEL_ASSERT_INDEX(i, region->fibre_count);
    return region->triangles != NULL ? region->triangles[i] : i;
}
static inline double pel_shell_fibre_weight(const pel_shell_region *region, int32_t i)
{
    PEL_ASSERT_INDEX(i, region->fibre_count);
    return region->weights != NULL ? region->weights[i] : 1;
}
pel_shell_fibre pel_shell_fibre_of(const pel_shell *shell, const pel_shell_region *region, int32_t i);

/* The stencils of a hinge, from rest positions (model vertex_count). */
static inline pel_hinge pel_shell_angle(const pel_shell *shell, const pel_record *rest, const pel_shell_hinge *hinge)
{
    double x[4][3];
    pel_hinge stencil;
    pel_load_points(rest, hinge->vertices, 4, x);
    pel_hinge_setup((const double(*)[3])x, &stencil);
    stencil.rest_angle = pel_shell_rest_angle(shell, hinge->number) + hinge->fold;
    return stencil;
}
static inline pel_bending_isometric pel_shell_isometric(const pel_record *rest, const pel_shell_hinge *hinge)
{
    double x[4][3];
    pel_bending_isometric stencil;
    pel_load_points(rest, hinge->vertices, 4, x);
    pel_bending_isometric_setup((const double(*)[3])x, &stencil);
    return stencil;
}

/* PEL_BAD_MESH: the triangle has no area. */
pel_status pel_refuse_area(const pel_mesh *mesh, int32_t triangle, pel_error *error);
/* Refuses numbers out of range (PEL_BAD_ARGUMENT with the body). */
pel_status pel_shell_check(const pel_body_def *def, int32_t body, pel_error *error);

/* Fills the body's shell when its def asks for one; its vertices have to be in the model already. PEL_BAD_MESH for a
   triangle without area, PEL_OUT_OF_MEMORY. */
pel_status pel_body_shell_create(const pel_body_def *def, pel_model *model, int32_t body, const pel_topology *topology,
                                 pel_error *error);
void pel_shell_destroy(pel_shell *shell);

/* Refuses bending without a stiffness, which pbd alone can do with (PEL_BAD_ARGUMENT with the body). */
pel_status pel_shell_check_bending(const pel_shell *shell, int32_t body, pel_error *error);
/* name of a feature that only position-based methods support (a strain limit, a region that caves in); null: none */
bool pel_shell_needs_projection(const pel_shell *shell);

/* Direction of a region's fibres in the frame of a rest triangle. */
void pel_shell_fibre_direction(const pel_anisotropy_def *def, const double x[3][3], double direction[2]);

/* ---- the tetrahedra of a filled body ---- */

/* Refuses a volume without tetrahedra, numbers out of range, and what filled bodies lack (PEL_BAD_ARGUMENT with the
   body). */
pel_status pel_filled_check(const pel_body_def *def, int32_t body, pel_error *error);

/* A quarter of the volume of the tetrahedra around each vertex. PEL_BAD_MESH names one without volume. */
pel_status pel_filled_lump(const pel_mesh *mesh, double *volumes, pel_error *error);

/* Fills the tetrahedra of a shell (PEL_OUT_OF_MEMORY); nothing to do without a volume. */
pel_status pel_filled_create(const pel_body_def *def, const pel_body *body, pel_shell *shell, pel_error *error);
void pel_filled_destroy(pel_shell *shell);

/* Shape at rest of tetrahedron t, from rest positions (model vertex_count), and its scale: Young's modulus times volume
   [J]. */
double pel_filled_rest(const pel_shell *shell, const pel_record *positions, int32_t t, pel_rest_tetra *rest);

#endif
