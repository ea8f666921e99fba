/* Coordinates in which boxes are made, and the boxes of moving points in them.

   An affine map of all points, y = matrix (x - origin(t)), does not change whether two features touch at a time t, so
   boxes may be compared in any such frame if all of them are in it. The origin moves on a straight line during the
   step, as the points do; so y does too, and the box around both ends contains its path. Two points at most d apart in
   x are at most d |row k of matrix| apart in y[k]. A frame that follows the body (translation, rotation, stretch)
   leaves only relative motion, for which a cached list of pairs has to allow. */
#ifndef PEL_BVH_FRAME_H
#define PEL_BVH_FRAME_H

#include "base/pool.h"
#include "bvh/box.h"

typedef struct pel_frame {
    double origin[2][3]; /* at the start and at the end */
    double matrix[3][3];
} pel_frame;

/* An origin at rest, no turning and no stretch. */
pel_frame pel_frame_at(const double origin[3]);

/* points at both ends of a step */
typedef struct pel_motion {
    const double (*start)[3], (*end)[3]; /* (vertex_count x 3); the same array: nothing moves */
    int32_t vertex_count;
} pel_motion;

/* The frame that moves with the mean of the points (of every n-th point of large sets), no turning and no stretch. */
pel_frame pel_frame_centre(const pel_motion *motion);

/* Places at mid-step of every n-th point, enough to follow the whole by: their number, and the places
   (pel_frame_sample_count x 3) in a frame without turning and stretch. */
int32_t pel_frame_sample_count(int32_t vertex_count);
void pel_frame_sample(const pel_frame *frame, const pel_motion *motion, double (*places)[3]);

/* The frame in which the points at mid-step are nearest to `before` (pel_frame_sample_count x 3): the sample of an
   earlier step in its pel_frame_centre (least squares). pel_frame_centre where the map would be too distorted. */
pel_frame pel_frame_follow(const pel_motion *motion, const double (*before)[3]);

/* The box of each point on its way from start to end, grown so that boxes of points that come within `reach` of each
   other overlap. Returns the first point that is not finite, -1 when all are. boxes (vertex_count). pool is nullable.
 */
int32_t pel_boxes_of_motion(const pel_frame *frame, const pel_motion *motion, double reach, pel_pool *pool,
                            pel_box *boxes);

#endif
