/* Inside of tangents: the lists of elements. */
#ifndef PEL_FORCE_TANGENT_BODY_H
#define PEL_FORCE_TANGENT_BODY_H

#include "base/assert.h"
#include "force/tangent.h"
#include "measure/midedge.h"
#include "model/shell.h"

/* elements, nodes or edges of one chunk of a parallel loop */
enum { PEL_TANGENT_CHUNK = 128 };

static inline int32_t pel_tangent_chunk_count(int32_t count)
{
    return (count + PEL_TANGENT_CHUNK - 1) / PEL_TANGENT_CHUNK;
}

/* elements of one kind that stand together: all of them have the same number of nodes */
typedef enum pel_part_kind {
    PEL_TANGENT_PART_TRIANGLES,
    PEL_TANGENT_PART_TETRAHEDRA,
    PEL_TANGENT_PART_STARS, /* smooth tetrahedra with one number of nodes */
    PEL_TANGENT_PART_HINGES,
    PEL_TANGENT_PART_SPRINGS,
    PEL_TANGENT_PART_POINTS
} pel_part_kind;

typedef struct pel_tangent_part {
    pel_part_kind kind;
    int32_t shell; /* of tangent->shells; springs and points: -1 */
    int32_t first, count;
    int32_t first_star;           /* of the shell's */
    int nodes, unknowns, strains; /* of one element, fibres not counted */
    int32_t first_stress, first_chunk;
    size_t first_row;
} pel_tangent_part;

typedef struct pel_tangent_fibre {
    int32_t region;
    double stiffness; /* N/m, weight included */
    double direction[2];
} pel_tangent_fibre;

typedef struct pel_tangent_spring {
    int32_t vertices[2];
    int32_t body;
    double stiffness, rest_length; /* N/m without the present factor; m */
} pel_tangent_spring;

/* shell properties of a body */
typedef struct pel_tangent_shell {
    const pel_shell *shell;
    int32_t body;
    pel_rest_triangle *rests; /* (triangle_count) */
    int32_t *fibre_begin;     /* (triangle_count + 1); null without fibres */
    pel_tangent_fibre *fibres;
    int32_t (*edges)[3];        /* (triangle_count) of mid-edge bending, ~edge where the triangle is the second */
    pel_midedge *midedges;      /* (triangle_count) */
    pel_hinge *hinges;          /* (hinge_count) of bending by the angle, else null */
    pel_rest_tetra *tetras;     /* (tetrahedron_count) null without */
    double *tetra_scales;       /* (tetrahedron_count) J: Young's modulus times volume at rest */
    double *normal_pressure[4]; /* (places) scratch of the vertex-normal form: area vector and area; else null */
    pel_rank_one *rank_one;     /* of a gas or a kept volume; else null */
    double pressure;            /* Pa, of the present evaluation */
} pel_tangent_shell;

struct pel_tangent {
    const pel_model *model;
    pel_tangent_pattern pattern;
    int32_t part_count, shell_count, chunk_count, spring_count, point_count;
    pel_tangent_part *parts;
    pel_tangent_shell *shells;
    pel_rank_one *rank_ones;
    pel_tangent_edge *edges;
    pel_tangent_spring *springs;
    int32_t *points; /* (point_count) vertices in use */
    int32_t *node_begin, *nodes;
    uint8_t *element_kind;
    pel_tangent_input input; /* of the last evaluation */
    double *rows;            /* (all unknowns of all elements) gradients */
    int32_t *gather_begin;   /* (nodes + 1) rows of a node */
    int32_t *gather;
    double *half_angles;          /* (edge_count) (theta - theta_rest) / 2; 0 on the boundary */
    double *first_half_angles;    /* (edge_count) those when edges were last settled: others are less than pi away */
    double *settle[4];            /* (edge_count) scratch */
    pel_tangent_energy *energies; /* (chunk_count) */
};

/* The two numbers that a triangle has of its edge: sign, and number. */
static inline int32_t pel_tangent_edge_of(int32_t signed_edge, double *sign)
{
    *sign = signed_edge < 0 ? -1 : 1;
    return signed_edge < 0 ? ~signed_edge : signed_edge;
}

static inline void pel_tangent_points(const double *unknowns, const int32_t *vertices, int count, double *x)
{
    for (int k = 0; k < count; k++)
        for (int c = 0; c < 3; c++)
            x[3 * k + c] = unknowns[3 * (size_t)vertices[k] + (size_t)c];
}

/* one evaluation */
typedef struct pel_tangent_loop {
    pel_tangent *tangent;
    const pel_tangent_input *input;
    double *gradient; /* null = not asked for */
    const double *step;
    double *stresses; /* extrapolates over the step; both null = not asked for */
    double *viscous;  /* gets strains and stiffnesses, or adds to the former; null = not asked for */
    double weight;    /* of these strains */
    bool is_other;
} pel_tangent_loop;

/* forces and energies are asked for, not numbers of strains */
static inline bool pel_tangent_sums(const pel_tangent_loop *loop)
{
    return loop->stresses == NULL && loop->viscous == NULL;
}

/* the numbers of a strain, which have its own values */
static inline void pel_tangent_refer(const pel_tangent_loop *loop, int32_t stress, double retardation,
                                     const double own[PEL_VISCOUS_NUMBERS])
{
    double *numbers = loop->viscous + PEL_VISCOUS_NUMBERS * (size_t)stress;
    numbers[0] = loop->weight * own[0] + (loop->is_other ? numbers[0] : 0);
    for (int j = 1; j < PEL_VISCOUS_NUMBERS && !loop->is_other; j++)
        numbers[j] = retardation * own[j];
}

/* the place of a triangle's first stress, in a part of triangles; those of its fibres follow */
static inline int32_t pel_tangent_stress(const pel_tangent_shell *own, const pel_tangent_part *part, int32_t t)
{
    PEL_ASSERT_INDEX(t, own->shell->triangle_count);
    return part->first_stress + t * part->strains + (own->fibre_begin != NULL ? own->fibre_begin[t] : 0);
}

/* Fills half_angles. */
void pel_tangent_find_angles(pel_tangent *tangent, const double *unknowns, pel_pool *pool);

/* Membranes and mid-edge bending of some triangles of a part, n unknowns each: sets gradients (count x n) or matrices
   (count x n x n; one of the two, or none), extrapolates where the loop has stresses, and adds to the energy. */
void pel_tangent_triangles(const pel_tangent_loop *loop, const pel_tangent_part *part, const int32_t *triangles,
                           int32_t count, double *gradients, double *matrices, pel_tangent_energy *energy);

/* Sets gradients (count x 12; nullable) of some linear tetrahedra of a part, and adds to the energy. */
void pel_tangent_tetrahedra(const pel_tangent_loop *loop, const pel_tangent_part *part, const int32_t *tetrahedra,
                            int32_t count, double *gradients, pel_tangent_energy *energy);

#endif
