/* Pellicle: geometry of a few points, without meshes or state. Always double, whatever pel_real is.
   Pure functions over the caller's numbers: no memory, no state, any thread. Points are (3), metres or any other unit.
 */
#ifndef PELLICLE_GEOMETRY_H
#define PELLICLE_GEOMETRY_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Closest points. Each function returns the squared distance and writes the weights of the end points or corners, in
   the order of the arguments: all in 0 .. 1, those of one object sum to 1, the closest point is the weighted sum.
   Degenerate segments and triangles (all points equal or on a line) are treated as what they are. Nearly parallel and
   thin cases choose the nearest of several candidates, so the distance is right even where the place is ill-determined.
   NaN or infinite input gives NaN or infinity, with weights that are still in range. */

/* Point p and segment a, b: weights (2) of a, b. */
double pel_closest_point_segment(const double p[3], const double a[3], const double b[3], double weights[2]);

/* Point p and triangle a, b, c: weights (3) of a, b, c. */
double pel_closest_point_triangle(const double p[3], const double a[3], const double b[3], const double c[3],
                                  double weights[3]);

/* Segments a, b and c, d: weights (4), those of a, b sum to 1 and those of c, d sum to 1. */
double pel_closest_segment_segment(const double a[3], const double b[3], const double c[3], const double d[3],
                                   double weights[4]);

/* Segment a, b and triangle c0, c1, c2: weights (5), first of a, b, then of c0, c1, c2. When the segment goes through
   the triangle the distance is zero but for rounding. */
double pel_closest_segment_triangle(const double a[3], const double b[3], const double c0[3], const double c1[3],
                                    const double c2[3], double weights[5]);

#ifdef __cplusplus
}
#endif
#endif
