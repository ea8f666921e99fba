/* Continuous collision of one pair, shared by the functions of pellicle/geometry.h. */
#ifndef PEL_GEOM_CCD_H
#define PEL_GEOM_CCD_H

#include "geom/ccd_pair.h"
#include "pellicle/geometry.h"

/* One query, scaled by a power of two where its size is extreme; lengths below are scaled. */
typedef struct ccd_query {
    ccd_pair pair;
    bool edge_edge;
    double scale; /* scaled = scale * given */
    double min_separation, tolerance, near;
    double error; /* of a corner's coordinate */
    int order[4]; /* order[i] = given number of the point that is point i here */
} ccd_query;

/* lengths of a query, as in pel_ccd_batch */
typedef struct ccd_lengths {
    double min_separation, tolerance, near;
} ccd_lengths;

typedef struct ccd_counts {
    int intervals; /* 0 = no cubic was needed: axes separate the step, or it starts near */
    bool fall_back;
} ccd_counts;

/* points at both ends of the step, pointers to (3) */
typedef struct ccd_points {
    const double *start[4], *end[4];
} ccd_points;

/* False when nothing can be computed from the numbers (NaN, infinite or too large). */
bool ccd_query_set(const ccd_points *points, bool edge_edge, const ccd_lengths *lengths, ccd_query *query);

/* Filter, axes and time of impact of one query in its own order of points. */
bool ccd_solve(const ccd_points *points, bool edge_edge, const ccd_lengths *lengths, pel_ccd_hit *hit,
               ccd_counts *counts);

/* The plain cubic. */
bool ccd_solve_bridson(const ccd_points *points, bool edge_edge, double min_separation, double tolerance,
                       pel_ccd_hit *hit);

/* Fills a hit at a time: closest place, weights in the caller's order, normal. */
void ccd_hit_set(const ccd_query *query, double time, pel_ccd_hit *hit);

/* The hit of input that is not finite. */
void ccd_hit_unknown(bool edge_edge, pel_ccd_hit *hit);

/* Filter and axes of a batch whose points have numbers: as pel_ccd_filter_batch. */
int32_t pel_ccd_near_batch(const pel_ccd_batch *batch, int32_t *survivors);

static inline void pel_ccd_statistics_add(pel_ccd_statistics *sum, const pel_ccd_statistics *more)
{
    sum->queries += more->queries;
    sum->passed_filter += more->passed_filter;
    sum->passed_hull += more->passed_hull;
    sum->cubics += more->cubics;
    sum->hits += more->hits;
    sum->intervals += more->intervals;
    sum->fall_backs += more->fall_backs;
}

/* difference vector of the closest points at a time; parameters s, u */
void ccd_closest(const ccd_query *query, double time, double *s, double *u, double vector[3]);

#endif
