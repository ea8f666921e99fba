/* Tetrahedra that are shorter in parts of a body, by longest-edge bisection (Rivara 1991). */
#ifndef PEL_TETRA_BISECT_H
#define PEL_TETRA_BISECT_H

#include "pellicle/mesh.h"

typedef struct pel_bisect_def {
    /* the longest edge [m] that a tetrahedron with this centre may have */
    double (*edge)(void *user, const double center[3]);
    void *user;
    const pel_mesh *surface; /* new vertices of the surface move to the nearest point of this one; nullable */
    int32_t most;            /* stops at so many tetrahedra */
} pel_bisect_def;

/* Bisects the tetrahedra of a filled mesh, and neighbours so that faces still fit, until no edge is longer than wanted.
   PEL_OUT_OF_MEMORY. On failure *finer is null. Free with pel_mesh_destroy. */
pel_status pel_mesh_bisect(const pel_mesh *filled, const pel_bisect_def *def, pel_mesh **finer, pel_error *error);

#endif
