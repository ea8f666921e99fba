/* Inside of the forces of shells: what the files of this folder share. */
#ifndef PEL_FORCE_SHELL_BODY_H
#define PEL_FORCE_SHELL_BODY_H

#include "force/shell_force.h"
#include "law/membrane.h"

/* elements of one chunk of a parallel loop */
enum { PEL_SHELL_CHUNK = 256 };

/* fibres of one region in one triangle, as the loop needs them */
typedef struct pel_triangle_fibre {
    int32_t region;
    double stiffness; /* N/m, weight included */
    double direction[2];
} pel_triangle_fibre;

/* numbers of a lane: inverse of the rest matrix (3), area times the law's modulus, weight of the pressure, 1 where
   there is a triangle */
enum { PEL_TRIANGLE_NUMBERS = 6 };
/* cosine and sine of the rest angle and the stiffness; or weights of x1, x2, x3, the factor and twice the energy at
   rest that is taken off */
enum { PEL_HINGE_NUMBERS = 5 };

/* Elements stand in blocks of PEL_BLOCK, one in a lane, by the lowest of their places: what a vertex gathers lies near
   together (in the order of the mesh a step on 20,480 triangles takes nearly twice as long). Each has a row, a record,
   for each of its corners: those of a block stand corner by corner, lane by lane, triangles before hinges. */
typedef struct pel_shell_body {
    const pel_shell *shell;
    int32_t body;
    int32_t first_place, place_count;
    int pressure_part;    /* which of the parts its pressure is; 0 = none */
    pel_membrane_law law; /* of all triangles, with the modulus of a sheet of young and thickness 1 */
    double stiffness;     /* of that law at rest: pel_membrane_law_stiffness */
    int32_t *fibre_begin; /* (triangle_count + 1); null without fibres */
    pel_triangle_fibre *fibres;
    int32_t *triangle_at, *hinge_at; /* (triangle_count, hinge_count) the element in a lane */
    int32_t *triangle_steps;         /* (triangle blocks x 3 x PEL_BLOCK) places times PEL_STEP */
    pel_real *triangle_numbers;      /* (triangle blocks x PEL_TRIANGLE_NUMBERS x PEL_BLOCK) */
    int32_t *hinge_steps;            /* (hinge blocks x 4 x PEL_BLOCK) places times PEL_STEP */
    pel_real *hinge_numbers;         /* (hinge blocks x PEL_HINGE_NUMBERS x PEL_BLOCK) */
    pel_record *rows;                /* (lanes of triangles x 3 + lanes of hinges x 4) forces on corners */
    size_t first_hinge_row;
    pel_record *area_vectors; /* (triangle lanes) weighted, of the vertex-normal form; else null */
    double (*energies)[3];    /* (chunks) membrane or bending, fibres, volume */
    int32_t *gather_begin;    /* (place_count + 1) */
    int32_t *gather;          /* numbers of rows */
    double *sums;             /* (place_count) scratch */
} pel_shell_body;

static inline int32_t pel_block_count(int32_t count)
{
    return (count + PEL_BLOCK - 1) / PEL_BLOCK;
}

/* the row of a corner of the element in a lane (counted through all blocks) within those of its kind */
static inline int32_t pel_row_of(int32_t lane, int arity, int corner)
{
    return (lane / PEL_BLOCK * arity + corner) * PEL_BLOCK + lane % PEL_BLOCK;
}

static inline int32_t pel_lane_of(int32_t row, int arity)
{
    return row / (arity * PEL_BLOCK) * PEL_BLOCK + row % PEL_BLOCK;
}

static inline int pel_corner_of(int32_t row, int arity)
{
    return row / PEL_BLOCK % arity;
}

/* ---- shell_lanes.c ---- */
/* what a loop over the blocks begin .. end - 1 asks for */
typedef struct pel_shell_sweep {
    const pel_record *position;
    int32_t begin, end;
    double pressure; /* Pa, positive inflates */
    bool with_pressure;
} pel_shell_sweep;

/* Fill the rows of triangles or hinges; return the energy of membrane or bending. */
double pel_shell_sweep_triangles(const pel_shell_body *own, const pel_shell_sweep *sweep, bool membrane);
double pel_shell_sweep_hinges(const pel_shell_body *own, const pel_shell_sweep *sweep);
/* The volume between the triangles and the first corner of all. */
double pel_shell_sweep_volumes(const pel_shell_body *own, const pel_shell_sweep *sweep);

struct pel_shell_forces {
    const pel_model *model;
    int32_t count;
    pel_shell_body *bodies;
};

static inline int32_t pel_shell_chunk_count(int32_t count, int32_t size)
{
    return (count + size - 1) / size;
}

/* null when a body is no shell */
const pel_shell_body *pel_shell_body_of(const pel_shell_forces *forces, int32_t body);

/* ---- shell_element.c ---- */
/* the law of triangle t */
pel_membrane_law pel_shell_law(const pel_shell_body *own, int32_t t);
/* Energy of the membrane of triangle t; subtracts its gradient from the rows, which may be null. */
double pel_shell_membrane_energy(const pel_shell_body *own, int32_t t, const double x[3][3], double rows[3][3]);
/* The same of its fibres. */
double pel_shell_fibre_energies(const pel_shell_body *own, int32_t t, double time, const double x[3][3],
                                double rows[3][3]);
/* Energy of a hinge over its factor, and its gradient, which may be null. */
double pel_shell_hinge_energy(const pel_shell *shell, const pel_shell_hinge *hinge, const double x[4][3],
                              double gradient[4][3]);

#endif
