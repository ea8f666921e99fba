/* A certificate that no new pairs can come near: the positions of a surface at one time, and all pairs of its features
   that were nearer to each other than `reach` then.

   Let d(p) be the displacement of a point p from those positions. Two points of the surface can approach each other by
   |d(p) - d(q)| at most. Displacements of all points lie in the box around those of the vertices, because points of
   features are means of vertices and paths are straight: so the diagonal of that box bounds every approach. The larger
   of the diagonals at the start and at the end of a step bounds it throughout the step. While needed + diagonal <
   reach, every pair that comes nearer than `needed` in the step is among the known ones, and no tree needs to be
   searched. A common translation of all points costs nothing. */
#ifndef PEL_COLLIDE_CLEARANCE_H
#define PEL_COLLIDE_CLEARANCE_H

#include "bvh/candidates.h"

typedef struct pel_clearance {
    double (*positions)[3]; /* (point_count) */
    int32_t point_count;
    double reach; /* m; 0 = no pairs are known */
    pel_pair_list vertex_face, edge_edge;
    int32_t uses;                /* queries that the present pairs served */
    int32_t pause, pause_length; /* slow steps to wait for before the next try; length of the last such pause */
} pel_clearance;

/* PEL_OUT_OF_MEMORY */
pel_status pel_clearance_create(int32_t point_count, pel_clearance *clearance, pel_error *error);
void pel_clearance_clear(pel_clearance *clearance);

/* Whether all pairs that come nearer than `needed` [m] between start and end (point_count) are known. */
bool pel_clearance_serves(pel_clearance *clearance, const double (*start)[3], const double (*end)[3], double needed,
                          pel_pool *pool);

/* Searches all pairs nearer than needed + margin at `start`, if the displacement to `end` is so short that they will
   serve many steps like this one. True = they are known now, and serve this step. False on failure too. */
bool pel_clearance_renew(pel_clearance *clearance, pel_candidates *candidates, const double (*start)[3],
                         const double (*end)[3], double needed, double margin, pel_pool *pool);

enum { PEL_CLEARANCE_PARTS = 5 };

/* Its state except the pairs, which follow from it (pel_candidates_memory). */
void pel_clearance_memory(pel_clearance *clearance, pel_memory_part parts[PEL_CLEARANCE_PARTS]);
/* Finds the pairs again after the pieces were overwritten; kept candidates are discarded. PEL_BAD_FORMAT if they cannot
   have been saved from here; other errors as for an update. */
pel_status pel_clearance_recall(pel_clearance *clearance, pel_candidates *candidates, pel_pool *pool, pel_error *error);

#endif
