/* Smoothed tetrahedra: elements around the edges of a mesh of linear tetrahedra, which neither lock in bending nor
   where the material is nearly incompressible.

   The deformation gradient of an edge is the mean over the tetrahedra at it (its star), by volume: F = sum_k x_k b_k^T
   with the means b_k of their gradients (edge-based smoothed finite elements; Liu, Nguyen-Thoi, Lam 2009). Each
   tetrahedron gives a sixth of its volume to each of its edges. So the shape part of a law (measure/tetra_lanes.h), the
   one of mu, is evaluated. The other part, of J or tr E, has a constraint of each tetrahedron, six for a vertex, where
   the material is nearly incompressible: too many. It is evaluated on patches without overlap instead (selective mean
   dilatation): stars as whole as they can be, found from the largest to the smallest. No mode is without energy, as a
   mean over the patches alone would have. */
#ifndef PEL_MEASURE_STAR_H
#define PEL_MEASURE_STAR_H

#include "measure/tetra.h"

enum { PEL_STAR_NODES = 12 }; /* of an element; tetrahedra of larger stars stand for themselves there */

/* Elements by rising number of nodes. */
typedef struct pel_stars {
    int32_t count;
    int32_t *begin;         /* (count + 1) */
    int32_t *nodes;         /* (begin[count]) */
    double (*gradients)[3]; /* (begin[count]) b_k [1/m] */
    double (*scales)[2]; /* (count) J: Young's modulus times volume, of the part of the shape and of that of the size */
} pel_stars;

/* From positions of the vertices and the tetrahedra between them, with a Young's modulus of each [Pa].
 * PEL_OUT_OF_MEMORY. */
pel_status pel_stars_create(const double (*positions)[3], int32_t vertex_count, const int32_t (*tetrahedra)[4],
                            int32_t count, const double *young, pel_stars **stars, pel_error *error);
void pel_stars_destroy(pel_stars *stars);

/* The law of an element: both parts of a law for a Young's modulus of 1, times their scales [J]. */
pel_solid_law pel_star_law(const pel_solid_law *law, const double scales[2]);

/* F by rows of element e at the points x (3 for each of its nodes). */
void pel_star_deformation(const pel_stars *stars, int32_t e, const double *x, double f[9]);

/* Adds gradient and Hessian of element e over its unknowns, and returns its energy [J]. */
double pel_star_tangent(const pel_stars *stars, int32_t e, const pel_solid_law *law, const double *x,
                        pel_tangent_kind kind, const pel_tangent_sum *sum);

#endif
