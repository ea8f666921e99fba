/* Pellicle: geometry of a few points, without meshes or state. Always double, whatever pel_real is.
   Pure functions over the caller's numbers: no memory, no state, any thread. Points are (3), metres or any other unit.
 */
#ifndef PELLICLE_GEOMETRY_H
#define PELLICLE_GEOMETRY_H

#include "kinds.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Closest points. Each function returns the squared distance and writes the weights of the end points or corners, in
   the order of the arguments: all in 0 .. 1, those of one object sum to 1, the closest point is the weighted sum.
   Degenerate segments and triangles (all points equal or on a line) are treated as points and lines. Nearly parallel
   and thin cases choose the nearest of several candidates, so the distance is right even where the closest points
   are ill-determined. NaN or infinite input gives NaN or infinity, with weights that are still in range. */

/* Point p and segment a, b: weights (2) of a, b. */
PEL_API double pel_closest_point_segment(const double p[3], const double a[3], const double b[3], double weights[2]);

/* Point p and triangle a, b, c: weights (3) of a, b, c. */
PEL_API double pel_closest_point_triangle(const double p[3], const double a[3], const double b[3], const double c[3],
                                          double weights[3]);

/* Segments a, b and c, d: weights (4), those of a, b sum to 1 and those of c, d sum to 1. */
PEL_API double pel_closest_segment_segment(const double a[3], const double b[3], const double c[3], const double d[3],
                                           double weights[4]);

/* Segment a, b and triangle c0, c1, c2: weights (5), first of a, b, then of c0, c1, c2. If the segment pierces the
   triangle, the distance is zero up to rounding. */
PEL_API double pel_closest_segment_triangle(const double a[3], const double b[3], const double c0[3],
                                            const double c1[3], const double c2[3], double weights[5]);

/* Continuous collision of points that move on straight lines, x(t) = start + t (end - start), 0 <= t <= 1.

   The answer is "hit" unless it is proved, with bounds of the rounding errors, that there is none. So there are no
   false negatives: every approach within min_separation, touching included, is found. False positives are possible in
   two cases. First, the gap (beyond min_separation) is below `tolerance`, or below the rounding of the closest
   distance: about 1e-14 of the size of the features, up to 1e-8 for nearly parallel edges and very thin faces. Second,
   the motion exhausts the budget of time intervals (rare; pel_ccd_statistics counts these). Only differences of points
   matter, not their distance from the origin. The answer does not depend on the order of the points of a face or an
   edge, or of the two edges. Degenerate faces and edges, and pairs without motion, are supported. NaN or infinite input
   is a hit.

   min_separation  length >= 0; negative counts as 0
   tolerance       length: time intervals are divided until the features move less than this relative to each other;
                   usual: 1e-6 of the size of the features; 0 = as fine as double allows */

/* A hit: the first time at which contact could not be excluded. */
typedef struct pel_ccd_hit {
    double time_of_impact; /* never later than the true one: before it, the features are more than min_separation apart;
                              at it, they are at most min_separation + tolerance apart, plus rounding as above. 0 if the
                              pair starts within `near` (pel_ccd_batch) */
    double weight[4];      /* of the four points, closest approach: 1, then minus the barycentric coordinates
                              (vertex-face), or (1-s), s, -(1-u), -u (edge-edge): their sum is 0, and
                              sum weight[i] x[i] is the vector from the face (edge 2,3) to the vertex (edge 0,1) */
    double normal[3];      /* unit vector from the face (edge 2,3) to the vertex (edge 0,1), on the side where they were
                              before the hit; 0 when the input is not finite */
} pel_ccd_hit;

/* Point 0 against triangle 1,2,3. True = they come within min_separation during the step, or this cannot be excluded;
   `hit` (nullable) is written only then. */
PEL_API bool pel_ccd_vertex_face(const double start[4][3], const double end[4][3], double min_separation,
                                 double tolerance, pel_ccd_hit *hit);

/* Edge 0,1 against edge 2,3; otherwise as above. */
PEL_API bool pel_ccd_edge_edge(const double start[4][3], const double end[4][3], double min_separation,
                               double tolerance, pel_ccd_hit *hit);

/* Only the non-penetration filter (Tang, Manocha, Tong 2010, with a bound of the rounding error): false = the four
   points never become coplanar, or within min_separation of coplanar, so there is no contact; true = they may touch. */
PEL_API bool pel_ccd_filter(const double start[4][3], const double end[4][3], bool edge_edge, double min_separation);

/* The method of Bridson, Fedkiw and Anderson 2002 that Sun et al. 2021 use: finds the roots of the coplanarity cubic
   and compares the distances at the roots and at the end of the step with min_separation + tolerance. For comparison
   only: it has false negatives if the four points stay (nearly) coplanar, and its time of impact may be late by
   rounding. */
PEL_API bool pel_ccd_bridson(const double start[4][3], const double end[4][3], bool edge_edge, double min_separation,
                             double tolerance, pel_ccd_hit *hit);

/* Many queries of one kind on one set of points. */
typedef struct pel_ccd_batch {
    const double *start, *end; /* (point count x 3) */
    const int32_t *points; /* (query_count x 4) numbers of the points of a query; null: query i has points 4i..4i+3 */
    int32_t query_count;
    bool edge_edge;        /* false: vertex-face */
    pel_ccd_method method; /* of pel_ccd_solve_batch */
    double min_separation; /* as above */
    double tolerance;
    double near; /* length: if a query starts within this distance, with its closest points inside both features, and
                    contact cannot be excluded, it is a hit at time 0 at these points, and no time is computed. Values
                    up to min_separation (such as 0) affect only pairs that start too close. Not for PEL_CCD_BRIDSON */
} pel_ccd_batch;

/* Counts of the queries that passed each stage. Functions add to these numbers. */
typedef struct pel_ccd_statistics {
    int64_t queries;
    int64_t passed_filter; /* not excluded by the non-penetration filter */
    int64_t passed_hull;   /* nor by separating axes of the swept hull */
    int64_t cubics;        /* of these, those whose cubic was solved; the others start near, or are not finite */
    int64_t hits;
    int64_t intervals;  /* examined time intervals */
    int64_t fall_backs; /* hits because the budget of intervals was exhausted */
} pel_ccd_statistics;

/* Only the filter, four queries at a time: writes the numbers of the queries that may touch, ascending, to survivors
   (query_count) and returns their count. */
PEL_API int32_t pel_ccd_filter_batch(const pel_ccd_batch *batch, int32_t *survivors);

/* All stages: writes the numbers of the queries that hit, ascending, to queries (query_count) and the hits to hits
   (query_count, nullable); returns their count. statistics is nullable. A batch tries a few more separating axes than a
   single call, so it may exclude contacts that a single call reports, never the reverse. */
PEL_API int32_t pel_ccd_solve_batch(const pel_ccd_batch *batch, int32_t *queries, pel_ccd_hit *hits,
                                    pel_ccd_statistics *statistics);

/* Exact predicates: the true sign, -1, 0 or 1, for all finite input, without tolerance, overflow or underflow; 0 if a
   coordinate is not finite. Fast if rounding cannot change the sign. */

/* Sign of the area of triangle a, b, c in the plane, points (2): 1 = counter-clockwise, 0 = on one line. */
PEL_API int pel_orient2d(const double a[2], const double b[2], const double c[2]);

/* Sign of ((b - a) x (c - a)) . (d - a): 1 = d is on the side from which a, b, c is counter-clockwise, 0 = all points
   are on one plane. */
PEL_API int pel_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);

/* True if two triangles (3 corners x 3) have a common point. The test is exact: touching at a single point counts, also
   within one plane; triangles without area are treated as segments or points. True if a coordinate is not finite. */
PEL_API bool pel_triangles_intersect(const double a[3][3], const double b[3][3]);

/* The same for neighbours in a mesh: the first shared_count corners of both (0, 1 or 2) are the same points, in the
   same order, and only an intersection beyond the shared corner or edge counts: one triangle cuts through the other or
   is folded onto it. True if a neighbour has no area or shared_count is 3 (the same triangle twice). */
PEL_API bool pel_triangles_intersect_beyond(const double a[3][3], const double b[3][3], int shared_count);

#ifdef __cplusplus
}
#endif
#endif
