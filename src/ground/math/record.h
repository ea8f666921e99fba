/* Positions and velocities of vertices as they are stored: records of three numbers and one more. */
#ifndef PEL_MATH_RECORD_H
#define PEL_MATH_RECORD_H

#include "base/wide.h"
#include "math/vec3.h"

static inline void pel_vertex_position(const pel_record *positions, int32_t v, double x[3])
{
    pel_vec3_set(x, (double)positions[v][0], (double)positions[v][1], (double)positions[v][2]);
}

#endif
