/* Projections of position-based dynamics. A constraint C on the points x_k with inverse masses w_k moves them by

       pbd     dx_k = -k w_k g_k C / sum w |g|^2,                       g_k = dC / dx_k
       xpbd    dl = -(C + a l) / (sum w |g|^2 + a),  dx_k = w_k g_k dl,   a = 1 / (stiffness dt^2), l += dl

   pbd takes the energies themselves as constraints, as paper B does (equation 5): stiffness, area and thickness cancel
   and a quadratic energy falls to a quarter, because C has a double root (theory page, section 0).

   Membrane. With the columns f1, f2 of F = sum_k x_k (p_k, q_k), where (p, q) are (i0, i1), (0, i2), (-i0, -i1 - i2)
   for the inverse [[i0, i1], [0, i2]] of the rest matrix, every gradient is g_k = p_k a + q_k b, and

       sum w g.g' = PP a.a' + PQ (a.b' + b.a') + QQ b.b',      PP = sum w p p and so on

   pbd: a, b are the columns of P = F S. xpbd works on the vector of strains c = (e11, e22, 2 e12) with the rows
   (f1, 0), (0, f2), (f2, f1): a 3 x 3 block G = sum w g g^T. For a quadratic energy c.D c / 2 (stvk; linear with its
   own strains, those of the triangle factor of F)

       (G + A) dl = -(c + A l),    A = D^-1 / (area dt^2)

   Other materials have the stress S(c) = d psi / dc and the tangent H = dS / dc. One Newton step of implicit Euler for
   the triangle alone, l = -area dt^2 S(c + G (l' - l)), is

       (1 + B G) dl = -(l + area dt^2 S),    B = area dt^2 H

   At its fixed point l = -area dt^2 S whatever B is: the stress is the material's own, and H only says how fast one
   gets there. So parts of H that are not positive definite are left out. With B = L L^T, dl = -L (1 + L^T G L)^-1 L^-1
   (l + area dt^2 S): symmetric, and no less than 1 whatever the stiffness.

   Guards have no scale of their own: steps of the pbd membrane are bounded by the size of the triangle at rest, a
   triangle squeezed to less than half has the gradient of half its size, quotients by zero are zero. */
#ifndef PEL_SOLVE_PROJECT_KERNEL_H
#define PEL_SOLVE_PROJECT_KERNEL_H

#include "base/lane.h"
#include "pellicle/material.h"
#include "solve/project_batch.h"

/* a copy for each kind and material: the flags that tell them apart are constants */
#define PEL_INLINE static inline __attribute__((always_inline))

/* ---- access ---- */

static inline const int32_t *places_of(const pel_batch *batch, int32_t block, int k)
{
    return batch->vertices + ((size_t)block * (size_t)batch->arity + (size_t)k) * PEL_BLOCK;
}

static inline pel_lane number_of(const pel_batch *batch, int32_t block, int count, int j, int32_t lane)
{
    return pel_lane_load(batch->numbers + ((size_t)block * (size_t)count + (size_t)j) * PEL_BLOCK, lane);
}

static inline pel_particle load_particle(const pel_batch *batch, int32_t block, int k, int32_t lane,
                                         const pel_record *positions)
{
    return pel_particle_load(positions, places_of(batch, block, k), lane);
}

static inline void move_particle(const pel_batch *batch, int32_t block, int k, int32_t lane, pel_record *positions,
                                 const pel_particle *p, pel_lane3 way)
{
    pel_particle_move(positions, places_of(batch, block, k), lane, p, way);
}

static inline pel_lane multiplier_of(const pel_batch *batch, int32_t block, int count, int j, int32_t lane)
{
    if (batch->multipliers == NULL)
        return pel_lane_splat(0);
    return pel_lane_load(batch->multipliers + ((size_t)block * (size_t)count + (size_t)j) * PEL_BLOCK, lane);
}

static inline void add_multiplier(const pel_batch *batch, int32_t block, int count, int j, int32_t lane, pel_lane old,
                                  pel_lane change)
{
    if (batch->multipliers != NULL)
        pel_lane_store(batch->multipliers + ((size_t)block * (size_t)count + (size_t)j) * PEL_BLOCK, lane,
                       old + change);
}

static inline pel_lane quotient(pel_lane a, pel_lane b)
{
    return pel_lane_where(pel_lane_above(b, pel_lane_splat(0)), a / b);
}

/* ---- springs ---- */

PEL_INLINE void sweep_edges(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions, bool compliant)
{
    const int count = compliant ? 2 : 1;
    for (int32_t block = begin; block < end; block++)
        for (int32_t lane = 0; lane < pel_lane_passes(batch->lane_counts[block]); lane++) {
            pel_particle a = load_particle(batch, block, 0, lane, positions);
            pel_particle b = load_particle(batch, block, 1, lane, positions);
            pel_lane3 d = pel_lane3_subtract(b.at, a.at);
            pel_lane length = pel_lane_sqrt(pel_lane3_dot(d, d));
            pel_lane stretch = length - number_of(batch, block, count, 0, lane), mobility = a.fourth + b.fourth;
            pel_lane change = stretch;
            if (compliant) {
                pel_lane softness = number_of(batch, block, count, 1, lane) * pel_lane_splat(batch->law.inverse_square);
                pel_lane multiplier = multiplier_of(batch, block, 1, 0, lane);
                change = (stretch + softness * multiplier) / (mobility + softness);
                add_multiplier(batch, block, 1, 0, lane, multiplier, -change);
                change = quotient(change, length);
            } else {
                change = quotient(stretch, mobility * length);
            }
            move_particle(batch, block, 0, lane, positions, &a, pel_lane3_scale(d, a.fourth * change));
            move_particle(batch, block, 1, lane, positions, &b, pel_lane3_scale(d, -(b.fourth * change)));
        }
}

/* ---- membrane ---- */

typedef struct triangle_lanes {
    pel_particle point[3];
    pel_lane i0, i1, i2;
    pel_lane3 f1, f2;
    pel_lane pp, pq, qq;
} triangle_lanes;

static inline triangle_lanes load_triangle(const pel_batch *batch, int32_t block, int32_t lane, int count,
                                           const pel_record *positions)
{
    triangle_lanes t;
    for (int k = 0; k < 3; k++)
        t.point[k] = load_particle(batch, block, k, lane, positions);
    t.i0 = number_of(batch, block, count, 0, lane);
    t.i1 = number_of(batch, block, count, 1, lane);
    t.i2 = number_of(batch, block, count, 2, lane);
    pel_lane3 first = pel_lane3_subtract(t.point[0].at, t.point[2].at);
    pel_lane3 second = pel_lane3_subtract(t.point[1].at, t.point[2].at);
    t.f1 = pel_lane3_scale(first, t.i0);
    t.f2 = pel_lane3_combine(t.i1, first, t.i2, second);
    pel_lane w0 = t.point[0].fourth, w1 = t.point[1].fourth, w2 = t.point[2].fourth, q2 = t.i1 + t.i2;
    t.pp = t.i0 * t.i0 * (w0 + w2);
    t.pq = t.i0 * (w0 * t.i1 + w2 * q2);
    t.qq = w0 * t.i1 * t.i1 + w1 * t.i2 * t.i2 + w2 * q2 * q2;
    return t;
}

/* dx_k = w_k (p_k a + q_k b) */
static inline void move_triangle(const pel_batch *batch, int32_t block, int32_t lane, pel_record *positions,
                                 const triangle_lanes *t, pel_lane3 a, pel_lane3 b)
{
    const pel_particle *p = t->point;
    move_particle(batch, block, 0, lane, positions, &p[0],
                  pel_lane3_combine(p[0].fourth * t->i0, a, p[0].fourth * t->i1, b));
    move_particle(batch, block, 1, lane, positions, &p[1], pel_lane3_scale(b, p[1].fourth * t->i2));
    move_particle(batch, block, 2, lane, positions, &p[2],
                  pel_lane3_combine(-(p[2].fourth * t->i0), a, -(p[2].fourth * (t->i1 + t->i2)), b));
}

/* symmetric 2 x 2: components 11, 22, 12 */
typedef struct symmetric2 {
    pel_lane a, b, c;
} symmetric2;

/* symmetric 3 x 3 */
typedef struct symmetric3 {
    pel_lane a11, a12, a13, a22, a23, a33;
} symmetric3;

typedef struct strain_lanes {
    symmetric2 green;  /* (C - I) / 2 */
    symmetric2 cauchy; /* C = F^T F */
} strain_lanes;

static inline strain_lanes strain_of(const triangle_lanes *t)
{
    const pel_lane half = pel_lane_splat((pel_real)0.5), one = pel_lane_splat(1);
    strain_lanes s;
    s.cauchy = (symmetric2){pel_lane3_dot(t->f1, t->f1), pel_lane3_dot(t->f2, t->f2), pel_lane3_dot(t->f1, t->f2)};
    s.green = (symmetric2){half * (s.cauchy.a - one), half * (s.cauchy.b - one), half * s.cauchy.c};
    return s;
}

/* what a material says: energy density, second Piola-Kirchhoff stress and a positive definite tangent */
typedef struct response {
    pel_lane energy;
    symmetric2 stress;
    symmetric3 tangent;
} response;

static inline void respond_stvk(const strain_lanes *s, pel_lane mu, pel_lane lambda, response *r)
{
    const pel_lane two = pel_lane_splat(2), half = pel_lane_splat((pel_real)0.5);
    pel_lane trace = s->green.a + s->green.b, volume = lambda * trace;
    r->stress = (symmetric2){two * mu * s->green.a + volume, two * mu * s->green.b + volume, two * mu * s->green.c};
    r->energy = mu * (s->green.a * s->green.a + s->green.b * s->green.b + two * s->green.c * s->green.c) +
                half * volume * trace;
    pel_lane zero = pel_lane_splat(0), along = two * mu + lambda;
    r->tangent = (symmetric3){along, lambda, zero, along, zero, mu};
}

/* area ratio and what goes with it; below the floor the inverse stays that of the floor */
typedef struct area_lanes {
    pel_lane ratio, floored, excess; /* J, at least the floor, J^2 - 1 of that */
    symmetric2 inverse;              /* of C */
} area_lanes;

static inline area_lanes area_of(const triangle_lanes *t, const strain_lanes *s)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), four = pel_lane_splat(4);
    const pel_lane floor = pel_lane_splat((pel_real)0.01);
    pel_lane3 normal = pel_lane3_cross(t->f1, t->f2);
    area_lanes area;
    area.ratio = pel_lane_sqrt(pel_lane3_dot(normal, normal));
    area.floored = pel_lane_max(area.ratio, floor);
    /* from the strains it is exact near rest */
    pel_lane determinant = s->green.a * s->green.b - s->green.c * s->green.c;
    pel_lane fine = two * (s->green.a + s->green.b) + four * determinant;
    pel_lane coarse = (area.floored - one) * (area.floored + one);
    area.excess = pel_lane_select(pel_lane_above(pel_lane_splat((pel_real)0.1), pel_lane_abs(coarse)), fine, coarse);
    pel_lane inverse = one / (area.floored * area.floored);
    area.inverse = (symmetric2){s->cauchy.b * inverse, s->cauchy.a * inverse, -(s->cauchy.c * inverse)};
    return area;
}

/* x c c^T + y P + z r r^T with P = -d C^-1 / d e of the inverse c */
static inline symmetric3 combine_tangent(pel_lane x, symmetric2 c, pel_lane y, pel_lane z, symmetric2 r)
{
    const pel_lane two = pel_lane_splat(2);
    return (symmetric3){
        x * c.a * c.a + y * two * c.a * c.a + z * r.a * r.a,
        x * c.a * c.b + y * two * c.c * c.c + z * r.a * r.b,
        x * c.a * c.c + y * two * c.a * c.c + z * r.a * r.c,
        x * c.b * c.b + y * two * c.b * c.b + z * r.b * r.b,
        x * c.b * c.c + y * two * c.b * c.c + z * r.b * r.c,
        x * c.c * c.c + y * (c.a * c.b + c.c * c.c) + z * r.c * r.c,
    };
}

/* U = sqrt C: U^-1 = (I + J C^-1) / s with s = tr U; psi = mu |U - I|^2 + lambda/2 tr^2 (U - I) */
static inline void respond_corotated(const triangle_lanes *t, const strain_lanes *s, pel_lane mu, pel_lane lambda,
                                     response *r)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), half = pel_lane_splat((pel_real)0.5);
    area_lanes area = area_of(t, s);
    pel_lane j = area.ratio;
    pel_lane trace = pel_lane_max(pel_lane_sqrt(s->cauchy.a + s->cauchy.b + two * j), pel_lane_splat((pel_real)0.01));
    pel_lane inverse = one / trace, excess = trace - two;
    pel_lane u11 = inverse * (s->cauchy.a + j) - one, u22 = inverse * (s->cauchy.b + j) - one;
    pel_lane u12 = inverse * s->cauchy.c;
    r->energy = mu * (u11 * u11 + u22 * u22 + two * u12 * u12) + half * lambda * excess * excess;
    symmetric2 root = {inverse * (one + j * area.inverse.a), inverse * (one + j * area.inverse.b),
                       inverse * (j * area.inverse.c)};
    pel_lane by_trace = lambda * excess - two * mu;
    r->stress = (symmetric2){two * mu + by_trace * root.a, two * mu + by_trace * root.b, by_trace * root.c};
    pel_lane pull = pel_lane_max(-by_trace, pel_lane_splat((pel_real)0.1) * mu), share = pull * j * inverse;
    r->tangent = combine_tangent(-share, area.inverse, share, lambda + pull * inverse, root);
}

/* true where a symmetric matrix is clearly positive definite */
static inline pel_lane_mask is_definite(const symmetric3 *m)
{
    const pel_lane margin = pel_lane_splat((pel_real)0.01);
    pel_lane minor = m->a11 * m->a22 - m->a12 * m->a12;
    pel_lane determinant = m->a33 * minor - m->a11 * m->a23 * m->a23 - m->a22 * m->a13 * m->a13 +
                           pel_lane_splat(2) * m->a12 * m->a13 * m->a23;
    return pel_lane_above(m->a11, pel_lane_splat(0)) & pel_lane_above(minor, margin * m->a11 * m->a22) &
           pel_lane_above(determinant, margin * margin * m->a11 * m->a22 * m->a33);
}

static inline symmetric3 select_matrix(pel_lane_mask mask, const symmetric3 *a, const symmetric3 *b)
{
    return (symmetric3){
        pel_lane_select(mask, a->a11, b->a11), pel_lane_select(mask, a->a12, b->a12),
        pel_lane_select(mask, a->a13, b->a13), pel_lane_select(mask, a->a22, b->a22),
        pel_lane_select(mask, a->a23, b->a23), pel_lane_select(mask, a->a33, b->a33),
    };
}

/* with h = 1 / J^2, or its tangent below the floor (material/membrane.c) */
static inline void respond_mooney(const triangle_lanes *t, const strain_lanes *s, pel_lane c1, pel_lane c2, response *r)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), four = pel_lane_splat(4);
    area_lanes area = area_of(t, s);
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
    symmetric2 c = area.inverse;
    pel_lane along = by_area * floored;
    r->stress = (symmetric2){by_trace + along * c.a, by_trace + along * c.b, along * c.c};
    pel_lane pull = pel_lane_max(-along, pel_lane_splat((pel_real)0.1) * c1), square = floored * floored;
    symmetric3 safe = combine_tangent(four * ((c1 + c2 * trace) * h + c2 * square), c, pull, pel_lane_splat(0), c);
    pel_lane coupling = four * c2 * h;
    symmetric3 full = {safe.a11 - two * coupling * c.a, safe.a12 - coupling * (c.a + c.b), safe.a13 - coupling * c.c,
                       safe.a22 - two * coupling * c.b, safe.a23 - coupling * c.c,         safe.a33};
    r->tangent = select_matrix(is_definite(&full), &full, &safe);
}

static inline void respond_neo_hookean(const triangle_lanes *t, const strain_lanes *s, pel_lane mu, pel_lane lambda,
                                       response *r)
{
    const pel_lane two = pel_lane_splat(2), half = pel_lane_splat((pel_real)0.5);
    area_lanes area = area_of(t, s);
    pel_lane below = (area.ratio - area.floored) / area.floored;
    pel_lane log_j = half * pel_lane_log1p(area.excess) + below;
    pel_lane determinant = s->green.a * s->green.b - s->green.c * s->green.c;
    pel_lane shear = half * area.excess - two * determinant - log_j;
    shear = pel_lane_select(pel_lane_above(area.floored, area.ratio), s->green.a + s->green.b - log_j, shear);
    r->energy = mu * shear + half * lambda * log_j * log_j;
    pel_lane by_log = lambda * log_j - mu;
    symmetric2 c = area.inverse;
    r->stress = (symmetric2){mu + by_log * c.a, mu + by_log * c.b, by_log * c.c};
    pel_lane pull = pel_lane_max(-by_log, pel_lane_splat((pel_real)0.1) * mu);
    r->tangent = combine_tangent(lambda, c, pull, pel_lane_splat(0), c);
}

static inline void respond(pel_membrane_kind kind, const pel_batch_law *law, const triangle_lanes *t,
                           const strain_lanes *s, response *r)
{
    pel_lane first = pel_lane_splat(law->first), second = pel_lane_splat(law->second);
    if (kind == PEL_MEMBRANE_COROTATED)
        respond_corotated(t, s, first, second, r);
    else if (kind == PEL_MEMBRANE_MOONEY_RIVLIN)
        respond_mooney(t, s, first, second, r);
    else if (kind == PEL_MEMBRANE_NEO_HOOKEAN)
        respond_neo_hookean(t, s, first, second, r);
    else
        respond_stvk(s, first, second, r);
}

/* The triangle factor [[a, b], [0, c]] of F in the frame of its first column (material/membrane.c). */
typedef struct factor_lanes {
    pel_lane3 t1, t2;
    pel_lane a, b, c, inverse; /* inverse of a, at most 2 */
} factor_lanes;

static inline factor_lanes factor_of(const triangle_lanes *t, const strain_lanes *s)
{
    factor_lanes f;
    f.a = pel_lane_sqrt(s->cauchy.a);
    f.t1 = pel_lane3_scale(t->f1, quotient(pel_lane_splat(1), f.a));
    f.b = pel_lane3_dot(t->f2, f.t1);
    f.t2 = pel_lane3_combine(pel_lane_splat(1), t->f2, -f.b, f.t1);
    f.c = pel_lane_sqrt(pel_lane3_dot(f.t2, f.t2));
    f.t2 = pel_lane3_scale(f.t2, quotient(pel_lane_splat(1), f.c));
    f.inverse = pel_lane_splat(1) / pel_lane_max(f.a, pel_lane_splat((pel_real)0.5));
    return f;
}

/* energy and the columns of P of the linear material */
static inline pel_lane linear_stress(const pel_batch_law *law, const triangle_lanes *t, const strain_lanes *s,
                                     pel_lane3 columns[2])
{
    const pel_lane one = pel_lane_splat(1), half = pel_lane_splat((pel_real)0.5), two = pel_lane_splat(2);
    pel_lane mu = pel_lane_splat(law->first), lambda = pel_lane_splat(law->second);
    factor_lanes f = factor_of(t, s);
    pel_lane e11 = f.a - one, e22 = f.c - one, e12 = half * f.b, trace = e11 + e22;
    pel_lane by_a = two * mu * e11 + lambda * trace, by_b = two * mu * e12, by_c = two * mu * e22 + lambda * trace;
    pel_lane turning = quotient(by_b * f.c - by_c * f.b, f.a);
    columns[0] = pel_lane3_combine(by_a, f.t1, turning, f.t2);
    columns[1] = pel_lane3_combine(by_b, f.t1, by_c, f.t2);
    return mu * (e11 * e11 + e22 * e22 + two * e12 * e12) + half * lambda * trace * trace;
}

/* pbd: the energy is the constraint */
PEL_INLINE void sweep_membrane(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions,
                               pel_membrane_kind kind)
{
    for (int32_t block = begin; block < end; block++)
        for (int32_t lane = 0; lane < pel_lane_passes(batch->lane_counts[block]); lane++) {
            triangle_lanes t = load_triangle(batch, block, lane, 3, positions);
            strain_lanes s = strain_of(&t);
            pel_lane3 stress[2];
            pel_lane energy;
            if (kind == PEL_MEMBRANE_LINEAR) {
                energy = linear_stress(&batch->law, &t, &s, stress);
            } else {
                response r;
                respond(kind, &batch->law, &t, &s, &r);
                energy = r.energy;
                stress[0] = pel_lane3_combine(r.stress.a, t.f1, r.stress.c, t.f2);
                stress[1] = pel_lane3_combine(r.stress.c, t.f1, r.stress.b, t.f2);
            }
            pel_lane bottom = t.pp * pel_lane3_dot(stress[0], stress[0]) +
                              pel_lane_splat(2) * t.pq * pel_lane3_dot(stress[0], stress[1]) +
                              t.qq * pel_lane3_dot(stress[1], stress[1]);
            /* no vertex moves by more than 1 / sqrt(i0^2 + i2^2), about 0.7 of an edge at rest */
            pel_lane mobility = t.point[0].fourth + t.point[1].fourth + t.point[2].fourth;
            bottom = pel_lane_max(bottom, energy * energy * mobility * (t.i0 * t.i0 + t.i2 * t.i2));
            pel_lane scale = -quotient(energy, bottom);
            move_triangle(batch, block, lane, positions, &t, pel_lane3_scale(stress[0], scale),
                          pel_lane3_scale(stress[1], scale));
        }
}

/* solves (m) x = right for a positive definite m; a pivot lost to rounding is taken as what rounding left of it */
static inline void solve_symmetric(const symmetric3 *m, pel_lane right[3])
{
    const pel_lane one = pel_lane_splat(1), least = pel_lane_splat(16 * PEL_REAL_EPSILON);
    pel_lane r1 = one / m->a11, l2 = m->a12 * r1, l3 = m->a13 * r1;
    pel_lane d2 = pel_lane_max(m->a22 - l2 * m->a12, least * m->a22), r2 = one / d2;
    pel_lane e3 = m->a23 - l3 * m->a12, k3 = e3 * r2;
    pel_lane d3 = pel_lane_max(m->a33 - l3 * m->a13 - k3 * e3, least * m->a33);
    pel_lane y2 = right[1] - l2 * right[0], y3 = right[2] - l3 * right[0] - k3 * y2;
    right[2] = y3 / d3;
    right[1] = y2 * r2 - k3 * right[2];
    right[0] = right[0] * r1 - l2 * right[1] - l3 * right[2];
}

/* G of the Green strains; a column squeezed to less than half counts as half */
static inline symmetric3 mobility_of(const triangle_lanes *t, const strain_lanes *s)
{
    const pel_lane quarter = pel_lane_splat((pel_real)0.25), two = pel_lane_splat(2);
    pel_lane c11 = pel_lane_max(s->cauchy.a, quarter), c22 = pel_lane_max(s->cauchy.b, quarter), c12 = s->cauchy.c;
    return (symmetric3){
        t->pp * c11,
        t->pq * c12,
        t->pp * c12 + t->pq * c11,
        t->qq * c22,
        t->pq * c22 + t->qq * c12,
        t->pp * c22 + two * t->pq * c12 + t->qq * c11,
    };
}

/* (G + D^-1 / (area dt^2)) dl = -(c + ...) for a quadratic energy; softness: 1 / (area young thickness dt^2) */
static inline void solve_quadratic(const pel_batch *batch, int32_t block, int32_t lane, symmetric3 g,
                                   const pel_lane strain[3], pel_lane softness, pel_lane change[3])
{
    pel_lane poisson = pel_lane_splat(batch->law.second), across = poisson * softness;
    pel_lane shear = pel_lane_splat(2) * (softness + across), old[3];
    for (int i = 0; i < 3; i++)
        old[i] = multiplier_of(batch, block, 3, i, lane);
    change[0] = -(strain[0] + softness * old[0] - across * old[1]);
    change[1] = -(strain[1] + softness * old[1] - across * old[0]);
    change[2] = -(strain[2] + shear * old[2]);
    g.a11 = g.a11 + softness;
    g.a22 = g.a22 + softness;
    g.a12 = g.a12 - across;
    g.a33 = g.a33 + shear;
    solve_symmetric(&g, change);
    for (int i = 0; i < 3; i++)
        add_multiplier(batch, block, 3, i, lane, old[i], change[i]);
}

PEL_INLINE void sweep_strain_stvk(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions)
{
    for (int32_t block = begin; block < end; block++)
        for (int32_t lane = 0; lane < pel_lane_passes(batch->lane_counts[block]); lane++) {
            triangle_lanes t = load_triangle(batch, block, lane, 4, positions);
            strain_lanes s = strain_of(&t);
            const pel_lane strain[3] = {s.green.a, s.green.b, s.cauchy.c};
            pel_lane softness = number_of(batch, block, 4, 3, lane) * pel_lane_splat(batch->law.inverse_square);
            pel_lane change[3];
            solve_quadratic(batch, block, lane, mobility_of(&t, &s), strain, softness, change);
            move_triangle(batch, block, lane, positions, &t, pel_lane3_combine(change[0], t.f1, change[2], t.f2),
                          pel_lane3_combine(change[2], t.f1, change[1], t.f2));
        }
}

/* strains a - 1, c - 1, b of the triangle factor, with the rows (t1, 0), (-b/a t2, t2), (c/a t2, t1) */
PEL_INLINE void sweep_strain_linear(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2);
    for (int32_t block = begin; block < end; block++)
        for (int32_t lane = 0; lane < pel_lane_passes(batch->lane_counts[block]); lane++) {
            triangle_lanes t = load_triangle(batch, block, lane, 4, positions);
            strain_lanes s = strain_of(&t);
            factor_lanes f = factor_of(&t, &s);
            const pel_lane strain[3] = {f.a - one, f.c - one, f.b};
            pel_lane softness = number_of(batch, block, 4, 3, lane) * pel_lane_splat(batch->law.inverse_square);
            pel_lane by_b = f.b * f.inverse, by_c = f.c * f.inverse, change[3];
            symmetric3 g = {t.pp,
                            pel_lane_splat(0),
                            t.pq,
                            t.pp * by_b * by_b - two * t.pq * by_b + t.qq,
                            t.pq * by_c - t.pp * by_b * by_c,
                            t.pp * by_c * by_c + t.qq};
            solve_quadratic(batch, block, lane, g, strain, softness, change);
            move_triangle(batch, block, lane, positions, &t,
                          pel_lane3_combine(change[0], f.t1, by_c * change[2] - by_b * change[1], f.t2),
                          pel_lane3_combine(change[2], f.t1, change[1], f.t2));
        }
}

/* dl = -L (1 + L^T G L)^-1 L^-1 right with B = L L^T; the result replaces right */
static inline void solve_newton(const symmetric3 *b, const symmetric3 *g, pel_lane right[3])
{
    const pel_lane one = pel_lane_splat(1);
    /* a collapsed triangle may have a tangent of rank one, or none */
    const pel_lane least =
        pel_lane_splat(16 * PEL_REAL_EPSILON) * (b->a11 + b->a22 + b->a33) + pel_lane_splat(PEL_REAL_TINY);
    pel_lane l11 = pel_lane_sqrt(pel_lane_max(b->a11, least)), r1 = one / l11, l21 = b->a12 * r1, l31 = b->a13 * r1;
    pel_lane l22 = pel_lane_sqrt(pel_lane_max(b->a22 - l21 * l21, least)), r2 = one / l22;
    pel_lane l32 = (b->a23 - l31 * l21) * r2;
    pel_lane l33 = pel_lane_sqrt(pel_lane_max(b->a33 - l31 * l31 - l32 * l32, least));
    pel_lane x1 = g->a11 * l11 + g->a12 * l21 + g->a13 * l31, x2 = g->a12 * l11 + g->a22 * l21 + g->a23 * l31;
    pel_lane x3 = g->a13 * l11 + g->a23 * l21 + g->a33 * l31;
    pel_lane y2 = g->a22 * l22 + g->a23 * l32, y3 = g->a23 * l22 + g->a33 * l32, z3 = g->a33 * l33;
    symmetric3 m = {one + l11 * x1 + l21 * x2 + l31 * x3,
                    l22 * x2 + l32 * x3,
                    l33 * x3,
                    one + l22 * y2 + l32 * y3,
                    l33 * y3,
                    one + l33 * z3};
    pel_lane y[3];
    y[0] = right[0] * r1;
    y[1] = (right[1] - l21 * y[0]) * r2;
    y[2] = (right[2] - l31 * y[0] - l32 * y[1]) / l33;
    solve_symmetric(&m, y);
    right[0] = -(l11 * y[0]);
    right[1] = -(l21 * y[0] + l22 * y[1]);
    right[2] = -(l31 * y[0] + l32 * y[1] + l33 * y[2]);
}

/* factor on a step with the gradients p_k a + q_k b so that no vertex moves by more than 1 / sqrt(i0^2 + i2^2), about
   0.7 of an edge at rest: barriers of collapsed triangles are steep */
static inline pel_lane step_limit(const triangle_lanes *t, pel_lane3 a, pel_lane3 b)
{
    pel_lane square =
        t->pp * pel_lane3_dot(a, a) + pel_lane_splat(2) * t->pq * pel_lane3_dot(a, b) + t->qq * pel_lane3_dot(b, b);
    pel_lane mobility = t->point[0].fourth + t->point[1].fourth + t->point[2].fourth;
    pel_lane share = quotient(pel_lane_splat(1), square * mobility * (t->i0 * t->i0 + t->i2 * t->i2));
    return pel_lane_sqrt(pel_lane_min(share, pel_lane_splat(1)));
}

PEL_INLINE void sweep_strain_newton(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions,
                                    pel_membrane_kind kind)
{
    for (int32_t block = begin; block < end; block++)
        for (int32_t lane = 0; lane < pel_lane_passes(batch->lane_counts[block]); lane++) {
            triangle_lanes t = load_triangle(batch, block, lane, 4, positions);
            strain_lanes s = strain_of(&t);
            response r;
            respond(kind, &batch->law, &t, &s, &r);
            pel_lane k = number_of(batch, block, 4, 3, lane) * pel_lane_splat(batch->law.square_time), old[3];
            for (int i = 0; i < 3; i++)
                old[i] = multiplier_of(batch, block, 3, i, lane);
            pel_lane change[3] = {old[0] + k * r.stress.a, old[1] + k * r.stress.b, old[2] + k * r.stress.c};
            const symmetric3 *h = &r.tangent;
            symmetric3 g = mobility_of(&t, &s);
            symmetric3 b = {k * h->a11, k * h->a12, k * h->a13, k * h->a22, k * h->a23, k * h->a33};
            solve_newton(&b, &g, change);
            pel_lane3 first = pel_lane3_combine(change[0], t.f1, change[2], t.f2);
            pel_lane3 second = pel_lane3_combine(change[2], t.f1, change[1], t.f2);
            pel_lane limit = step_limit(&t, first, second);
            for (int i = 0; i < 3; i++)
                add_multiplier(batch, block, 3, i, lane, old[i], limit * change[i]);
            move_triangle(batch, block, lane, positions, &t, pel_lane3_scale(first, limit),
                          pel_lane3_scale(second, limit));
        }
}

/* ---- bending ---- */

/* u = K x has the gradient K_a on each component: rank one, four numbers instead of a 4 x 4 matrix */
PEL_INLINE void sweep_isometric(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions,
                                bool compliant)
{
    for (int32_t block = begin; block < end; block++)
        for (int32_t lane = 0; lane < pel_lane_passes(batch->lane_counts[block]); lane++) {
            pel_particle p[4];
            for (int a = 0; a < 4; a++)
                p[a] = load_particle(batch, block, a, lane, positions);
            pel_lane k[4], number = number_of(batch, block, 4, 3, lane);
            for (int a = 1; a < 4; a++)
                k[a] = number_of(batch, block, 4, a - 1, lane);
            k[0] = -(k[1] + k[2] + k[3]);
            pel_lane3 u = pel_lane3_combine(k[1], pel_lane3_subtract(p[1].at, p[0].at), k[2],
                                            pel_lane3_subtract(p[2].at, p[0].at));
            u = pel_lane3_add(u, pel_lane3_scale(pel_lane3_subtract(p[3].at, p[0].at), k[3]));
            pel_lane mobility = p[0].fourth * k[0] * k[0] + p[1].fourth * k[1] * k[1] + p[2].fourth * k[2] * k[2] +
                                p[3].fourth * k[3] * k[3];
            pel_lane3 change;
            if (compliant) {
                pel_lane softness = number * pel_lane_splat(batch->law.inverse_square);
                pel_lane factor = pel_lane_splat(1) / (mobility + softness);
                pel_lane3 old = {multiplier_of(batch, block, 3, 0, lane), multiplier_of(batch, block, 3, 1, lane),
                                 multiplier_of(batch, block, 3, 2, lane)};
                change = pel_lane3_combine(-factor, u, -(factor * softness), old);
                add_multiplier(batch, block, 3, 0, lane, old.x, change.x);
                add_multiplier(batch, block, 3, 1, lane, old.y, change.y);
                add_multiplier(batch, block, 3, 2, lane, old.z, change.z);
            } else {
                pel_lane square = pel_lane3_dot(u, u);
                pel_lane bottom = pel_lane_max(square, number * pel_lane_splat((pel_real)0.25)) * mobility;
                pel_lane top = pel_lane_splat((pel_real)-0.5 * batch->law.weight) * (square - number);
                change = pel_lane3_scale(u, quotient(top, bottom));
            }
            for (int a = 0; a < 4; a++)
                move_particle(batch, block, a, lane, positions, &p[a], pel_lane3_scale(change, p[a].fourth * k[a]));
        }
}

/* the dihedral angle and its gradients g2, g3 on the tips; on the ends they are -(1 - t2) g2 - (1 - t3) g3 and
   -t2 g2 - t3 g3 (element/bending.c) */
PEL_INLINE void sweep_angle(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions, bool compliant)
{
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2), zero = pel_lane_splat(0);
    const int count = compliant ? 3 : 2;
    for (int32_t block = begin; block < end; block++)
        for (int32_t lane = 0; lane < pel_lane_passes(batch->lane_counts[block]); lane++) {
            pel_particle p[4];
            for (int a = 0; a < 4; a++)
                p[a] = load_particle(batch, block, a, lane, positions);
            pel_lane3 edge = pel_lane3_subtract(p[1].at, p[0].at), to2 = pel_lane3_subtract(p[2].at, p[0].at);
            pel_lane3 to3 = pel_lane3_subtract(p[3].at, p[0].at);
            pel_lane3 n2 = pel_lane3_cross(edge, to2), n3 = pel_lane3_cross(to3, edge);
            pel_lane square = pel_lane3_dot(edge, edge), length = pel_lane_sqrt(square), cosine = pel_lane3_dot(n2, n3);
            pel_lane sine = -(length * pel_lane3_dot(to3, n2));
            /* turned back by the rest angle: the difference comes out the short way round */
            pel_lane rest_cosine = number_of(batch, block, count, 0, lane);
            pel_lane rest_sine = number_of(batch, block, count, 1, lane);
            pel_lane difference =
                pel_lane_atan2(sine * rest_cosine - cosine * rest_sine, cosine * rest_cosine + sine * rest_sine);
            pel_lane r2 = quotient(one, pel_lane3_dot(n2, n2)), r3 = quotient(one, pel_lane3_dot(n3, n3));
            pel_lane inverse = quotient(one, square);
            pel_lane t2 = inverse * pel_lane3_dot(to2, edge), t3 = inverse * pel_lane3_dot(to3, edge);
            pel_lane g22 = square * r2, g33 = square * r3, g23 = g22 * (r3 * cosine);
            pel_lane s2 = one - t2, s3 = one - t3;
            pel_lane mobility = p[2].fourth * g22 + p[3].fourth * g33 +
                                p[0].fourth * (s2 * s2 * g22 + two * s2 * s3 * g23 + s3 * s3 * g33) +
                                p[1].fourth * (t2 * t2 * g22 + two * t2 * t3 * g23 + t3 * t3 * g33);
            pel_lane change;
            if (compliant) {
                pel_lane softness = number_of(batch, block, count, 2, lane) * pel_lane_splat(batch->law.inverse_square);
                pel_lane old = multiplier_of(batch, block, 1, 0, lane);
                change = -((difference + softness * old) / (mobility + softness));
                add_multiplier(batch, block, 1, 0, lane, old, change);
            } else {
                change = quotient(pel_lane_splat((pel_real)-0.5 * batch->law.weight) * difference, mobility);
            }
            pel_lane3 g2 = pel_lane3_scale(n2, -(length * r2 * change));
            pel_lane3 g3 = pel_lane3_scale(n3, -(length * r3 * change));
            pel_lane w0 = p[0].fourth, w1 = p[1].fourth;
            move_particle(batch, block, 0, lane, positions, &p[0],
                          pel_lane3_combine(zero - w0 * s2, g2, zero - w0 * s3, g3));
            move_particle(batch, block, 1, lane, positions, &p[1],
                          pel_lane3_combine(zero - w1 * t2, g2, zero - w1 * t3, g3));
            move_particle(batch, block, 2, lane, positions, &p[2], pel_lane3_scale(g2, p[2].fourth));
            move_particle(batch, block, 3, lane, positions, &p[3], pel_lane3_scale(g3, p[3].fourth));
        }
}

/* ---- fibres ---- */

/* the image F a of a fibre is c0 (x0 - x2) + c1 (x1 - x2): a distance between weighted points */
typedef struct fibre_lanes {
    pel_particle point[3];
    pel_lane c0, c1, number; /* number: the third of the constraint */
    pel_lane3 image;
    pel_lane square, mobility;
} fibre_lanes;

static inline fibre_lanes load_fibre(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions)
{
    fibre_lanes f;
    for (int k = 0; k < 3; k++)
        f.point[k] = load_particle(batch, block, k, lane, positions);
    f.c0 = number_of(batch, block, 3, 0, lane);
    f.c1 = number_of(batch, block, 3, 1, lane);
    f.number = number_of(batch, block, 3, 2, lane);
    f.image = pel_lane3_combine(f.c0, pel_lane3_subtract(f.point[0].at, f.point[2].at), f.c1,
                                pel_lane3_subtract(f.point[1].at, f.point[2].at));
    f.square = pel_lane3_dot(f.image, f.image);
    pel_lane c2 = f.c0 + f.c1;
    f.mobility = f.point[0].fourth * f.c0 * f.c0 + f.point[1].fourth * f.c1 * f.c1 + f.point[2].fourth * c2 * c2;
    return f;
}

PEL_INLINE void sweep_fibres(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions, bool squared,
                             bool compliant)
{
    const pel_lane one = pel_lane_splat(1), half = pel_lane_splat((pel_real)0.5);
    for (int32_t block = begin; block < end; block++)
        for (int32_t lane = 0; lane < pel_lane_passes(batch->lane_counts[block]); lane++) {
            fibre_lanes f = load_fibre(batch, block, lane, positions);
            pel_lane length = pel_lane_sqrt(f.square);
            pel_lane value = squared ? f.square - one : length - pel_lane_splat(batch->law.rest_length);
            /* gradient c_k times this times the image */
            pel_lane slope = squared ? pel_lane_splat(2) : quotient(one, length);
            pel_lane mobility = f.mobility;
            if (squared)
                mobility = pel_lane_splat(4) * mobility * pel_lane_max(f.square, pel_lane_splat((pel_real)0.25));
            pel_lane change;
            if (compliant) {
                pel_lane softness = f.number * pel_lane_splat(batch->law.inverse_square);
                pel_lane old = multiplier_of(batch, block, 1, 0, lane);
                change = -((value + softness * old) / (mobility + softness));
                add_multiplier(batch, block, 1, 0, lane, old, change);
            } else {
                change = quotient(-(half * f.number * value), mobility);
            }
            pel_lane3 way = pel_lane3_scale(f.image, slope * change);
            const pel_particle *p = f.point;
            move_particle(batch, block, 0, lane, positions, &p[0], pel_lane3_scale(way, p[0].fourth * f.c0));
            move_particle(batch, block, 1, lane, positions, &p[1], pel_lane3_scale(way, p[1].fourth * f.c1));
            move_particle(batch, block, 2, lane, positions, &p[2],
                          pel_lane3_scale(way, -(p[2].fourth * (f.c0 + f.c1))));
        }
}

/* paper B: the gradient of the fibre's energy replaced by the normal, so that a stretched triangle goes inward; for
   equal masses by strength times the energy density over the stiffness */
PEL_INLINE void sweep_cave(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions, bool squared)
{
    const pel_lane one = pel_lane_splat(1), half = pel_lane_splat((pel_real)0.5);
    for (int32_t block = begin; block < end; block++)
        for (int32_t lane = 0; lane < pel_lane_passes(batch->lane_counts[block]); lane++) {
            fibre_lanes f = load_fibre(batch, block, lane, positions);
            const pel_particle *p = f.point;
            pel_lane strain = squared ? f.square - one : pel_lane_sqrt(f.square) - one;
            pel_lane depth = pel_lane_min(pel_lane_splat(batch->law.strength) * half * strain * strain,
                                          pel_lane_splat(batch->law.max_step));
            pel_lane3 normal =
                pel_lane3_cross(pel_lane3_subtract(p[1].at, p[0].at), pel_lane3_subtract(p[2].at, p[0].at));
            pel_lane size = pel_lane_sqrt(pel_lane3_dot(normal, normal));
            pel_lane mass = p[0].fourth + p[1].fourth + p[2].fourth;
            pel_lane scale = quotient(-(pel_lane_splat(3) * depth * f.number), mass * size);
            for (int k = 0; k < 3; k++)
                move_particle(batch, block, k, lane, positions, &p[k], pel_lane3_scale(normal, scale * p[k].fourth));
        }
}

/* ---- pressure ---- */

/* a third of pressure times area along the normal on each corner (element/triangle.c) */
PEL_INLINE void sweep_pressure(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions)
{
    for (int32_t block = begin; block < end; block++)
        for (int32_t lane = 0; lane < pel_lane_passes(batch->lane_counts[block]); lane++) {
            pel_particle a = load_particle(batch, block, 0, lane, positions);
            pel_particle b = load_particle(batch, block, 1, lane, positions);
            pel_particle c = load_particle(batch, block, 2, lane, positions);
            pel_lane3 normal = pel_lane3_cross(pel_lane3_subtract(b.at, a.at), pel_lane3_subtract(c.at, a.at));
            pel_lane3 force =
                pel_lane3_scale(normal, pel_lane_splat(batch->law.strength) * number_of(batch, block, 1, 0, lane));
            for (int k = 0; k < 3; k++) {
                pel_particle sum = load_particle(batch, block, k, lane, batch->target);
                move_particle(batch, block, k, lane, batch->target, &sum, force);
            }
        }
}

/* ---- the table ---- */

#define PEL_PROJECT_SWEEP(name, call)                                                                                  \
    static void name(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions)                        \
    {                                                                                                                  \
        call;                                                                                                          \
    }

PEL_PROJECT_SWEEP(sweep_distance, sweep_edges(batch, begin, end, positions, false))
PEL_PROJECT_SWEEP(sweep_spring, sweep_edges(batch, begin, end, positions, true))
PEL_PROJECT_SWEEP(sweep_stvk, sweep_membrane(batch, begin, end, positions, PEL_MEMBRANE_STVK))
PEL_PROJECT_SWEEP(sweep_corotated, sweep_membrane(batch, begin, end, positions, PEL_MEMBRANE_COROTATED))
PEL_PROJECT_SWEEP(sweep_linear, sweep_membrane(batch, begin, end, positions, PEL_MEMBRANE_LINEAR))
PEL_PROJECT_SWEEP(sweep_mooney, sweep_membrane(batch, begin, end, positions, PEL_MEMBRANE_MOONEY_RIVLIN))
PEL_PROJECT_SWEEP(sweep_neo, sweep_membrane(batch, begin, end, positions, PEL_MEMBRANE_NEO_HOOKEAN))
PEL_PROJECT_SWEEP(sweep_soft_stvk, sweep_strain_stvk(batch, begin, end, positions))
PEL_PROJECT_SWEEP(sweep_soft_linear, sweep_strain_linear(batch, begin, end, positions))
PEL_PROJECT_SWEEP(sweep_soft_corotated, sweep_strain_newton(batch, begin, end, positions, PEL_MEMBRANE_COROTATED))
PEL_PROJECT_SWEEP(sweep_soft_mooney, sweep_strain_newton(batch, begin, end, positions, PEL_MEMBRANE_MOONEY_RIVLIN))
PEL_PROJECT_SWEEP(sweep_soft_neo, sweep_strain_newton(batch, begin, end, positions, PEL_MEMBRANE_NEO_HOOKEAN))
PEL_PROJECT_SWEEP(sweep_bending, sweep_isometric(batch, begin, end, positions, false))
PEL_PROJECT_SWEEP(sweep_soft_bending, sweep_isometric(batch, begin, end, positions, true))
PEL_PROJECT_SWEEP(sweep_hinge, sweep_angle(batch, begin, end, positions, false))
PEL_PROJECT_SWEEP(sweep_soft_hinge, sweep_angle(batch, begin, end, positions, true))
PEL_PROJECT_SWEEP(sweep_fibre, sweep_fibres(batch, begin, end, positions, false, false))
PEL_PROJECT_SWEEP(sweep_fibre_square, sweep_fibres(batch, begin, end, positions, true, false))
PEL_PROJECT_SWEEP(sweep_soft_fibre, sweep_fibres(batch, begin, end, positions, false, true))
PEL_PROJECT_SWEEP(sweep_soft_fibre_square, sweep_fibres(batch, begin, end, positions, true, true))
PEL_PROJECT_SWEEP(sweep_cave_length, sweep_cave(batch, begin, end, positions, false))
PEL_PROJECT_SWEEP(sweep_cave_square, sweep_cave(batch, begin, end, positions, true))
PEL_PROJECT_SWEEP(add_pressure, sweep_pressure(batch, begin, end, positions))

#define PEL_PROJECT_TABLE                                                                                              \
    {                                                                                                                  \
        [PEL_CONSTRAINT_DISTANCE] = sweep_distance, [PEL_CONSTRAINT_SPRING] = sweep_spring,                            \
        [PEL_CONSTRAINT_MEMBRANE + PEL_MEMBRANE_STVK] = sweep_stvk,                                                    \
        [PEL_CONSTRAINT_MEMBRANE + PEL_MEMBRANE_COROTATED] = sweep_corotated,                                          \
        [PEL_CONSTRAINT_MEMBRANE + PEL_MEMBRANE_LINEAR] = sweep_linear,                                                \
        [PEL_CONSTRAINT_MEMBRANE + PEL_MEMBRANE_MOONEY_RIVLIN] = sweep_mooney,                                         \
        [PEL_CONSTRAINT_MEMBRANE + PEL_MEMBRANE_NEO_HOOKEAN] = sweep_neo,                                              \
        [PEL_CONSTRAINT_STRAIN + PEL_MEMBRANE_STVK] = sweep_soft_stvk,                                                 \
        [PEL_CONSTRAINT_STRAIN + PEL_MEMBRANE_COROTATED] = sweep_soft_corotated,                                       \
        [PEL_CONSTRAINT_STRAIN + PEL_MEMBRANE_LINEAR] = sweep_soft_linear,                                             \
        [PEL_CONSTRAINT_STRAIN + PEL_MEMBRANE_MOONEY_RIVLIN] = sweep_soft_mooney,                                      \
        [PEL_CONSTRAINT_STRAIN + PEL_MEMBRANE_NEO_HOOKEAN] = sweep_soft_neo,                                           \
        [PEL_CONSTRAINT_ISOMETRIC] = sweep_bending, [PEL_CONSTRAINT_ISOMETRIC_COMPLIANT] = sweep_soft_bending,         \
        [PEL_CONSTRAINT_ANGLE] = sweep_hinge, [PEL_CONSTRAINT_ANGLE_COMPLIANT] = sweep_soft_hinge,                     \
        [PEL_CONSTRAINT_FIBRE] = sweep_fibre, [PEL_CONSTRAINT_FIBRE_SQUARE] = sweep_fibre_square,                      \
        [PEL_CONSTRAINT_FIBRE_COMPLIANT] = sweep_soft_fibre,                                                           \
        [PEL_CONSTRAINT_FIBRE_SQUARE_COMPLIANT] = sweep_soft_fibre_square, [PEL_CONSTRAINT_CAVE] = sweep_cave_length,  \
        [PEL_CONSTRAINT_CAVE_SQUARE] = sweep_cave_square, [PEL_CONSTRAINT_PRESSURE] = add_pressure,                    \
    }

#endif
