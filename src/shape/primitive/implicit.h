/* Surfaces that are the zero of a function of space, and triangle meshes on them. */
#ifndef PEL_PRIMITIVE_IMPLICIT_H
#define PEL_PRIMITIVE_IMPLICIT_H

#include "pellicle/mesh.h"

/* Below 0 inside. The gradient is not 0 near the surface; the function is about a distance there. */
typedef struct pel_implicit {
    double (*value)(const void *inner, const double point[3], double gradient[3]);
    const void *inner;
    double low[3], high[3]; /* a box that holds the surface with some room */
} pel_implicit;

/* Moves a point onto the surface by Newton's method along the gradient; returns the unit normal there. */
void pel_implicit_project(const pel_implicit *surface, double point[3], double normal[3]);

/* Marching tetrahedra: each cell of a lattice with this spacing is cut into six tetrahedra along one diagonal. The mesh
   is an oriented closed manifold, turned outward; its triangles are uneven.
   For lattices of at most 2^31 / 12 points. Errors: PEL_OUT_OF_MEMORY; PEL_BAD_ARGUMENT when no lattice point is
   inside. */
pel_status pel_implicit_march(const pel_implicit *surface, double spacing, pel_mesh **mesh, pel_error *error);

/* Replaces a closed mesh on the surface by one with edges of about this length: splits, collapses and flips edges and
   moves the vertices along the surface (Botsch and Kobbelt 2004). Connectivity stays that of a manifold.
   On failure (PEL_OUT_OF_MEMORY) *mesh is destroyed and null. */
pel_status pel_implicit_remesh(const pel_implicit *surface, double edge, pel_mesh **mesh, pel_error *error);

#endif
