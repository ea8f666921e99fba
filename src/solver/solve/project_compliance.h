/* What a compliance adds to a projection. Part of project_kernel.h. */
#ifndef PEL_SOLVE_PROJECT_COMPLIANCE_H
#define PEL_SOLVE_PROJECT_COMPLIANCE_H

#include "base/lane.h"
#include "batch/batch.h"

/* ---- damping of the material ----
   The constraint of a strain s is s + g (s - s_0), with s_0 at the start of the substep and g the retardation over the
   length of the substep: so the multiplier holds the viscous stress too. Its gradient is 1 + g times that of s. */

PEL_INLINE bool is_viscous(const pel_batch *batch)
{
    return batch->law.viscosity > 0;
}

/* a constraint with one strain, which has changed in the substep */
PEL_INLINE void damp(const pel_batch *batch, pel_lane change, pel_lane *strain, pel_lane *mobility)
{
    const pel_lane share = pel_lane_splat(batch->law.viscosity);
    *strain = *strain + share * change;
    *mobility = *mobility + share * *mobility;
}

/* ---- what a single sweep leaves to the next substep (softness.h) ----
   a - D / 2 in place of a takes it back, by at most law.correction of a in any strain: the sweep is that of a material
   up to 1 / (1 - law.correction) times as stiff, and as stable. */

PEL_INLINE pel_lane corrected(const pel_batch *batch, pel_lane mobility, pel_lane softness)
{
    return softness - pel_lane_min(PEL_CONSTANT(0.5) * mobility, pel_lane_splat(batch->law.correction) * softness);
}

/* The same of a block, as share of the mobility that is left: (G + A) - G / 2. most over softness: the trace of A^-1 G,
   no less than its largest eigenvalue. */
PEL_INLINE pel_lane share_left(const pel_batch *batch, pel_lane softness, pel_lane most)
{
    const pel_lane half = PEL_CONSTANT(0.5), bound = pel_lane_splat(batch->law.correction) * softness;
    if (pel_lane_all(pel_lane_above(bound, half * most)))
        return half;
    return pel_lane_splat(1) - pel_lane_min(half, pel_lane_quotient(bound, most));
}

#endif
