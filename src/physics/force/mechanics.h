/* Strain, resultants and energies of the triangles of a shell: sums over elements, then tensors in space. */
#ifndef PEL_FORCE_MECHANICS_H
#define PEL_FORCE_MECHANICS_H

#include "force/shell_force.h"
#include "force/tangent.h"
#include "pellicle/sim_forces.h"

/* Fills the triangles (triangle_count) of a body: membrane, fibres and hinges; zeros for a body that is no shell. Until
   pel_mechanics_finish, `moment` holds components 11, 22, 12 in the frame of the rest triangle times its area. */
void pel_mechanics_fill(const pel_shell_forces *forces, int32_t body, int32_t triangle_count,
                        const pel_record *position, double time, pel_triangle_mechanics *triangles);

/* Energy [J] of membrane and fibres in triangle t, whose gradients on the corners are added; 0 for a body without. */
double pel_mechanics_gradient(const pel_shell_forces *forces, int32_t body, int32_t t, const pel_record *position,
                              double time, double gradient[3][3]);

/* Adds mid-edge bending of a body at the unknowns of the tangent. */
void pel_mechanics_add_midedge(pel_tangent *tangent, const double *unknowns, pel_pool *pool, int32_t body,
                               pel_triangle_mechanics *triangles);

/* Adds a third of the energy of mid-edge bending of each triangle to the rows of its corners; rows are those of
   pel_shell_vertex_energies. */
void pel_mechanics_share_midedge(pel_tangent *tangent, const double *unknowns, pel_pool *pool, int32_t body,
                                 const int32_t *output_vertex, double *bending);

/* How much mid-edge bending of a body gives way more than the plate, as a share of its energy: jumps of the curvatures
   over edges, with lengths l and stiffness D, D l^2 ([along]^2 / 120 + [twist]^2 / 12) / 2 of each (the jumps of
   deflection and slope of Beirao da Veiga, Niiranen, Stenberg 2007, Numer. Math. 106:165). */
double pel_mechanics_midedge_error(pel_tangent *tangent, const double *unknowns, pel_pool *pool, int32_t body);

/* Turns sums over triangles into densities, and tensors into space. */
void pel_mechanics_finish(const pel_shell_forces *forces, int32_t body, const pel_record *position,
                          pel_triangle_mechanics *triangles);

#endif
