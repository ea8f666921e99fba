/* Where a segment that moves passes through a triangle that moves: both go straight from their places at the start of a
   time step to those at its end. */
#ifndef PEL_GEOM_SWEEP_H
#define PEL_GEOM_SWEEP_H

#include <stdbool.h>

/* Where a part of the passage begins or ends. */
typedef enum pel_sweep_kind {
    PEL_SWEEP_EDGE,  /* the segment goes over the edge from corner `edge` to the next one */
    PEL_SWEEP_END,   /* an end of the segment goes through the triangle */
    PEL_SWEEP_FIRST, /* the segment is in the triangle at the start */
    PEL_SWEEP_LAST   /* and at the end */
} pel_sweep_kind;

typedef struct pel_sweep_event {
    double time; /* 0 to 1 */
    double weights[3];
    pel_sweep_kind kind;
    int edge;
} pel_sweep_event;

typedef struct pel_sweep {
    double segment[2][2][3]; /* (time x end x 3) m */
    double corners[2][3][3]; /* (time x corner x 3) m */
    bool turned[3];          /* of an edge: seen from its other end, so that both triangles beside it say the same */
} pel_sweep;

/* three roots of each edge and of both ends, and the two ends of the time */
enum { PEL_SWEEP_EVENTS = 17 };

/* Fills events (PEL_SWEEP_EVENTS) in pairs: the segment is in the triangle from the first one of a pair to the second,
   in a point that goes from one to the other. Returns their number, an even one. Exact up to rounding; a passage
   through a corner or along an edge, and a segment that stays in the plane of the triangle, may be missed: move the
   segment aside by a share of its length that rounding does not reach. */
int pel_sweep_find(const pel_sweep *sweep, pel_sweep_event *events);

/* Weights of the point where a segment at rest passes through a triangle; false if it does not. */
bool pel_segment_passes(const double segment[2][3], const double corners[3][3], double weights[3]);

#endif
