/* How far points have gone since the loads of a step were recalled: bounds by which pairs need not be looked at again
   (refresh.c, tool/solid.c). They come from the boxes around the ways of the points of each body between two calls, so
   that a common translation brings no two points nearer to each other. */
#ifndef PEL_COLLIDE_TRAVEL_H
#define PEL_COLLIDE_TRAVEL_H

#include "base/pool.h"
#include "math/record.h"
#include "pellicle/base.h"

/* What points are whose; the arrays have to live on. */
typedef struct pel_travel_def {
    int32_t vertex_count, body_count;
    const int32_t *body_of_slice; /* (vertex_count / PEL_WIDTH), rising */
    const pel_real *mass;         /* (vertex_count) kg; places with mass 0 are skipped */
} pel_travel_def;

typedef struct pel_travel {
    pel_travel_def def;
    double *way;      /* (body_count) m, the longest of a point of each body */
    double approach;  /* m, of any two points to each other */
    bool is_measured; /* the last positions are known: */
    pel_record *last; /* (vertex_count) m */
    /* parts of bodies that are measured at once, with the boxes around their ways */
    int32_t chunk_count;
    int32_t *chunk_begin; /* (chunk_count + 1) vertices */
    double (*low)[3], (*high)[3];
} pel_travel;

/* PEL_OUT_OF_MEMORY */
pel_status pel_travel_create(const pel_travel_def *def, pel_travel *travel, pel_error *error);
void pel_travel_destroy(pel_travel *travel);
/* Nothing has moved. */
void pel_travel_restart(pel_travel *travel);
/* Adds the ways since the last call (positions: vertex_count). other [m]: way of something else that they may meet,
   negative = there is nothing else. Same bits for any pool. */
void pel_travel_follow(pel_travel *travel, const pel_record *positions, double other, pel_pool *pool);

#endif
