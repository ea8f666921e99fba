/* The volume between triangles and a point, the sum of x0 . (x1 x x2) / 6, and the vector of a triangle's area. The
   force of a pressure on the back of a triangle is a sixth of pressure times the doubled area vector on each corner: on
   a closed mesh the pressure times the gradient of the volume. */
#ifndef PEL_MEASURE_VOLUME_H
#define PEL_MEASURE_VOLUME_H

#include "base/lane.h"

/* six times the volume */
PEL_INLINE pel_lane pel_volume_of(pel_lane3 x0, pel_lane3 x1, pel_lane3 x2)
{
    return pel_lane3_dot(x0, pel_lane3_cross(x1, x2));
}

/* the normal, twice as long as the area is large */
PEL_INLINE pel_lane3 pel_area_vector(pel_lane3 x0, pel_lane3 x1, pel_lane3 x2)
{
    return pel_lane3_cross(pel_lane3_subtract(x1, x0), pel_lane3_subtract(x2, x0));
}

#endif
