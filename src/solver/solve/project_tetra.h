/* Projection of tetrahedra (xpbd). The energy is the sum of two squares, A^2 / 2 = shape and k B^2 / 2 with B = size
   (measure/tetra_lanes.h), so it has two constraints with the compliances a = 1 / (young volume dt^2) and a / k, solved
   together as in Macklin and Mueller, "A constraint-based formulation of stable neo-Hookean materials" (2021):

       [ G_AA + a   G_AB       ] [ dl_A ]     [ A + a l_A       ]
       [ G_AB       G_BB + a/k ] [ dl_B ] = - [ B + (a / k) l_B ],     G_XY = sum_k w_k (grad_k X) . (grad_k Y)

   Both are 0 at rest. With parts that pull against each other there, such as |F|^2 and (J - 1 - mu/lambda)^2, the
   system lacks the stiffness of shear, which is then in the second derivatives: bodies at rest explode where a substep
   is long beside the vibrations of a tetrahedron. Part of project_kernel.h. */

/* k of a law that does not resist a change of size: so soft that it does not matter */
#define PEL_LEAST_SIZE_STIFFNESS 1e-9

PEL_INLINE void project_tetra(const pel_batch *batch, int32_t block, int32_t lane, const pel_record *positions,
                              pel_lane3 *ways, pel_volume_kind kind)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_lane number[PEL_SOLID_NUMBERS], inverse_mass[4];
    pel_lane3 x[4], f[3], shape[4], size[4];
    for (int j = 0; j < PEL_SOLID_NUMBERS; j++)
        number[j] = number_of(batch, block, PEL_SOLID_NUMBERS, j, lane);
    for (int k = 0; k < 4; k++) {
        const pel_particle point = load_particle(batch, block, k, lane, positions);
        x[k] = point.at;
        inverse_mass[k] = point.fourth;
    }
    const pel_tetra_gradients b = pel_tetra_gradients_of(number);
    pel_tetra_columns(&b, x, f);
    const pel_tetra_parts p = pel_tetra_parts_of(&batch->law.solid, kind, f);
    const pel_lane zero = pel_lane_splat(0), strain = pel_lane_sqrt(pel_lane_max(p.shape + p.shape, zero));
    const pel_lane by_strain = pel_lane_quotient(pel_lane_splat(1), strain);
    pel_lane aa = zero, ab = zero, bb = zero;
    for (int k = 0; k < 4; k++) {
        shape[k] = pel_lane3_scale(pel_tetra_row(p.shape_slope, b.corner[k]), by_strain);
        size[k] = pel_tetra_row(p.size_slope, b.corner[k]);
        aa = aa + inverse_mass[k] * pel_lane3_dot(shape[k], shape[k]);
        ab = ab + inverse_mass[k] * pel_lane3_dot(shape[k], size[k]);
        bb = bb + inverse_mass[k] * pel_lane3_dot(size[k], size[k]);
    }
    const double stiffness = p.size_stiffness > PEL_LEAST_SIZE_STIFFNESS ? p.size_stiffness : PEL_LEAST_SIZE_STIFFNESS;
    const pel_lane softness = number[9] * pel_lane_splat(batch->law.inverse_square);
    const pel_lane size_softness = softness * PEL_CONSTANT(1 / stiffness);
    const pel_lane old_shape = multiplier_of(batch, block, 2, 0, lane),
                   old_size = multiplier_of(batch, block, 2, 1, lane);
    const pel_lane right_a = strain + softness * old_shape, right_b = p.size + size_softness * old_size;
    const pel_lane left = share_left(batch, softness, aa + PEL_CONSTANT(stiffness) * bb);
    aa = left * aa + softness;
    ab = left * ab;
    bb = left * bb + size_softness;
    const pel_lane inverse = pel_lane_splat(-1) / pel_lane_max(aa * bb - ab * ab, softness * size_softness);
    const pel_lane change_a = inverse * (bb * right_a - ab * right_b);
    const pel_lane change_b = inverse * (aa * right_b - ab * right_a);
    add_multiplier(batch, block, 2, 0, lane, old_shape, change_a);
    add_multiplier(batch, block, 2, 1, lane, old_size, change_b);
    for (int k = 0; k < 4; k++)
        ways[k] = pel_lane3_combine(inverse_mass[k] * change_a, shape[k], inverse_mass[k] * change_b, size[k]);
}
