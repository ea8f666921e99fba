/* Keeping subdivided fields in their range. */
#ifndef PEL_SUBDIVIDE_CLAMP_H
#define PEL_SUBDIVIDE_CLAMP_H

#include <stdint.h>

/* moves the rows given_count .. row_count - 1 of values (row_count x component_count) into the range that each
   component has on the rows before */
void pel_clamp_rows(double *values, int32_t component_count, int32_t given_count, int32_t row_count);

#endif
