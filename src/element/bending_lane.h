/* The hinge of bending.c for loops over lanes, for the forces of shells and for the constraints of position-based
   methods. */
#ifndef PEL_ELEMENT_BENDING_LANE_H
#define PEL_ELEMENT_BENDING_LANE_H

#include "base/lane.h"

/* The gradients of the angle are g2 = -length r2 n2 and g3 = -length r3 n3 on the tips, -(1 - t2) g2 - (1 - t3) g3 and
   -t2 g2 - t3 g3 on the ends of the edge. */
typedef struct pel_hinge_lanes {
    pel_lane difference;     /* angle less that at rest, the short way round */
    pel_lane length, square; /* of the edge */
    pel_lane3 n2, n3;        /* normals times twice the areas */
    pel_lane cosine;         /* n2 . n3 */
    pel_lane r2, r3;         /* 1 / |n|^2, 0 where that is 0 */
    pel_lane t2, t3;         /* feet of the tips on the edge */
} pel_hinge_lanes;

PEL_INLINE pel_hinge_lanes pel_hinge_of(const pel_particle p[4], pel_lane rest_cosine, pel_lane rest_sine)
{
    const pel_lane one = pel_lane_splat(1);
    pel_hinge_lanes h;
    pel_lane3 edge = pel_lane3_subtract(p[1].at, p[0].at), to2 = pel_lane3_subtract(p[2].at, p[0].at);
    pel_lane3 to3 = pel_lane3_subtract(p[3].at, p[0].at);
    h.n2 = pel_lane3_cross(edge, to2);
    h.n3 = pel_lane3_cross(to3, edge);
    h.square = pel_lane3_dot(edge, edge);
    h.length = pel_lane_sqrt(h.square);
    h.cosine = pel_lane3_dot(h.n2, h.n3);
    pel_lane sine = -(h.length * pel_lane3_dot(to3, h.n2));
    /* turned back by the rest angle */
    h.difference = pel_lane_atan2(sine * rest_cosine - h.cosine * rest_sine, h.cosine * rest_cosine + sine * rest_sine);
    h.r2 = pel_lane_quotient(one, pel_lane3_dot(h.n2, h.n2));
    h.r3 = pel_lane_quotient(one, pel_lane3_dot(h.n3, h.n3));
    pel_lane inverse = pel_lane_quotient(one, h.square);
    h.t2 = inverse * pel_lane3_dot(to2, edge);
    h.t3 = inverse * pel_lane3_dot(to3, edge);
    return h;
}

#endif
