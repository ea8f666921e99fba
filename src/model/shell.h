/* What a body has as a shell, beside the springs: rest shapes and numbers of its triangles and hinges, fibres and
   pressure. Plain arrays in double and in mesh order, vertices by their places in the model's order: the reference from
   which solvers lay out what they need (colour batches, lists by vertex). */
#ifndef PEL_MODEL_SHELL_H
#define PEL_MODEL_SHELL_H

#include "model/model.h"
#include "pellicle/element.h"

/* A membrane triangle; t is its number in the body's mesh. */
typedef struct pel_shell_triangle {
    int32_t vertices[3];
    pel_rest_triangle rest;
    double young, thickness; /* means of the corners */
} pel_shell_triangle;

/* Bending of a triangle, as hinges between its parts and its mid-edge element take it. */
typedef struct pel_shell_part_bending {
    double stiffness; /* D, N m; 0 = unknown */
    double curl;      /* factor on rest angles */
} pel_shell_part_bending;

/* Two triangles that share an edge: vertices as in pellicle/bending.h. Other numbers follow from the rest positions. */
typedef struct pel_shell_hinge {
    int32_t vertices[4];
    int32_t triangles[2]; /* of the mesh, left and right */
    double rest_angle;    /* rad, with curls applied */
    double stiffness;     /* D, N m; 0 = unknown (no membrane and none given) */
} pel_shell_hinge;

/* Fibres of one region in one triangle. */
typedef struct pel_shell_fibre {
    int32_t triangle;
    double direction[2]; /* in the rest frame; of PEL_FIBRE_PRINCIPAL any */
    double weight;       /* mean of the corners, > 0 */
} pel_shell_fibre;

typedef struct pel_shell_region {
    pel_anisotropy_def def; /* pointers null */
    pel_curve rest_length;  /* with def.rest_length.value as its factor */
    int32_t fibre_count, fibre_limit;
    pel_shell_fibre *fibres; /* (fibre_count) by rising triangle; none for PEL_FIBRE_CURL */
} pel_shell_region;

struct pel_shell {
    bool has_membrane;
    pel_membrane_material material; /* young and thickness: those of the first triangle */
    /* limits: room in the arrays; the counts themselves unless the body refines (shell_front.h) */
    int32_t triangle_count, triangle_limit;
    pel_shell_triangle *triangles; /* (triangle_count) also without a membrane */
    pel_shell_part_bending *parts; /* (triangle_count) of a body that can refine or has mid-edge bending, else null */

    double strain_limit; /* principal stretches stay within 1 +- this; 0 = none */

    pel_bending_model bending;
    double bending_weight; /* k_B; negative = automatic */
    int32_t hinge_count, hinge_limit;
    pel_shell_hinge *hinges; /* (hinge_count) by rising edge number of the topology; none without bending */

    int32_t region_count;
    pel_shell_region *regions;

    pel_pressure_def pressure; /* pointers null */
    pel_curve outside, target; /* over time, times the def's values; no keys = 1 */
    double *pressure_weights;  /* (triangle_count) region times field of `outside`; null = 1 */
    double mean_edge;          /* m, at rest */
};

/* hinges that have an energy: those of mid-edge bending only tell rest angles */
static inline int32_t pel_shell_elastic_hinges(const pel_shell *shell)
{
    return shell->bending == PEL_BENDING_MIDEDGE ? 0 : shell->hinge_count;
}

/* the corners of an element, for loops in double */
static inline void pel_load_points(const pel_record *position, const int32_t *vertices, int count, double x[][3])
{
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            x[i][c] = (double)position[vertices[i]][c];
}

/* The stencils of a hinge, from rest positions (model vertex_count). */
static inline pel_hinge pel_shell_angle(const pel_record *rest, const pel_shell_hinge *hinge)
{
    double x[4][3];
    pel_hinge stencil;
    pel_load_points(rest, hinge->vertices, 4, x);
    pel_hinge_setup((const double(*)[3])x, &stencil);
    stencil.rest_angle = hinge->rest_angle;
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

/* Refuses numbers out of range (PEL_BAD_ARGUMENT with the body). */
pel_status pel_shell_check(const pel_body_def *def, int32_t body, pel_error *error);

/* Fills the body's shell when its def asks for one; its vertices have to be in the model already. PEL_BAD_MESH for a
   triangle without area, PEL_OUT_OF_MEMORY. */
pel_status pel_body_shell_create(const pel_body_def *def, pel_model *model, int32_t body, const pel_topology *topology,
                                 pel_error *error);
void pel_shell_destroy(pel_shell *shell);
/* whether it has what only position-based methods know: a strain limit, a region that caves in; null: no */
bool pel_shell_needs_projection(const pel_shell *shell);

/* Direction of a region's fibres in the frame of a rest triangle. */
void pel_shell_fibre_direction(const pel_anisotropy_def *def, const double x[3][3], double direction[2]);

#endif
