/* Bending measures of the four points of a hinge (include/pellicle/bending.h has the drawing): the dihedral angle, and
   K x, whose length is the strain of isometric bending. */
#ifndef PEL_MEASURE_HINGE_H
#define PEL_MEASURE_HINGE_H

#include "base/lane.h"

/* The gradients of the angle are g2 = -length r2 n2 and g3 = -length r3 n3 on the tips, -(1 - t2) g2 - (1 - t3) g3 and
   -t2 g2 - t3 g3 on the ends of the edge. */
typedef struct pel_hinge_lanes {
    pel_lane difference;     /* angle less that at rest (pel_hinge_difference) */
    pel_lane length, square; /* of the edge */
    pel_lane3 n2, n3;        /* normals times twice the areas */
    pel_lane cosine;         /* n2 . n3 */
    pel_lane r2, r3;         /* 1 / |n|^2, 0 where that is 0 */
    pel_lane t2, t3;         /* feet of the tips on the edge */
} pel_hinge_lanes;

/* The difference of an angle and the rest angle along the shorter arc is their plain difference unless that exceeds
   half a turn: then a fold would have passed through its closed state. This is allowed only for rest folds sharper than
   a quarter turn: scans have such folds, whose sides overlap. `sine` has the sign of the angle. */
PEL_INLINE pel_lane pel_hinge_difference(pel_lane turned, pel_lane sine, pel_lane rest_cosine)
{
    const pel_lane zero = pel_lane_splat(0), full = PEL_CONSTANT(6.283185307179586);
    pel_lane far = pel_lane_abs(turned) - PEL_CONSTANT(1.5707963267948966);
    pel_lane across = pel_lane_min(pel_lane_min(-(turned * sine), far), rest_cosine);
    pel_lane turn = pel_lane_select(pel_lane_above(turned, zero), full, -full);
    return turned - pel_lane_select(pel_lane_above(across, zero), turn, zero);
}

/* the angle alone: sets neither r2, r3 nor t2, t3 */
PEL_INLINE pel_hinge_lanes pel_hinge_angle_of(const pel_particle p[4], pel_lane rest_cosine, pel_lane rest_sine)
{
    pel_hinge_lanes h;
    pel_lane3 edge = pel_lane3_subtract(p[1].at, p[0].at), to2 = pel_lane3_subtract(p[2].at, p[0].at);
    pel_lane3 to3 = pel_lane3_subtract(p[3].at, p[0].at);
    h.n2 = pel_lane3_cross(edge, to2);
    h.n3 = pel_lane3_cross(to3, edge);
    h.square = pel_lane3_dot(edge, edge);
    h.length = pel_lane_sqrt(h.square);
    h.cosine = pel_lane3_dot(h.n2, h.n3);
    pel_lane sine = -(h.length * pel_lane3_dot(to3, h.n2));
    pel_lane turned =
        pel_lane_atan2(sine * rest_cosine - h.cosine * rest_sine, h.cosine * rest_cosine + sine * rest_sine);
    h.difference = pel_hinge_difference(turned, sine, rest_cosine);
    return h;
}

PEL_INLINE pel_hinge_lanes pel_hinge_of(const pel_particle p[4], pel_lane rest_cosine, pel_lane rest_sine)
{
    const pel_lane one = pel_lane_splat(1);
    pel_hinge_lanes h = pel_hinge_angle_of(p, rest_cosine, rest_sine);
    pel_lane3 edge = pel_lane3_subtract(p[1].at, p[0].at), to2 = pel_lane3_subtract(p[2].at, p[0].at);
    pel_lane3 to3 = pel_lane3_subtract(p[3].at, p[0].at);
    h.r2 = pel_lane_quotient(one, pel_lane3_dot(h.n2, h.n2));
    h.r3 = pel_lane_quotient(one, pel_lane3_dot(h.n3, h.n3));
    pel_lane inverse = pel_lane_quotient(one, h.square);
    h.t2 = inverse * pel_lane3_dot(to2, edge);
    h.t3 = inverse * pel_lane3_dot(to3, edge);
    return h;
}

/* scale times the gradients over -length: forces with scale = moment length, gradients of the angle with scale =
   -length */
PEL_INLINE void pel_hinge_gradients(const pel_hinge_lanes *h, pel_lane scale, pel_lane3 gradient[4])
{
    const pel_lane one = pel_lane_splat(1);
    gradient[2] = pel_lane3_scale(h->n2, scale * h->r2);
    gradient[3] = pel_lane3_scale(h->n3, scale * h->r3);
    gradient[0] = pel_lane3_combine(h->t2 - one, gradient[2], h->t3 - one, gradient[3]);
    gradient[1] = pel_lane3_combine(-h->t2, gradient[2], -h->t3, gradient[3]);
}

/* the weights of K x, from those of x1, x2, x3; all sum to zero */
PEL_INLINE void pel_isometric_weights(pel_lane weight[4])
{
    weight[0] = -(weight[1] + weight[2] + weight[3]);
}

/* K x from differences to x0: exact far from the origin. Its gradient on x_k is weight[k] on each component. */
PEL_INLINE pel_lane3 pel_isometric_of(const pel_particle p[4], const pel_lane weight[4])
{
    pel_lane3 sum = pel_lane3_combine(weight[1], pel_lane3_subtract(p[1].at, p[0].at), weight[2],
                                      pel_lane3_subtract(p[2].at, p[0].at));
    return pel_lane3_add(sum, pel_lane3_scale(pel_lane3_subtract(p[3].at, p[0].at), weight[3]));
}

#endif
