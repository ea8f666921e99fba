/* The distance of two points and its derivative, -d / |d| and d / |d|. */
#ifndef PEL_MEASURE_LENGTH_H
#define PEL_MEASURE_LENGTH_H

#include "base/lane.h"

typedef struct pel_length {
    pel_lane3 d;
    pel_lane length;
} pel_length;

PEL_INLINE pel_length pel_length_of(pel_lane3 a, pel_lane3 b)
{
    pel_length l = {.d = pel_lane3_subtract(b, a)};
    l.length = pel_lane_sqrt(pel_lane3_dot(l.d, l.d));
    return l;
}

#endif
