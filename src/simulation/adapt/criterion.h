/* The criteria of refinement. */
#ifndef PEL_ADAPT_CRITERION_H
#define PEL_ADAPT_CRITERION_H

#include "stage/stage.h"

typedef struct pel_verdict {
    double strength; /* largest measure over threshold; above 1 the vertex refines the triangles around it */
    bool warm;       /* a measure is above its lower threshold */
} pel_verdict;

/* Before the slices of a body are looked at in a step. */
void pel_refine_criterion_begin(pel_sim *sim, int32_t body);
/* the criteria at the vertices of a slice of a body, whose def uses any of them */
void pel_refine_criterion_slice(pel_sim *sim, int32_t body, int32_t slice, const pel_body_force *numbers,
                                pel_verdict verdicts[PEL_WIDTH]);
/* after loading a snapshot: resets data that it does not contain */
void pel_refine_criterion_forget(const pel_sim *sim, int32_t body);
static inline bool pel_refine_criterion_is_used(const pel_refine_def *def)
{
    return !def->everywhere && (def->above > 0 || def->curvature_above > 0 || def->near_tools > 0);
}

#endif
