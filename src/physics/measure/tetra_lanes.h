/* Tetrahedra in lanes: F by columns from the gradients of the shape functions at rest, energy and stress of a law
   (measure/tetra.h has them in double). */
#ifndef PEL_MEASURE_TETRA_LANES_H
#define PEL_MEASURE_TETRA_LANES_H

#include "base/lane.h"
#include "law/solid.h"
#include "measure/tetra.h"

/* the law in two parts, both over young, neither of them negative, and both with their least value 0 at rest: one of
   Lame's mu, and lambda/2 (J - 1)^2; of stvk the second is that of tr E = (S2 - 3) / 2. With the singular values s of F
   the first is mu/2 (s.s - 4 J + J^2) for neo-hookean, which is not negative since s.s >= 3 |J|^(2/3); mooney-rivlin
   adds c2 (II - 4 J + 1) with II >= 3 |J|^(4/3) */
typedef struct pel_tetra_parts {
    pel_lane shape;           /* energy of the first */
    pel_lane3 shape_slope[3]; /* its derivative by F, by columns */
    pel_lane size;            /* J - 1, or tr E */
    pel_lane3 size_slope[3];
    double size_stiffness;
} pel_tetra_parts;

/* gradient of the shape function of each corner */
typedef struct pel_tetra_gradients {
    pel_lane3 corner[4];
} pel_tetra_gradients;

PEL_INLINE pel_tetra_gradients pel_tetra_gradients_of(const pel_lane number[9])
{
    pel_tetra_gradients b;
    for (int k = 0; k < 3; k++)
        b.corner[k] = (pel_lane3){number[3 * k], number[3 * k + 1], number[3 * k + 2]};
    b.corner[3] =
        pel_lane3_scale(pel_lane3_add(pel_lane3_add(b.corner[0], b.corner[1]), b.corner[2]), pel_lane_splat(-1));
    return b;
}

PEL_INLINE void pel_tetra_columns(const pel_tetra_gradients *b, const pel_lane3 x[4], pel_lane3 f[3])
{
    pel_lane3 edge[3];
    for (int k = 0; k < 3; k++)
        edge[k] = pel_lane3_subtract(x[k], x[3]);
    for (int j = 0; j < 3; j++) {
        const pel_lane w[3] = {j == 0   ? b->corner[0].x
                               : j == 1 ? b->corner[0].y
                                        : b->corner[0].z,
                               j == 0   ? b->corner[1].x
                               : j == 1 ? b->corner[1].y
                                        : b->corner[1].z,
                               j == 0   ? b->corner[2].x
                               : j == 1 ? b->corner[2].y
                                        : b->corner[2].z};
        f[j] = pel_lane3_add(pel_lane3_combine(w[0], edge[0], w[1], edge[1]), pel_lane3_scale(edge[2], w[2]));
    }
}

/* columns times the gradient of a corner */
PEL_INLINE pel_lane3 pel_tetra_row(const pel_lane3 columns[3], pel_lane3 gradient)
{
    return pel_lane3_add(pel_lane3_combine(gradient.x, columns[0], gradient.y, columns[1]),
                         pel_lane3_scale(columns[2], gradient.z));
}

/* the nearest rotation, lane after lane; returns its product with F */
static inline pel_lane pel_tetra_rotation(const pel_lane3 f[3], pel_lane3 rotation[3])
{
    enum { LANES = sizeof(pel_lane) / sizeof(pel_lane_number) };
    pel_lane trace = pel_lane_splat(0);
    for (int lane = 0; lane < LANES; lane++) {
        double own[9], r[9], sum = 0;
        for (int j = 0; j < 3; j++) {
            own[j] = (double)((const pel_lane_number *)&f[j].x)[lane];
            own[3 + j] = (double)((const pel_lane_number *)&f[j].y)[lane];
            own[6 + j] = (double)((const pel_lane_number *)&f[j].z)[lane];
        }
        pel_nearest_rotation(own, r);
        for (int i = 0; i < 9; i++)
            sum += own[i] * r[i];
        ((pel_lane_number *)&trace)[lane] = (pel_lane_number)sum;
        for (int j = 0; j < 3; j++) {
            ((pel_lane_number *)&rotation[j].x)[lane] = (pel_lane_number)r[j];
            ((pel_lane_number *)&rotation[j].y)[lane] = (pel_lane_number)r[3 + j];
            ((pel_lane_number *)&rotation[j].z)[lane] = (pel_lane_number)r[6 + j];
        }
    }
    return trace;
}

PEL_INLINE pel_tetra_parts pel_tetra_parts_of(const pel_solid_law *law, pel_volume_kind kind, const pel_lane3 f[3])
{
    const bool is_stvk = kind == PEL_VOLUME_STVK, is_corotated = kind == PEL_VOLUME_COROTATED;
    const bool has_fourth = is_stvk || kind == PEL_VOLUME_MOONEY_RIVLIN;
    const pel_lane zero = pel_lane_splat(0), three = pel_lane_splat(3);
    pel_tetra_parts p;
    pel_lane c[3][3], square = zero, fourth = zero;
    for (int a = 0; a < 3; a++)
        for (int b = 0; b <= a; b++)
            c[a][b] = c[b][a] = pel_lane3_dot(f[a], f[b]);
    for (int a = 0; a < 3; a++) {
        square = square + c[a][a];
        for (int b = 0; has_fourth && b < 3; b++)
            fourth = fourth + c[a][b] * c[a][b];
    }
    const pel_lane change = square - three, by_square = PEL_CONSTANT(is_stvk ? 0 : law->b2) * change;
    p.shape = (PEL_CONSTANT(law->a2) + PEL_CONSTANT(0.5) * by_square) * change;
    if (has_fourth)
        p.shape = p.shape + PEL_CONSTANT(law->a4) * (fourth - three);
    const pel_lane linear = PEL_CONSTANT(2 * law->a2) + (by_square + by_square);
    for (int b = 0; b < 3; b++) {
        p.shape_slope[b] = pel_lane3_scale(f[b], linear);
        if (has_fourth)
            p.shape_slope[b] = pel_lane3_add(
                p.shape_slope[b],
                pel_lane3_scale(pel_tetra_row(f, (pel_lane3){c[0][b], c[1][b], c[2][b]}), PEL_CONSTANT(4 * law->a4)));
        p.size_slope[b] = is_stvk ? f[b] : pel_lane3_cross(f[(b + 1) % 3], f[(b + 2) % 3]);
    }
    if (is_corotated) {
        pel_lane3 rotation[3];
        p.shape = p.shape + PEL_CONSTANT(law->a1) * (pel_tetra_rotation(f, rotation) - three);
        for (int b = 0; b < 3; b++)
            p.shape_slope[b] = pel_lane3_add(p.shape_slope[b], pel_lane3_scale(rotation[b], PEL_CONSTANT(law->a1)));
    }
    p.size_stiffness = is_stvk ? 4 * law->b2 : law->k - law->shape_k;
    p.size = is_stvk ? PEL_CONSTANT(0.5) * change : pel_lane3_dot(f[0], p.size_slope[0]) - pel_lane_splat(1);
    if (!is_stvk && !is_corotated) {
        const pel_lane constant = PEL_CONSTANT(law->c), slope = PEL_CONSTANT(law->shape_k) * p.size;
        p.shape = p.shape + (constant + PEL_CONSTANT(0.5) * slope) * p.size;
        for (int b = 0; b < 3; b++)
            p.shape_slope[b] = pel_lane3_add(p.shape_slope[b], pel_lane3_scale(p.size_slope[b], constant + slope));
    }
    return p;
}

/* psi and its derivative by columns, over young */
PEL_INLINE pel_lane pel_tetra_stress(const pel_solid_law *law, pel_volume_kind kind, const pel_lane3 f[3],
                                     pel_lane3 stress[3])
{
    const pel_tetra_parts p = pel_tetra_parts_of(law, kind, f);
    const pel_lane slope = PEL_CONSTANT(p.size_stiffness) * p.size;
    for (int b = 0; b < 3; b++)
        stress[b] = pel_lane3_add(p.shape_slope[b], pel_lane3_scale(p.size_slope[b], slope));
    return p.shape + PEL_CONSTANT(0.5) * slope * p.size;
}

#endif
