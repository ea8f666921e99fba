/* Corotated: psi = mu |U - I|^2 + lambda/2 tr^2 (U - I) with U = sqrt C. With u = tr U = sqrt(tr C + 2 J)

       psi = mu (tr C - 2 u + 2) + lambda/2 (u - 2)^2,     psi_u = lambda (u - 2) - 2 mu

   Numbers: lambda / mu. */
#ifndef PEL_LAW_COROTATED_H
#define PEL_LAW_COROTATED_H

#include "law/stvk.h"

enum { pel_law_corotated_traits = PEL_LAW_BY_AREA | PEL_LAW_READS_POISSON };

PEL_INLINE void pel_law_corotated(const pel_lane *numbers, const pel_strain *s, pel_response *r)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), half = PEL_CONSTANT(0.5),
                   quarter = PEL_CONSTANT(0.25);
    const pel_symmetric2 c = s->cauchy;
    pel_lane j = s->area_ratio, root = pel_lane_sqrt(c.a + c.b + two * j);
    /* a triangle squeezed to a point exerts no force */
    pel_lane inverse = one / pel_lane_max(root, PEL_CONSTANT(1e-6)), excess = root - two;
    /* U - I by components keeps the digits of small strains */
    pel_lane u11 = inverse * (c.a + j) - one, u22 = inverse * (c.b + j) - one, u12 = inverse * c.c;
    pel_lane trace = u11 + u22, by_root = numbers[0] * excess - two;
    pel_isotropic f;
    f.energy = u11 * u11 + u22 * u22 + two * u12 * u12 + half * numbers[0] * trace * trace;
    f.j = inverse * by_root;
    f.t = one + half * f.j;
    /* floored: the tangent grows as 1 / u^2 */
    pel_lane steep = one / pel_lane_max(root, PEL_CONSTANT(0.01));
    f.jj = steep * steep * (numbers[0] - steep * by_root);
    f.tj = half * f.jj;
    f.tt = quarter * f.jj;
    pel_respond_isotropic(s, pel_lane_max(j, PEL_CONSTANT(0.01)), &f, r);
}

#define pel_law_corotated_of pel_law_stvk_of
#define pel_law_corotated_refuse pel_law_stvk_refuse

#endif
