#define PEL_LANE_DOUBLE
#include "measure/tangent.h"

#include "law/fibre.h"
#include "math/extremes.h"
#include "math/vec3.h"
#include "measure/tangent_triangle.h"

#include <math.h>
#include <string.h>

/* ---- membrane ---- */

double pel_membrane_tangent(const pel_rest_triangle *rest, const pel_membrane_law *law, const double *x,
                            const pel_tangent_request *request, const pel_tangent_sum *sum)
{
    pel_sheet sheet = {.inverse = {rest->inverse[0], rest->inverse[1], rest->inverse[2]},
                       .area = rest->area,
                       .kind = law->kind,
                       .modulus = law->modulus};
    memcpy(sheet.numbers, law->numbers, sizeof sheet.numbers);
    const pel_lane3 corners[3] = {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, {x[6], x[7], x[8]}};
    return pel_sheet_tangent(&sheet, corners, request, sum);
}

/* ---- lines ---- */

pel_line pel_line_of_spring(double stiffness, double rest_length)
{
    return (pel_line){PEL_LINE_LENGTH, 2, {-1, 1}, stiffness, rest_length, 1};
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
                      rest_length,
                      1};
}

pel_line pel_line_of_muscle(const pel_rest_triangle *rest, double stiffness, double optimum, double width,
                            const double direction[2])
{
    pel_line line = pel_line_of_fibre(rest, false, stiffness, optimum, direction);
    line.kind = PEL_LINE_MUSCLE;
    line.width = width;
    return line;
}

pel_line pel_line_of_isometric(const pel_bending_isometric *stencil, double stiffness)
{
    const double *w = stencil->weight;
    /* D / 3 represents a plate */
    return (pel_line){PEL_LINE_VECTOR, 4, {w[0], w[1], w[2], w[3]}, stiffness / 3 * stencil->factor, 0, 1};
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
            const double weight = line->weight[a] * line->weight[b];
            const pel_lane3 right = {y[0], y[1], y[2]};
            pel_lead_add_unit(lead, a, b, weight * scale);
            pel_lead_add_product(lead, a, b, pel_lane3_scale(right, weight * radial), right);
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
    double y[3], length = line_vector(line, x, y), inverse = pel_lane_quotient(1, length);
    if (line->kind == PEL_LINE_VECTOR)
        return add_line_vector(line, y, sum);
    bool squared = line->kind == PEL_LINE_SQUARE;
    double strain = squared ? length * length - 1 : length - line->rest;
    pel_strain_point point = {.energy = 0.5 * line->stiffness * strain * strain,
                              .strain = {strain},
                              .stress = {line->stiffness * strain},
                              .tangent = {{line->stiffness}}};
    if (line->kind == PEL_LINE_MUSCLE) {
        const pel_muscle_response r = pel_law_muscle(length, line->rest, line->width);
        point.energy = line->stiffness * r.energy;
        point.stress[0] = line->stiffness * r.force;
        point.tangent[0][0] = line->stiffness * (request->kind == PEL_TANGENT_POSITIVE ? pel_max(r.slope, 0) : r.slope);
    }
    set_line_gradient(line, squared ? 2 : inverse, y, point.gradient[0]);
    pel_strain_damp(&point, PEL_LINE_STRAINS, request);
    double stress = pel_strain_geometric(&point, request)[0];
    if (request->kind == PEL_TANGENT_POSITIVE)
        stress = pel_max(stress, 0);
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

/* adds the symmetric part of the derivative by corner b along c of the same vector `slope` (3) on each corner */
static void add_push_column(const double slope[3], int b, int c, const pel_tangent_sum *sum)
{
    for (int a = 0; a < 9; a++) {
        double half = 0.5 * slope[a % 3];
        sum->hessian[a * sum->stride + 3 * b + c] += half;
        sum->hessian[(3 * b + c) * sum->stride + a] += half;
    }
}

double pel_push_tangent(const pel_line *fibre, double scale, const double *x, const pel_tangent_request *request,
                        const pel_tangent_sum *sum)
{
    double y[3], normal[3], gradient[PEL_TANGENT_UNKNOWNS], length = line_vector(fibre, x, y);
    bool squared = fibre->kind == PEL_LINE_SQUARE;
    double strain = squared ? length * length - 1 : length - fibre->rest;
    double energy = 0.5 * fibre->stiffness * strain * strain;
    pel_vec3_triangle_normal(x, x + 3, x + 6, normal);
    double size = pel_vec3_length(normal);
    if (strain >= 0 || !(size > 0))
        return 0;
    pel_vec3_scale(normal, 1 / size, normal);
    for (int a = 0; sum->gradient != NULL && a < 9; a++)
        sum->gradient[a] += scale * energy * normal[a % 3];
    if (sum->hessian == NULL || request->kind == PEL_TANGENT_POSITIVE)
        return 0;
    set_line_gradient(fibre, fibre->stiffness * strain * (squared ? 2 : pel_lane_quotient(1, length)), y, gradient);
    for (int b = 0; b < 3; b++)
        for (int c = 0; c < 3; c++) {
            /* d (E n) = n dE + E (dN - n n.dN) / |N|, and dN = d x (x_b+1 - x_b+2) */
            double unit[3] = {c == 0, c == 1, c == 2}, edge[3], turned[3], slope[3];
            pel_vec3_subtract(x + 3 * ((b + 1) % 3), x + 3 * ((b + 2) % 3), edge);
            pel_vec3_cross(unit, edge, turned);
            pel_vec3_along(turned, -pel_vec3_dot(turned, normal), normal, turned);
            for (int i = 0; i < 3; i++)
                slope[i] = scale * (gradient[3 * b + c] * normal[i] + energy / size * turned[i]);
            add_push_column(slope, b, c, sum);
        }
    return 0;
}
