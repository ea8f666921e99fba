/* What a session counts of the tools while a tear is led. */
#ifndef PEL_SESSION_SCORE_H
#define PEL_SESSION_SCORE_H

#include "pellicle/session.h"

/* sums over the steps so far; zeros at the start */
typedef struct pel_score_sums {
    double peak, squares; /* N, N2: of the largest force of all tools in a step */
    int64_t pulls;        /* steps with a force */
    int64_t touches;      /* steps in which a tool was at the far side */
    double begin, end;    /* s, of the first and of the last step with a force */
} pel_score_sums;

/* Adds the step that was taken. lead: the first tool of the scene that leads a tear. PEL_OUT_OF_MEMORY. */
pel_status pel_score_add(pel_score_sums *sums, pel_sim *sim, const pel_tool_def *lead, pel_error *error);

#endif
