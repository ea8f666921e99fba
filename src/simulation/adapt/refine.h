/* Refinement of the surfaces while they move. */
#ifndef PEL_ADAPT_REFINE_H
#define PEL_ADAPT_REFINE_H

#include "stage/stage.h"

/* verdict of the criteria on a vertex */
typedef enum pel_request {
    PEL_REQUEST_NONE,
    PEL_REQUEST_MADE,   /* it requests the triangles around it */
    PEL_REQUEST_ENDING, /* still requests, and is in the list of those that stop */
    PEL_REQUEST_WAITING /* is in the list of candidates */
} pel_request;

/* State of the refinement of one body (refine.c). Lists are of vertices, numbered as in the forest. */
struct pel_refine_body {
    int32_t *mark_counts; /* (nodes that can be red) how many vertices ask for it */
    uint8_t *requests;    /* (vertices of the finest level) pel_request */
    int64_t *warm_step;   /* (same) last step in which a hot vertex was above its lower threshold */
    double *strengths;    /* (same) largest measure over threshold, when it was last looked at */
    uint8_t *asked_level; /* (mesh vertices) by pel_sim_refine */
    int32_t *visited;     /* (vertices of the finest level) scratch of a walk over rings: number of the walk */
    int32_t *queue;       /* (same) scratch */
    int32_t *candidates;  /* (same) waiting ones of past rounds, then those found in this round */
    int32_t *leaving;     /* (same) those that stop to ask */
    int32_t *hot;         /* (same) those that ask, leaving ones included */
    int32_t *hot_place;   /* (same) their places in that list */
    int32_t walk, candidate_count, waiting_count, leaving_count, hot_count;
    int32_t part;            /* of the round that comes next, 0 .. interval - 1 */
    double *rest_curvatures; /* (curvature_count) by place, of the present surface at rest, NAN = not known */
    int32_t curvature_count; /* places of the body, 0 = not used */
};

pel_status pel_refine_create(pel_sim *sim, pel_error *error);
void pel_refine_destroy(pel_sim *sim);
/* looks at a part of the vertices, refines and coarsens */
void pel_refine_step(pel_sim *sim);
/* the whole body on its finest level, or only the requested refinement; for stability checks */
void pel_refine_everywhere(pel_sim *sim, int32_t body, bool everywhere);
/* Initial refinement. PEL_BAD_ARGUMENT if a budget is too small for it. */
pel_status pel_refine_start(pel_sim *sim, pel_error *error);

#endif
