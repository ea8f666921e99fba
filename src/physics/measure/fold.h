/* Plastic folds: the angle of a hinge from its rest angle, which follows where the moment reaches the yield moment.

   With the elastic angle d of a fold and its yield angle y (both rad; the moment is stiffness times d), and the
   hardening h, the slip of a step from d is (|d| - y) / (1 + h), the rest angle follows by it, and y grows by h times
   it (radial return, isotropic hardening). The energy of the step, elastic plus dissipated,

       psi(d) = d^2 / 2 for |d| <= y,   y |d| - y^2 / 2 + h / (1 + h) (|d| - y)^2 / 2 beyond

   is convex with a continuous slope, so that methods that minimise find the end of the step, slip included (Ortiz and
   Stainier 1999). */
#ifndef PEL_MEASURE_FOLD_H
#define PEL_MEASURE_FOLD_H

#include "base/lane.h"

#include <math.h>

/* what a hinge remembers */
typedef struct pel_fold {
    double angle; /* rad, that its rest angle has changed by */
    double slip;  /* rad, sum of the magnitudes of these changes */
} pel_fold;

/* of a hinge at present: its moment rises beyond the yield angle [rad] by the share h / (1 + h) */
typedef struct pel_yield {
    double angle, share;
} pel_yield;

static inline double pel_fold_share(double hardening)
{
    return hardening / (1 + hardening);
}

/* Lets a fold slip from an elastic angle; returns the work that it dissipates over the stiffness of the hinge. */
static inline double pel_fold_slip(pel_fold *fold, double angle, double yield_angle, double hardening)
{
    const double limit = yield_angle + hardening * fold->slip, slip = (fabs(angle) - limit) / (1 + hardening);
    if (!(slip > 0))
        return 0;
    fold->angle += angle < 0 ? -slip : slip;
    fold->slip += slip;
    return slip * (limit + 0.5 * hardening * slip);
}

/* moment and energy over the stiffness */
typedef struct pel_fold_response {
    pel_lane moment, energy;
} pel_fold_response;

PEL_INLINE pel_fold_response pel_fold_respond(pel_lane angle, pel_lane yield_angle, pel_lane share)
{
    const pel_lane half = PEL_CONSTANT(0.5), size = pel_lane_abs(angle), elastic = pel_lane_min(size, yield_angle);
    const pel_lane beyond = size - elastic, moment = elastic + share * beyond;
    return (pel_fold_response){pel_lane_select(pel_lane_above(angle, pel_lane_splat(0)), moment, -moment),
                               half * elastic * elastic + (elastic + half * share * beyond) * beyond};
}

#endif
