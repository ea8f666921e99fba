/* The elements of a triangle, membrane and mid-edge bending, with gradient, Hessian and extrapolation. Written once
   over pel_lane (base/lane.h): a triangle (measure/tangent.c, measure/midedge.c), or one in each lane
   (force/tangent_triangles.c). Every lane has the bits of the single triangle. */
#ifndef PEL_MEASURE_TANGENT_TRIANGLE_H
#define PEL_MEASURE_TANGENT_TRIANGLE_H

#include "measure/face_turn.h"
#include "measure/membrane.h"
#include "measure/midedge.h"
#include "measure/strain_point.h"

/* ---- membrane ---- */

/* pel_rest_triangle and pel_membrane_law */
typedef struct pel_sheet {
    pel_lane inverse[3], area;
    pel_membrane_kind kind;
    pel_lane modulus, numbers[PEL_LAW_NUMBERS];
} pel_sheet;

/* the columns of F as sums over the corners: f1 = sum_a weight[0][a] x_a */
typedef struct pel_sheet_shape {
    pel_lane weight[2][3];
    pel_gradient f;
} pel_sheet_shape;

PEL_INLINE pel_sheet_shape pel_sheet_shape_of(const pel_sheet *sheet, const pel_lane3 x[3])
{
    const pel_lane *i = sheet->inverse;
    pel_sheet_shape shape = {.weight = {{i[0], pel_lane_splat(0), -i[0]}, {i[1], i[2], -(i[1] + i[2])}}};
    shape.f = pel_gradient_of(pel_lane3_subtract(x[0], x[2]), pel_lane3_subtract(x[1], x[2]), i[0], i[1], i[2]);
    return shape;
}

/* row of B: sum over the corners of (weight1 p + weight2 q) . dx */
PEL_INLINE void pel_sheet_row(const pel_sheet_shape *shape, pel_lane3 p, pel_lane3 q, pel_lane row[9])
{
    for (int a = 0; a < 3; a++)
        pel_strain_row_set(&row[3 * a], pel_lane3_combine(shape->weight[0][a], p, shape->weight[1][a], q));
}

PEL_INLINE void pel_sheet_respond(const pel_sheet *sheet, const pel_strain *strain, pel_tangent_kind kind,
                                  pel_strain_point *point, pel_response *at)
{
    pel_respond(sheet->kind, sheet->numbers, strain, at);
    const pel_lane scale = sheet->area * sheet->modulus;
    const pel_symmetric3 *d = kind == PEL_TANGENT_POSITIVE ? &at->positive : &at->tangent;
    const pel_lane packed[6] = {d->a11, d->a12, d->a13, d->a22, d->a23, d->a33};
    pel_strain_tangent_set(packed, scale, point);
    point->energy = scale * at->energy;
    point->strain[0] = strain->strain.a;
    point->strain[1] = strain->strain.b;
    point->strain[2] = strain->strain.c;
    point->stress[0] = scale * at->stress.a;
    point->stress[1] = scale * at->stress.b;
    point->stress[2] = scale * at->stress.c;
}

PEL_INLINE void pel_sheet_green(const pel_sheet *sheet, const pel_sheet_shape *shape, pel_tangent_kind kind,
                                pel_strain_point *point)
{
    const pel_lane3 zero = {pel_lane_splat(0), pel_lane_splat(0), pel_lane_splat(0)};
    const pel_strain strain = pel_green_strain(&shape->f);
    pel_response at;
    pel_sheet_respond(sheet, &strain, kind, point, &at);
    if (pel_law_traits(sheet->kind) & PEL_LAW_BY_AREA) {
        /* 2 psi_t I + psi_J / J adj C: laws bound J in their stress, P = F t holds with J itself */
        const pel_lane scale = sheet->area * sheet->modulus, trace = pel_lane_splat(2) * scale * at.by_trace;
        const pel_lane pull = scale * at.by_area * pel_lane_quotient(pel_lane_splat(1), strain.area_ratio);
        point->stress[0] = trace + pull * strain.cauchy.b;
        point->stress[1] = trace + pull * strain.cauchy.a;
        point->stress[2] = -pull * strain.cauchy.c;
    }
    pel_sheet_row(shape, shape->f.f1, zero, point->gradient[0]);
    pel_sheet_row(shape, zero, shape->f.f2, point->gradient[1]);
    pel_sheet_row(shape, shape->f.f2, shape->f.f1, point->gradient[2]);
}

/* the tensile part of a symmetric 2 x 2 stress (11, 22, 12) */
PEL_INLINE void pel_sheet_clamp(pel_lane stress[3])
{
    const pel_lane half = PEL_CONSTANT(0.5), zero = pel_lane_splat(0);
    const pel_lane mean = half * (stress[0] + stress[1]), difference = half * (stress[0] - stress[1]);
    const pel_lane size = pel_lane_sqrt(difference * difference + stress[2] * stress[2]);
    const pel_lane high = pel_lane_max(mean + size, zero), low = pel_lane_max(mean - size, zero);
    const pel_lane centre = half * (high + low);
    const pel_lane scale = half * (high - low) * pel_lane_quotient(pel_lane_splat(1), size);
    stress[0] = centre + scale * difference;
    stress[1] = centre - scale * difference;
    stress[2] = scale * stress[2];
}

/* t11 Hess e11 + ...: (w1 t11 w1 + w2 t22 w2 + w1 t12 w2 + w2 t12 w1) times the unit matrix */
PEL_INLINE void pel_sheet_green_geometric(const pel_sheet_shape *shape, const pel_lane stress[3], pel_lead_matrix *lead)
{
    const pel_lane *p = shape->weight[0], *q = shape->weight[1];
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) {
            const pel_lane scale = stress[0] * p[a] * p[b] + stress[1] * q[a] * q[b];
            pel_lead_add_unit(lead, a, b, scale + stress[2] * (p[a] * q[b] + q[a] * p[b]));
        }
}

/* ---- membrane in the frame of its first axis ---- */

/* strains (a - 1, c - 1, b) of the triangle factor: a = |f1|, b = f1 . f2 / a, c = |f1 x f2| / a */
PEL_INLINE void pel_sheet_aligned(const pel_sheet *sheet, const pel_sheet_shape *shape, const pel_factor *factor,
                                  pel_tangent_kind kind, pel_strain_point *point)
{
    const pel_lane3 zero = {pel_lane_splat(0), pel_lane_splat(0), pel_lane_splat(0)};
    const pel_strain strain = pel_factor_strain(factor);
    pel_response at;
    pel_sheet_respond(sheet, &strain, kind, point, &at);
    const pel_lane inverse = pel_lane_quotient(pel_lane_splat(1), factor->a);
    pel_sheet_row(shape, factor->t1, zero, point->gradient[0]);
    pel_sheet_row(shape, pel_lane3_scale(factor->t2, -factor->b * inverse), factor->t2, point->gradient[1]);
    pel_sheet_row(shape, pel_lane3_scale(factor->t2, factor->c * inverse), factor->t1, point->gradient[2]);
}

/* a function of F (6 numbers, f1 before f2): value, gradient, Hessian */
typedef struct pel_jet6 {
    pel_lane value, gradient[6], hessian[6][6];
} pel_jet6;

PEL_INLINE pel_jet6 pel_jet6_zero(pel_lane value)
{
    pel_jet6 jet = {.value = value};
    for (int i = 0; i < 6; i++) {
        jet.gradient[i] = pel_lane_splat(0);
        for (int j = 0; j < 6; j++)
            jet.hessian[i][j] = pel_lane_splat(0);
    }
    return jet;
}

PEL_INLINE pel_jet6 pel_jet6_of_first_length(const pel_factor *r)
{
    const pel_lane t1[3] = {r->t1.x, r->t1.y, r->t1.z}, inverse = pel_lane_quotient(pel_lane_splat(1), r->a);
    pel_jet6 jet = pel_jet6_zero(r->a);
    for (int i = 0; i < 3; i++) {
        jet.gradient[i] = t1[i];
        for (int j = 0; j < 3; j++)
            jet.hessian[i][j] = inverse * (pel_lane_splat(i == j) - t1[i] * t1[j]);
    }
    return jet;
}

PEL_INLINE pel_jet6 pel_jet6_of_product(const pel_gradient *f)
{
    pel_jet6 jet = pel_jet6_zero(pel_lane3_dot(f->f1, f->f2));
    pel_strain_row_set(jet.gradient, f->f2);
    pel_strain_row_set(jet.gradient + 3, f->f1);
    for (int i = 0; i < 3; i++)
        jet.hessian[i][3 + i] = jet.hessian[3 + i][i] = pel_lane_splat(1);
    return jet;
}

/* |f1 x f2|: its Hessian is the Hessian of n . (f1 x f2) at fixed n plus the projection of d(f1 x f2) off n over the
   length */
PEL_INLINE pel_jet6 pel_jet6_of_area(const pel_factor *r, const pel_gradient *f)
{
    const pel_lane3 normal = pel_lane3_cross(r->t1, r->t2), t[2] = {r->t1, r->t2};
    const pel_lane n[3] = {normal.x, normal.y, normal.z};
    pel_jet6 jet = pel_jet6_zero(r->a * r->c);
    const pel_lane inverse = pel_lane_quotient(pel_lane_splat(1), jet.value);
    pel_lane row[2][6];
    pel_strain_row_set(jet.gradient, pel_lane3_cross(f->f2, normal));
    pel_strain_row_set(jet.gradient + 3, pel_lane3_cross(normal, f->f1));
    for (int k = 0; k < 2; k++) {
        pel_strain_row_set(row[k], pel_lane3_cross(f->f2, t[k]));
        pel_strain_row_set(row[k] + 3, pel_lane3_cross(t[k], f->f1));
    }
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            jet.hessian[i][j] = inverse * (row[0][i] * row[0][j] + row[1][i] * row[1][j]);
    /* df1 . (df2 x n) */
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        jet.hessian[i][3 + j] += n[k];
        jet.hessian[j][3 + i] -= n[k];
        jet.hessian[3 + j][i] += n[k];
        jet.hessian[3 + i][j] -= n[k];
    }
    return jet;
}

/* adds scale times the Hessian of q / a */
PEL_INLINE void pel_jet6_add_quotient(const pel_jet6 *q, const pel_jet6 *a, pel_lane scale, pel_lane hessian[6][6])
{
    const pel_lane inverse = pel_lane_quotient(pel_lane_splat(1), a->value), ratio = q->value * inverse;
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) {
            const pel_lane cross = q->gradient[i] * a->gradient[j] + a->gradient[i] * q->gradient[j];
            const pel_lane own = pel_lane_splat(2) * a->gradient[i] * a->gradient[j] * inverse - a->hessian[i][j];
            hessian[i][j] += scale * inverse * (q->hessian[i][j] - cross * inverse + ratio * own);
        }
}

PEL_INLINE void pel_sheet_aligned_geometric(const pel_sheet_shape *shape, const pel_factor *r, const pel_lane stress[3],
                                            pel_lead_matrix *lead)
{
    const pel_jet6 length = pel_jet6_of_first_length(r), product = pel_jet6_of_product(&shape->f);
    const pel_jet6 area = pel_jet6_of_area(r, &shape->f);
    pel_lane hessian[6][6];
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            hessian[i][j] = stress[0] * length.hessian[i][j];
    pel_jet6_add_quotient(&area, &length, stress[1], hessian);
    pel_jet6_add_quotient(&product, &length, stress[2], hessian);
    for (int a = 0; a < 6; a++)
        for (int b = 0; b < 6; b++)
            for (int p = 0; p < 2; p++)
                for (int q = 0; q < 2; q++)
                    lead->entry[a][b] +=
                        shape->weight[p][a / 3] * shape->weight[q][b / 3] * hessian[3 * p + a % 3][3 * q + b % 3];
}

/* pel_membrane_tangent */
PEL_INLINE pel_lane pel_sheet_tangent(const pel_sheet *sheet, const pel_lane3 x[3], const pel_strain_request *request,
                                      const pel_strain_sum *sum)
{
    const pel_sheet_shape shape = pel_sheet_shape_of(sheet, x);
    const bool positive = request->kind == PEL_TANGENT_POSITIVE, geometric = sum->hessian != NULL;
    pel_strain_point point;
    pel_lead_matrix lead;
    if (geometric)
        pel_lead_clear(&lead, 3);
    if (pel_law_traits(sheet->kind) & PEL_LAW_ALIGNED) {
        const pel_factor factor = pel_factor_of(&shape.f);
        pel_sheet_aligned(sheet, &shape, &factor, request->kind, &point);
        pel_strain_damp(&point, PEL_MEMBRANE_STRAINS, request);
        if (geometric && !positive)
            pel_sheet_aligned_geometric(&shape, &factor, pel_strain_geometric(&point, request), &lead);
    } else {
        pel_sheet_green(sheet, &shape, request->kind, &point);
        pel_strain_damp(&point, PEL_MEMBRANE_STRAINS, request);
        const pel_lane *at = pel_strain_geometric(&point, request);
        pel_lane stress[3] = {at[0], at[1], at[2]};
        if (positive)
            pel_sheet_clamp(stress);
        if (geometric)
            pel_sheet_green_geometric(&shape, stress, &lead);
    }
    pel_strain_add(&point, PEL_MEMBRANE_STRAINS, 3, 0, &lead, request, sum);
    return point.energy;
}

/* ---- mid-edge bending ---- */

/* pel_midedge_moments */
PEL_INLINE void pel_plate_moments(const pel_lane k[6], const pel_lane alpha[3], pel_lane moment[3])
{
    moment[0] = k[0] * alpha[0] + k[1] * alpha[1] + k[2] * alpha[2];
    moment[1] = k[1] * alpha[0] + k[3] * alpha[1] + k[4] * alpha[2];
    moment[2] = k[2] * alpha[0] + k[4] * alpha[1] + k[5] * alpha[2];
}

/* sum over the edges of moment times the Hessian of gamma; all share one normal */
PEL_INLINE void pel_plate_geometric(const pel_face_turn turn[3], const pel_lane moment[3], pel_lead_matrix *lead)
{
    const pel_lane3 zero = {pel_lane_splat(0), pel_lane_splat(0), pel_lane_splat(0)};
    pel_lane3 v[2][2] = {{zero, zero}, {zero, zero}};
    /* edge l has tail l, head l + 1, tip l + 2 */
    for (int l = 0; l < 3; l++)
        for (int i = 0; i < 2; i++)
            for (int j = 0; j < 2; j++)
                v[i][j] = pel_face_turn_add_second(&turn[l], moment[l], (i + 3 - l) % 3, (j + 3 - l) % 3, v[i][j]);
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            pel_lead_add_product(lead, i, j, v[i][j], turn[0].normal);
            pel_lead_add_product(lead, i, j, turn[0].normal, v[j][i]);
        }
}

/* pel_midedge_tangent */
PEL_INLINE pel_lane pel_plate_tangent(const pel_lane stiffness[6], const pel_lane alpha[3], const pel_lane sign[3],
                                      const pel_lane3 x[3], const pel_strain_request *request,
                                      const pel_strain_sum *sum)
{
    pel_face_turn turn[3];
    pel_strain_point point;
    pel_plate_moments(stiffness, alpha, point.stress);
    point.energy =
        PEL_CONSTANT(0.5) * (alpha[0] * point.stress[0] + alpha[1] * point.stress[1] + alpha[2] * point.stress[2]);
    for (int l = 0; l < 3; l++)
        point.strain[l] = alpha[l];
    pel_strain_tangent_set(stiffness, pel_lane_splat(1), &point);
    pel_strain_damp(&point, PEL_MIDEDGE_STRAINS, request);
    if (sum->gradient == NULL && sum->hessian == NULL && request->extrapolated == NULL)
        return point.energy;
    pel_lead_matrix lead;
    if (sum->hessian != NULL)
        pel_lead_clear(&lead, 3);
    for (int l = 0; l < 3; l++) {
        turn[l] = pel_face_turn_of(x[l], x[(l + 1) % 3], x[(l + 2) % 3]);
        for (int i = 0; i < 3; i++)
            pel_strain_row_set(&point.gradient[l][3 * ((l + i) % 3)],
                               pel_lane3_scale(turn[l].normal, pel_face_turn_slope(&turn[l], i)));
        for (int k = 0; k < 3; k++)
            point.gradient[l][9 + k] = k == l ? sign[l] : pel_lane_splat(0);
    }
    if (sum->hessian != NULL && request->kind != PEL_TANGENT_POSITIVE)
        pel_plate_geometric(turn, pel_strain_geometric(&point, request), &lead);
    pel_strain_add(&point, PEL_MIDEDGE_STRAINS, 3, 3, &lead, request, sum);
    return point.energy;
}

#endif
