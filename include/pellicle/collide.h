/* Pellicle: collisions of a moving surface with itself. A collider stores the triangles of a surface. In each step it
   finds the pairs that may touch while the vertices move from one set of positions to another:

       pel_collider_def def = pel_collider_def_default();
       def.mesh = mesh;
       pel_collider_create(&def, &collider, &error);
       pel_collision_query query = pel_collision_query_default();
       query.start = x, query.end = x_next, query.min_separation = thickness;
       pel_collider_detect(collider, &query, &result, &error);

   It moves nothing: the caller responds to collisions. One thread at a time uses a collider (inside, it uses threads of
   its own). It keeps pairs from call to call. This affects its run time, and the order and number of candidates, but
   not the detected collisions. */
#ifndef PELLICLE_COLLIDE_H
#define PELLICLE_COLLIDE_H

#include "geometry.h"
#include "intersect.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pel_collider pel_collider;

typedef struct pel_collider_def {
    const pel_mesh *mesh; /* copied. One mesh may contain several bodies: pairs are found within and between them */
    double margin; /* m, relative motion up to which pairs are kept from step to step; 0 = a new search in each step;
                      negative = a fifth of the mean edge length */
    int64_t memory_limit; /* bytes for pairs, about 32 each; 0 = 1 GiB, or 4 KiB per triangle if that is more. Near the
                             limit the margin shrinks to 0; a query that exceeds it fails */
    int thread_count;     /* 0 = the processors of this machine; the results do not depend on it */
    uint32_t cookie;      /* set by pel_collider_def_default */
} pel_collider_def;

/* No mesh yet, margin -1, one thread. */
PEL_API pel_collider_def pel_collider_def_default(void);

/* PEL_BAD_ARGUMENT (numbers out of range, a position that is not finite), PEL_BAD_MESH with the triangle (a bad index
   or a repeated vertex), PEL_OUT_OF_MEMORY. Free with pel_collider_destroy. */
PEL_API pel_status pel_collider_create(const pel_collider_def *def, pel_collider **collider, pel_error *error);
PEL_API void pel_collider_destroy(pel_collider *collider);

/* One step: all vertices move on straight lines. */
typedef struct pel_collision_query {
    const double *start, *end; /* (vertex_count x 3) m, finite; the same array for a surface at rest */
    double min_separation;     /* m, >= 0: smaller distances are collisions */
    double tolerance;          /* m, >= 0, in addition to min_separation; see pellicle/geometry.h */
    double near;               /* m, >= 0, see pel_ccd_batch */
    pel_ccd_method method;
} pel_collision_query;

/* Separation 0, tolerance 0, near 0, PEL_CCD_CONSERVATIVE. */
PEL_API pel_collision_query pel_collision_query_default(void);

/* Candidates: all pairs without a common vertex whose swept boxes, enlarged by min_separation + tolerance, overlap;
   each pair once. Lives until the next call with this collider. */
typedef struct pel_collision_candidates {
    const pel_pair *vertex_face; /* (vertex_face_count) vertex, triangle */
    int64_t vertex_face_count;
    const pel_pair *edge_edge; /* (edge_edge_count) edges, first < second. An edge is named by the first half-edge along
                                  it, 3 t + i: from corner i of triangle t to the next corner */
    int64_t edge_edge_count;
    int64_t searches; /* searches of the tree since creation; the other steps used kept pairs */
    int64_t kept;     /* pairs examined */
} pel_collision_candidates;

/* Only the broad phase. Allocates memory only if there are more candidates than in any call before.
   PEL_BAD_ARGUMENT (a position that is not finite, with its vertex; numbers out of range; more candidates than
   memory_limit allows: use a shorter step), PEL_OUT_OF_MEMORY. */
PEL_API pel_status pel_collider_candidates(pel_collider *collider, const pel_collision_query *query,
                                           pel_collision_candidates *candidates, pel_error *error);

/* A vertex and a triangle, or two edges, whose distance falls below min_separation. */
typedef struct pel_collision {
    bool edge_edge;
    int32_t first, second; /* vertex and triangle, or edges, as in the candidates */
    int32_t vertices[4];   /* vertex and corners, or the ends of both edges */
    pel_ccd_hit hit;       /* when and where; weights in the order of `vertices` */
} pel_collision;

typedef struct pel_collision_result {
    const pel_collision *collisions; /* vertex-face first; each kind by ascending numbers; lives until the next call */
    int64_t collision_count;
    pel_ccd_statistics vertex_face, edge_edge; /* queries are the candidates */
} pel_collision_result;

/* Broad and narrow phase: every pair without a common vertex that comes within min_separation during the step is found
   (see pellicle/geometry.h for what a hit means). Failures as above. */
PEL_API pel_status pel_collider_detect(pel_collider *collider, const pel_collision_query *query,
                                       pel_collision_result *result, pel_error *error);

#ifdef __cplusplus
}
#endif
#endif
