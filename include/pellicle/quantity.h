/* Pellicle: parameters that vary over time or over a body. */
#ifndef PELLICLE_QUANTITY_H
#define PELLICLE_QUANTITY_H

#include "base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One point of a piecewise linear curve over time, constant before the first and after the last key. */
typedef struct pel_key {
    double time; /* s */
    double value;
} pel_key;

/* A material parameter that may vary over the body or over time (not both). */
typedef struct pel_quantity {
    double value;        /* used when field and keys are null */
    const double *field; /* (vertex_count) value on each vertex; springs and triangles use the mean of their vertices;
                            nullable */
    const pel_key *keys; /* (key_count) value over time; nullable */
    int32_t key_count;
} pel_quantity;

#ifdef __cplusplus
}
#endif
#endif
