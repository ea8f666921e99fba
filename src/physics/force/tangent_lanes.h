/* Elements of tangents in lanes: four at once, or single ones where lanes are float. A source includes this first. */
#ifndef PEL_FORCE_TANGENT_LANES_H
#define PEL_FORCE_TANGENT_LANES_H

#ifdef PEL_SINGLE
#define PEL_LANE_DOUBLE
#endif
#include "base/lane.h"
#include "force/tangent_body.h"

#include <string.h>

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

/* numbers in lanes as rows of `width`, from the first lane on */
static inline void pel_tangent_scatter(const pel_lane *from, int width, int lanes, double *rows, size_t stride)
{
#ifdef PEL_LANE_SCALAR
    (void)lanes;
    (void)stride;
    memcpy(rows, from, (size_t)width * sizeof *rows);
#else
    int k = 0;
    for (; k + PEL_TANGENT_LANES <= width; k += PEL_TANGENT_LANES) {
        pel_wide a = from[k], b = from[k + 1], c = from[k + 2], d = from[k + 3];
        pel_wide_transpose(&a, &b, &c, &d);
        const pel_wide columns[PEL_TANGENT_LANES] = {a, b, c, d};
        for (int l = 0; l < lanes; l++)
            memcpy(rows + (size_t)l * stride + k, &columns[l], sizeof columns[l]);
    }
    for (; k < width; k++)
        for (int l = 0; l < lanes; l++)
            rows[(size_t)l * stride + (size_t)k] = from[k][l];
#endif
}

#endif
