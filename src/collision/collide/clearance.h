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

#include "base/lane.h"
#include "bvh/candidates.h"

typedef struct pel_clearance {
    double (*positions)[3]; /* (point_count) */
    int32_t point_count;
    double reach;    /* m; 0 = no pairs are known */
    double nearest;  /* m, distance of the nearest known pair; infinite = none */
    double approach; /* m, bound of that of any two points from there to the end of the last way that was clear;
                        infinite = not known */
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

/* a step of points of which the first are records */
typedef struct pel_clearance_way {
    const pel_record *start_records; /* (record_count) m, null = the end of the last way, which was clear */
    const pel_record *end_records;   /* (record_count) m */
    int32_t record_count;
    const double (*start)[3], (*end)[3]; /* (point_count) m, those before record_count are not read */
} pel_clearance_way;

/* Whether no pair at all comes nearer than `needed` [m] on the way, because even the nearest known one was too far
   apart. */
bool pel_clearance_is_clear(pel_clearance *clearance, const pel_clearance_way *way, double needed, pel_pool *pool);
/* The same from the end of the last way, which was clear, if no displacement is longer than this [m]; points are not
   looked at. ends: the way is taken, and the next one goes on from its end. */
bool pel_clearance_stays_clear(pel_clearance *clearance, double longest, bool ends, double needed);
/* Sets the start of the next way to these positions (point_count), for pel_clearance_stays_clear after a way that was
   not clear. Nothing is measured if a known pair is nearer than `needed` already. */
void pel_clearance_go(pel_clearance *clearance, const pel_record *positions, double needed, pel_pool *pool);

/* Searches all pairs nearer than needed + margin at `start`, if the displacement to `end` is so short that they will
   serve many steps like this one. True = they are known now, and serve this step. False on failure too. */
bool pel_clearance_renew(pel_clearance *clearance, pel_candidates *candidates, const double (*start)[3],
                         const double (*end)[3], double needed, double margin, pel_pool *pool);

/* After the known pairs served a step from start to end, in which they come nearer than `needed` [m]: if it was short,
   and many before it have brought points nearer to each other, the known pairs are those at `start` from now on, with
   less reach. The nearest pair is so found again where surfaces have come to rest. */
void pel_clearance_settle(pel_clearance *clearance, const pel_tree *tree, const double (*start)[3],
                          const double (*end)[3], double needed, pel_pool *pool);

/* Room in `inner` for all known pairs, so that pel_clearance_narrow allocates nothing in a step in which bodies have
   come to rest. False on failure. */
bool pel_clearance_reserve(pel_clearance *inner, const pel_clearance *outer);

/* Of the known pairs, which served or may serve the step from start to end, those that are near at `start`: fewer pairs
   for some steps. True = they serve this step. False on failure too. */
bool pel_clearance_narrow(pel_clearance *inner, const pel_clearance *outer, const pel_tree *tree,
                          const double (*start)[3], const double (*end)[3], double needed, pel_pool *pool);

enum { PEL_CLEARANCE_PARTS = 5 };

/* Its state except the pairs, which follow from it (pel_candidates_memory). */
void pel_clearance_memory(pel_clearance *clearance, pel_memory_part parts[PEL_CLEARANCE_PARTS]);
/* Finds the pairs again after the pieces were overwritten; kept candidates are discarded. PEL_BAD_FORMAT if they cannot
   have been saved from here; other errors as for an update. */
pel_status pel_clearance_recall(pel_clearance *clearance, pel_candidates *candidates, pel_pool *pool, pel_error *error);

#endif
