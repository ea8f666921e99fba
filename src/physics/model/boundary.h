/* Held vertices during a step: they have no mobility and follow their path. The simulation sets it for the end of each
   substep, methods read it. */
#ifndef PEL_MODEL_BOUNDARY_H
#define PEL_MODEL_BOUNDARY_H

#include <stdint.h>

typedef struct pel_boundary {
    const uint8_t *is_held;    /* (vertex_count) 1 = held; null = none is */
    const int32_t *held;       /* (held_count) vertices */
    const double (*target)[3]; /* (held_count) m, their positions at the end of the substep */
    int32_t held_count;
} pel_boundary;

#endif
