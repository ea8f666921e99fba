/* Membranes for loops over lanes: strains, energies and stresses of the materials of membrane.c, for the forces of
   shells and for the constraints of position-based methods. */
#ifndef PEL_MATERIAL_MEMBRANE_LANE_H
#define PEL_MATERIAL_MEMBRANE_LANE_H

#include "base/lane.h"
#include "pellicle/material.h"

/* symmetric 2 x 2: components 11, 22, 12 */
typedef struct pel_symmetric2 {
    pel_lane a, b, c;
} pel_symmetric2;

/* symmetric 3 x 3 */
typedef struct pel_symmetric3 {
    pel_lane a11, a12, a13, a22, a23, a33;
} pel_symmetric3;

typedef struct pel_strain_lanes {
    pel_lane3 f1, f2;      /* columns of F */
    pel_symmetric2 green;  /* (C - I) / 2 */
    pel_symmetric2 cauchy; /* C = F^T F */
} pel_strain_lanes;

PEL_INLINE pel_strain_lanes pel_strain_of(pel_lane3 f1, pel_lane3 f2)
{
    const pel_lane half = pel_lane_splat((pel_real)0.5), one = pel_lane_splat(1);
    pel_strain_lanes s;
    s.f1 = f1;
    s.f2 = f2;
    s.cauchy = (pel_symmetric2){pel_lane3_dot(f1, f1), pel_lane3_dot(f2, f2), pel_lane3_dot(f1, f2)};
    s.green = (pel_symmetric2){half * (s.cauchy.a - one), half * (s.cauchy.b - one), half * s.cauchy.c};
    return s;
}

/* what a material says: energy density, second Piola-Kirchhoff stress and a positive definite tangent */
typedef struct pel_response {
    pel_lane energy;
    pel_symmetric2 stress;
    pel_symmetric3 tangent;
    pel_lane by_trace, by_area; /* of isotropic ones but stvk: P = 2 by_trace F + by_area dJ/dF (material/membrane.c) */
} pel_response;

static inline void respond_stvk(const pel_strain_lanes *s, pel_lane mu, pel_lane lambda, pel_response *r)
{
    const pel_lane two = pel_lane_splat(2), half = pel_lane_splat((pel_real)0.5);
    pel_lane trace = s->green.a + s->green.b, volume = lambda * trace;
    r->stress = (pel_symmetric2){two * mu * s->green.a + volume, two * mu * s->green.b + volume, two * mu * s->green.c};
    r->energy = mu * (s->green.a * s->green.a + s->green.b * s->green.b + two * s->green.c * s->green.c) +
                half * volume * trace;
    pel_lane zero = pel_lane_splat(0), along = two * mu + lambda;
    r->tangent = (pel_symmetric3){along, lambda, zero, along, zero, mu};
}

/* area ratio and what goes with it; below the floor the inverse stays that of the floor */
typedef struct area_lanes {
    pel_lane ratio, floored, excess; /* J, at least the floor, J^2 - 1 of that */
    pel_symmetric2 inverse;          /* of C */
} area_lanes;

static inline area_lanes area_of(const pel_strain_lanes *s)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), four = pel_lane_splat(4);
    const pel_lane floor = pel_lane_splat((pel_real)0.01);
    pel_lane3 normal = pel_lane3_cross(s->f1, s->f2);
    area_lanes area;
    area.ratio = pel_lane_sqrt(pel_lane3_dot(normal, normal));
    area.floored = pel_lane_max(area.ratio, floor);
    /* from the strains it is exact near rest */
    pel_lane determinant = s->green.a * s->green.b - s->green.c * s->green.c;
    pel_lane fine = two * (s->green.a + s->green.b) + four * determinant;
    pel_lane coarse = (area.floored - one) * (area.floored + one);
    area.excess = pel_lane_select(pel_lane_above(pel_lane_splat((pel_real)0.1), pel_lane_abs(coarse)), fine, coarse);
    pel_lane inverse = one / (area.floored * area.floored);
    area.inverse = (pel_symmetric2){s->cauchy.b * inverse, s->cauchy.a * inverse, -(s->cauchy.c * inverse)};
    return area;
}

/* x c c^T + y P + z r r^T with P = -d C^-1 / d e of the inverse c */
static inline pel_symmetric3 combine_tangent(pel_lane x, pel_symmetric2 c, pel_lane y, pel_lane z, pel_symmetric2 r)
{
    const pel_lane two = pel_lane_splat(2);
    return (pel_symmetric3){
        x * c.a * c.a + y * two * c.a * c.a + z * r.a * r.a,
        x * c.a * c.b + y * two * c.c * c.c + z * r.a * r.b,
        x * c.a * c.c + y * two * c.a * c.c + z * r.a * r.c,
        x * c.b * c.b + y * two * c.b * c.b + z * r.b * r.b,
        x * c.b * c.c + y * two * c.b * c.c + z * r.b * r.c,
        x * c.c * c.c + y * (c.a * c.b + c.c * c.c) + z * r.c * r.c,
    };
}

/* U = sqrt C: U^-1 = (I + J C^-1) / s with s = tr U; psi = mu |U - I|^2 + lambda/2 tr^2 (U - I) */
static inline void respond_corotated(const pel_strain_lanes *s, pel_lane mu, pel_lane lambda, pel_response *r)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), half = pel_lane_splat((pel_real)0.5);
    area_lanes area = area_of(s);
    pel_lane j = area.ratio;
    pel_lane trace = pel_lane_max(pel_lane_sqrt(s->cauchy.a + s->cauchy.b + two * j), pel_lane_splat((pel_real)0.01));
    pel_lane inverse = one / trace, excess = trace - two;
    pel_lane u11 = inverse * (s->cauchy.a + j) - one, u22 = inverse * (s->cauchy.b + j) - one;
    pel_lane u12 = inverse * s->cauchy.c;
    r->energy = mu * (u11 * u11 + u22 * u22 + two * u12 * u12) + half * lambda * excess * excess;
    pel_symmetric2 root = {inverse * (one + j * area.inverse.a), inverse * (one + j * area.inverse.b),
                           inverse * (j * area.inverse.c)};
    pel_lane by_trace = lambda * excess - two * mu;
    r->by_area = inverse * by_trace;
    r->by_trace = mu + half * r->by_area;
    r->stress = (pel_symmetric2){two * mu + by_trace * root.a, two * mu + by_trace * root.b, by_trace * root.c};
    pel_lane pull = pel_lane_max(-by_trace, pel_lane_splat((pel_real)0.1) * mu), share = pull * j * inverse;
    r->tangent = combine_tangent(-share, area.inverse, share, lambda + pull * inverse, root);
}

/* true where a symmetric matrix is clearly positive definite */
static inline pel_lane_mask is_definite(const pel_symmetric3 *m)
{
    const pel_lane margin = pel_lane_splat((pel_real)0.01);
    pel_lane minor = m->a11 * m->a22 - m->a12 * m->a12;
    pel_lane determinant = m->a33 * minor - m->a11 * m->a23 * m->a23 - m->a22 * m->a13 * m->a13 +
                           pel_lane_splat(2) * m->a12 * m->a13 * m->a23;
    return pel_lane_above(m->a11, pel_lane_splat(0)) & pel_lane_above(minor, margin * m->a11 * m->a22) &
           pel_lane_above(determinant, margin * margin * m->a11 * m->a22 * m->a33);
}

static inline pel_symmetric3 select_matrix(pel_lane_mask mask, const pel_symmetric3 *a, const pel_symmetric3 *b)
{
    return (pel_symmetric3){
        pel_lane_select(mask, a->a11, b->a11), pel_lane_select(mask, a->a12, b->a12),
        pel_lane_select(mask, a->a13, b->a13), pel_lane_select(mask, a->a22, b->a22),
        pel_lane_select(mask, a->a23, b->a23), pel_lane_select(mask, a->a33, b->a33),
    };
}

/* with h = 1 / J^2, or its tangent below the floor (material/membrane.c) */
static inline void respond_mooney(const pel_strain_lanes *s, pel_lane c1, pel_lane c2, pel_response *r)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), four = pel_lane_splat(4);
    const pel_lane half = pel_lane_splat((pel_real)0.5);
    area_lanes area = area_of(s);
    pel_lane j = area.ratio, floored = area.floored, trace = s->cauchy.a + s->cauchy.b;
    pel_lane h = one / (floored * floored), slope = -(two * h / floored);
    pel_lane determinant4 = four * (s->green.a * s->green.b - s->green.c * s->green.c);
    pel_lane i1 = h * (two * (s->green.a + s->green.b) * area.excess - determinant4);
    pel_lane i2 = h * (area.excess * area.excess - determinant4);
    h = h + slope * (j - floored);
    pel_lane_mask low = pel_lane_above(floored, j);
    i1 = pel_lane_select(low, trace + h - pel_lane_splat(3), i1);
    i2 = pel_lane_select(low, j * j + trace * h - pel_lane_splat(3), i2);
    r->energy = c1 * i1 + c2 * i2;
    pel_lane by_trace = two * (c1 + c2 * h), by_area = c1 * slope + c2 * (two * j + trace * slope);
    r->by_trace = half * by_trace;
    r->by_area = by_area;
    pel_symmetric2 c = area.inverse;
    pel_lane along = by_area * floored;
    r->stress = (pel_symmetric2){by_trace + along * c.a, by_trace + along * c.b, along * c.c};
    pel_lane pull = pel_lane_max(-along, pel_lane_splat((pel_real)0.1) * c1), square = floored * floored;
    pel_symmetric3 safe = combine_tangent(four * ((c1 + c2 * trace) * h + c2 * square), c, pull, pel_lane_splat(0), c);
    pel_lane coupling = four * c2 * h;
    pel_symmetric3 full = {safe.a11 - two * coupling * c.a, safe.a12 - coupling * (c.a + c.b),
                           safe.a13 - coupling * c.c,       safe.a22 - two * coupling * c.b,
                           safe.a23 - coupling * c.c,       safe.a33};
    r->tangent = select_matrix(is_definite(&full), &full, &safe);
}

static inline void respond_neo_hookean(const pel_strain_lanes *s, pel_lane mu, pel_lane lambda, pel_response *r)
{
    const pel_lane two = pel_lane_splat(2), half = pel_lane_splat((pel_real)0.5);
    area_lanes area = area_of(s);
    pel_lane below = (area.ratio - area.floored) / area.floored;
    pel_lane log_j = half * pel_lane_log1p(area.excess) + below;
    pel_lane determinant = s->green.a * s->green.b - s->green.c * s->green.c;
    pel_lane shear = half * area.excess - two * determinant - log_j;
    shear = pel_lane_select(pel_lane_above(area.floored, area.ratio), s->green.a + s->green.b - log_j, shear);
    r->energy = mu * shear + half * lambda * log_j * log_j;
    pel_lane by_log = lambda * log_j - mu;
    r->by_trace = half * mu;
    r->by_area = by_log / area.floored;
    pel_symmetric2 c = area.inverse;
    r->stress = (pel_symmetric2){mu + by_log * c.a, mu + by_log * c.b, by_log * c.c};
    pel_lane pull = pel_lane_max(-by_log, pel_lane_splat((pel_real)0.1) * mu);
    r->tangent = combine_tangent(lambda, c, pull, pel_lane_splat(0), c);
}

/* first, second: as in pel_membrane_law, any multiple of them */
PEL_INLINE void pel_respond(pel_membrane_kind kind, pel_lane first, pel_lane second, const pel_strain_lanes *s,
                            pel_response *r)
{
    if (kind == PEL_MEMBRANE_COROTATED)
        respond_corotated(s, first, second, r);
    else if (kind == PEL_MEMBRANE_MOONEY_RIVLIN)
        respond_mooney(s, first, second, r);
    else if (kind == PEL_MEMBRANE_NEO_HOOKEAN)
        respond_neo_hookean(s, first, second, r);
    else
        respond_stvk(s, first, second, r);
}

/* The triangle factor [[a, b], [0, c]] of F in the frame of its first column (material/membrane.c). */
typedef struct pel_factor_lanes {
    pel_lane3 t1, t2;
    pel_lane a, b, c, inverse; /* inverse of a, at most 2 */
} pel_factor_lanes;

PEL_INLINE pel_factor_lanes pel_factor_of(const pel_strain_lanes *s)
{
    pel_factor_lanes f;
    f.a = pel_lane_sqrt(s->cauchy.a);
    f.t1 = pel_lane3_scale(s->f1, pel_lane_quotient(pel_lane_splat(1), f.a));
    f.b = pel_lane3_dot(s->f2, f.t1);
    f.t2 = pel_lane3_combine(pel_lane_splat(1), s->f2, -f.b, f.t1);
    f.c = pel_lane_sqrt(pel_lane3_dot(f.t2, f.t2));
    f.t2 = pel_lane3_scale(f.t2, pel_lane_quotient(pel_lane_splat(1), f.c));
    f.inverse = pel_lane_splat(1) / pel_lane_max(f.a, pel_lane_splat((pel_real)0.5));
    return f;
}

/* energy and the columns of P of the linear material */
PEL_INLINE pel_lane pel_linear_stress(pel_lane mu, pel_lane lambda, const pel_strain_lanes *s, pel_lane3 columns[2])
{
    const pel_lane one = pel_lane_splat(1), half = pel_lane_splat((pel_real)0.5), two = pel_lane_splat(2);
    pel_factor_lanes f = pel_factor_of(s);
    pel_lane e11 = f.a - one, e22 = f.c - one, e12 = half * f.b, trace = e11 + e22;
    pel_lane by_a = two * mu * e11 + lambda * trace, by_b = two * mu * e12, by_c = two * mu * e22 + lambda * trace;
    pel_lane turning = pel_lane_quotient(by_b * f.c - by_c * f.b, f.a);
    columns[0] = pel_lane3_combine(by_a, f.t1, turning, f.t2);
    columns[1] = pel_lane3_combine(by_b, f.t1, by_c, f.t2);
    return mu * (e11 * e11 + e22 * e22 + two * e12 * e12) + half * lambda * trace * trace;
}

/* energy per area and the columns of P */
PEL_INLINE pel_lane pel_membrane_stress(pel_membrane_kind kind, pel_lane first, pel_lane second,
                                        const pel_strain_lanes *s, pel_lane3 columns[2])
{
    if (kind == PEL_MEMBRANE_LINEAR)
        return pel_linear_stress(first, second, s, columns);
    pel_response r;
    pel_respond(kind, first, second, s, &r);
    if (kind == PEL_MEMBRANE_STVK) {
        columns[0] = pel_lane3_combine(r.stress.a, s->f1, r.stress.c, s->f2);
        columns[1] = pel_lane3_combine(r.stress.c, s->f1, r.stress.b, s->f2);
        return r.energy;
    }
    pel_lane3 normal = pel_lane3_cross(s->f1, s->f2);
    normal = pel_lane3_scale(normal, pel_lane_quotient(r.by_area, pel_lane_sqrt(pel_lane3_dot(normal, normal))));
    pel_lane along = r.by_trace + r.by_trace;
    columns[0] = pel_lane3_add(pel_lane3_scale(s->f1, along), pel_lane3_cross(s->f2, normal));
    columns[1] = pel_lane3_add(pel_lane3_scale(s->f2, along), pel_lane3_cross(normal, s->f1));
    return r.energy;
}

#endif
