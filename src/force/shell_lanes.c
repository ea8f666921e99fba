/* The loops of the forces of shells over blocks of elements, all lanes at once. A lane without an element has numbers
   of zero: its energy and forces are zero. */
#include "force/shell_body.h"
#include "measure/hinge.h"
#include "measure/membrane.h"
#include "measure/volume.h"

static inline pel_lane number_of(const pel_real *numbers, int count, int32_t block, int j)
{
    return pel_lane_load(numbers + ((size_t)block * (size_t)count + (size_t)j) * PEL_BLOCK, 0);
}

static inline pel_particle load_corner(const int32_t *steps, int arity, int32_t block, int k,
                                       const pel_record *positions)
{
    return pel_particle_load(positions, steps + ((size_t)block * (size_t)arity + (size_t)k) * PEL_BLOCK, 0);
}

static inline double sum_of_lanes(pel_lane a)
{
    double sum = 0;
    for (int i = 0; i < PEL_BLOCK; i++)
        sum += (double)a[i];
    return sum;
}

/* ---- triangles ---- */

typedef struct triangle_forces {
    pel_lane3 row[3];
} triangle_forces;

/* a third of pressure times area along the normal on each corner (measure/volume.h) */
static inline void add_pressure(const pel_shell_body *own, int32_t block, pel_lane sixth, const pel_particle x[3],
                                triangle_forces *forces)
{
    pel_lane weight = number_of(own->triangle_numbers, PEL_TRIANGLE_NUMBERS, block, 4);
    pel_lane3 force = pel_area_vector(x[0].at, x[1].at, x[2].at);
    if (own->area_vectors != NULL) {
        pel_lane3_store(own->area_vectors + (size_t)block * PEL_BLOCK,
                        pel_lane3_scale(force, pel_lane_splat((pel_real)0.5) * weight));
        return;
    }
    force = pel_lane3_scale(force, sixth * weight);
    for (int k = 0; k < 3; k++)
        forces->row[k] = pel_lane3_add(forces->row[k], force);
}

/* psi times the area, and the forces -d (area psi) / dx */
PEL_INLINE pel_lane add_membrane(const pel_shell_body *own, int32_t block, pel_membrane_kind kind, const pel_lane *law,
                                 const pel_particle x[3], triangle_forces *forces)
{
    pel_lane number[4];
    for (int j = 0; j < 4; j++)
        number[j] = number_of(own->triangle_numbers, PEL_TRIANGLE_NUMBERS, block, j);
    pel_lane3 first = pel_lane3_subtract(x[0].at, x[2].at), second = pel_lane3_subtract(x[1].at, x[2].at);
    pel_gradient f = pel_gradient_of(first, second, number[0], number[1], number[2]);
    pel_lane3 stress[2];
    pel_lane energy = pel_membrane_stress(kind, law, &f, stress), scale = -number[3];
    forces->row[0] = pel_lane3_combine(scale * number[0], stress[0], scale * number[1], stress[1]);
    forces->row[1] = pel_lane3_scale(stress[1], scale * number[2]);
    forces->row[2] = pel_lane3_subtract(pel_lane3_scale(forces->row[0], pel_lane_splat(-1)), forces->row[1]);
    return number[3] * energy;
}

PEL_INLINE double sweep_triangles(const pel_shell_body *own, const pel_shell_sweep *sweep, pel_membrane_kind kind,
                                  bool membrane)
{
    pel_lane energy = pel_lane_splat(0), sixth = pel_lane_splat((pel_real)(sweep->pressure / 6));
    pel_lane law[PEL_LAW_NUMBERS];
    for (int i = 0; i < PEL_LAW_NUMBERS; i++)
        law[i] = pel_lane_splat((pel_real)own->law.numbers[i]);
    const pel_lane3 none = {energy, energy, energy};
    for (int32_t block = sweep->begin; block < sweep->end; block++) {
        pel_particle x[3];
        triangle_forces forces = {{none, none, none}};
        for (int k = 0; k < 3; k++)
            x[k] = load_corner(own->triangle_steps, 3, block, k, sweep->position);
        if (membrane)
            energy = energy + add_membrane(own, block, kind, law, x, &forces);
        if (sweep->with_pressure)
            add_pressure(own, block, sixth, x, &forces);
        for (int k = 0; k < 3; k++)
            pel_lane3_store(own->rows + ((size_t)block * 3 + (size_t)k) * PEL_BLOCK, forces.row[k]);
    }
    return sum_of_lanes(energy);
}

double pel_shell_sweep_triangles(const pel_shell_body *own, const pel_shell_sweep *sweep, bool membrane)
{
    if (!membrane || !own->shell->has_membrane)
        return sweep_triangles(own, sweep, PEL_MEMBRANE_STVK, false);
    switch (own->law.kind) {
#define SWEEP(KIND, law, name)                                                                                         \
    case PEL_MEMBRANE_##KIND:                                                                                          \
        return sweep_triangles(own, sweep, PEL_MEMBRANE_##KIND, true);
        PEL_MEMBRANE_LAWS(SWEEP)
#undef SWEEP
    }
    return 0;
}

double pel_shell_sweep_volumes(const pel_shell_body *own, const pel_shell_sweep *sweep)
{
    pel_lane volume = pel_lane_splat(0);
    const pel_record corner = pel_record_get(sweep->position, own->triangle_steps[0]);
    const pel_lane3 origin = {pel_lane_splat(corner[0]), pel_lane_splat(corner[1]), pel_lane_splat(corner[2])};
    for (int32_t block = sweep->begin; block < sweep->end; block++) {
        pel_lane3 x[3];
        for (int k = 0; k < 3; k++)
            x[k] = pel_lane3_subtract(load_corner(own->triangle_steps, 3, block, k, sweep->position).at, origin);
        pel_lane used = number_of(own->triangle_numbers, PEL_TRIANGLE_NUMBERS, block, 5);
        volume = volume + used * pel_volume_of(x[0], x[1], x[2]);
    }
    return sum_of_lanes(volume) / 6;
}

/* ---- hinges ---- */

static inline void store_hinge(const pel_shell_body *own, int32_t block, const pel_lane3 force[4])
{
    for (int k = 0; k < 4; k++)
        pel_lane3_store(own->rows + own->first_hinge_row + ((size_t)block * 4 + (size_t)k) * PEL_BLOCK, force[k]);
}

static double sweep_angles(const pel_shell_body *own, const pel_shell_sweep *sweep)
{
    const pel_real *numbers = own->hinge_numbers;
    pel_lane energy = pel_lane_splat(0);
    for (int32_t block = sweep->begin; block < sweep->end; block++) {
        pel_particle x[4];
        for (int k = 0; k < 4; k++)
            x[k] = load_corner(own->hinge_steps, 4, block, k, sweep->position);
        pel_hinge_lanes h = pel_hinge_of(x, number_of(numbers, PEL_HINGE_NUMBERS, block, 0),
                                         number_of(numbers, PEL_HINGE_NUMBERS, block, 1));
        pel_lane moment = number_of(numbers, PEL_HINGE_NUMBERS, block, 2) * h.difference;
        energy = energy + moment * h.difference;
        pel_lane3 force[4];
        pel_hinge_gradients(&h, moment * h.length, force);
        store_hinge(own, block, force);
    }
    return 0.5 * sum_of_lanes(energy);
}

static double sweep_isometric(const pel_shell_body *own, const pel_shell_sweep *sweep)
{
    const pel_real *numbers = own->hinge_numbers;
    pel_lane energy = pel_lane_splat(0);
    for (int32_t block = sweep->begin; block < sweep->end; block++) {
        pel_particle x[4];
        pel_lane weight[4];
        for (int k = 0; k < 4; k++)
            x[k] = load_corner(own->hinge_steps, 4, block, k, sweep->position);
        for (int k = 1; k < 4; k++)
            weight[k] = number_of(numbers, PEL_HINGE_NUMBERS, block, k - 1);
        pel_isometric_weights(weight);
        pel_lane3 sum = pel_isometric_of(x, weight);
        pel_lane factor = number_of(numbers, PEL_HINGE_NUMBERS, block, 3);
        energy = energy + factor * pel_lane3_dot(sum, sum) - number_of(numbers, PEL_HINGE_NUMBERS, block, 4);
        pel_lane3 force[4];
        for (int k = 0; k < 4; k++)
            force[k] = pel_lane3_scale(sum, -(factor * weight[k]));
        store_hinge(own, block, force);
    }
    return 0.5 * sum_of_lanes(energy);
}

double pel_shell_sweep_hinges(const pel_shell_body *own, const pel_shell_sweep *sweep)
{
    return own->shell->bending == PEL_BENDING_HINGE ? sweep_angles(own, sweep) : sweep_isometric(own, sweep);
}
