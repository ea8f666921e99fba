/* Rigid convex solids in their own frame: the shapes of tools. */
#ifndef PEL_GEOM_SOLID_H
#define PEL_GEOM_SOLID_H

#include "pellicle/base.h"

typedef enum pel_solid_kind {
    PEL_SOLID_SPHERE,  /* radius */
    PEL_SOLID_CAPSULE, /* radius about the segment from -half_length to +half_length on the z axis */
    PEL_SOLID_BOX      /* half_extents */
} pel_solid_kind;

typedef struct pel_solid {
    pel_solid_kind kind;
    double radius, half_length;
    double half_extents[3];
} pel_solid;

/* Signed distance of p, negative inside. normal (3) is the unit direction out of the solid through the nearest face. */
double pel_solid_distance(const pel_solid *solid, const double p[3], double normal[3]);

/* How deep the triangle goes into the solid: the depth of its deepest point (positive), whose weights (3) and outward
   normal (3) are written; 0 or less when it stays out (weights and normal are not written then). Exact: closest points
   for sphere and capsule, a small linear program for the box. */
double pel_solid_depth(const pel_solid *solid, const double a[3], const double b[3], const double c[3],
                       double weights[3], double normal[3]);

/* Half sizes of the box about the solid in its own frame. */
void pel_solid_half_box(const pel_solid *solid, double half[3]);

#endif
