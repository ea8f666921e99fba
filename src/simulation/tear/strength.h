/* Where a tear starts by itself: the strength of the material, averaged over a length of the material. */
#ifndef PEL_TEAR_STRENGTH_H
#define PEL_TEAR_STRENGTH_H

#include "tear/survey.h"

/* A tear to be: a slit from a vertex, to both sides of it, or from the border inward. */
typedef struct pel_start {
    int32_t vertex;
    double direction[3]; /* unit, in the rest shape */
    double length;       /* m, of each arm */
    int arm_count;       /* 2, or 1 from a border, into `direction` */
} pel_start;

/* The vertex of a body with a strength where the mean stress exceeds it most; false if none does
   (pel_shell_forces_follow has been called for the present state). With as many tips as `most_tips` none starts. */
bool pel_start_find(pel_survey *survey, int32_t most_tips, pel_start *start);

#endif
