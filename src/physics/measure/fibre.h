/* The image F a of a fibre, c0 (x0 - x2) + c1 (x1 - x2), and I5 = |F a|^2. */
#ifndef PEL_MEASURE_FIBRE_H
#define PEL_MEASURE_FIBRE_H

#include "base/lane.h"

typedef struct pel_fibre_image {
    pel_lane3 image;
    pel_lane square; /* I5 */
} pel_fibre_image;

PEL_INLINE pel_fibre_image pel_fibre_image_of(pel_lane3 first, pel_lane3 second, pel_lane c0, pel_lane c1)
{
    pel_fibre_image f = {.image = pel_lane3_combine(c0, first, c1, second)};
    f.square = pel_lane3_dot(f.image, f.image);
    return f;
}

#endif
