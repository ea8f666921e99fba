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

   The answer is "hit" unless freedom was proved with bounded rounding error, so there is no false negative by
   construction: every approach within min_separation, touching included, is found. A wrong "hit" needs a gap (beyond
   min_separation) below `tolerance` or below the rounding of the closest distance: about 1e-14 of the size of the
   features, up to 1e-8 for nearly parallel edges and very thin faces; or a motion that exhausts the budget of time
   intervals (pel_ccd_statistics counts these; they are rare). Only differences of points matter, not their place in the
   world; the answer does not depend on the order of the points of a face or an edge nor of the two edges; degenerate
   faces and edges, and pairs that do not move, are supported. NaN or infinite input is a hit.

   min_separation  length >= 0; negative counts as 0
   tolerance       length: time intervals are divided until the features move less than this relative to each other.
   1e-6 of the size of the features is usual; 0 = as fine as double allows
 */

/* The first time at which freedom could not be proved any longer. */
typedef struct pel_ccd_hit {
    double time_of_impact; /* never later than the true one: until then the features are more than min_separation apart.
                              At this time they are at most min_separation + tolerance apart, rounding as above, or
                              0 where the pair starts near enough (pel_ccd_batch) */
    double weight[4];      /* of the four points, closest approach: 1, then minus the barycentric coordinates
                              (vertex-face), or (1-s), s, -(1-u), -u (edge-edge): their sum is 0, and
                              sum weight[i] x[i] is the vector from the face (edge 2,3) to the vertex (edge 0,1) */
    double normal[3];      /* unit vector from the face (edge 2,3) to the vertex (edge 0,1), on the side where they were
                              before the hit; 0 when the input is not finite */
} pel_ccd_hit;

/* Point 0 against triangle 1,2,3. True = they come within min_separation during the step, or this cannot be ruled out;
 *hit (nullable) is written only then. */
PEL_API bool pel_ccd_vertex_face(const double start[4][3], const double end[4][3], double min_separation,
                                 double tolerance, pel_ccd_hit *hit);

/* Edge 0,1 against edge 2,3. Otherwise as above. */
PEL_API bool pel_ccd_edge_edge(const double start[4][3], const double end[4][3], double min_separation,
                               double tolerance, pel_ccd_hit *hit);

/* The non-penetration filter alone (Tang, Manocha, Tong 2010, with a bound of the rounding error): false = the four
   points never become coplanar (nor come within min_separation of it), so there is no contact; true = may touch. */
PEL_API bool pel_ccd_filter(const double start[4][3], const double end[4][3], bool edge_edge, double min_separation);

/* The plain method of Bridson, Fedkiw and Anderson 2002 that Sun et al. 2021 use: roots of the coplanarity cubic, then
   the distance at the root, and at the end of the step, against min_separation + tolerance. Kept for comparison: it has
   false negatives where the four points stay (nearly) coplanar, and its time of impact may be late by rounding. */
PEL_API bool pel_ccd_bridson(const double start[4][3], const double end[4][3], bool edge_edge, double min_separation,
                             double tolerance, pel_ccd_hit *hit);

typedef enum pel_ccd_method {
    PEL_CCD_CONSERVATIVE, /* filter, separating axes, conservative time of impact */
    PEL_CCD_BRIDSON       /* filter, then the plain cubic */
} pel_ccd_method;

/* Many queries of one kind on one set of points. */
typedef struct pel_ccd_batch {
    const double *start, *end; /* (point count x 3) */
    const int32_t *points; /* (query_count x 4) numbers of the points of a query; null: query i has points 4i..4i+3 */
    int32_t query_count;
    bool edge_edge;        /* false: vertex-face */
    pel_ccd_method method; /* of pel_ccd_solve_batch */
    double min_separation; /* as above */
    double tolerance;
    double near; /* length: a query that starts within this distance, with its closest points inside both features, and
                    is not proved free, hits at time 0 at that place; its time is not computed. Values up to
                    min_separation (such as 0) affect only pairs that are too near already. Not for PEL_CCD_BRIDSON */
} pel_ccd_batch;

/* How far queries got: each number counts those that passed a stage. Functions add to it. */
typedef struct pel_ccd_statistics {
    int64_t queries;
    int64_t passed_filter; /* not ruled out by the non-penetration filter */
    int64_t passed_hull;   /* nor by separating axes of the swept hull */
    int64_t cubics;        /* of these, the cubic was solved; the others start near, or are no finite numbers */
    int64_t hits;
    int64_t intervals;  /* time intervals looked at for them */
    int64_t fall_backs; /* hits because the budget of intervals was used up */
} pel_ccd_statistics;

/* Filter alone, four queries at a time: writes the numbers of the queries that may touch, rising, to survivors
   (query_count) and returns how many there are. */
PEL_API int32_t pel_ccd_filter_batch(const pel_ccd_batch *batch, int32_t *survivors);

/* All stages: writes the numbers of the queries that hit, rising, to queries (query_count) and the hits to hits
   (query_count, nullable); returns how many there are. statistics is nullable. A batch tries a few more axes than a
   single call: it may prove freedom where that cannot, never the other way round. */
PEL_API int32_t pel_ccd_solve_batch(const pel_ccd_batch *batch, int32_t *queries, pel_ccd_hit *hits,
                                    pel_ccd_statistics *statistics);

/* Exact predicates: the true sign, -1, 0 or 1, for all finite input, without tolerance, overflow or underflow; 0 when a
   coordinate is not finite. Fast where rounding cannot matter. */

/* Sign of the area of triangle a, b, c in the plane, points (2): 1 = counter-clockwise, 0 = on one line. */
PEL_API int pel_orient2d(const double a[2], const double b[2], const double c[2]);

/* Sign of ((b - a) x (c - a)) . (d - a): 1 = d is on the side from which a, b, c is counter-clockwise, 0 = on one
 * plane. */
PEL_API int pel_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]);

/* True when two triangles (3 corners x 3) have a point in common, exactly: touching at a single point counts, in one
   plane too; triangles without area are treated as the segments or points they are. True when a coordinate is not
   finite. */
PEL_API bool pel_triangles_intersect(const double a[3][3], const double b[3][3]);

/* The same for neighbours in a mesh: the first shared_count corners of both (0, 1 or 2) are the same points, in the
   same order, and only an intersection beyond the shared corner or edge counts: one cuts through the other, or is
   folded onto it. True when a neighbour has no area or shared_count is 3 (the same triangle twice). */
PEL_API bool pel_triangles_intersect_beyond(const double a[3][3], const double b[3][3], int shared_count);

#ifdef __cplusplus
}
#endif
#endif
