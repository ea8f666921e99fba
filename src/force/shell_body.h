/* Inside of the forces of shells: what the files of this folder share. */
#ifndef PEL_FORCE_SHELL_BODY_H
#define PEL_FORCE_SHELL_BODY_H

#include "force/shell_force.h"
#include "material/membrane.h"

/* elements of one chunk of a parallel loop */
enum { PEL_SHELL_CHUNK = 256 };

/* fibres of one region in one triangle, as the loop needs them */
typedef struct pel_triangle_fibre {
    int32_t region;
    double stiffness; /* N/m, weight included */
    double direction[2];
} pel_triangle_fibre;

typedef struct pel_shell_body {
    const pel_shell *shell;
    int32_t body;
    int32_t first_place, place_count;
    int pressure_part;      /* which of the parts its pressure is; 0 = none */
    pel_membrane_law *laws; /* (triangle_count), or one when the material is uniform */
    int32_t *fibre_begin;   /* (triangle_count + 1); null without fibres */
    pel_triangle_fibre *fibres;
    double (*rows)[3];         /* (3 triangle_count + 4 hinge_count) forces on corners */
    double (*area_vectors)[3]; /* (triangle_count) weighted, of the vertex-normal form; else null */
    double (*energies)[3];     /* (chunks) membrane or bending, fibres, volume */
    int32_t *gather_begin;     /* (place_count + 1) */
    int32_t *gather;           /* numbers of rows */
} pel_shell_body;

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
/* Energy of the membrane of triangle t; subtracts its gradient from the rows, which may be null. */
double pel_shell_membrane_energy(const pel_shell_body *own, int32_t t, const double x[3][3], double rows[3][3]);
/* The same of its fibres. */
double pel_shell_fibre_energies(const pel_shell_body *own, int32_t t, double time, const double x[3][3],
                                double rows[3][3]);
/* Energy of a hinge over its factor, and its gradient, which may be null. */
double pel_shell_hinge_energy(const pel_shell *shell, const pel_shell_hinge *hinge, const double x[4][3],
                              double gradient[4][3]);

#endif
