/* Projections of position-based dynamics. A constraint C on the points x_k with inverse masses w_k moves them by

       pbd     dx_k = -k w_k g_k C / sum w |g|^2,                       g_k = dC / dx_k
       xpbd    dl = -(C + a l) / (sum w |g|^2 + a),  dx_k = w_k g_k dl,   a = 1 / (stiffness dt^2), l += dl

   pbd takes the energies themselves as constraints, as paper B does (equation 5): stiffness, area and thickness cancel
   and a quadratic energy falls to a quarter, because C touches zero instead of crossing it (theory page, section 0).

   Membrane. With the columns f1, f2 of F = sum_k x_k (p_k, q_k), where (p, q) are (i0, i1), (0, i2), (-i0, -i1 - i2)
   for the inverse [[i0, i1], [0, i2]] of the rest matrix, every gradient is g_k = p_k a + q_k b, and

       sum w g.g' = PP a.a' + PQ (a.b' + b.a') + QQ b.b',      PP = sum w p p and so on

   pbd: a, b are the columns of P (measure/membrane.h). xpbd works on the vector of strains s = (e11, e22, 2 e12) with
   the rows (f1, 0), (0, f2), (f2, f1): a 3 x 3 block G = sum w g g^T. A law with a constant tangent D has a compliance:

       (G + A) dl = -(s + A l),    A = D^-1 / (area dt^2)

   Other laws have the stress t(s) = d psi / ds. One Newton step of implicit Euler for the triangle alone,
   l = -area dt^2 t(s + G (l' - l)), is

       (1 + B G) dl = -(l + area dt^2 t),    B = area dt^2 D+

   with the positive semi-definite part D+ of the tangent. At its fixed point l = -area dt^2 t whatever B is: the stress
   is the law's own, and D+ only says how fast one gets there. With B = L L^T, dl = -L (1 + L^T G L)^-1 L^-1
   (l + area dt^2 t): symmetric, and no less than 1 whatever the stiffness.

   Guards have no scale of their own: steps of the pbd membrane are bounded by the size of the triangle at rest, a
   triangle squeezed to less than half has the gradient of half its size, quotients by zero are zero.

   A kernel computes the displacements of the points of one block; the sweep applies them after up to PEL_BATCH_GROUP
   blocks. Tried and lost: transposes by 128-bit halves (as many cycles), two blocks side by side in one loop (3 to
   14 %), lanes of 512 bits as two vectors (GCC 12: five times slower).  */
#ifndef PEL_SOLVE_PROJECT_KERNEL_H
#define PEL_SOLVE_PROJECT_KERNEL_H

#include "base/assert.h"
#include "law/fibre.h"
#include "measure/fibre.h"
#include "measure/hinge.h"
#include "measure/length.h"
#include "measure/membrane.h"
#include "measure/tetra_lanes.h"
#include "measure/volume.h"
#include "solve/project.h"
#include "solve/project_compliance.h"

/* ---- access ---- */

PEL_INLINE const int32_t *steps_of(const pel_batch *batch, int32_t block, int k)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    return batch->steps + ((size_t)block * (size_t)batch->arity + (size_t)k) * PEL_BLOCK;
}

PEL_INLINE pel_lane number_of(const pel_batch *batch, int32_t block, int count, int j, int32_t lane)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    return pel_lane_load(batch->numbers + ((size_t)block * (size_t)count + (size_t)j) * PEL_BLOCK, lane);
}

PEL_INLINE pel_particle load_particle(const pel_batch *batch, int32_t block, int k, int32_t lane,
                                      const pel_record *positions)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    return pel_particle_load(positions, steps_of(batch, block, k), lane);
}

PEL_INLINE pel_lane multiplier_of(const pel_batch *batch, int32_t block, int count, int j, int32_t lane)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    if (batch->multipliers == NULL)
        return pel_lane_splat(0);
    return pel_lane_load(batch->multipliers + ((size_t)block * (size_t)count + (size_t)j) * PEL_BLOCK, lane);
}

PEL_INLINE void add_multiplier(const pel_batch *batch, int32_t block, int count, int j, int32_t lane, pel_lane old,
                               pel_lane change)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    if (batch->multipliers != NULL)
        pel_lane_store(batch->multipliers + ((size_t)block * (size_t)count + (size_t)j) * PEL_BLOCK, lane,
                       old + change);
}

PEL_INLINE pel_symmetric3 scaled(const pel_symmetric3 *m, pel_lane scale)
{
    return (pel_symmetric3){scale * m->a11, scale * m->a12, scale * m->a13,
                            scale * m->a22, scale * m->a23, scale * m->a33};
}

/* ---- springs ---- */

PEL_INLINE void project_edge(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                             pel_lane3 *ways, bool compliant)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const int count = compliant ? 2 : 1;
    pel_particle a = load_particle(batch, block, 0, lane, positions);
    pel_particle b = load_particle(batch, block, 1, lane, positions);
    pel_length l = pel_length_of(a.at, b.at);
    pel_lane stretch = l.length - number_of(batch, block, count, 0, lane), mobility = a.fourth + b.fourth;
    if (compliant && is_viscous(batch)) {
        pel_length old = pel_length_of(load_particle(batch, block, 0, lane, batch->before).at,
                                       load_particle(batch, block, 1, lane, batch->before).at);
        damp(batch, l.length - old.length, &stretch, &mobility);
    }
    pel_lane change = stretch;
    if (compliant) {
        pel_lane softness = number_of(batch, block, count, 1, lane) * pel_lane_splat(batch->law.inverse_square);
        pel_lane multiplier = multiplier_of(batch, block, 1, 0, lane);
        change = (stretch + softness * multiplier) / (mobility + corrected(batch, mobility, softness));
        add_multiplier(batch, block, 1, 0, lane, multiplier, -change);
        change = pel_lane_quotient(change, l.length);
    } else {
        change = pel_lane_splat(batch->law.share) * pel_lane_quotient(stretch, mobility * l.length);
    }
    ways[0] = pel_lane3_scale(l.d, a.fourth * change);
    ways[1] = pel_lane3_scale(l.d, -(b.fourth * change));
}

/* ---- membrane ---- */

typedef struct triangle_lanes {
    pel_particle point[3];
    pel_gradient f;
    pel_lane m00, m01, m11, m20, m21; /* w_k p_k and w_k q_k of each corner, the last with the sign turned; p_1 = 0 */
    pel_lane pp, pq, qq;
} triangle_lanes;

PEL_INLINE triangle_lanes load_triangle(const pel_batch *batch, int32_t block, int32_t lane, int count,
                                        const pel_record *positions)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    triangle_lanes t;
    for (int k = 0; k < 3; k++)
        t.point[k] = load_particle(batch, block, k, lane, positions);
    pel_lane i0 = number_of(batch, block, count, 0, lane), i1 = number_of(batch, block, count, 1, lane);
    pel_lane i2 = number_of(batch, block, count, 2, lane), q2 = i1 + i2;
    pel_lane3 first = pel_lane3_subtract(t.point[0].at, t.point[2].at);
    pel_lane3 second = pel_lane3_subtract(t.point[1].at, t.point[2].at);
    t.f = pel_gradient_of(first, second, i0, i1, i2);
    t.m00 = t.point[0].fourth * i0;
    t.m01 = t.point[0].fourth * i1;
    t.m11 = t.point[1].fourth * i2;
    t.m20 = t.point[2].fourth * i0;
    t.m21 = t.point[2].fourth * q2;
    t.pp = i0 * (t.m00 + t.m20);
    t.pq = i0 * (t.m01 + t.m21);
    t.qq = i1 * t.m01 + i2 * t.m11 + q2 * t.m21;
    return t;
}

/* viscous part of the strains of a triangle: g (s - s_0) */
PEL_INLINE pel_symmetric2 viscous_strain(const pel_batch *batch, int32_t block, int32_t lane, int count,
                                         pel_symmetric2 strain, bool is_aligned)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const pel_lane share = pel_lane_splat(batch->law.viscosity);
    const triangle_lanes t = load_triangle(batch, block, lane, count, batch->before);
    const pel_factor f = pel_factor_of(&t.f);
    const pel_symmetric2 old = is_aligned ? pel_factor_strain(&f).strain : pel_green_strain(&t.f).strain;
    return (pel_symmetric2){share * (strain.a - old.a), share * (strain.b - old.b), share * (strain.c - old.c)};
}

/* the same, and its gradient */
PEL_INLINE void damp_triangle(const pel_batch *batch, int32_t block, int32_t lane, bool is_aligned,
                              pel_symmetric2 *strain, pel_symmetric3 *g)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    if (!is_viscous(batch))
        return;
    const pel_symmetric2 part = viscous_strain(batch, block, lane, PEL_TRIANGLE_NUMBERS, *strain, is_aligned);
    *strain = (pel_symmetric2){strain->a + part.a, strain->b + part.b, strain->c + part.c};
    *g = scaled(g, pel_lane_splat(1 + batch->law.viscosity));
}

/* dx_k = scale w_k (p_k a + q_k b) */
PEL_INLINE void move_triangle(const triangle_lanes *t, pel_lane scale, pel_lane3 a, pel_lane3 b, pel_lane3 *ways)
{
    ways[0] = pel_lane3_combine(scale * t->m00, a, scale * t->m01, b);
    ways[1] = pel_lane3_scale(b, scale * t->m11);
    ways[2] = pel_lane3_combine(-scale * t->m20, a, -scale * t->m21, b);
}

/* sum of w |g|^2 */
PEL_INLINE pel_lane sum_of_squares(const triangle_lanes *t, pel_lane3 a, pel_lane3 b)
{
    pel_lane mixed = t->pq * pel_lane3_dot(a, b);
    return t->pp * pel_lane3_dot(a, a) + (mixed + mixed) + t->qq * pel_lane3_dot(b, b);
}

/* the numbers of a law, those of each triangle first */
PEL_INLINE void load_law(const pel_batch *batch, int32_t block, int32_t lane, pel_membrane_kind kind,
                         pel_lane numbers[PEL_LAW_NUMBERS])
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const int count = pel_triangle_numbers(pel_law_traits(kind)), axis = count - PEL_TRIANGLE_NUMBERS;
    for (int i = 0; i < PEL_LAW_NUMBERS; i++)
        numbers[i] = i < axis ? number_of(batch, block, count, PEL_TRIANGLE_NUMBERS + i, lane)
                              : pel_lane_splat(batch->law.numbers[i]);
}

/* pbd: the energy is the constraint. A vertex moves by no more than (w_k / sum w (p^2 + q^2))^(1/2): half an edge of a
   regular triangle with equal masses, and never more than a height. */
PEL_INLINE void project_membrane(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                                 pel_lane3 *ways, pel_membrane_kind kind)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_lane numbers[PEL_LAW_NUMBERS];
    load_law(batch, block, lane, kind, numbers);
    triangle_lanes t = load_triangle(batch, block, lane, pel_triangle_numbers(pel_law_traits(kind)), positions);
    pel_lane3 stress[2];
    pel_lane energy = pel_membrane_stress(kind, numbers, &t.f, stress);
    pel_lane bottom = sum_of_squares(&t, stress[0], stress[1]);
    bottom = pel_lane_max(bottom, energy * energy * (t.pp + t.qq));
    move_triangle(&t, -pel_lane_splat(batch->law.share) * pel_lane_quotient(energy, bottom), stress[0], stress[1],
                  ways);
}

/* Strain limit: the constraint is the distance of the Green strain E from those whose principal values e_i are within
   the limits. Its gradient is F S / |S| with S = E less the strain with its principal values clamped, so impulses keep
   linear and angular momentum. Within the limits S is zero and nothing moves. Bounded as in project_membrane. */
PEL_INLINE void project_limit(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                              pel_lane3 *ways)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const pel_lane half = PEL_CONSTANT(0.5), zero = pel_lane_splat(0);
    const pel_lane least = pel_lane_splat(batch->law.least_strain), most = pel_lane_splat(batch->law.most_strain);
    triangle_lanes t = load_triangle(batch, block, lane, 3, positions);
    pel_strain s = pel_green_strain(&t.f);
    pel_lane mean = half * (s.strain.a + s.strain.b), along = half * (s.strain.a - s.strain.b),
             across = half * s.strain.c;
    pel_lane radius = pel_lane_sqrt(along * along + across * across), large = mean + radius, small = mean - radius;
    pel_lane s1 = pel_lane_max(large - most, zero) + pel_lane_min(large - least, zero);
    pel_lane s2 = pel_lane_max(small - most, zero) + pel_lane_min(small - least, zero);
    pel_lane middle = half * (s1 + s2), turned = pel_lane_quotient(half * (s1 - s2), radius);
    pel_lane square = s1 * s1 + s2 * s2, shear = turned * across;
    pel_lane3 first = pel_lane3_combine(middle + turned * along, t.f.f1, shear, t.f.f2);
    pel_lane3 second = pel_lane3_combine(shear, t.f.f1, middle - turned * along, t.f.f2);
    pel_lane bottom = pel_lane_max(sum_of_squares(&t, first, second), square * square * (t.pp + t.qq));
    move_triangle(&t, -pel_lane_quotient(square, bottom), first, second, ways);
}

/* Solves (m) x = right for a positive definite m, in units of its first pivot, so that no product is out of range: the
   first unknown by elimination, the two others by Cramer's rule, which loses no more than elimination does. A pivot
   lost to rounding is taken as what rounding left of it. */
PEL_INLINE void solve_symmetric(const pel_symmetric3 *m, pel_lane right[3])
{
    const pel_lane one = pel_lane_splat(1), least = pel_lane_splat(16 * PEL_REAL_EPSILON);
    pel_lane inverse = one / m->a11, l2 = m->a12 * inverse, l3 = m->a13 * inverse;
    pel_lane a22 = m->a22 * inverse, a33 = m->a33 * inverse;
    pel_lane d22 = pel_lane_max(a22 - l2 * l2, least * a22), d33 = pel_lane_max(a33 - l3 * l3, least * a33);
    pel_lane d23 = m->a23 * inverse - l2 * l3, product = d22 * d33;
    pel_lane scale = one / pel_lane_max(product - d23 * d23, least * product);
    pel_lane y1 = right[0] * inverse, y2 = right[1] * inverse - l2 * y1, y3 = right[2] * inverse - l3 * y1;
    right[1] = (d33 * y2 - d23 * y3) * scale;
    right[2] = (d22 * y3 - d23 * y2) * scale;
    right[0] = y1 - l2 * right[1] - l3 * right[2];
}

/* G of the Green strains; a column squeezed to less than half counts as half */
PEL_INLINE pel_symmetric3 mobility_of(const triangle_lanes *t, const pel_strain *s)
{
    const pel_lane quarter = pel_lane_splat((pel_real)0.25), two = pel_lane_splat(2);
    pel_lane c11 = pel_lane_max(s->cauchy.a, quarter), c22 = pel_lane_max(s->cauchy.b, quarter), c12 = s->cauchy.c;
    return (pel_symmetric3){
        t->pp * c11,
        t->pq * c12,
        t->pp * c12 + t->pq * c11,
        t->qq * c22,
        t->pq * c22 + t->qq * c12,
        t->pp * c22 + two * t->pq * c12 + t->qq * c11,
    };
}

/* (G + D^-1 / (area dt^2)) dl = -(c + ...) for a quadratic energy; softness: 1 / (area young thickness dt^2) */
PEL_INLINE void solve_quadratic(const pel_batch *batch, int32_t block, int32_t lane, pel_symmetric3 g,
                                pel_symmetric2 strain, pel_lane softness, pel_lane change[3])
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_lane poisson = pel_lane_splat(batch->law.poisson), across = poisson * softness;
    pel_lane shear = pel_lane_splat(2) * (softness + across), old[3];
    for (int i = 0; i < 3; i++)
        old[i] = multiplier_of(batch, block, 3, i, lane);
    change[0] = -(strain.a + softness * old[0] - across * old[1]);
    change[1] = -(strain.b + softness * old[1] - across * old[0]);
    change[2] = -(strain.c + shear * old[2]);
    /* trace of D g, times 1 / (area young dt^2) */
    const double nu = (double)batch->law.poisson;
    const pel_lane most = PEL_CONSTANT(1 / (1 - nu * nu)) * (g.a11 + g.a22 + PEL_CONSTANT(2 * nu) * g.a12) +
                          PEL_CONSTANT(0.5 / (1 + nu)) * g.a33;
    g = scaled(&g, share_left(batch, softness, most));
    g.a11 = g.a11 + softness;
    g.a22 = g.a22 + softness;
    g.a12 = g.a12 - across;
    g.a33 = g.a33 + shear;
    solve_symmetric(&g, change);
    for (int i = 0; i < 3; i++)
        add_multiplier(batch, block, 3, i, lane, old[i], change[i]);
}

/* a law with a constant tangent, of the Green strain */
PEL_INLINE void project_strain_green(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                                     pel_lane3 *ways)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    triangle_lanes t = load_triangle(batch, block, lane, PEL_TRIANGLE_NUMBERS, positions);
    pel_strain s = pel_green_strain(&t.f);
    pel_lane softness =
        number_of(batch, block, PEL_TRIANGLE_NUMBERS, 3, lane) * pel_lane_splat(batch->law.inverse_square);
    pel_lane change[3];
    pel_symmetric3 g = mobility_of(&t, &s);
    damp_triangle(batch, block, lane, false, &s.strain, &g);
    solve_quadratic(batch, block, lane, g, s.strain, softness, change);
    move_triangle(&t, pel_lane_splat(1), pel_lane3_combine(change[0], t.f.f1, change[2], t.f.f2),
                  pel_lane3_combine(change[2], t.f.f1, change[1], t.f.f2), ways);
}

/* the same of the triangle factor, strains with the rows (t1, 0), (-b/a t2, t2), (c/a t2, t1) */
PEL_INLINE void project_strain_aligned(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                                       pel_lane3 *ways)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const pel_lane one = pel_lane_splat(1), two = pel_lane_splat(2);
    triangle_lanes t = load_triangle(batch, block, lane, PEL_TRIANGLE_NUMBERS, positions);
    pel_factor f = pel_factor_of(&t.f);
    pel_strain s = pel_factor_strain(&f);
    pel_lane softness =
        number_of(batch, block, PEL_TRIANGLE_NUMBERS, 3, lane) * pel_lane_splat(batch->law.inverse_square);
    pel_lane inverse = one / pel_lane_max(f.a, pel_lane_splat((pel_real)0.5));
    pel_lane by_b = f.b * inverse, by_c = f.c * inverse, change[3];
    pel_symmetric3 g = {t.pp,
                        pel_lane_splat(0),
                        t.pq,
                        t.pp * by_b * by_b - two * t.pq * by_b + t.qq,
                        t.pq * by_c - t.pp * by_b * by_c,
                        t.pp * by_c * by_c + t.qq};
    damp_triangle(batch, block, lane, true, &s.strain, &g);
    solve_quadratic(batch, block, lane, g, s.strain, softness, change);
    move_triangle(&t, one, pel_lane3_combine(change[0], f.t1, by_c * change[2] - by_b * change[1], f.t2),
                  pel_lane3_combine(change[2], f.t1, change[1], f.t2), ways);
}

/* dl = -L (1 + L^T G L)^-1 L^-1 right with B = L L^T; the result replaces right */
PEL_INLINE void solve_newton(const pel_batch *batch, const pel_symmetric3 *b, const pel_symmetric3 *g,
                             pel_lane right[3])
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
    pel_symmetric3 m = {
        l11 * x1 + l21 * x2 + l31 * x3, l22 * x2 + l32 * x3, l33 * x3, l22 * y2 + l32 * y3, l33 * y3, l33 * z3};
    m = scaled(&m, share_left(batch, one, m.a11 + m.a22 + m.a33));
    m = (pel_symmetric3){one + m.a11, m.a12, m.a13, one + m.a22, m.a23, one + m.a33};
    pel_lane y[3];
    y[0] = right[0] * r1;
    y[1] = (right[1] - l21 * y[0]) * r2;
    y[2] = (right[2] - l31 * y[0] - l32 * y[1]) / l33;
    solve_symmetric(&m, y);
    right[0] = -(l11 * y[0]);
    right[1] = -(l21 * y[0] + l22 * y[1]);
    right[2] = -(l31 * y[0] + l32 * y[1] + l33 * y[2]);
}

/* factor on a step with the gradients p_k a + q_k b so that no vertex moves further than in sweep_membrane: barriers of
   collapsed triangles are steep */
PEL_INLINE pel_lane step_limit(const triangle_lanes *t, pel_lane3 a, pel_lane3 b)
{
    const pel_lane one = pel_lane_splat(1);
    return pel_lane_sqrt(one / pel_lane_max(sum_of_squares(t, a, b) * (t->pp + t->qq), one));
}

/* The multipliers and the points of a triangle, not further than step_limit. bound: at least sum w |g|^2 of the step.
 */
PEL_INLINE void move_strained(const pel_batch *batch, int32_t block, int32_t lane, const triangle_lanes *t,
                              const pel_lane old[3], const pel_lane change[3], pel_lane bound, pel_lane3 *ways)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_lane3 first = pel_lane3_combine(change[0], t->f.f1, change[2], t->f.f2);
    pel_lane3 second = pel_lane3_combine(change[2], t->f.f1, change[1], t->f.f2);
    pel_lane limit = pel_lane_splat(1);
    /* far from the limit, whatever is lost to rounding, it is 1: then the sum itself is not needed */
    if (!pel_lane_all(pel_lane_above(PEL_CONSTANT(0.5), bound * (t->pp + t->qq))))
        limit = step_limit(t, first, second);
    for (int i = 0; i < 3; i++)
        add_multiplier(batch, block, 3, i, lane, old[i], limit * change[i]);
    move_triangle(t, limit, first, second, ways);
}

PEL_INLINE void multiply_add(const pel_symmetric3 *m, const pel_lane x[3], pel_lane sum[3])
{
    sum[0] = sum[0] + (m->a11 * x[0] + m->a12 * x[1] + m->a13 * x[2]);
    sum[1] = sum[1] + (m->a12 * x[0] + m->a22 * x[1] + m->a23 * x[2]);
    sum[2] = sum[2] + (m->a13 * x[0] + m->a23 * x[1] + m->a33 * x[2]);
}

PEL_INLINE void project_strain_newton(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                                      pel_lane3 *ways, pel_membrane_kind kind)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_lane numbers[PEL_LAW_NUMBERS];
    load_law(batch, block, lane, kind, numbers);
    triangle_lanes t = load_triangle(batch, block, lane, pel_triangle_numbers(pel_law_traits(kind)), positions);
    pel_strain s = pel_green_strain(&t.f);
    pel_response r;
    pel_respond(kind, numbers, &s, &r);
    const pel_symmetric3 *h = &r.positive;
    pel_symmetric3 g = mobility_of(&t, &s);
    pel_lane k = number_of(batch, block, pel_triangle_numbers(pel_law_traits(kind)), 3, lane) *
                 pel_lane_splat(batch->law.square_time),
             old[3];
    /* a crushed triangle counts as 1e15 times stiffer than its points are mobile, so that no product overflows */
    k = pel_lane_min(k, PEL_CONSTANT(1e15) / ((h->a11 + h->a22 + h->a33) * (g.a11 + g.a22 + g.a33)));
    for (int i = 0; i < 3; i++)
        old[i] = multiplier_of(batch, block, 3, i, lane);
    pel_lane change[3] = {old[0] + k * r.stress.a, old[1] + k * r.stress.b, old[2] + k * r.stress.c};
    pel_symmetric3 b = scaled(h, k);
    if (is_viscous(batch)) {
        const pel_symmetric2 part =
            viscous_strain(batch, block, lane, pel_triangle_numbers(pel_law_traits(kind)), s.strain, false);
        const pel_lane strain[3] = {part.a, part.b, part.c};
        multiply_add(&b, strain, change);
        b = scaled(&b, pel_lane_splat(1 + batch->law.viscosity));
    }
    solve_newton(batch, &b, &g, change);
    move_strained(batch, block, lane, &t, old, change, PEL_CONSTANT(HUGE_VAL), ways);
}

/* scale (C x C - part C (x) C); below its bound of the area that of a wider triangle, because a collapsed one has no
   inverse */
PEL_INLINE pel_symmetric3 compliance_of(const pel_symmetric2 *m, pel_lane scale, pel_lane part)
{
    pel_lane shared = scale * part, along = scale - shared, a = along * m->a, b = along * m->b, c = m->c + m->c;
    pel_lane product = m->a * m->b, square = m->c * m->c, both = scale * square - shared * product;
    return (pel_symmetric3){a * m->a, both,  a * c,
                            b * m->b, b * c, c * along * c + (scale + scale) * (product - square)};
}

/* D^-1 t of t = I - c C^-1: scale C (C - (c + part (tr C - 2 c)) I) */
PEL_INLINE void relaxed_strain(const pel_response *r, const pel_strain *s, const pel_symmetric2 *m,
                               pel_lane_mask is_low, pel_lane strain[3])
{
    const pel_compliance *k = &r->compliance;
    pel_lane trace = s->cauchy.a + s->cauchy.b, c = s->cauchy.c, square = c * c;
    pel_lane base = k->c + k->part * (trace - (k->c + k->c));
    strain[0] = k->scale * (s->cauchy.a * (s->cauchy.a - base) + square);
    strain[1] = k->scale * (s->cauchy.b * (s->cauchy.b - base) + square);
    strain[2] = k->scale * ((c + c) * (trace - base));
    if (pel_lane_all(~is_low))
        return;
    const pel_lane stress[3] = {r->stress.a, r->stress.b, r->stress.c}, zero = pel_lane_splat(0);
    pel_symmetric3 d = compliance_of(m, k->scale, k->part);
    pel_lane low[3] = {zero, zero, zero};
    multiply_add(&d, stress, low);
    for (int i = 0; i < 3; i++)
        strain[i] = pel_lane_select(is_low, low[i], strain[i]);
}

/* the same step by the inverse of D: (G + a D^-1) dl = -D^-1 (a l + t), a = 1 / (area dt^2) */
PEL_INLINE void project_strain_compliant(const pel_batch *batch, int32_t block, int32_t lane,
                                         const pel_record *positions, pel_lane3 *ways, pel_membrane_kind kind)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const pel_lane least = PEL_CONSTANT(PEL_LEAST_AREA_RATIO);
    pel_lane numbers[PEL_LAW_NUMBERS], old[3], change[3];
    load_law(batch, block, lane, kind, numbers);
    triangle_lanes t = load_triangle(batch, block, lane, pel_triangle_numbers(pel_law_traits(kind)), positions);
    pel_strain s = pel_green_strain(&t.f);
    pel_response r;
    pel_respond(kind, numbers, &s, &r);
    const pel_lane_mask is_low = pel_lane_above(least * least, s.area_square);
    const pel_lane wider = pel_lane_where(is_low, least);
    const pel_symmetric2 m = {s.cauchy.a + wider, s.cauchy.b + wider, s.cauchy.c};
    pel_lane softness = number_of(batch, block, pel_triangle_numbers(pel_law_traits(kind)), 3, lane) *
                        pel_lane_splat(batch->law.inverse_square);
    pel_symmetric3 g = mobility_of(&t, &s), d = compliance_of(&m, softness * r.compliance.scale, r.compliance.part);
    relaxed_strain(&r, &s, &m, is_low, change);
    for (int i = 0; i < 3; i++)
        old[i] = multiplier_of(batch, block, 3, i, lane);
    if (batch->multipliers != NULL)
        multiply_add(&d, old, change);
    if (is_viscous(batch)) {
        const pel_symmetric2 part =
            viscous_strain(batch, block, lane, pel_triangle_numbers(pel_law_traits(kind)), s.strain, false);
        change[0] = change[0] + part.a;
        change[1] = change[1] + part.b;
        change[2] = change[2] + part.c;
        g = scaled(&g, pel_lane_splat(1 + batch->law.viscosity));
    }
    const pel_lane right[3] = {-change[0], -change[1], -change[2]};
    for (int i = 0; i < 3; i++)
        change[i] = right[i];
    /* trace of D g for D = (C^-1 x C^-1 + q C^-1 (x) C^-1) / scale, q = part / (1 - 2 part): (3/2 + q) sum w p.C^-1 p
     */
    const pel_lane two = pel_lane_splat(2), rest = pel_lane_splat(1) - two * r.compliance.part;
    const pel_lane whole = rest * r.compliance.scale * (m.a * m.b - m.c * m.c);
    const pel_lane most = pel_lane_splat(1 + batch->law.viscosity) * (rest + PEL_CONSTANT(0.5)) *
                          (t.pp * m.b + t.qq * m.a - two * t.pq * m.c);
    g = scaled(&g, share_left(batch, softness * whole, most));
    g = (pel_symmetric3){g.a11 + d.a11, g.a12 + d.a12, g.a13 + d.a13, g.a22 + d.a22, g.a23 + d.a23, g.a33 + d.a33};
    solve_symmetric(&g, change);
    /* at least half of dl G dl is dl (right - a D^-1 dl), and D is positive definite */
    pel_lane bound = two * (right[0] * change[0] + right[1] * change[1] + right[2] * change[2]);
    move_strained(batch, block, lane, &t, old, change, bound, ways);
}

/* the strain form of a law */
PEL_INLINE void project_strain(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                               pel_lane3 *ways, pel_membrane_kind kind)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const int traits = pel_law_traits(kind);
    if ((traits & PEL_LAW_COMPLIANT) != 0)
        project_strain_compliant(batch, block, lane, positions, ways, kind);
    else if ((traits & PEL_LAW_CONSTANT_TANGENT) == 0)
        project_strain_newton(batch, block, lane, positions, ways, kind);
    else if ((traits & PEL_LAW_ALIGNED) == 0)
        project_strain_green(batch, block, lane, positions, ways);
    else
        project_strain_aligned(batch, block, lane, positions, ways);
}

/* ---- bending ---- */

/* u = K x has the gradient K_a on each component: rank one, four numbers instead of a 4 x 4 matrix */
PEL_INLINE void project_isometric(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                                  pel_particle p[4], pel_lane3 *ways, bool compliant)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    for (int a = 0; a < 4; a++)
        p[a] = load_particle(batch, block, a, lane, positions);
    pel_lane k[4], number = number_of(batch, block, PEL_ISOMETRIC_NUMBERS, compliant ? 3 : 4, lane);
    for (int a = 1; a < 4; a++)
        k[a] = number_of(batch, block, PEL_ISOMETRIC_NUMBERS, a - 1, lane);
    pel_isometric_weights(k);
    pel_lane3 u = pel_isometric_of(p, k);
    pel_lane m[4], mobility;
    for (int a = 0; a < 4; a++)
        m[a] = p[a].fourth * k[a];
    mobility = m[0] * k[0] + m[1] * k[1] + (m[2] * k[2] + m[3] * k[3]);
    pel_lane3 change;
    if (compliant) {
        pel_lane softness = number * pel_lane_splat(batch->law.inverse_square);
        pel_lane factor = pel_lane_splat(1) / (mobility + corrected(batch, mobility, softness));
        pel_lane3 old = {multiplier_of(batch, block, 3, 0, lane), multiplier_of(batch, block, 3, 1, lane),
                         multiplier_of(batch, block, 3, 2, lane)};
        change = pel_lane3_combine(-factor, u, -(factor * softness), old);
        add_multiplier(batch, block, 3, 0, lane, old.x, change.x);
        add_multiplier(batch, block, 3, 1, lane, old.y, change.y);
        add_multiplier(batch, block, 3, 2, lane, old.z, change.z);
    } else {
        pel_lane square = pel_lane3_dot(u, u);
        pel_lane bottom = pel_lane_max(square, number * pel_lane_splat((pel_real)0.25)) * mobility;
        pel_lane top = pel_lane_splat((pel_real)-0.5 * batch->law.weight * batch->law.share) * (square - number);
        change = pel_lane3_scale(u, pel_lane_quotient(top, bottom));
    }
    for (int a = 0; a < 4; a++)
        ways[a] = pel_lane3_scale(change, m[a]);
}

/* the dihedral angle and its gradients g2, g3 on the tips; on the ends they are -(1 - t2) g2 - (1 - t3) g3 and
   -t2 g2 - t3 g3 (measure/hinge.h) */
PEL_INLINE void project_angle(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                              pel_particle p[4], pel_lane3 *ways, bool compliant, int count)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const pel_lane one = pel_lane_splat(1);
    for (int k = 0; k < 4; k++)
        p[k] = load_particle(batch, block, k, lane, positions);
    pel_hinge_lanes h =
        pel_hinge_of(p, number_of(batch, block, count, 0, lane), number_of(batch, block, count, 1, lane));
    pel_lane s2 = one - h.t2, s3 = one - h.t3;
    pel_lane m02 = p[0].fourth * s2, m03 = p[0].fourth * s3, m12 = p[1].fourth * h.t2, m13 = p[1].fourth * h.t3;
    pel_lane across = h.r2 * h.cosine * h.r3 * (m02 * s3 + m12 * h.t3);
    pel_lane mobility = h.square * (h.r2 * (p[2].fourth + m02 * s2 + m12 * h.t2) +
                                    h.r3 * (p[3].fourth + m03 * s3 + m13 * h.t3) + (across + across));
    pel_lane change, difference = h.difference;
    if (compliant && is_viscous(batch)) {
        pel_particle old[4];
        for (int k = 0; k < 4; k++)
            old[k] = load_particle(batch, block, k, lane, batch->before);
        const pel_hinge_lanes before =
            pel_hinge_angle_of(old, number_of(batch, block, count, 0, lane), number_of(batch, block, count, 1, lane));
        damp(batch, difference - before.difference, &difference, &mobility);
    }
    if (compliant) {
        pel_lane softness = number_of(batch, block, count, 2, lane) * pel_lane_splat(batch->law.inverse_square);
        pel_lane old = multiplier_of(batch, block, 1, 0, lane);
        pel_lane inverse = one / (mobility + corrected(batch, mobility, softness));
        change = inverse * (difference + softness * old);
        add_multiplier(batch, block, 1, 0, lane, old, -change);
    } else {
        pel_lane weight = pel_lane_splat((pel_real)0.5 * batch->law.weight * batch->law.share);
        change = pel_lane_quotient(weight * h.difference, mobility);
    }
    change = h.length * change;
    pel_lane3 g2 = pel_lane3_scale(h.n2, h.r2 * change), g3 = pel_lane3_scale(h.n3, h.r3 * change);
    ways[0] = pel_lane3_combine(-m02, g2, -m03, g3);
    ways[1] = pel_lane3_combine(-m12, g2, -m13, g3);
    ways[2] = pel_lane3_scale(g2, p[2].fourth);
    ways[3] = pel_lane3_scale(g3, p[3].fourth);
}

/* ---- fibres ---- */

/* the image of a fibre is a distance between weighted points */
typedef struct fibre_lanes {
    pel_particle point[3];
    pel_lane c0, c1, number; /* number: softness, or weight of pbd */
    pel_fibre_image fibre;
    pel_lane mobility;
} fibre_lanes;

PEL_INLINE fibre_lanes load_fibre(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                                  bool compliant)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const int count = compliant ? PEL_FIBRE_NUMBERS : PEL_FIBRE_WEIGHTED_NUMBERS;
    fibre_lanes f;
    for (int k = 0; k < 3; k++)
        f.point[k] = load_particle(batch, block, k, lane, positions);
    f.c0 = number_of(batch, block, count, 0, lane);
    f.c1 = number_of(batch, block, count, 1, lane);
    f.number = number_of(batch, block, count, compliant ? 2 : 3, lane);
    f.fibre = pel_fibre_image_of(pel_lane3_subtract(f.point[0].at, f.point[2].at),
                                 pel_lane3_subtract(f.point[1].at, f.point[2].at), f.c0, f.c1);
    pel_lane c2 = f.c0 + f.c1;
    f.mobility = f.point[0].fourth * f.c0 * f.c0 + f.point[1].fourth * f.c1 * f.c1 + f.point[2].fourth * c2 * c2;
    return f;
}

PEL_INLINE void project_fibre(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                              pel_lane3 *ways, bool squared, bool compliant)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const pel_lane half = pel_lane_splat((pel_real)0.5);
    fibre_lanes f = load_fibre(batch, block, lane, positions, compliant);
    /* gradient c_k times the slope times the image */
    pel_fibre_response r = pel_law_fibre(f.fibre.square, pel_lane_splat(batch->law.rest_length), squared);
    pel_lane mobility = f.mobility;
    if (squared)
        mobility = r.slope * r.slope * mobility * pel_lane_max(f.fibre.square, pel_lane_splat((pel_real)0.25));
    pel_lane change;
    if (compliant) {
        pel_lane softness = f.number * pel_lane_splat(batch->law.inverse_square);
        pel_lane old = multiplier_of(batch, block, 1, 0, lane);
        change = -((r.strain + softness * old) / (mobility + corrected(batch, mobility, softness)));
        add_multiplier(batch, block, 1, 0, lane, old, change);
    } else {
        change = pel_lane_splat(batch->law.share) * pel_lane_quotient(-(half * f.number * r.strain), mobility);
    }
    pel_lane3 way = pel_lane3_scale(f.fibre.image, r.slope * change);
    const pel_particle *p = f.point;
    ways[0] = pel_lane3_scale(way, p[0].fourth * f.c0);
    ways[1] = pel_lane3_scale(way, p[1].fourth * f.c1);
    ways[2] = pel_lane3_scale(way, -(p[2].fourth * (f.c0 + f.c1)));
}

/* Newton's step of force + softness times multiplier, with the slope of the force-length curve where it rises; beyond
   its optimum the force of the present length acts. */
PEL_INLINE void project_muscle(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                               pel_lane3 *ways)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const fibre_lanes f = load_fibre(batch, block, lane, positions, true);
    const pel_lane length = pel_lane_sqrt(f.fibre.square),
                   softness = f.number * pel_lane_splat(batch->law.inverse_square);
    const pel_muscle_response r =
        pel_law_muscle(length, pel_lane_splat(batch->law.optimum), pel_lane_splat(batch->law.width));
    const pel_lane force = pel_lane_splat(batch->law.rest_length) * r.force,
                   old = multiplier_of(batch, block, 1, 0, lane);
    const pel_lane slope = pel_lane_splat(batch->law.rest_length) * pel_lane_max(r.slope, pel_lane_splat(0));
    const pel_lane change =
        -((force + softness * old) / (slope * f.mobility + corrected(batch, slope * f.mobility, softness)));
    add_multiplier(batch, block, 1, 0, lane, old, change);
    const pel_lane3 way = pel_lane3_scale(f.fibre.image, pel_lane_quotient(change, length));
    const pel_particle *p = f.point;
    ways[0] = pel_lane3_scale(way, p[0].fourth * f.c0);
    ways[1] = pel_lane3_scale(way, p[1].fourth * f.c1);
    ways[2] = pel_lane3_scale(way, -(p[2].fourth * (f.c0 + f.c1)));
}

/* each corner that can move goes inward along the normal (project_cave.c) */
PEL_INLINE void project_cave(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                             pel_lane3 *ways)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_particle p[3];
    for (int k = 0; k < 3; k++)
        p[k] = load_particle(batch, block, k, lane, positions);
    pel_lane3 normal = pel_area_vector(p[0].at, p[1].at, p[2].at);
    pel_lane inverse = pel_lane_quotient(pel_lane_splat(-1), pel_lane_sqrt(pel_lane3_dot(normal, normal)));
    for (int k = 0; k < 3; k++) {
        pel_lane way = number_of(batch, block, PEL_CAVE_NUMBERS, PEL_CAVE_WAY + k, lane);
        pel_lane_mask moves = pel_lane_above(p[k].fourth, pel_lane_splat(0));
        ways[k] = pel_lane3_scale(normal, pel_lane_where(moves, inverse * way));
    }
}

/* pbd: the constraint is the energy E_A of a fibre that is shorter than at rest, and its gradient k_A n on each corner:
   the correction -w n E_A / (k_A sum w) goes inward, and never beyond the bound (project_body.c) */
PEL_INLINE void project_normal(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                               pel_lane3 *ways, bool squared)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    const pel_lane zero = pel_lane_splat(0), share = pel_lane_splat(batch->law.share);
    pel_particle p[3];
    pel_lane number[PEL_NORMAL_NUMBERS];
    for (int k = 0; k < 3; k++)
        p[k] = load_particle(batch, block, k, lane, positions);
    for (int j = 0; j < PEL_NORMAL_NUMBERS; j++)
        number[j] = number_of(batch, block, PEL_NORMAL_NUMBERS, j, lane);
    pel_fibre_image f = pel_fibre_image_of(pel_lane3_subtract(p[0].at, p[2].at), pel_lane3_subtract(p[1].at, p[2].at),
                                           number[0], number[1]);
    pel_lane ratio =
        number[PEL_NORMAL_PUSH] * pel_law_fibre_shortening(pel_law_fibre(f.square, pel_lane_splat(1), squared));
    pel_lane3 normal = pel_area_vector(p[0].at, p[1].at, p[2].at);
    pel_lane inverse = pel_lane_quotient(pel_lane_splat(-1), pel_lane_sqrt(pel_lane3_dot(normal, normal)));
    pel_lane rate = pel_lane_quotient(ratio, p[0].fourth + p[1].fourth + p[2].fourth), limited = zero;
    for (int k = 0; k < 3; k++) {
        pel_lane way = rate * p[k].fourth;
        limited = pel_lane_where(pel_lane_above(way, number[PEL_NORMAL_MOST]), pel_lane_splat(1)) + limited;
        ways[k] = pel_lane3_scale(normal, inverse * share * pel_lane_min(way, number[PEL_NORMAL_MOST]));
    }
    pel_real *counts = batch->numbers + ((size_t)block * PEL_NORMAL_NUMBERS + PEL_NORMAL_LIMITED) * PEL_BLOCK;
    pel_lane_store(counts, lane, number[PEL_NORMAL_LIMITED] + pel_lane_min(limited, pel_lane_splat(1)));
}

#include "solve/project_tetra.h"

/* ---- sweeps ---- */

/* float has twice the records for its registers: four points are moved at once while they are there */
PEL_INLINE bool is_staged(int arity)
{
    return sizeof(pel_real) == 8 || arity < 4;
}

/* the blocks from .. are of one colour and share no vertex: all of them find the ways of their points before any goes
 */
PEL_INLINE int32_t group_end(const pel_batch *batch, int32_t from)
{
    return from + 1 + (is_staged(batch->arity) ? batch->followers[from] : 0);
}

PEL_INLINE void move_points(const pel_batch *batch, int32_t block, int32_t lane, const pel_particle *points,
                            const pel_lane3 *ways, pel_record *positions)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    for (int k = 0; k < batch->arity; k++)
        pel_particle_move(positions, steps_of(batch, block, k), lane, is_staged(batch->arity) ? NULL : &points[k],
                          ways[k]);
}

/* The force of one constraint on what holds its fixed vertices. */
typedef struct held_share {
    double point[4][3]; /* m, of the fixed vertices, from their mean */
    int32_t step[4];
    int count;
    double force[3], torque[3]; /* of all of them, the torque about their mean */
} held_share;

/* Its impulses, and their moments, sum to zero, so that the free vertices tell both sums. False = none is fixed or all
   are. */
static bool find_held_share(const pel_batch *batch, const pel_record *positions, const int32_t *steps, int32_t lane,
                            pel_record (*ways)[PEL_BLOCK], held_share *share)
{
    double mean[3] = {0, 0, 0}, x[4][3];
    *share = (held_share){0};
    for (int k = 0; k < batch->arity; k++) {
        pel_record own = pel_record_get(positions, steps[k * PEL_BLOCK + lane]);
        pel_vec3_set(x[k], (double)own[0], (double)own[1], (double)own[2]);
        if (own[3] > 0)
            continue;
        share->step[share->count] = steps[k * PEL_BLOCK + lane];
        pel_vec3_copy(x[k], share->point[share->count++]);
        pel_vec3_add(mean, x[k], mean);
    }
    if (share->count == 0 || share->count == batch->arity)
        return false;
    pel_vec3_scale(mean, 1.0 / share->count, mean);
    for (int i = 0; i < share->count; i++)
        pel_vec3_subtract(share->point[i], mean, share->point[i]);
    for (int k = 0; k < batch->arity; k++) {
        double w = (double)pel_record_get(positions, steps[k * PEL_BLOCK + lane])[3], force[3], arm[3], torque[3];
        for (int i = 0; i < 3 && w > 0; i++)
            force[i] = -(double)batch->law.force_rate / w * (double)ways[k][lane][i];
        if (!(w > 0))
            continue;
        pel_vec3_subtract(x[k], mean, arm);
        pel_vec3_cross(arm, force, torque);
        pel_vec3_add(share->force, force, share->force);
        pel_vec3_add(share->torque, torque, share->torque);
    }
    return true;
}

/* the turn w of the fixed vertices about their mean with sum r x (w x r) = torque, as if each had the mass 1; none
   about a line on which all lie, about which there is no torque */
static void find_turn(const held_share *share, double turn[3])
{
    double m[3][3] = {{0}}, square = 0, inverse[3][3];
    for (int i = 0; i < share->count; i++)
        square += pel_vec3_squared_length(share->point[i]);
    pel_vec3_set(turn, 0, 0, 0);
    if (!(square > 0))
        return;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            m[a][b] = a == b ? (1 + 1e-9) * square : 0;
            for (int i = 0; i < share->count; i++)
                m[a][b] -= share->point[i][a] * share->point[i][b];
        }
    pel_vec3_cross(m[1], m[2], inverse[0]);
    pel_vec3_cross(m[2], m[0], inverse[1]);
    pel_vec3_cross(m[0], m[1], inverse[2]);
    double determinant = pel_vec3_dot(m[0], inverse[0]);
    for (int a = 0; a < 3 && determinant > 0; a++)
        turn[a] = pel_vec3_dot(inverse[a], share->torque) / determinant;
}

/* Distribute the force evenly over fixed vertices, and the torque as a rotation about their mean. */
static void record_lane(const pel_batch *batch, const pel_record *positions, const int32_t *steps, int32_t lane,
                        pel_record (*ways)[PEL_BLOCK])
{
    held_share share;
    double turn[3];
    if (!find_held_share(batch, positions, steps, lane, ways, &share))
        return;
    find_turn(&share, turn);
    for (int i = 0; i < share.count; i++) {
        double force[3];
        pel_vec3_cross(turn, share.point[i], force);
        pel_vec3_along(force, 1.0 / share.count, share.force, force);
        pel_record sum = {(pel_real)force[0], (pel_real)force[1], (pel_real)force[2], 0};
        pel_record_set(batch->reaction, share.step[i], pel_record_get(batch->reaction, share.step[i]) + sum);
    }
}

/* before the points of a block move */
static __attribute__((noinline, cold)) void record_reactions(const pel_batch *batch, int32_t block, int32_t lane,
                                                             const pel_record *positions, const pel_lane3 *ways)
{
    pel_record stored[4][PEL_BLOCK];
    const int32_t *steps = steps_of(batch, block, 0);
    for (int k = 0; k < batch->arity; k++)
        pel_lane3_store(stored[k] + lane, ways[k]);
    int32_t end = pel_lane_passes(batch->lane_counts[block]) > 1 ? lane + 1 : batch->lane_counts[block];
    for (int32_t l = lane; l < end; l++)
        record_lane(batch, positions, steps, l, stored);
}

#ifdef PEL_LANE_SCALAR
enum { IS_WIDE = 0 };
#else
enum { IS_WIDE = 1 };
#endif

/* behind the blocks from .. on that hold no fixed vertex */
static inline int32_t free_end(const pel_batch *batch, int32_t from, int32_t end)
{
    const uint8_t *held = batch->has_fixed != NULL ? memchr(batch->has_fixed + from, 1, (size_t)(end - from)) : NULL;
    return held != NULL ? (int32_t)(held - batch->has_fixed) : end;
}

/* The blocks from begin to end - 1: call finds the ways of a block's points. The batch is copied: what is stored cannot
   change a local, so its fields stay in registers. */
#define PEL_PROJECT_BLOCKS(name, corners, call)                                                                        \
    PEL_INLINE void name##_blocks(const pel_batch *given, int32_t begin, int32_t end, pel_record *positions,           \
                                  bool records)                                                                        \
    {                                                                                                                  \
        pel_batch own = *given, *batch = &own;                                                                         \
        pel_lane3 staged[PEL_BATCH_GROUP][corners];                                                                    \
        pel_particle points[4];                                                                                        \
        own.arity = corners;                                                                                           \
        for (int32_t from = begin, to; from < end; from = to) {                                                        \
            to = group_end(batch, from);                                                                               \
            for (int32_t block = from; block < to; block++)                                                            \
                for (int32_t lane = 0; lane < pel_lane_passes(batch->lane_counts[block]); lane++) {                    \
                    pel_lane3 *ways = staged[block - from];                                                            \
                    call;                                                                                              \
                    if (records && own.has_fixed != NULL && own.has_fixed[block])                                      \
                        record_reactions(batch, block, lane, positions, ways);                                         \
                    if (!IS_WIDE)                                                                                      \
                        move_points(batch, block, lane, points, ways, positions);                                      \
                }                                                                                                      \
            for (int32_t block = from; IS_WIDE && block < to; block++)                                                 \
                move_points(batch, block, 0, points, staged[block - from], positions);                                 \
        }                                                                                                              \
        (void)points;                                                                                                  \
    }

/* the sweep of a kind */
#define PEL_PROJECT_SWEEP(name, corners, call)                                                                         \
    PEL_PROJECT_BLOCKS(name, corners, call)                                                                            \
    static void name(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions)                        \
    {                                                                                                                  \
        name##_blocks(batch, begin, end, positions, true);                                                             \
    }

/* The same for bending under pbd. In float the mere branch to the record of reactions, between the ways of four points
   and their moves, costs a tenth of the sweep: there blocks with fixed vertices go through a copy of the loop. The
   other kinds lose by it (bending under xpbd a tenth). */
#define PEL_PROJECT_SPLIT_SWEEP(name, corners, call)                                                                   \
    PEL_PROJECT_BLOCKS(name, corners, call)                                                                            \
    static __attribute__((noinline)) void name##_all(const pel_batch *batch, int32_t begin, int32_t end,               \
                                                     pel_record *positions)                                            \
    {                                                                                                                  \
        name##_blocks(batch, begin, end, positions, true);                                                             \
    }                                                                                                                  \
    static void name(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions)                        \
    {                                                                                                                  \
        if (is_staged(corners)) {                                                                                      \
            name##_all(batch, begin, end, positions);                                                                  \
            return;                                                                                                    \
        }                                                                                                              \
        for (int32_t held; begin < end; begin = held + 1) {                                                            \
            held = free_end(batch, begin, end);                                                                        \
            name##_blocks(batch, begin, held, positions, false);                                                       \
            if (held < end)                                                                                            \
                name##_all(batch, held, held + 1, positions);                                                          \
        }                                                                                                              \
    }

PEL_PROJECT_SWEEP(sweep_distance, 2, project_edge(batch, block, lane, positions, ways, false))
PEL_PROJECT_SWEEP(sweep_spring, 2, project_edge(batch, block, lane, positions, ways, true))
#define PEL_PROJECT_LAW(KIND, law, name)                                                                               \
    PEL_PROJECT_SWEEP(sweep_##law, 3, project_membrane(batch, block, lane, positions, ways, PEL_MEMBRANE_##KIND))      \
    PEL_PROJECT_SWEEP(sweep_soft_##law, 3, project_strain(batch, block, lane, positions, ways, PEL_MEMBRANE_##KIND))
PEL_MEMBRANE_LAWS(PEL_PROJECT_LAW)
#define PEL_PROJECT_SOLID(KIND, name, word)                                                                            \
    PEL_PROJECT_SWEEP(sweep_solid_##name, 4, project_tetra(batch, block, lane, positions, ways, PEL_VOLUME_##KIND))
PEL_VOLUME_LAWS(PEL_PROJECT_SOLID)
PEL_PROJECT_SPLIT_SWEEP(sweep_bending, 4, project_isometric(batch, block, lane, positions, points, ways, false))
PEL_PROJECT_SWEEP(sweep_soft_bending, 4, project_isometric(batch, block, lane, positions, points, ways, true))
PEL_PROJECT_SPLIT_SWEEP(sweep_hinge, 4,
                        project_angle(batch, block, lane, positions, points, ways, false, PEL_ANGLE_NUMBERS))
PEL_PROJECT_SWEEP(sweep_soft_hinge, 4,
                  project_angle(batch, block, lane, positions, points, ways, true, PEL_ANGLE_NUMBERS))
PEL_PROJECT_SWEEP(sweep_fold, 4, project_angle(batch, block, lane, positions, points, ways, true, PEL_FOLD_NUMBERS))
PEL_PROJECT_SWEEP(sweep_fibre, 3, project_fibre(batch, block, lane, positions, ways, false, false))
PEL_PROJECT_SWEEP(sweep_fibre_square, 3, project_fibre(batch, block, lane, positions, ways, true, false))
PEL_PROJECT_SWEEP(sweep_soft_fibre, 3, project_fibre(batch, block, lane, positions, ways, false, true))
PEL_PROJECT_SWEEP(sweep_soft_fibre_square, 3, project_fibre(batch, block, lane, positions, ways, true, true))
PEL_PROJECT_SWEEP(sweep_muscle, 3, project_muscle(batch, block, lane, positions, ways))
PEL_PROJECT_SWEEP(pass_limit, 3, project_limit(batch, block, lane, positions, ways))

/* A limit has no multiplier that one sweep could leave to the next one, so it passes several times: a strip of 16
   triangles under ten times its weight exceeds a limit of 10 % by 1.2 % after one pass of each substep. */
static void sweep_limit(const pel_batch *batch, int32_t begin, int32_t end, pel_record *positions)
{
    for (int pass = 0; pass < PEL_LIMIT_PASSES; pass++)
        pass_limit(batch, begin, end, positions);
}

PEL_PROJECT_SWEEP(sweep_cave, 3, project_cave(batch, block, lane, positions, ways))
PEL_PROJECT_SWEEP(sweep_normal, 3, project_normal(batch, block, lane, positions, ways, false))
PEL_PROJECT_SWEEP(sweep_normal_square, 3, project_normal(batch, block, lane, positions, ways, true))

#define PEL_PROJECT_LAW_ROW(KIND, law, name)                                                                           \
    [PEL_CONSTRAINT_MEMBRANE + PEL_MEMBRANE_##KIND] = sweep_##law,                                                     \
                               [PEL_CONSTRAINT_STRAIN + PEL_MEMBRANE_##KIND] = sweep_soft_##law,
#define PEL_PROJECT_SOLID_ROW(KIND, name, word) [PEL_CONSTRAINT_SOLID + PEL_VOLUME_##KIND] = sweep_solid_##name,
#define PEL_PROJECT_TABLE                                                                                              \
    {                                                                                                                  \
        [PEL_CONSTRAINT_DISTANCE] = sweep_distance, [PEL_CONSTRAINT_SPRING] = sweep_spring,                            \
        PEL_MEMBRANE_LAWS(PEL_PROJECT_LAW_ROW)[PEL_CONSTRAINT_ISOMETRIC] = sweep_bending,                              \
        [PEL_CONSTRAINT_ISOMETRIC_COMPLIANT] = sweep_soft_bending, [PEL_CONSTRAINT_ANGLE] = sweep_hinge,               \
        [PEL_CONSTRAINT_ANGLE_COMPLIANT] = sweep_soft_hinge, [PEL_CONSTRAINT_FOLD] = sweep_fold,                       \
        [PEL_CONSTRAINT_FIBRE] = sweep_fibre, [PEL_CONSTRAINT_FIBRE_SQUARE] = sweep_fibre_square,                      \
        [PEL_CONSTRAINT_FIBRE_COMPLIANT] = sweep_soft_fibre,                                                           \
        [PEL_CONSTRAINT_FIBRE_SQUARE_COMPLIANT] = sweep_soft_fibre_square, [PEL_CONSTRAINT_CAVE] = sweep_cave,         \
        [PEL_CONSTRAINT_MUSCLE] = sweep_muscle, [PEL_CONSTRAINT_NORMAL] = sweep_normal,                                \
        [PEL_CONSTRAINT_NORMAL_SQUARE] = sweep_normal_square,                                                          \
        PEL_VOLUME_LAWS(PEL_PROJECT_SOLID_ROW)[PEL_CONSTRAINT_LIMIT] = sweep_limit,                                    \
    }

#endif
