/* Boxes along the axes in double, as their low and high corners. bvh/box.h has those that a search reads. */
#ifndef PEL_MATH_BOUNDS_H
#define PEL_MATH_BOUNDS_H

#include "math/extremes.h"
#include "math/vec3.h"

/* contains nothing: its low corner is above its high one */
static inline void pel_bounds_clear(double low[3], double high[3])
{
    pel_vec3_set(low, HUGE_VAL, HUGE_VAL, HUGE_VAL);
    pel_vec3_set(high, -HUGE_VAL, -HUGE_VAL, -HUGE_VAL);
}

/* widens the box as far as the point */
static inline void pel_bounds_add(double low[3], double high[3], const double point[3])
{
    for (int i = 0; i < 3; i++) {
        low[i] = pel_min(low[i], point[i]);
        high[i] = pel_max(high[i], point[i]);
    }
}

#endif
