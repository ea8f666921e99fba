/* Pellicle: the potential energy of a simulation's bodies as a function of all positions, with gradient and Hessian:
   for optimisers, stability analyses and solvers of the caller's own.

   The potential includes springs, volumetric springs, membrane, fibres, bending, pressure if it is conservative,
   gravity and loads, at the time of the simulation. That of gravity and loads is 0 at the rest positions. Contact,
   tools, pins, supports and damping are not included. The gradient is minus the forces of pel_sim_get_forces for bodies
   without velocity, and includes pressure that is not conservative.

   Positions are those of all bodies, one after the other, each in the order of pel_sim_get_positions:
   (pel_potential_vertex_count x 3). Source: theory page, sections 3 to 6 and 16. */
#ifndef PELLICLE_POTENTIAL_H
#define PELLICLE_POTENTIAL_H

#include "sim_step.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pel_potential pel_potential;

/* The simulation and its model must outlive the potential; one thread at a time steps the simulation or evaluates the
   potential. PEL_BAD_ARGUMENT for bending without a stiffness and for bodies that refine; PEL_OUT_OF_MEMORY. Free with
   pel_potential_destroy, which permits null. */
PEL_API pel_status pel_potential_create(pel_sim *sim, pel_potential **potential, pel_error *error);
PEL_API void pel_potential_destroy(pel_potential *potential);
PEL_API int32_t pel_potential_vertex_count(const pel_potential *potential);

/* Energy [J] at the positions, and its gradient [N] (vertex_count x 3), which may be null. Rotations of edges
   (PEL_BENDING_MIDEDGE) minimise the energy. PEL_BAD_ARGUMENT for a position that is not finite. */
PEL_API pel_status pel_potential_evaluate(pel_potential *potential, const double *positions, double *energy,
                                          double *gradient, pel_error *error);

/* A symmetric matrix in compressed rows plus outer products: values + sum of coefficient g g^T. Row 3 v + k is
   component k of vertex v; both triangles are stored, columns of a row ascend. */
typedef struct pel_hessian {
    int32_t row_count;        /* 3 vertex_count */
    int32_t entry_count;      /* of values */
    int32_t *row_start;       /* (row_count + 1) */
    int32_t *columns;         /* (entry_count) */
    double *values;           /* (entry_count) N/m */
    int32_t rank_one_count;   /* one for each enclosed gas and target volume */
    double *coefficients;     /* (rank_one_count) J/m6 */
    double *volume_gradients; /* (rank_one_count x row_count) m2 */
} pel_hessian;

/* The exact second derivative at the positions. PEL_BAD_ARGUMENT for a position that is not finite, for
   PEL_BENDING_MIDEDGE (its edges have additional unknowns) and for more than 2^31 entries; PEL_OUT_OF_MEMORY. On
   failure *hessian is null. Free with pel_hessian_destroy, which permits null. */
PEL_API pel_status pel_potential_hessian(pel_potential *potential, const double *positions, pel_hessian **hessian,
                                         pel_error *error);
PEL_API void pel_hessian_destroy(pel_hessian *hessian);

#ifdef __cplusplus
}
#endif
#endif
