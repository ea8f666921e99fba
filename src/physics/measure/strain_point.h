/* An element at a point: the results of a law for strains and their derivatives, and the terms common to all
   elements. Written once over pel_lane (base/lane.h): an element, or one in each lane. */
#ifndef PEL_MEASURE_STRAIN_POINT_H
#define PEL_MEASURE_STRAIN_POINT_H

#include "base/lane.h"
#include "measure/tangent.h"

enum { PEL_STRAIN_LIMIT = 3 };

/* pel_tangent_request and pel_tangent_sum in lanes */
#ifdef PEL_LANE_DOUBLE
typedef pel_tangent_request pel_strain_request;
typedef pel_tangent_sum pel_strain_sum;
#else
typedef struct pel_strain_request {
    pel_tangent_kind kind;
    const pel_lane *stress, *step;
    pel_lane *extrapolated;
    const pel_lane *viscous;
    double rate;
    pel_lane *strain;
} pel_strain_request;
typedef struct pel_strain_sum {
    pel_lane *gradient, *hessian;
    int stride;
} pel_strain_sum;
#endif

/* the first `strains` rows and `unknowns` columns are used; volumes are in energy, stress and tangent */
typedef struct pel_strain_point {
    pel_lane energy;
    pel_lane strain[PEL_STRAIN_LIMIT];
    pel_lane stress[PEL_STRAIN_LIMIT];
    pel_lane tangent[PEL_STRAIN_LIMIT][PEL_STRAIN_LIMIT];
    pel_lane gradient[PEL_STRAIN_LIMIT][PEL_TANGENT_UNKNOWNS]; /* B */
} pel_strain_point;

PEL_INLINE void pel_strain_tangent_set(const pel_lane packed[6], pel_lane scale, pel_strain_point *point)
{
    static const int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            point->tangent[i][j] = scale * packed[at[i][j]];
}

/* part of a row of B: three numbers */
PEL_INLINE void pel_strain_row_set(pel_lane *row, pel_lane3 part)
{
    row[0] = part.x;
    row[1] = part.y;
    row[2] = part.z;
}

/* Stores the strains that rates refer to later, and adds the viscous part of this element. */
PEL_INLINE void pel_strain_damp(pel_strain_point *point, int strains, const pel_strain_request *request)
{
    pel_lane change[PEL_STRAIN_LIMIT];
    for (int i = 0; request->strain != NULL && i < strains; i++) {
        request->strain[PEL_VISCOUS_NUMBERS * i] = point->strain[i];
        for (int j = 0; j < PEL_STRAIN_LIMIT; j++)
            request->strain[PEL_VISCOUS_NUMBERS * i + 1 + j] = j < strains ? point->tangent[i][j] : pel_lane_splat(0);
    }
    if (request->viscous == NULL)
        return;
    const pel_lane rate = pel_lane_splat(request->rate), half = PEL_CONSTANT(0.5);
    for (int i = 0; i < strains; i++)
        change[i] = point->strain[i] - request->viscous[PEL_VISCOUS_NUMBERS * i];
    for (int i = 0; i < strains; i++) {
        pel_lane stress = pel_lane_splat(0);
        for (int j = 0; j < strains; j++) {
            const pel_lane entry = rate * request->viscous[PEL_VISCOUS_NUMBERS * i + 1 + j];
            point->tangent[i][j] += entry;
            stress += entry * change[j];
        }
        point->stress[i] += stress;
        point->energy += half * stress * change[i];
    }
}

/* stresses of the geometric part */
PEL_INLINE const pel_lane *pel_strain_geometric(const pel_strain_point *point, const pel_strain_request *request)
{
    return request->stress != NULL ? request->stress : point->stress;
}

/* A symmetric matrix over corners that no translation changes: its sum over the blocks of a row is 0. So the blocks
   without the last corner tell all of it. */
typedef struct pel_lead_matrix {
    pel_lane entry[PEL_TANGENT_UNKNOWNS - 3][PEL_TANGENT_UNKNOWNS - 3];
} pel_lead_matrix;

/* adds scale times the unit matrix to the block of corners a and b */
PEL_INLINE void pel_lead_add_unit(pel_lead_matrix *lead, int a, int b, pel_lane scale)
{
    for (int c = 0; c < 3; c++)
        lead->entry[3 * a + c][3 * b + c] += scale;
}

/* adds left right^T to the block of corners a and b */
PEL_INLINE void pel_lead_add_product(pel_lead_matrix *lead, int a, int b, pel_lane3 left, pel_lane3 right)
{
    const pel_lane l[3] = {left.x, left.y, left.z}, r[3] = {right.x, right.y, right.z};
    for (int c = 0; c < 3; c++)
        for (int d = 0; d < 3; d++)
            lead->entry[3 * a + c][3 * b + d] += l[c] * r[d];
}

PEL_INLINE void pel_lead_clear(pel_lead_matrix *lead, int corners)
{
    for (int i = 0; i < 3 * (corners - 1); i++)
        for (int j = 0; j < 3 * (corners - 1); j++)
            lead->entry[i][j] = pel_lane_splat(0);
}

/* adds the whole matrix to the Hessian of a sum */
PEL_INLINE void pel_lead_add(const pel_lead_matrix *lead, int corners, const pel_strain_sum *sum)
{
    const int m = 3 * (corners - 1);
    const pel_lane zero = pel_lane_splat(0);
    pel_lane corner[3][3] = {{zero, zero, zero}, {zero, zero, zero}, {zero, zero, zero}};
    for (int i = 0; i < m; i++) {
        pel_lane *row = sum->hessian + i * sum->stride, last[3] = {zero, zero, zero};
        for (int j = 0; j < m; j++)
            row[j] += lead->entry[i][j];
        for (int j = 0; j < m; j++)
            last[j % 3] -= lead->entry[i][j];
        for (int c = 0; c < 3; c++) {
            row[m + c] += last[c];
            sum->hessian[(m + c) * sum->stride + i] += last[c];
            corner[i % 3][c] -= last[c];
        }
    }
    for (int c = 0; c < 3; c++)
        for (int d = 0; d < 3; d++)
            sum->hessian[(m + c) * sum->stride + m + d] += corner[c][d];
}

/* adds the columns of unknowns after those of the corners: strain i has one of them, with this derivative */
PEL_INLINE void pel_strain_add_edges(pel_lane stiff[][PEL_TANGENT_UNKNOWNS], const pel_lane *derivative, int edges,
                                     int corners, const pel_strain_point *point, const pel_strain_sum *sum)
{
    const int n = 3 * corners;
    for (int k = 0; k < edges; k++) {
        pel_lane *row = sum->hessian + (n + k) * sum->stride;
        for (int i = 0; i < n; i++) {
            pel_lane entry = derivative[k] * stiff[k][i];
            row[i] += entry;
            sum->hessian[i * sum->stride + n + k] += entry;
        }
        for (int l = 0; l < edges; l++)
            row[n + l] += derivative[k] * derivative[l] * point->tangent[k][l];
    }
}

/* Adds B^T t and B^T D B with a geometric part, and extrapolates. Strain k has the unknown 3 corners + k where there
   are edges. */
PEL_INLINE void pel_strain_add(const pel_strain_point *point, int strains, int corners, int edges,
                               pel_lead_matrix *geometric, const pel_strain_request *request, const pel_strain_sum *sum)
{
    const int n = 3 * corners, m = n - 3, unknowns = n + edges;
    for (int i = 0; sum->gradient != NULL && i < strains; i++)
        for (int a = 0; a < unknowns; a++)
            sum->gradient[a] += point->stress[i] * point->gradient[i][a];
    if (sum->hessian == NULL && request->extrapolated == NULL)
        return;
    pel_lane stiff[PEL_STRAIN_LIMIT][PEL_TANGENT_UNKNOWNS], derivative[PEL_STRAIN_LIMIT];
    for (int i = 0; i < strains; i++)
        for (int a = 0; a < n; a++) {
            stiff[i][a] = pel_lane_splat(0);
            for (int j = 0; j < strains; j++)
                stiff[i][a] += point->tangent[i][j] * point->gradient[j][a];
        }
    for (int k = 0; k < edges; k++)
        derivative[k] = point->gradient[k][n + k];
    if (sum->hessian != NULL) {
        for (int a = 0; a < m; a++)
            for (int i = 0; i < strains; i++)
                for (int b = 0; b < m; b++)
                    geometric->entry[a][b] += stiff[i][a] * point->gradient[i][b];
        pel_lead_add(geometric, corners, sum);
        pel_strain_add_edges(stiff, derivative, edges, corners, point, sum);
    }
    for (int i = 0; request->extrapolated != NULL && i < strains; i++) {
        request->extrapolated[i] = point->stress[i];
        for (int a = 0; a < n; a++)
            request->extrapolated[i] += stiff[i][a] * request->step[a];
        for (int k = 0; k < edges; k++)
            request->extrapolated[i] += point->tangent[i][k] * derivative[k] * request->step[n + k];
    }
}

#endif
