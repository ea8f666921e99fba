/* An element at a point: what a law gives for strains and their derivatives, and what follows from them for every
   element alike. */
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

/* adds B^T t and B^T D B, and extrapolates; inline for constant counts */
static inline __attribute__((always_inline)) void pel_strain_add(const pel_strain_point *point, int strains,
                                                                 int unknowns, const pel_tangent_request *request,
                                                                 const pel_tangent_sum *sum)
{
    for (int i = 0; sum->gradient != NULL && i < strains; i++)
        for (int a = 0; a < unknowns; a++)
            sum->gradient[a] += point->stress[i] * point->gradient[i][a];
    if (sum->hessian == NULL && request->extrapolated == NULL)
        return;
    double stiff[PEL_STRAIN_LIMIT][PEL_TANGENT_UNKNOWNS];
    for (int i = 0; i < strains; i++)
        for (int a = 0; a < unknowns; a++) {
            stiff[i][a] = 0;
            for (int j = 0; j < strains; j++)
                stiff[i][a] += point->tangent[i][j] * point->gradient[j][a];
        }
    for (int a = 0; sum->hessian != NULL && a < unknowns; a++)
        for (int b = 0; b < unknowns; b++) {
            double entry = 0;
            for (int i = 0; i < strains; i++)
                entry += stiff[i][a] * point->gradient[i][b];
            sum->hessian[a * sum->stride + b] += entry;
        }
    for (int i = 0; request->extrapolated != NULL && i < strains; i++) {
        request->extrapolated[i] = point->stress[i];
        for (int a = 0; a < unknowns; a++)
            request->extrapolated[i] += stiff[i][a] * request->step[a];
    }
}

/* adds scale times the unit matrix to the block of vertices a and b */
static inline void pel_block_add_unit(const pel_tangent_sum *sum, int a, int b, double scale)
{
    for (int c = 0; c < 3; c++)
        sum->hessian[(3 * a + c) * sum->stride + 3 * b + c] += scale;
}

/* adds left right^T to the block of vertices a and b */
static inline void pel_block_add_product(const pel_tangent_sum *sum, int a, int b, const double left[3],
                                         const double right[3])
{
    for (int c = 0; c < 3; c++)
        for (int d = 0; d < 3; d++)
            sum->hessian[(3 * a + c) * sum->stride + 3 * b + d] += left[c] * right[d];
}

#endif
