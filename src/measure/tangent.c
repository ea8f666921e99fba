#define PEL_LANE_DOUBLE
#include "measure/tangent.h"

#include "math/functions.h"
#include "math/vec3.h"
#include "measure/face_turn.h"
#include "measure/membrane.h"
#include "measure/strain_point.h"

#include <math.h>

/* ---- membrane ---- */

/* the columns of F as sums over the corners: f1 = sum_a weight[0][a] x_a */
typedef struct triangle_shape {
    double weight[2][3];
    double f1[3], f2[3];
} triangle_shape;

static triangle_shape shape_of(const pel_rest_triangle *rest, const double *x)
{
    const double *i = rest->inverse;
    triangle_shape shape = {.weight = {{i[0], 0, -i[0]}, {i[1], i[2], -(i[1] + i[2])}}};
    for (int c = 0; c < 3; c++) {
        double first = x[c] - x[6 + c], second = x[3 + c] - x[6 + c];
        shape.f1[c] = i[0] * first;
        shape.f2[c] = i[1] * first + i[2] * second;
    }
    return shape;
}

/* row of B: sum over the corners of (weight1 p + weight2 q) . dx */
static void set_strain_row(const triangle_shape *shape, const double p[3], const double q[3], double row[9])
{
    for (int a = 0; a < 3; a++)
        for (int c = 0; c < 3; c++)
            row[3 * a + c] = shape->weight[0][a] * p[c] + shape->weight[1][a] * q[c];
}

static void set_law(const pel_membrane_law *law, double area, const pel_strain *strain, pel_tangent_kind kind,
                    pel_strain_point *point, pel_response *at)
{
    pel_respond(law->kind, law->numbers, strain, at);
    double scale = area * law->modulus;
    const pel_symmetric3 *d = kind == PEL_TANGENT_POSITIVE ? &at->positive : &at->tangent;
    const double packed[6] = {d->a11, d->a12, d->a13, d->a22, d->a23, d->a33};
    pel_strain_tangent_set(packed, scale, point);
    point->energy = scale * at->energy;
    pel_vec3_set(point->stress, scale * at->stress.a, scale * at->stress.b, scale * at->stress.c);
}

static void set_green(const pel_rest_triangle *rest, const pel_membrane_law *law, const triangle_shape *shape,
                      pel_tangent_kind kind, pel_strain_point *point)
{
    static const double zero[3] = {0, 0, 0};
    const pel_gradient f = {{shape->f1[0], shape->f1[1], shape->f1[2]}, {shape->f2[0], shape->f2[1], shape->f2[2]}};
    pel_strain strain = pel_green_strain(&f);
    pel_response at;
    set_law(law, rest->area, &strain, kind, point, &at);
    if (pel_law_traits(law->kind) & PEL_LAW_BY_AREA) {
        /* 2 psi_t I + psi_J / J adj C: laws bound J in their stress, P = F t holds with J itself */
        double scale = rest->area * law->modulus, pull = scale * at.by_area * pel_inverse_or_zero(strain.area_ratio);
        double trace = 2 * scale * at.by_trace;
        pel_vec3_set(point->stress, trace + pull * strain.cauchy.b, trace + pull * strain.cauchy.a,
                     -pull * strain.cauchy.c);
    }
    set_strain_row(shape, shape->f1, zero, point->gradient[0]);
    set_strain_row(shape, zero, shape->f2, point->gradient[1]);
    set_strain_row(shape, shape->f2, shape->f1, point->gradient[2]);
}

/* the tensile part of a symmetric 2 x 2 stress (11, 22, 12) */
static void clamp_stress(const double stress[3], double positive[3])
{
    double mean = 0.5 * (stress[0] + stress[1]), difference = 0.5 * (stress[0] - stress[1]);
    double size = pel_hypot(difference, stress[2]), high = fmax(mean + size, 0), low = fmax(mean - size, 0);
    double centre = 0.5 * (high + low), scale = 0.5 * (high - low) * pel_inverse_or_zero(size);
    pel_vec3_set(positive, centre + scale * difference, centre - scale * difference, scale * stress[2]);
}

/* t11 Hess e11 + ...: (w1 t11 w1 + w2 t22 w2 + w1 t12 w2 + w2 t12 w1) times the unit matrix */
static void add_green_geometric(const triangle_shape *shape, const double stress[3], pel_lead_matrix *lead)
{
    const double *p = shape->weight[0], *q = shape->weight[1];
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) {
            double scale = stress[0] * p[a] * p[b] + stress[1] * q[a] * q[b];
            pel_lead_add_unit(lead, a, b, scale + stress[2] * (p[a] * q[b] + q[a] * p[b]));
        }
}

/* ---- membrane in the frame of its first axis ---- */

/* strains (a - 1, c - 1, b) of the triangle factor: a = |f1|, b = f1 . f2 / a, c = |f1 x f2| / a */
static void set_aligned(const pel_rest_triangle *rest, const pel_membrane_law *law, const triangle_shape *shape,
                        const pel_factor *factor, pel_tangent_kind kind, pel_strain_point *point)
{
    static const double zero[3] = {0, 0, 0};
    pel_strain strain = pel_factor_strain(factor);
    pel_response at;
    set_law(law, rest->area, &strain, kind, point, &at);
    const double t1[3] = {factor->t1.x, factor->t1.y, factor->t1.z}, t2[3] = {factor->t2.x, factor->t2.y, factor->t2.z};
    double inverse = pel_inverse_or_zero(factor->a), turned[3];
    set_strain_row(shape, t1, zero, point->gradient[0]);
    pel_vec3_scale(t2, -factor->b * inverse, turned);
    set_strain_row(shape, turned, t2, point->gradient[1]);
    pel_vec3_scale(t2, factor->c * inverse, turned);
    set_strain_row(shape, turned, t1, point->gradient[2]);
}

/* a function of F (6 numbers, f1 before f2): value, gradient, Hessian */
typedef struct jet6 {
    double value, gradient[6], hessian[6][6];
} jet6;

static jet6 jet_of_first_length(const pel_factor *r, const double t1[3])
{
    jet6 jet = {.value = r->a};
    for (int i = 0; i < 3; i++) {
        jet.gradient[i] = t1[i];
        for (int j = 0; j < 3; j++)
            jet.hessian[i][j] = pel_inverse_or_zero(r->a) * ((i == j) - t1[i] * t1[j]);
    }
    return jet;
}

static jet6 jet_of_product(const double f1[3], const double f2[3])
{
    jet6 jet = {.value = pel_vec3_dot(f1, f2)};
    for (int i = 0; i < 3; i++) {
        jet.gradient[i] = f2[i];
        jet.gradient[3 + i] = f1[i];
        jet.hessian[i][3 + i] = jet.hessian[3 + i][i] = 1;
    }
    return jet;
}

/* |f1 x f2|: its Hessian is the Hessian of n . (f1 x f2) at fixed n plus the projection of d(f1 x f2) off n over the
   length */
static jet6 jet_of_area(const pel_factor *r, const double f1[3], const double f2[3], const double t[2][3],
                        const double n[3])
{
    jet6 jet = {.value = r->a * r->c};
    double row[2][6], inverse = pel_inverse_or_zero(jet.value);
    pel_vec3_cross(f2, n, jet.gradient);
    pel_vec3_cross(n, f1, jet.gradient + 3);
    for (int k = 0; k < 2; k++) {
        pel_vec3_cross(f2, t[k], row[k]);
        pel_vec3_cross(t[k], f1, row[k] + 3);
    }
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            jet.hessian[i][j] = inverse * (row[0][i] * row[0][j] + row[1][i] * row[1][j]);
    /* df1 . (df2 x n) */
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        jet.hessian[i][3 + j] += n[k];
        jet.hessian[j][3 + i] -= n[k];
        jet.hessian[3 + j][i] += n[k];
        jet.hessian[3 + i][j] -= n[k];
    }
    return jet;
}

/* adds scale times the Hessian of q / a */
static void add_quotient(const jet6 *q, const jet6 *a, double scale, double hessian[6][6])
{
    double inverse = pel_inverse_or_zero(a->value), ratio = q->value * inverse;
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++) {
            double cross = q->gradient[i] * a->gradient[j] + a->gradient[i] * q->gradient[j];
            double own = 2 * a->gradient[i] * a->gradient[j] * inverse - a->hessian[i][j];
            hessian[i][j] += scale * inverse * (q->hessian[i][j] - cross * inverse + ratio * own);
        }
}

static void add_aligned_geometric(const triangle_shape *shape, const pel_factor *r, const double stress[3],
                                  pel_lead_matrix *lead)
{
    const double t[2][3] = {{r->t1.x, r->t1.y, r->t1.z}, {r->t2.x, r->t2.y, r->t2.z}};
    double normal[3], hessian[6][6];
    pel_vec3_cross(t[0], t[1], normal);
    const jet6 length = jet_of_first_length(r, t[0]), product = jet_of_product(shape->f1, shape->f2);
    const jet6 area = jet_of_area(r, shape->f1, shape->f2, t, normal);
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            hessian[i][j] = stress[0] * length.hessian[i][j];
    add_quotient(&area, &length, stress[1], hessian);
    add_quotient(&product, &length, stress[2], hessian);
    for (int a = 0; a < 6; a++)
        for (int b = 0; b < 6; b++)
            for (int p = 0; p < 2; p++)
                for (int q = 0; q < 2; q++)
                    lead->entry[a][b] +=
                        shape->weight[p][a / 3] * shape->weight[q][b / 3] * hessian[3 * p + a % 3][3 * q + b % 3];
}

double pel_membrane_tangent(const pel_rest_triangle *rest, const pel_membrane_law *law, const double *x,
                            const pel_tangent_request *request, const pel_tangent_sum *sum)
{
    triangle_shape shape = shape_of(rest, x);
    pel_strain_point point;
    pel_lead_matrix lead;
    bool positive = request->kind == PEL_TANGENT_POSITIVE, geometric = sum->hessian != NULL;
    if (geometric)
        pel_lead_clear(&lead, 3);
    if (pel_law_traits(law->kind) & PEL_LAW_ALIGNED) {
        const pel_gradient f = {{shape.f1[0], shape.f1[1], shape.f1[2]}, {shape.f2[0], shape.f2[1], shape.f2[2]}};
        pel_factor factor = pel_factor_of(&f);
        set_aligned(rest, law, &shape, &factor, request->kind, &point);
        if (geometric && !positive)
            add_aligned_geometric(&shape, &factor, pel_strain_geometric(&point, request), &lead);
    } else {
        set_green(rest, law, &shape, request->kind, &point);
        double stress[3];
        pel_vec3_copy(pel_strain_geometric(&point, request), stress);
        if (positive)
            clamp_stress(stress, stress);
        if (geometric)
            add_green_geometric(&shape, stress, &lead);
    }
    pel_strain_add(&point, PEL_MEMBRANE_STRAINS, 3, 0, &lead, request, sum);
    return point.energy;
}

/* ---- lines ---- */

pel_line pel_line_of_spring(double stiffness, double rest_length)
{
    return (pel_line){PEL_LINE_LENGTH, 2, {-1, 1}, stiffness, rest_length};
}

pel_line pel_line_of_fibre(const pel_rest_triangle *rest, bool squared, double stiffness, double rest_length,
                           const double direction[2])
{
    const double *i = rest->inverse;
    double first = direction[0] * i[0] + direction[1] * i[1], second = direction[1] * i[2];
    return (pel_line){squared ? PEL_LINE_SQUARE : PEL_LINE_LENGTH,
                      3,
                      {first, second, -(first + second)},
                      rest->area * stiffness,
                      rest_length};
}

pel_line pel_line_of_isometric(const pel_bending_isometric *stencil, double stiffness)
{
    const double *w = stencil->weight;
    /* D / 3 represents a plate */
    return (pel_line){PEL_LINE_VECTOR, 4, {w[0], w[1], w[2], w[3]}, stiffness / 3 * stencil->factor, 0};
}

/* y, from differences to the first vertex where the weights sum to zero: exact far from the origin */
static double line_vector(const pel_line *line, const double *x, double y[3])
{
    pel_vec3_set(y, 0, 0, 0);
    for (int a = 1; a < line->count; a++)
        for (int c = 0; c < 3; c++)
            y[c] += line->weight[a] * (x[3 * a + c] - x[c]);
    return pel_vec3_length(y);
}

static void set_line_gradient(const pel_line *line, double scale, const double y[3], double *gradient)
{
    for (int a = 0; a < line->count; a++)
        for (int c = 0; c < 3; c++)
            gradient[3 * a + c] = scale * line->weight[a] * y[c];
}

/* adds weight_a weight_b (scale I + radial y y^T) */
static void add_line_blocks(const pel_line *line, double scale, double radial, const double y[3], pel_lead_matrix *lead)
{
    for (int a = 0; a < line->count - 1; a++)
        for (int b = 0; b < line->count - 1; b++) {
            double weight = line->weight[a] * line->weight[b], left[3];
            pel_vec3_scale(y, weight * radial, left);
            pel_lead_add_unit(lead, a, b, weight * scale);
            pel_lead_add_product(lead, a, b, left, y);
        }
}

static double add_line_vector(const pel_line *line, const double y[3], const pel_tangent_sum *sum)
{
    double gradient[PEL_TANGENT_UNKNOWNS];
    set_line_gradient(line, line->stiffness, y, gradient);
    for (int a = 0; sum->gradient != NULL && a < 3 * line->count; a++)
        sum->gradient[a] += gradient[a];
    for (int a = 0; sum->hessian != NULL && a < line->count; a++)
        for (int b = 0; b < line->count; b++)
            for (int c = 0; c < 3; c++)
                sum->hessian[(3 * a + c) * sum->stride + 3 * b + c] +=
                    line->stiffness * line->weight[a] * line->weight[b];
    return 0.5 * line->stiffness * pel_vec3_squared_length(y);
}

double pel_line_tangent(const pel_line *line, const double *x, const pel_tangent_request *request,
                        const pel_tangent_sum *sum)
{
    double y[3], length = line_vector(line, x, y), inverse = pel_inverse_or_zero(length);
    if (line->kind == PEL_LINE_VECTOR)
        return add_line_vector(line, y, sum);
    bool squared = line->kind == PEL_LINE_SQUARE;
    double strain = squared ? length * length - 1 : length - line->rest;
    pel_strain_point point = {.energy = 0.5 * line->stiffness * strain * strain,
                              .stress = {line->stiffness * strain},
                              .tangent = {{line->stiffness}}};
    set_line_gradient(line, squared ? 2 : inverse, y, point.gradient[0]);
    double stress = pel_strain_geometric(&point, request)[0];
    if (request->kind == PEL_TANGENT_POSITIVE)
        stress = fmax(stress, 0);
    pel_lead_matrix lead;
    pel_lead_clear(&lead, line->count);
    if (sum->hessian != NULL && squared)
        add_line_blocks(line, 2 * stress, 0, y, &lead);
    else if (sum->hessian != NULL)
        add_line_blocks(line, stress * inverse, -stress * inverse * inverse * inverse, y, &lead);
    pel_strain_add(&point, PEL_LINE_STRAINS, line->count, 0, &lead, request, sum);
    return point.energy;
}

/* ---- pressure ---- */

double pel_pressure_tangent(double pressure, const double *x, const pel_tangent_request *request,
                            const pel_tangent_sum *sum)
{
    double area[3], product[3];
    pel_vec3_triangle_normal(x, x + 3, x + 6, area);
    for (int a = 0; sum->gradient != NULL && a < 9; a++)
        sum->gradient[a] -= pressure / 6 * area[a % 3];
    pel_vec3_cross(x + 3, x + 6, product);
    double energy = -pressure / 6 * pel_vec3_dot(x, product);
    if (sum->hessian == NULL || request->kind == PEL_TANGENT_POSITIVE)
        return energy;
    /* the block of corners i, i + 1 is -pressure / 12 times the cross product with x_i + x_i+1 - 2 x_i+2 */
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double v[3];
        for (int c = 0; c < 3; c++)
            v[c] = -pressure / 12 * (x[3 * i + c] + x[3 * j + c] - 2 * x[3 * k + c]);
        const double cross[3][3] = {{0, -v[2], v[1]}, {v[2], 0, -v[0]}, {-v[1], v[0], 0}};
        for (int c = 0; c < 3; c++)
            for (int d = 0; d < 3; d++) {
                sum->hessian[(3 * i + c) * sum->stride + 3 * j + d] += cross[c][d];
                sum->hessian[(3 * j + d) * sum->stride + 3 * i + c] += cross[c][d];
            }
    }
    return energy;
}
