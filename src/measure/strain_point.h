/* An element at a point: the results of a law for strains and their derivatives, and the terms common to all
   elements. */
#ifndef PEL_MEASURE_STRAIN_POINT_H
#define PEL_MEASURE_STRAIN_POINT_H

#include "measure/tangent.h"

enum { PEL_STRAIN_LIMIT = 3 };

/* the first `strains` rows and `unknowns` columns are used; volumes are in energy, stress and tangent */
typedef struct pel_strain_point {
    double energy;
    double stress[PEL_STRAIN_LIMIT];
    double tangent[PEL_STRAIN_LIMIT][PEL_STRAIN_LIMIT];
    double gradient[PEL_STRAIN_LIMIT][PEL_TANGENT_UNKNOWNS]; /* B */
} pel_strain_point;

static inline void pel_strain_tangent_set(const double packed[6], double scale, pel_strain_point *point)
{
    static const int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            point->tangent[i][j] = scale * packed[at[i][j]];
}

/* stresses of the geometric part */
static inline const double *pel_strain_geometric(const pel_strain_point *point, const pel_tangent_request *request)
{
    return request->stress != NULL ? request->stress : point->stress;
}

/* A symmetric matrix over corners that no translation changes: its sum over the blocks of a row is 0. So the blocks
   without the last corner tell all of it. */
typedef struct pel_lead_matrix {
    double entry[PEL_TANGENT_UNKNOWNS - 3][PEL_TANGENT_UNKNOWNS - 3];
} pel_lead_matrix;

/* adds scale times the unit matrix to the block of corners a and b */
static inline void pel_lead_add_unit(pel_lead_matrix *lead, int a, int b, double scale)
{
    for (int c = 0; c < 3; c++)
        lead->entry[3 * a + c][3 * b + c] += scale;
}

/* adds left right^T to the block of corners a and b */
static inline void pel_lead_add_product(pel_lead_matrix *lead, int a, int b, const double left[3],
                                        const double right[3])
{
    for (int c = 0; c < 3; c++)
        for (int d = 0; d < 3; d++)
            lead->entry[3 * a + c][3 * b + d] += left[c] * right[d];
}

/* for constant counts */
#define PEL_ELEMENT_INLINE static inline __attribute__((always_inline))

PEL_ELEMENT_INLINE void pel_lead_clear(pel_lead_matrix *lead, int corners)
{
    for (int i = 0; i < 3 * (corners - 1); i++)
        for (int j = 0; j < 3 * (corners - 1); j++)
            lead->entry[i][j] = 0;
}

/* adds the whole matrix to the Hessian of a sum */
PEL_ELEMENT_INLINE void pel_lead_add(const pel_lead_matrix *lead, int corners, const pel_tangent_sum *sum)
{
    const int m = 3 * (corners - 1);
    double corner[3][3] = {{0}};
    for (int i = 0; i < m; i++) {
        double *row = sum->hessian + i * sum->stride, last[3] = {0, 0, 0};
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
PEL_ELEMENT_INLINE void pel_strain_add_edges(double stiff[][PEL_TANGENT_UNKNOWNS], const double *derivative, int edges,
                                             int corners, const pel_strain_point *point, const pel_tangent_sum *sum)
{
    const int n = 3 * corners;
    for (int k = 0; k < edges; k++) {
        double *row = sum->hessian + (n + k) * sum->stride;
        for (int i = 0; i < n; i++) {
            double entry = derivative[k] * stiff[k][i];
            row[i] += entry;
            sum->hessian[i * sum->stride + n + k] += entry;
        }
        for (int l = 0; l < edges; l++)
            row[n + l] += derivative[k] * derivative[l] * point->tangent[k][l];
    }
}

/* Adds B^T t and B^T D B with a geometric part, and extrapolates. Strain k has the unknown 3 corners + k where there
   are edges. */
PEL_ELEMENT_INLINE void pel_strain_add(const pel_strain_point *point, int strains, int corners, int edges,
                                       pel_lead_matrix *geometric, const pel_tangent_request *request,
                                       const pel_tangent_sum *sum)
{
    const int n = 3 * corners, m = n - 3, unknowns = n + edges;
    for (int i = 0; sum->gradient != NULL && i < strains; i++)
        for (int a = 0; a < unknowns; a++)
            sum->gradient[a] += point->stress[i] * point->gradient[i][a];
    if (sum->hessian == NULL && request->extrapolated == NULL)
        return;
    double stiff[PEL_STRAIN_LIMIT][PEL_TANGENT_UNKNOWNS], derivative[PEL_STRAIN_LIMIT];
    for (int i = 0; i < strains; i++)
        for (int a = 0; a < n; a++) {
            stiff[i][a] = 0;
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
