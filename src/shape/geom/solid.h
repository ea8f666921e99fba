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

/* Depth of the triangle in the solid: positive at its deepest point, whose weights (3) are written, along `normal` (3),
   the direction out; 0 or less if it stays out (weights and normal are not written then). Exact: closest points for
   sphere and capsule; for a box the deepest point by a small linear program and the direction by pel_box_separation. */
double pel_solid_depth(const pel_solid *solid, const double a[3], const double b[3], const double c[3],
                       double weights[3], double normal[3]);

/* The axis (3), out of a box, along which it and a triangle are farthest apart or overlap least: a normal of a face,
   that of the triangle, or one across an edge of each. Where an edge of the box presses into the triangle, no face
   gives the direction out. Returns the support of the box: the signed distance of the triangle's point p is axis . p
   minus it. */
double pel_box_separation(const double half[3], const double triangle[3][3], double axis[3]);

/* Half sizes of the box about the solid in its own frame. */
void pel_solid_half_box(const pel_solid *solid, double half[3]);

/* Sum of these half sizes: a length that no point of the solid is farther from its center than. */
double pel_solid_size(const pel_solid *solid);

#endif
