/* Mass, center and inertia of meshes, by exact integrals over their triangles. */
#ifndef PEL_RIGID_INERTIA_H
#define PEL_RIGID_INERTIA_H

#include "pellicle/mesh.h"

typedef struct pel_inertia {
    double mass, center[3]; /* kg, m */
    double tensor[3][3];    /* kg m2, about the center */
} pel_inertia;

/* of the filling of a closed mesh, which may have cavities; density in kg/m3 */
void pel_inertia_of_solid(const pel_mesh *mesh, double density, pel_inertia *inertia);
/* of the triangles alone, as thin as they are; density in kg/m2 */
void pel_inertia_of_sheet(const pel_mesh *mesh, double density, pel_inertia *inertia);

/* the inverse of a symmetric matrix; false, and zeros, where it has none */
bool pel_inertia_invert(const double tensor[3][3], double inverse[3][3]);
/* The same, none if its determinant is at most `least` of the cube of its trace. */
bool pel_inertia_invert_above(const double tensor[3][3], double least, double inverse[3][3]);

/* Masses (vertex_count) of vertices whose sum and center are those of the inertia: shares (vertex_count) > 0, tilted as
   little as that takes. The center has to be inside of their convex hull; false if it is not. masses may be shares. */
bool pel_inertia_lump(const pel_mesh *mesh, const pel_inertia *inertia, const double *shares, double *masses);

#endif
