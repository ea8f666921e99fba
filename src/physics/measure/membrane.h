/* Strain of a triangle and its derivative. With the columns f1, f2 of F = D_s D_m^-1 the Green strain is (C - I) / 2,
   C = F^T F, and the gradient of the area times psi on the vertices follows from P = d psi / d F (paper B, equation 1).

   The triangle factor [[a, b], [0, c]] of F in the frame of its first column, a = |f1|, b = f2 . t1, c = f2 . t2, has
   the strain (a - 1, c - 1, b). Turning of the frame: d b / d f1 = c t2 / a and d c / d f1 = -b t2 / a. */
#ifndef PEL_MEASURE_MEMBRANE_H
#define PEL_MEASURE_MEMBRANE_H

#include "law/laws.h"

/* columns of F from the edges x0 - x2 and x1 - x2 and the inverse [[i0, i1], [0, i2]] of the rest matrix */
typedef struct pel_gradient {
    pel_lane3 f1, f2;
} pel_gradient;

PEL_INLINE pel_gradient pel_gradient_of(pel_lane3 first, pel_lane3 second, pel_lane i0, pel_lane i1, pel_lane i2)
{
    return (pel_gradient){pel_lane3_scale(first, i0), pel_lane3_combine(i1, first, i2, second)};
}

/* Green strain; the area ratio is the length of f1 x f2 */
PEL_INLINE pel_strain pel_green_strain(const pel_gradient *f)
{
    const pel_lane half = PEL_CONSTANT(0.5), one = pel_lane_splat(1);
    pel_strain s;
    s.cauchy = (pel_symmetric2){pel_lane3_dot(f->f1, f->f1), pel_lane3_dot(f->f2, f->f2), pel_lane3_dot(f->f1, f->f2)};
    s.strain = (pel_symmetric2){half * (s.cauchy.a - one), half * (s.cauchy.b - one), s.cauchy.c};
    pel_lane3 normal = pel_lane3_cross(f->f1, f->f2);
    s.area_square = pel_lane3_dot(normal, normal);
    s.area_ratio = pel_lane_sqrt(s.area_square);
    return s;
}

typedef struct pel_factor {
    pel_lane3 t1, t2;
    pel_lane a, b, c;
} pel_factor;

PEL_INLINE pel_factor pel_factor_of(const pel_gradient *f)
{
    pel_factor r;
    r.a = pel_lane_sqrt(pel_lane3_dot(f->f1, f->f1));
    r.t1 = pel_lane3_scale(f->f1, pel_lane_quotient(pel_lane_splat(1), r.a));
    r.b = pel_lane3_dot(f->f2, r.t1);
    r.t2 = pel_lane3_combine(pel_lane_splat(1), f->f2, -r.b, r.t1);
    r.c = pel_lane_sqrt(pel_lane3_dot(r.t2, r.t2));
    r.t2 = pel_lane3_scale(r.t2, pel_lane_quotient(pel_lane_splat(1), r.c));
    return r;
}

PEL_INLINE pel_strain pel_factor_strain(const pel_factor *r)
{
    const pel_lane one = pel_lane_splat(1);
    pel_strain s = {.strain = {r->a - one, r->c - one, r->b}, .area_ratio = r->a * r->c};
    s.area_square = s.area_ratio * s.area_ratio;
    s.cauchy = (pel_symmetric2){r->a * r->a, r->b * r->b + r->c * r->c, r->a * r->b};
    return s;
}

/* energy and stress of a law for a triangle, and P by columns */
PEL_INLINE pel_lane pel_aligned_stress(pel_membrane_kind kind, const pel_lane *numbers, const pel_gradient *f,
                                       pel_lane3 columns[2])
{
    pel_factor r = pel_factor_of(f);
    pel_strain s = pel_factor_strain(&r);
    pel_response at;
    pel_respond(kind, numbers, &s, &at);
    pel_lane turning = pel_lane_quotient(at.stress.c * r.c - at.stress.b * r.b, r.a);
    columns[0] = pel_lane3_combine(at.stress.a, r.t1, turning, r.t2);
    columns[1] = pel_lane3_combine(at.stress.c, r.t1, at.stress.b, r.t2);
    return at.energy;
}

/* psi and the columns of P = d psi / d F, in units of the shear modulus */
PEL_INLINE pel_lane pel_membrane_stress(pel_membrane_kind kind, const pel_lane *numbers, const pel_gradient *f,
                                        pel_lane3 columns[2])
{
    const int traits = pel_law_traits(kind);
    if (traits & PEL_LAW_ALIGNED)
        return pel_aligned_stress(kind, numbers, f, columns);
    pel_strain s = pel_green_strain(f);
    pel_response at;
    pel_respond(kind, numbers, &s, &at);
    if (traits & PEL_LAW_BY_AREA) {
        /* dJ / dF = [f2 x n, n x f1] with the unit normal n */
        pel_lane3 normal = pel_lane3_cross(f->f1, f->f2);
        normal = pel_lane3_scale(normal, pel_lane_quotient(at.by_area, s.area_ratio));
        pel_lane along = at.by_trace + at.by_trace;
        columns[0] = pel_lane3_add(pel_lane3_scale(f->f1, along), pel_lane3_cross(f->f2, normal));
        columns[1] = pel_lane3_add(pel_lane3_scale(f->f2, along), pel_lane3_cross(normal, f->f1));
    } else {
        columns[0] = pel_lane3_combine(at.stress.a, f->f1, at.stress.c, f->f2);
        columns[1] = pel_lane3_combine(at.stress.c, f->f1, at.stress.b, f->f2);
    }
    return at.energy;
}

#endif
