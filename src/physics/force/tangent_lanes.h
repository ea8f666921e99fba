/* Elements of tangents in lanes: four at once, or single ones where lanes are float. A source includes this first. */
#ifndef PEL_FORCE_TANGENT_LANES_H
#define PEL_FORCE_TANGENT_LANES_H

#ifdef PEL_SINGLE
#define PEL_LANE_DOUBLE
#endif
#include "base/lane.h"
#include "force/tangent_body.h"

enum { PEL_TANGENT_LANES = (int)(sizeof(pel_lane) / sizeof(double)) };

/* number k of each of some arrays */
static inline pel_lane pel_tangent_gather(const double *const from[PEL_TANGENT_LANES], int k)
{
#ifdef PEL_LANE_SCALAR
    return from[0][k];
#else
    return (pel_lane){from[0][k], from[1][k], from[2][k], from[3][k]};
#endif
}

/* corner k of the nodes of each lane */
static inline pel_lane3 pel_tangent_corner(const double *unknowns, const int32_t *const nodes[PEL_TANGENT_LANES], int k)
{
    const double *from[PEL_TANGENT_LANES];
    for (int l = 0; l < PEL_TANGENT_LANES; l++)
        from[l] = unknowns + 3 * (size_t)nodes[l][k];
    return (pel_lane3){pel_tangent_gather(from, 0), pel_tangent_gather(from, 1), pel_tangent_gather(from, 2)};
}

/* the number in a lane */
static inline double pel_tangent_lane(const pel_lane *lanes, int l)
{
    return ((const double *)lanes)[l];
}

#endif
