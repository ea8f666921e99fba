/* Forces and energies of shells over the blocks of batches, all lanes at once. Blocks share no vertex, so a block adds
   to the forces of its corners independently of others. */
#include "base/assert.h"
#include "force/shell_body.h"
#include "law/fibre.h"
#include "measure/fibre.h"
#include "measure/hinge.h"
#include "measure/membrane.h"
#include "measure/tetra_lanes.h"
#include "measure/volume.h"

PEL_INLINE const int32_t *steps_of(const pel_batch *batch, int32_t block, int k)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    return batch->steps + ((size_t)block * (size_t)batch->arity + (size_t)k) * PEL_BLOCK;
}

PEL_INLINE pel_lane number_of(const pel_batch *batch, int32_t block, int j)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    return pel_lane_load(batch->numbers + ((size_t)block * (size_t)batch->number_count + (size_t)j) * PEL_BLOCK, 0);
}

PEL_INLINE pel_particle corner_of(const pel_batch *batch, int32_t block, int k, const pel_record *position)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    return pel_particle_load(position, steps_of(batch, block, k), 0);
}

static inline double sum_of_lanes(pel_lane a)
{
    double sum = 0;
    for (int i = 0; i < PEL_BLOCK; i++)
        sum += (double)a[i];
    return sum;
}

/* lanes that repeat another one count for nothing */
static inline pel_lane used_lanes(pel_lane a, int32_t count)
{
    for (int32_t i = count; i < PEL_BLOCK; i++)
        a[i] = 0;
    return a;
}

/* ---- elements: energy and forces of a block ---- */

/* psi times the area, and -d (area psi) / dx */
PEL_INLINE pel_lane press_membrane(const pel_batch *batch, int32_t block, const pel_record *position,
                                   pel_membrane_kind kind, pel_lane3 force[3])
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_lane law[PEL_LAW_NUMBERS], number[4];
    pel_lane3 x[3], stress[2];
    const int axis = pel_triangle_numbers(pel_law_traits(kind)) - PEL_TRIANGLE_NUMBERS;
    for (int i = 0; i < PEL_LAW_NUMBERS; i++)
        law[i] = i < axis ? number_of(batch, block, PEL_TRIANGLE_NUMBERS + i) : pel_lane_splat(batch->law.numbers[i]);
    for (int j = 0; j < 4; j++)
        number[j] = number_of(batch, block, j);
    for (int k = 0; k < 3; k++)
        x[k] = corner_of(batch, block, k, position).at;
    pel_gradient f = pel_gradient_of(pel_lane3_subtract(x[0], x[2]), pel_lane3_subtract(x[1], x[2]), number[0],
                                     number[1], number[2]);
    pel_lane modulus = number[3];
    if ((pel_law_traits(kind) & PEL_LAW_CONSTANT_TANGENT) != 0)
        modulus = pel_lane_splat((pel_real)batch->law.modulus) / number[3];
    else if ((pel_law_traits(kind) & PEL_LAW_COMPLIANT) != 0)
        modulus = pel_lane_splat(1) / number[3];
    pel_lane energy = pel_membrane_stress(kind, law, &f, stress), scale = -modulus;
    force[0] = pel_lane3_combine(scale * number[0], stress[0], scale * number[1], stress[1]);
    force[1] = pel_lane3_scale(stress[1], scale * number[2]);
    force[2] = pel_lane3_subtract(pel_lane3_scale(force[0], pel_lane_splat(-1)), force[1]);
    return modulus * energy;
}

PEL_INLINE pel_lane bend_angle(const pel_batch *batch, int32_t block, const pel_record *position, pel_lane3 force[4])
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_particle x[4];
    for (int k = 0; k < 4; k++)
        x[k] = corner_of(batch, block, k, position);
    pel_hinge_lanes h = pel_hinge_of(x, number_of(batch, block, 0), number_of(batch, block, 1));
    pel_lane moment = h.difference / number_of(batch, block, 2);
    pel_hinge_gradients(&h, moment * h.length, force);
    return PEL_CONSTANT(0.5) * moment * h.difference;
}

/* a hinge whose rest angle follows: the energy of a step from its present one */
PEL_INLINE pel_lane bend_fold(const pel_batch *batch, int32_t block, const pel_record *position, pel_lane3 force[4])
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_particle x[4];
    for (int k = 0; k < 4; k++)
        x[k] = corner_of(batch, block, k, position);
    pel_hinge_lanes h = pel_hinge_of(x, number_of(batch, block, 0), number_of(batch, block, 1));
    const pel_fold_response r =
        pel_fold_respond(h.difference, number_of(batch, block, 3), pel_lane_splat(batch->law.fold_share));
    const pel_lane stiffness = pel_lane_splat(1) / number_of(batch, block, 2);
    pel_hinge_gradients(&h, stiffness * r.moment * h.length, force);
    return stiffness * r.energy;
}

PEL_INLINE pel_lane bend_isometric(const pel_batch *batch, int32_t block, const pel_record *position,
                                   pel_lane3 force[4])
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_particle x[4];
    pel_lane weight[4];
    for (int k = 0; k < 4; k++)
        x[k] = corner_of(batch, block, k, position);
    for (int k = 1; k < 4; k++)
        weight[k] = number_of(batch, block, k - 1);
    pel_isometric_weights(weight);
    pel_lane3 sum = pel_isometric_of(x, weight);
    pel_lane factor = pel_lane_splat(1) / number_of(batch, block, 3);
    for (int k = 0; k < 4; k++)
        force[k] = pel_lane3_scale(sum, -(factor * weight[k]));
    return PEL_CONSTANT(0.5) * factor * (pel_lane3_dot(sum, sum) - number_of(batch, block, 4));
}

PEL_INLINE pel_fibre_image fibre_of(const pel_batch *batch, int32_t block, const pel_record *position)
{
    pel_lane3 x[3];
    for (int k = 0; k < 3; k++)
        x[k] = corner_of(batch, block, k, position).at;
    return pel_fibre_image_of(pel_lane3_subtract(x[0], x[2]), pel_lane3_subtract(x[1], x[2]),
                              number_of(batch, block, 0), number_of(batch, block, 1));
}

PEL_INLINE void pull_along(const pel_batch *batch, int32_t block, pel_lane3 image, pel_lane scale, pel_lane3 force[3])
{
    pel_lane c0 = number_of(batch, block, 0), c1 = number_of(batch, block, 1);
    force[0] = pel_lane3_scale(image, scale * c0);
    force[1] = pel_lane3_scale(image, scale * c1);
    force[2] = pel_lane3_scale(image, -(scale * (c0 + c1)));
}

PEL_INLINE pel_lane pull_fibre(const pel_batch *batch, int32_t block, const pel_record *position, double rest_length,
                               bool squared, pel_lane3 force[3])
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_fibre_image f = fibre_of(batch, block, position);
    pel_fibre_response r = pel_law_fibre(f.square, pel_lane_splat((pel_real)rest_length), squared);
    pel_lane stiffness = pel_lane_splat(1) / number_of(batch, block, 2);
    pull_along(batch, block, f.image, -(stiffness * r.strain * r.slope), force);
    return stiffness * pel_law_fibre_energy(r);
}

PEL_INLINE pel_lane pull_muscle(const pel_batch *batch, int32_t block, const pel_record *position, double activation,
                                pel_lane3 force[3])
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_fibre_image f = fibre_of(batch, block, position);
    pel_lane length = pel_lane_sqrt(f.square);
    pel_muscle_response r =
        pel_law_muscle(length, pel_lane_splat(batch->law.optimum), pel_lane_splat(batch->law.width));
    pel_lane tension = pel_lane_splat((pel_real)activation) / number_of(batch, block, 2);
    pull_along(batch, block, f.image, -pel_lane_quotient(tension * r.force, length), force);
    return tension * r.energy;
}

/* a push of stiffness / k_A times a third of E_A along the inward normal on each corner */
PEL_INLINE pel_lane push_normal(const pel_batch *batch, int32_t block, const pel_record *position, double stiffness,
                                bool squared, pel_lane3 force[3])
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_lane3 x[3];
    for (int k = 0; k < 3; k++)
        x[k] = corner_of(batch, block, k, position).at;
    pel_fibre_image f = pel_fibre_image_of(pel_lane3_subtract(x[0], x[2]), pel_lane3_subtract(x[1], x[2]),
                                           number_of(batch, block, 0), number_of(batch, block, 1));
    pel_lane psi = pel_law_fibre_shortening(pel_law_fibre(f.square, pel_lane_splat(1), squared));
    pel_lane push = pel_lane_splat((pel_real)(-stiffness / 3)) * number_of(batch, block, PEL_NORMAL_PUSH) * psi;
    pel_lane3 normal = pel_area_vector(x[0], x[1], x[2]);
    pel_lane scale = pel_lane_quotient(push, pel_lane_sqrt(pel_lane3_dot(normal, normal)));
    force[0] = force[1] = force[2] = pel_lane3_scale(normal, scale);
    return pel_lane_splat(0);
}

PEL_INLINE pel_lane weight_of(const pel_batch *batch, int32_t block)
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    return batch->number_count > 0 ? number_of(batch, block, 0) : pel_lane_splat(1);
}

/* a third of pressure times area along the normal on each corner (measure/volume.h) */
PEL_INLINE pel_lane press_area(const pel_batch *batch, int32_t block, const pel_record *position, double pressure,
                               pel_lane3 force[3])
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_lane3 x[3];
    for (int k = 0; k < 3; k++)
        x[k] = corner_of(batch, block, k, position).at;
    pel_lane scale = pel_lane_splat((pel_real)(pressure / 6)) * weight_of(batch, block);
    force[0] = force[1] = force[2] = pel_lane3_scale(pel_area_vector(x[0], x[1], x[2]), scale);
    return pel_lane_splat(0);
}

PEL_INLINE pel_lane strain_tetra(const pel_batch *batch, int32_t block, const pel_record *position,
                                 pel_volume_kind kind, pel_lane3 force[4])
{
    PEL_ASSERT_INDEX(block, batch->block_count);
    pel_lane number[9];
    pel_lane3 x[4], f[3], stress[3];
    for (int j = 0; j < 9; j++)
        number[j] = number_of(batch, block, j);
    for (int k = 0; k < 4; k++)
        x[k] = corner_of(batch, block, k, position).at;
    const pel_tetra_gradients b = pel_tetra_gradients_of(number);
    pel_tetra_columns(&b, x, f);
    const pel_lane scale = pel_lane_splat(1) / number_of(batch, block, 9);
    const pel_lane energy = pel_tetra_stress(&batch->law.solid, kind, f, stress);
    for (int k = 0; k < 4; k++)
        force[k] = pel_lane3_scale(pel_tetra_row(stress, b.corner[k]), -scale);
    return scale * energy;
}

/* ---- sweeps ---- */

/* The sweep of a kind: call finds forces and energy of a block. The batch is copied: what is stored cannot change a
   local, so its fields stay in registers. */
#define PEL_FORCE_SWEEP(name, corners, numbers_of, call)                                                               \
    static double name(const pel_batch *given, int32_t begin, int32_t end, const pel_record *position, double amount,  \
                       pel_record *force)                                                                              \
    {                                                                                                                  \
        pel_batch own = *given, *batch = &own;                                                                         \
        own.arity = corners;                                                                                           \
        own.number_count = numbers_of;                                                                                 \
        pel_lane energy = pel_lane_splat(0);                                                                           \
        (void)amount;                                                                                                  \
        for (int32_t block = begin; block < end; block++) {                                                            \
            pel_lane3 forces[corners];                                                                                 \
            pel_lane part = call;                                                                                      \
            energy = energy + (own.lane_counts[block] < PEL_BLOCK ? used_lanes(part, own.lane_counts[block]) : part);  \
            for (int k = 0; force != NULL && k < corners; k++)                                                         \
                pel_particle_move(force, steps_of(batch, block, k), 0, NULL, forces[k]);                               \
        }                                                                                                              \
        return sum_of_lanes(energy);                                                                                   \
    }

#define PEL_FORCE_LAW(KIND, law, name)                                                                                 \
    PEL_FORCE_SWEEP(sweep_##law, 3, pel_triangle_numbers(pel_law_##law##_traits),                                      \
                    press_membrane(batch, block, position, PEL_MEMBRANE_##KIND, forces))
PEL_MEMBRANE_LAWS(PEL_FORCE_LAW)
PEL_FORCE_SWEEP(sweep_angle, 4, PEL_ANGLE_NUMBERS, bend_angle(batch, block, position, forces))
PEL_FORCE_SWEEP(sweep_fold, 4, PEL_FOLD_NUMBERS, bend_fold(batch, block, position, forces))
PEL_FORCE_SWEEP(sweep_isometric, 4, PEL_ISOMETRIC_NUMBERS, bend_isometric(batch, block, position, forces))
PEL_FORCE_SWEEP(sweep_fibre, 3, given->number_count, pull_fibre(batch, block, position, amount, false, forces))
PEL_FORCE_SWEEP(sweep_fibre_square, 3, given->number_count, pull_fibre(batch, block, position, amount, true, forces))
PEL_FORCE_SWEEP(sweep_muscle, 3, PEL_FIBRE_NUMBERS, pull_muscle(batch, block, position, amount, forces))
PEL_FORCE_SWEEP(sweep_normal, 3, PEL_NORMAL_NUMBERS, push_normal(batch, block, position, amount, false, forces))
PEL_FORCE_SWEEP(sweep_normal_square, 3, PEL_NORMAL_NUMBERS, push_normal(batch, block, position, amount, true, forces))
PEL_FORCE_SWEEP(sweep_pressure, 3, given->number_count, press_area(batch, block, position, amount, forces))

#define PEL_FORCE_SOLID(KIND, law, name)                                                                               \
    PEL_FORCE_SWEEP(sweep_solid_##law, 4, PEL_SOLID_NUMBERS,                                                           \
                    strain_tetra(batch, block, position, PEL_VOLUME_##KIND, forces))
PEL_VOLUME_LAWS(PEL_FORCE_SOLID)

typedef double force_sweep(const pel_batch *batch, int32_t begin, int32_t end, const pel_record *position,
                           double amount, pel_record *force);

#define PEL_FORCE_LAW_ROW(KIND, law, name)                                                                             \
    [PEL_CONSTRAINT_MEMBRANE + PEL_MEMBRANE_##KIND] = sweep_##law,                                                     \
                               [PEL_CONSTRAINT_STRAIN + PEL_MEMBRANE_##KIND] = sweep_##law,
#define PEL_FORCE_SOLID_ROW(KIND, law, name) [PEL_CONSTRAINT_SOLID + PEL_VOLUME_##KIND] = sweep_solid_##law,
static force_sweep *const sweeps[PEL_CONSTRAINT_COUNT] = {
    PEL_MEMBRANE_LAWS(PEL_FORCE_LAW_ROW)[PEL_CONSTRAINT_ISOMETRIC] = sweep_isometric,
    [PEL_CONSTRAINT_ISOMETRIC_COMPLIANT] = sweep_isometric,
    [PEL_CONSTRAINT_ANGLE] = sweep_angle,
    [PEL_CONSTRAINT_ANGLE_COMPLIANT] = sweep_angle,
    [PEL_CONSTRAINT_FOLD] = sweep_fold,
    [PEL_CONSTRAINT_FIBRE] = sweep_fibre,
    [PEL_CONSTRAINT_FIBRE_COMPLIANT] = sweep_fibre,
    [PEL_CONSTRAINT_FIBRE_SQUARE] = sweep_fibre_square,
    [PEL_CONSTRAINT_FIBRE_SQUARE_COMPLIANT] = sweep_fibre_square,
    [PEL_CONSTRAINT_MUSCLE] = sweep_muscle,
    [PEL_CONSTRAINT_NORMAL] = sweep_normal,
    [PEL_CONSTRAINT_NORMAL_SQUARE] = sweep_normal_square,
    PEL_VOLUME_LAWS(PEL_FORCE_SOLID_ROW)[PEL_CONSTRAINT_PRESSURE] = sweep_pressure,
};

double pel_shell_sweep(const pel_batch *batch, int32_t begin, int32_t end, const pel_record *position, double amount,
                       pel_record *force)
{
    return sweeps[batch->kind](batch, begin, end, position, amount, force);
}

void pel_shell_sweep_areas(const pel_batch *batch, int32_t begin, int32_t end, const pel_record *position,
                           pel_record *area_vectors)
{
    for (int32_t block = begin; block < end; block++) {
        pel_lane3 x[3];
        pel_record areas[PEL_BLOCK], sums[PEL_BLOCK];
        for (int k = 0; k < 3; k++)
            x[k] = corner_of(batch, block, k, position).at;
        pel_lane half = pel_lane_splat((pel_real)0.5) * weight_of(batch, block);
        pel_lane3 area = pel_lane3_scale(pel_area_vector(x[0], x[1], x[2]), half);
        pel_lane length = pel_lane_sqrt(pel_lane3_dot(area, area));
        pel_lane3_store(areas, area);
        for (int i = 0; i < PEL_BLOCK; i++)
            areas[i][3] = length[i];
        for (int k = 0; k < 3; k++) {
            /* all are read before any is written, as lanes may repeat */
            const int32_t *steps = steps_of(batch, block, k);
            for (int i = 0; i < PEL_BLOCK; i++)
                sums[i] = pel_record_get(area_vectors, steps[i]) + areas[i];
            for (int i = 0; i < PEL_BLOCK; i++)
                pel_record_set(area_vectors, steps[i], sums[i]);
        }
    }
}

double pel_shell_sweep_volumes(const pel_batch *batch, int32_t begin, int32_t end, const pel_record *position,
                               pel_record origin)
{
    pel_lane volume = pel_lane_splat(0);
    const pel_lane3 from = {pel_lane_splat(origin[0]), pel_lane_splat(origin[1]), pel_lane_splat(origin[2])};
    for (int32_t block = begin; block < end; block++) {
        pel_lane3 x[3];
        for (int k = 0; k < 3; k++)
            x[k] = pel_lane3_subtract(corner_of(batch, block, k, position).at, from);
        volume = volume + used_lanes(pel_volume_of(x[0], x[1], x[2]), batch->lane_counts[block]);
    }
    return sum_of_lanes(volume) / 6;
}
